"""A configuration of a loop drawn with matplotlib: joint axes, links as common normals,
offsets, joint numbers."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from linkages.loop import Loop
from linkages.scene import best_view, make_scene

__all__ = ["draw_configuration"]

AXIS, LINK, OFFSET = "#888888", "#0072B2", "#D55E00"


def draw_configuration(loop: Loop, theta: np.ndarray, title: str = "") -> Figure:
    """The loop at ``theta`` (n,), rad, seen from where it is clearest; lengths keep
    their proportions."""
    scene = make_scene(loop, theta)
    figure = Figure(figsize=(5, 5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(projection="3d", proj_type="ortho")
    for ends in scene.axes:
        axes.plot(*ends.T, color=AXIS, linewidth=1.2, linestyle="-.")
    for ends in scene.offsets:
        axes.plot(*ends.T, color=OFFSET, linewidth=2.5)
    for ends in scene.normals:
        axes.plot(*ends.T, color=LINK, linewidth=2.5, solid_capstyle="round")
    axes.scatter(*scene.joints.T, color="black", s=18, depthshade=False)
    for number, ends in enumerate(scene.axes, start=1):
        place = scene.joints[number - 1] + 1.15 * (ends[1] - scene.joints[number - 1])
        axes.text(*place, str(number), ha="center", va="center", fontsize=12)
    everything = np.concatenate(
        [scene.axes.reshape(-1, 3), scene.normals.reshape(-1, 3)]
    )
    low, high = everything.min(axis=0), everything.max(axis=0)
    middle, half = (low + high) / 2, 0.5 * float((high - low).max())
    for set_limits, centre in zip(
        (axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, strict=True
    ):
        set_limits(centre - half, centre + half)
    axes.set_box_aspect((1, 1, 1), zoom=1.1)
    elevation, azimuth = best_view(scene)
    axes.view_init(elev=elevation, azim=azimuth)
    axes.set_axis_off()
    if title:
        figure.suptitle(title, fontsize=11)
    return figure
