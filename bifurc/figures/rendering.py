"""A figure as PNG and as SVG at once: every artist is drawn once, for both.

What takes time in matplotlib is to find out what is to be drawn, and where: ticks, texts,
transformed lines.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.backend_bases import GraphicsContextBase, RendererBase
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox, Transform, TransformedPath
from PIL import Image

POINTS = 72  # of an inch, the unit of SVG
# No dates, no names of programs, so that the same figure gives the same bytes.
NO_METADATA = {"Date": None, "Creator": None}
WHOLE = 1e-6  # of a pixel, by which rounding may miss a whole number of them
QUICK_COMPRESSION = 2  # of PNG: two thirds of the time of 6, a tenth more bytes


LONGEST = 200  # letters of a text, which no figure is wide enough for
NO_DATE: dict[str, Any] = {"CreationDate": None}  # of PDF


class Rendering(NamedTuple):
    """A figure as the bytes of a PNG and of an SVG file."""

    png: bytes
    svg: bytes


def contents_of(
    figure: Figure, resolution: float, formats: Sequence[str]
) -> dict[str, bytes]:
    """The bytes of files of a figure in these formats; of a long text its beginning is
    shown."""
    _cut_long_texts(figure)
    contents: dict[str, bytes] = {}
    if {"png", "svg"} & set(formats):
        contents.update(render(figure, resolution)._asdict())
    if "pdf" in formats:
        stream = io.BytesIO()
        figure.savefig(stream, format="pdf", metadata=NO_DATE)
        contents["pdf"] = stream.getvalue()
    return {ending: contents[ending] for ending in formats}


def _cut_long_texts(figure: Figure) -> None:
    for text in figure.findobj(Text):
        words = text.get_text()
        if len(words) > LONGEST:
            text.set_text(f"{words[: LONGEST - 1]}…")


def render(figure: Figure, resolution: float) -> Rendering:
    """A figure, which is opaque and holds no image, in both formats; ``resolution`` is
    that of the PNG file, in dots per inch."""
    figure.set_dpi(POINTS)
    text = io.StringIO()
    renderer = _DoubleRenderer(figure, text, resolution)
    figure.draw(renderer)
    renderer.finalize()
    return Rendering(renderer.png(), text.getvalue().encode())


# The methods of both have no annotations.
SvgRenderer: Any = RendererSVG
PixelRenderer: Any = RendererAgg


class _DoubleRenderer(SvgRenderer):
    """Writes SVG, and hands everything on to a renderer of pixels, to scale."""

    def __init__(self, figure: Figure, text: io.StringIO, resolution: float) -> None:
        width, height = figure.get_size_inches()
        super().__init__(
            POINTS * width,
            POINTS * height,
            text,
            image_dpi=resolution,
            metadata=NO_METADATA,
        )
        self._resolution = resolution
        self._scale = resolution / POINTS
        self._to_pixels = Affine2D().scale(self._scale)
        rows = int(resolution * height + WHOLE)
        columns = int(resolution * width + WHOLE)
        self._pixels = PixelRenderer(columns, rows, resolution)

    def png(self) -> bytes:
        """What has been drawn, as the bytes of a PNG file."""
        colors = np.asarray(self._pixels.buffer_rgba())[..., :3]
        stream = io.BytesIO()
        Image.fromarray(np.ascontiguousarray(colors)).save(
            stream,
            format="png",
            dpi=(self._resolution, self._resolution),
            compress_level=QUICK_COMPRESSION,
        )
        return stream.getvalue()

    def draw_path(
        self,
        gc: GraphicsContextBase,
        path: Path,
        transform: Transform,
        rgbFace: Any = None,
    ) -> None:
        super().draw_path(gc, path, transform, rgbFace)
        context = self._pixel_context(gc)
        self._pixels.draw_path(context, path, transform + self._to_pixels, rgbFace)

    def draw_markers(
        self,
        gc: GraphicsContextBase,
        marker_path: Path,
        marker_trans: Transform,
        path: Path,
        trans: Transform,
        rgbFace: Any = None,
    ) -> None:
        super().draw_markers(gc, marker_path, marker_trans, path, trans, rgbFace)
        self._pixels.draw_markers(
            self._pixel_context(gc),
            marker_path,
            marker_trans + self._to_pixels,
            path,
            trans + self._to_pixels,
            rgbFace,
        )

    draw_path_collection = RendererBase.draw_path_collection  # path by path

    def draw_text(
        self,
        gc: GraphicsContextBase,
        x: float,
        y: float,
        s: str,
        prop: FontProperties,
        angle: float,
        ismath: Any = False,
        mtext: Text | None = None,
    ) -> None:
        super().draw_text(gc, x, y, s, prop, angle, ismath, mtext)
        context = self._pixel_context(gc)
        left = self._scale * x
        top = self._pixels.height - self._scale * (self.height - y)
        self._pixels.draw_text(context, left, top, s, prop, angle, ismath, mtext)

    def _pixel_context(self, gc: GraphicsContextBase) -> GraphicsContextBase:
        """How to draw, with the clipping to scale; lines and dashes are in points."""
        context = GraphicsContextBase()
        context.copy_properties(gc)
        rectangle = gc.get_clip_rectangle()
        if rectangle is not None:
            corners = self._to_pixels.transform(rectangle.get_points())
            context.set_clip_rectangle(Bbox(corners))
        path: Any
        path, transform = gc.get_clip_path()
        if transform is not None:
            clip = TransformedPath(path, transform + self._to_pixels)
            context.set_clip_path(clip)
        return context
