"""A linkage that moves, as a picture file: GIF with Pillow, MP4 with ffmpeg, by the
writers of matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.errors import BifurcError
from bifurc.figures.rc import drawing_style
from linkages.export.model import Motion
from linkages.links.traced_points import traced_point
from linkages.pictures.picture import Painter
from linkages.pictures.plot_linkage import draw_picture
from linkages.subject import subject_at
from linkages.viewing.start import clearest

RATE = 25  # pictures a second
RESOLUTION = 100  # dots per inch
CORNER = (0.02, 0.98)  # where the name of a motion is, of the picture
GIF, MP4 = ".gif", ".mp4"


class NoWriterError(BifurcError):
    """A program is missing that writes this kind of file."""


def movie_writer(path: Path) -> AbstractMovieWriter:
    """What writes a moving picture to a path that ends with .gif or .mp4; raises
    `NoWriterError`."""
    if path.suffix.lower() == GIF:
        return PillowWriter(fps=RATE)
    if not FFMpegWriter.isAvailable():
        matplotlib.rcParams["animation.ffmpeg_path"] = _installed_ffmpeg(path)
    return FFMpegWriter(fps=RATE)


def _installed_ffmpeg(path: Path) -> str:
    """The program that comes with the package imageio-ffmpeg; raises `NoWriterError`."""
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise NoWriterError(
            f"{path.name}: MP4 is written by ffmpeg, which is not here; install it, or "
            "pip install 'bifurc[movies]'"
        ) from None


def write_animation(
    atlas: Atlas,
    motions: Sequence[Motion],
    size: tuple[float, float],
    path: Path,
    trace: Sequence[str] = (),
) -> None:
    """Write the linkage of an atlas along motions, one after another, one picture for
    each of their configurations, of a size in inches, with the paths of the points of a
    ``trace``; raises `NoWriterError`, `OSError`, and `GeometryError` for a point of no
    body.

    It is seen from where the configuration is clear whose joints are farthest from one
    line, and all of the motions are within the picture. Of several each is named.
    """
    points = np.concatenate([motion.configurations for motion in motions])
    painter = _painter_of(atlas, points, trace)
    pictures = [painter.picture(point) for point in points]
    names = [motion.name for motion in motions for _ in motion.configurations]
    corners = np.array([picture.corners for picture in pictures])
    frame = np.array([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
    with drawing_style():
        figure = Figure(figsize=size)
        ax = figure.add_axes((0, 0, 1, 1))
        writer = movie_writer(path)
        with writer.saving(figure, str(path), RESOLUTION):
            for picture, name in zip(pictures, names, strict=True):
                ax.clear()
                draw_picture(ax, picture, frame)
                if len(motions) > 1:
                    ax.text(*CORNER, name, va="top", transform=ax.transAxes)
                writer.grab_frame()


def _painter_of(atlas: Atlas, points: np.ndarray, trace: Sequence[str]) -> Painter:
    """What makes pictures at configurations (k, n)."""
    parts = subject_at(atlas).parts_for(trace)
    first = points[clearest(parts.breadths(points))]
    return Painter(parts, first, points, [traced_point(parts, text) for text in trace])
