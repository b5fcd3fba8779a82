"""A configuration of a loop drawn with matplotlib: joint axes, links as common normals,
offsets, joint numbers."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from linkages.loop import Loop
from linkages.scene import Scene, best_view, make_scene

AXIS_COLOR = "#888888"
LINK_COLOR = "#0072B2"
OFFSET_COLOR = "#D55E00"
NUMBER_REACH = 1.15  # where a number stands, over where the axis of the joint ends


def draw_configuration(loop: Loop, theta: np.ndarray, title: str = "") -> Figure:
    """The loop at ``theta`` (n,), rad, seen from where it is clearest; lengths keep
    their proportions."""
    scene = make_scene(loop, theta)
    figure = Figure(figsize=(5, 5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(projection="3d", proj_type="ortho")
    _draw_lines(axes, scene)
    _draw_joints(axes, scene)
    _set_limits(axes, scene)
    view = best_view(scene)
    axes.view_init(elev=view.elevation, azim=view.azimuth)
    axes.set_axis_off()
    if title:
        figure.suptitle(title, fontsize=11)
    return figure


def _draw_lines(axes: Axes3D, scene: Scene) -> None:
    for ends in scene.axes:
        axes.plot(*ends.T, color=AXIS_COLOR, linewidth=1.2, linestyle="-.")
    for ends in scene.offsets:
        axes.plot(*ends.T, color=OFFSET_COLOR, linewidth=2.5)
    for ends in scene.normals:
        axes.plot(*ends.T, color=LINK_COLOR, linewidth=2.5, solid_capstyle="round")


def _draw_joints(axes: Axes3D, scene: Scene) -> None:
    """Dots, and the numbers of the joints beyond the ends of their axes."""
    axes.scatter(*scene.joints.T, color="black", s=18, depthshade=False)
    places = scene.joints + NUMBER_REACH * (scene.axes[:, 1] - scene.joints)
    for number, place in enumerate(places, start=1):
        axes.text(*place, str(number), ha="center", va="center", fontsize=12)


def _set_limits(axes: Axes3D, scene: Scene) -> None:
    """The same scale in all directions, around everything that is drawn."""
    ends = np.concatenate([scene.axes.reshape(-1, 3), scene.normals.reshape(-1, 3)])
    low = ends.min(axis=0)
    high = ends.max(axis=0)
    half = 0.5 * float((high - low).max())
    x, y, z = (low + high) / 2
    axes.set_xlim(x - half, x + half)
    axes.set_ylim(y - half, y + half)
    axes.set_zlim(z - half, z + half)
    axes.set_box_aspect((1, 1, 1), zoom=1.1)
