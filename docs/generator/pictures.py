"""The pictures of a linkage: one configuration drawn, and its transition map."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d.proj3d import proj_transform

from bifurc.atlas import Atlas
from bifurc.figures.plotting import plot_transition_map
from bifurc.figures.rc import drawing_style
from docs.generator.scene_figure import draw_configuration
from linkages.labels import loop_of
from linkages.scene import Scene, breadth, clearance, make_scene

MARGIN = 0.05  # inches
LETTER = 0.12  # inches around the place of a number
SAMPLES = 100  # configurations of each form that are looked at


def drawing_of(name: str) -> str:
    """The file of the drawing of a linkage."""
    return f"{name}-drawing.svg"


def map_of(name: str) -> str:
    """The file of the transition map of a linkage."""
    return f"{name}-map.svg"


def draw_linkage(atlas: Atlas, name: str, folder: Path) -> None:
    """Write both pictures of the linkage called ``name`` to ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    drawing = draw_configuration(loop_of(atlas), clearest_configuration(atlas))
    _save(drawing, folder / drawing_of(name), _extent(drawing))
    _save(plot_transition_map(atlas), folder / map_of(name), "tight")


def draw_no_picture(path: Path) -> None:
    """Write the picture that stands for a study that is not run."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure = Figure(figsize=(4, 2.8))
    figure.text(0.5, 0.5, "code and text", ha="center", color="0.5", fontsize=26)
    figure.savefig(path, dpi=100)


def _save(figure: Figure, path: Path, extent: Bbox | Literal["tight"]) -> None:
    """Write the part of a figure within ``extent`` (inches), with a small margin."""
    with drawing_style():
        figure.savefig(
            path, bbox_inches=extent, pad_inches=MARGIN, metadata={"Date": None}
        )


def _extent(drawing: Figure) -> Bbox:
    """Where there is something on a drawing in space, which is centred in a cube:
    inches, with room for the numbers of the joints."""
    drawing.draw_without_rendering()
    axes: Any = drawing.axes[0]  # Axes3D, whose artists have no types
    lines = [np.array(line.get_data_3d()) for line in axes.lines]
    numbers = [np.array(text.get_position_3d())[:, None] for text in axes.texts]
    places = np.concatenate(lines + numbers, axis=1)
    x, y, _ = proj_transform(*places, axes.get_proj())
    pixels = axes.transData.transform(np.column_stack([x, y]))
    inches = drawing.dpi_scale_trans.inverted().transform(pixels)
    return Bbox([inches.min(axis=0), inches.max(axis=0)]).padded(LETTER)


def clearest_configuration(atlas: Atlas) -> np.ndarray:
    """Of all configurations (n,), rad, that are looked at, that whose joints lie
    furthest from joints and links; zeros where the map holds none."""
    loop = loop_of(atlas)

    def room(theta: np.ndarray) -> float:
        return _room(make_scene(loop, theta))

    samples = [theta for form in atlas.forms for theta in form.branch.sample(SAMPLES)]
    for surface in atlas.surfaces:
        samples += list(surface.samples[:SAMPLES])
    samples += list(atlas.rigid)
    return max(samples, key=room, default=np.zeros(loop.n))


def _room(scene: Scene) -> float:
    """How much joints and links keep clear of each other."""
    between_joints, to_links = clearance(scene.joints, scene.normals)
    return between_joints + 2 * to_links + breadth(scene.joints)
