"""The picture of the transition map in three unknowns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D, proj3d

from bifurc import torus
from bifurc.atlas import Atlas, MeetingPoint
from bifurc.checks import UnknownName
from bifurc.figures.drawing import (
    OVERLAY,
    DegreeLocator,
    drawn_curves,
    legend_entries,
    marked_points,
)
from bifurc.figures.labels import joined
from bifurc.figures.layout import Canvas, Margins, PanelPlan, figure_of, lay_out
from bifurc.figures.planes import (
    Scale,
    copies_in_frame,
    curve_points,
    indices_of,
    place_in_frame,
    scale_of,
)
from bifurc.figures.rc import drawing_style
from bifurc.figures.selection import EVERYTHING, Selection

SPACE = {"projection": "3d", "proj_type": "ortho"}
MARGINS = Margins(0.1, 0.3, 0.25, 0.1)
LEAST_HEIGHT = 2.4  # of the cube with its ticks, in inches
SAME_SPOT = 0.004  # of the picture: points that are closer share a name


def plot_map_in_space(
    atlas: Atlas,
    unknowns: Sequence[UnknownName | int],
    figure: Canvas | None = None,
    *,
    ax: Axes3D | None = None,
    selection: Selection = EVERYTHING,
) -> Figure:
    """The forms in the space of three unknowns, by their names or by their numbers from
    1, with the singular points marked and named; angles in degrees, on the torus.

    It is drawn into ``ax``, or with a legend into a ``figure`` or a part of one, or
    into a new one. Raises `ProblemError` for what are not three of the unknowns.
    """
    indices = indices_of(atlas, "unknowns", unknowns, 3)
    scales = [scale_of(atlas, index, selection.window) for index in indices]
    with drawing_style():
        if ax is None:
            plan = PanelPlan(1, 1, 4.9, 4.9, MARGINS, least_height=LEAST_HEIGHT)
            entries = legend_entries(atlas, selection)
            figure, (ax,), _ = lay_out(figure, plan, entries, SPACE)
        FigureCanvasAgg(figure_of(ax))
        _draw_forms(ax, atlas, indices, scales, selection)
        _set_frame(ax, scales)
        _draw_points(ax, atlas, indices, scales, selection)
    return figure_of(ax)


def _shown(points: np.ndarray, scales: Sequence[Scale]) -> np.ndarray:
    """Points (k, 3) as they are shown, periodic unknowns within the frame."""
    periods = np.array([2 * scale.half for scale in scales])
    factors = np.array([scale.factor for scale in scales])
    middles = np.array([scale.middle for scale in scales])
    return np.asarray(torus.wrap(points * factors - middles, periods) + middles)


def _draw_forms(
    axes: Axes3D,
    atlas: Atlas,
    indices: Sequence[int],
    scales: Sequence[Scale],
    selection: Selection,
) -> None:
    """Every form and near motion, with breaks where it leaves the frame."""
    half = np.array([scale.half for scale in scales])
    for curve in drawn_curves(atlas, selection):
        points = curve_points(curve.branch)
        if not len(points):
            continue
        shown = _shown(points[:, list(indices)], scales)
        is_jump = np.any(np.abs(np.diff(shown, axis=0)) > half, axis=1)
        shown[~_are_in_frame(shown, scales)] = np.nan
        rows = np.insert(shown, np.flatnonzero(is_jump) + 1, np.nan, axis=0)
        axes.plot(*rows.T, linewidth=1.6, label=curve.name, **curve.style.line)


def _spots(points: np.ndarray, scales: Sequence[Scale]) -> np.ndarray:
    """Where points (k, 3) are shown (m, 3): on both faces of the frame where they lie on
    one, and nowhere where they lie outside of it."""
    copies = [copies_in_frame(p, scales) for p in place_in_frame(points, scales)]
    shown = np.concatenate(copies)
    return shown[_are_in_frame(shown, scales).all(axis=1)]


def _are_in_frame(shown: np.ndarray, scales: Sequence[Scale]) -> np.ndarray:
    """Which coordinates of points (k, 3), as they are shown, lie in the frame: all of
    those without a period."""
    endless = (-np.inf, np.inf)
    limits = [scale.limits if scale.is_periodic else endless for scale in scales]
    low, high = np.array(limits).T
    return np.asarray((low <= shown) & (shown <= high))


def _draw_points(
    axes: Axes3D,
    atlas: Atlas,
    indices: Sequence[int],
    scales: Sequence[Scale],
    selection: Selection,
) -> None:
    """What is marked, singular points with their names, surfaces, and what the user lays
    over."""
    picked = list(indices)
    for surface in selection.surfaces(atlas):
        shown = place_in_frame(surface.samples[:, picked], scales)
        shown = shown[_are_in_frame(shown, scales).all(axis=1)]
        axes.plot(*shown.T, ".", color="0.6", markersize=2, zorder=1)
    for marked in marked_points(atlas, selection):
        places = _spots(np.array(marked.points)[:, picked], scales).T
        axes.plot(*places, ls="", zorder=marked.zorder, **marked.style)
    over = selection.points_over(*(atlas.names[index] for index in indices))
    if over is not None:
        factors = [scale.factor for scale in scales]
        places = _spots(over / factors, scales).T
        axes.plot(*places, ls="", zorder=5, **OVERLAY)
    _name_points(axes, selection.points(atlas), picked, scales)


def _name_points(
    axes: Axes3D,
    points: Sequence[MeetingPoint],
    indices: Sequence[int],
    scales: Sequence[Scale],
) -> None:
    """Singular points with their names; those in one spot share it."""
    spots, names = [], []
    for point in points:
        for spot in _spots(point.point.u[None, list(indices)], scales)[:1]:
            spots.append(spot)
            names.append(point.name)

    def are_same(spot: np.ndarray, other: np.ndarray) -> bool:
        return bool(np.abs(_seen(axes, spot) - _seen(axes, other)).max() < SAME_SPOT)

    for label in joined(names, spots, are_same):
        _write_name(axes, label.spot, label.text)


def _seen(axes: Axes3D, spot: np.ndarray) -> np.ndarray:
    """Where in the picture (2,) a spot (3,) is seen."""
    return np.array(proj3d.proj_transform(*spot, axes.get_proj())[:2])


def _write_name(axes: Axes3D, spot: np.ndarray, name: str) -> None:
    """A name beside a spot (3,), towards the middle: at the right are ticks."""
    is_right = _seen(axes, spot)[0] > 0
    text, side = (f"{name}  ", "right") if is_right else (f"  {name}", "left")
    axes.text(*spot, text, ha=side, fontweight="bold", zorder=5)


def _set_frame(axes: Axes3D, scales: Sequence[Scale]) -> None:
    """Names, ticks and limits of the three axes. The second one begins where the first
    ends, and ends where the third begins: it has no ticks there."""
    labels = (axes.set_xlabel, axes.set_ylabel, axes.set_zlabel)
    limits = (axes.set_xlim, axes.set_ylim, axes.set_zlim)
    lines = (axes.xaxis, axes.yaxis, axes.zaxis)
    for scale, label, limit, line in zip(scales, labels, limits, lines, strict=True):
        label(scale.label)
        if scale.is_periodic:
            limit(scale.limits)
        if scale.is_degrees:
            line.set_major_locator(DegreeLocator())
        else:
            line.set_major_locator(MaxNLocator(5))
    second = axes.yaxis
    if scales[1].is_degrees:
        second.set_major_locator(DegreeLocator(has_ends=False))
    else:
        second.set_major_locator(MaxNLocator(5, prune="both"))
    axes.set_box_aspect((1, 1, 1), zoom=0.9)
    axes.view_init(elev=22, azim=-58)
