"""The picture of the transition map in three unknowns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator
from mpl_toolkits.mplot3d import Axes3D, proj3d

from bifurc import torus
from bifurc.atlas import Atlas
from bifurc.figures.drawing import curve_style, draw_legend_outside, legend_size
from bifurc.figures.planes import (
    Scale,
    curve_points,
    indices_of,
    scale_of,
    shown_branches,
)
from bifurc.figures.rendering import RC
from bifurc.figures.style import hollow


def plot_map_in_space(
    atlas: Atlas, unknowns: Sequence[int], figure: Figure | None = None
) -> Figure:
    """The forms in the space of three unknowns, numbered from 1, with the singular
    points marked and named; angles in degrees, on the torus.

    Raises `ProblemError` for numbers that are not three of the unknowns.
    """
    indices = indices_of(atlas, "unknowns", unknowns, 3)
    scales = [scale_of(atlas, index) for index in indices]
    legend = legend_size(atlas)
    with rc_context(RC):
        size = (5.6 + legend.width, max(5.2, legend.height))
        figure = figure or Figure(figsize=size, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot(projection="3d", proj_type="ortho")
        _draw_forms(axes, atlas, indices, scales)
        _set_frame(axes, scales)
        _draw_points(axes, atlas, indices, scales)
        draw_legend_outside(figure, atlas)
    return figure


def _shown(points: np.ndarray, scales: Sequence[Scale]) -> np.ndarray:
    """Points (k, 3) as they are shown, periodic unknowns within the frame."""
    periods = np.array([2 * scale.half for scale in scales])
    factors = np.array([scale.factor for scale in scales])
    return np.asarray(torus.wrap(points * factors, periods))


def _draw_forms(
    axes: Axes3D, atlas: Atlas, indices: Sequence[int], scales: Sequence[Scale]
) -> None:
    """Every form and near motion, with breaks where it leaves the frame."""
    half = np.array([scale.half for scale in scales])
    for i, branch in enumerate(shown_branches(atlas)):
        points = curve_points(branch)
        if not len(points):
            continue
        shown = _shown(points[:, list(indices)], scales)
        is_jump = np.any(np.abs(np.diff(shown, axis=0)) > half, axis=1)
        rows = np.insert(shown, np.flatnonzero(is_jump) + 1, np.nan, axis=0)
        axes.plot(*rows.T, linewidth=1.6, **curve_style(atlas, i).line)


def _draw_points(
    axes: Axes3D, atlas: Atlas, indices: Sequence[int], scales: Sequence[Scale]
) -> None:
    """Singular points with their names, and isolated solutions."""
    for point in atlas.points:
        spot = _shown(point.point.u[None, list(indices)], scales)[0]
        axes.plot(*spot[:, None], zorder=4, **hollow(point.kind.mark))
        _write_name(axes, spot, point.name)
    for solution in atlas.rigid:
        spot = _shown(solution[None, list(indices)], scales)[0]
        axes.plot(*spot[:, None], "x", color="0.3", markersize=4)


def _write_name(axes: Axes3D, spot: np.ndarray, name: str) -> None:
    """A name beside a spot (3,), towards the middle: at the right are ticks."""
    across, _, _ = proj3d.proj_transform(*spot, axes.get_proj())
    is_right = across > 0
    text, side = (f"{name}  ", "right") if is_right else (f"  {name}", "left")
    axes.text(*spot, text, ha=side, fontsize=8.5, fontweight="bold", zorder=5)


def _inner_number(degrees: float, _: int | None = None) -> str:
    """The number at a tick; nothing at the ends of a turn."""
    number = round(degrees)
    return "" if abs(number) >= 180 else str(number).replace("-", "\N{MINUS SIGN}")


def _set_frame(axes: Axes3D, scales: Sequence[Scale]) -> None:
    """Names, ticks and limits of the three axes. The second one begins where the first
    ends, and ends where the third begins: its ticks there have no numbers."""
    labels = (axes.set_xlabel, axes.set_ylabel, axes.set_zlabel)
    limits = (axes.set_xlim, axes.set_ylim, axes.set_zlim)
    lines = (axes.xaxis, axes.yaxis, axes.zaxis)
    for scale, label, limit, line in zip(scales, labels, limits, lines, strict=True):
        label(scale.label)
        if scale.is_periodic:
            limit(-scale.half, scale.half)
        if scale.half == 180.0:
            line.set_major_locator(MultipleLocator(90))
        else:
            line.set_major_locator(MaxNLocator(5))
    second, half = axes.yaxis, scales[1].half
    if half == 180.0:
        second.set_major_formatter(_inner_number)
    else:
        second.set_major_locator(MaxNLocator(5, prune="both"))
    axes.set_box_aspect((1, 1, 1), zoom=0.9)
    axes.view_init(elev=22, azim=-58)
