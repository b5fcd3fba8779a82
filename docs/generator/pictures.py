"""The pictures of a linkage: one configuration drawn, and its transition map."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.figures.plotting import plot_transition_map
from bifurc.figures.style import RC
from linkages.app.scene_figure import draw_configuration
from linkages.labels import loop_of
from linkages.scene import Scene, breadth, clearance, make_scene

__all__ = ["clearest_configuration", "draw_linkage", "drawing_of", "map_of"]

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
    _save(drawing, folder / drawing_of(name))
    _save(plot_transition_map(atlas), folder / map_of(name))


def _save(figure: Figure, path: Path) -> None:
    """Write a figure without the empty space around what it shows."""
    with rc_context(RC):
        figure.savefig(
            path, bbox_inches="tight", pad_inches=0.05, metadata={"Date": None}
        )


def clearest_configuration(atlas: Atlas) -> np.ndarray:
    """Of all configurations (n,), rad, that are looked at, that whose joints lie
    furthest from joints and links; zeros where the map holds none."""
    loop = loop_of(atlas)

    def room(theta: np.ndarray) -> float:
        return _room(make_scene(loop, theta))

    samples = [
        theta for form in atlas.forms for theta in form.branch.sample(SAMPLES)
    ]
    for surface in atlas.surfaces:
        samples += list(surface.samples[:SAMPLES])
    samples += list(atlas.rigid)
    return max(samples, key=room, default=np.zeros(loop.n))


def _room(scene: Scene) -> float:
    """How much joints and links keep clear of each other."""
    between_joints, to_links = clearance(scene.joints, scene.normals)
    return between_joints + 2 * to_links + breadth(scene.joints)
