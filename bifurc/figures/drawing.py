"""How curves, marks and names look in every figure."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bifurc.atlas import Atlas
from bifurc.figures.planes import copies_in_frame, place_in_frame, scale_of
from bifurc.singular.point import Kind

__all__ = [
    "SETTINGS",
    "Style",
    "draw_curve",
    "draw_legend",
    "draw_marks",
    "form_style",
    "label_groups",
    "legend_size",
    "note_emptiness",
]

# settings that the user's own must not disturb
SETTINGS: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.labelsize": 9,
    "axes.titlesize": 9,
    "axes.linewidth": 0.8,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8.5,
    "axes.unicode_minus": True,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "savefig.bbox": None,
    "svg.hashsalt": "bifurc",
    "svg.fonttype": "path",
    "text.usetex": False,
    "path.simplify": True,
    "lines.dash_capstyle": "butt",
    "lines.solid_capstyle": "butt",
    "axes.edgecolor": "0.4",
    "figure.constrained_layout.w_pad": 0.08,
    "figure.constrained_layout.h_pad": 0.08,
}

# Okabe and Ito (2008), without the yellow that is too light on white
COLORS = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#56B4E9",
    "#E69F00",
    "#000000",
    "#7F3C8D",
)
DASHES = (
    "-",
    (0, (6, 2)),
    (0, (6, 2, 1.2, 2)),
    (0, (1.2, 1.2)),
    (0, (9, 2, 3, 2)),
    (0, (3, 1.5)),
)
LABEL_REACH = 11.0  # points from a mark to its name
DIRECTIONS = [
    np.array([np.cos(a), np.sin(a)])
    for a in np.deg2rad([45, 135, 315, 225, 0, 180, 90, 270])
]
MARKS = {Kind.BIFURCATION: ("o", 6.5), Kind.RANK_DROP: ("D", 5.0)}
OTHER_MARK = ("s", 5.0)


@dataclass(frozen=True)
class Style:
    """Colour and dashes of a form."""

    color: str
    dashes: Any


def form_style(index: int) -> Style:
    """Style of form number ``index``: colours and dashes repeat, but not together
    before 24 forms."""
    return Style(COLORS[index % len(COLORS)], DASHES[index % len(DASHES)])


def draw_curve(
    axes: Axes, rows: np.ndarray, style: Style, width: float, cut: bool = False
) -> None:
    """One line through rows (k, 2) with breaks at NaN; not cut at the frame, in which a
    torus's curves lie anyway."""
    axes.plot(
        rows[:, 0],
        rows[:, 1],
        color=style.color,
        linestyle=style.dashes,
        linewidth=width,
        clip_on=cut,
        zorder=2,
    )


def draw_marks(
    axes: Axes, atlas: Atlas, plane: tuple[int, ...], size: float | None = None
) -> None:
    """Singular points, isolated solutions and surfaces in a plane, on both edges where
    they lie on one."""
    scales = (scale_of(atlas, plane[0]), scale_of(atlas, plane[-1]))
    pick = [plane[0], plane[-1]]
    for surface in atlas.surfaces:
        shown = place_in_frame(surface.samples[:, pick], scales)
        axes.plot(shown[:, 0], shown[:, 1], ".", color="0.6", markersize=2, zorder=1)
    for solution in atlas.rigid:
        shown = copies_in_frame(place_in_frame(solution[None, pick], scales)[0], scales)
        axes.plot(
            shown[:, 0],
            shown[:, 1],
            "x",
            color="0.3",
            markersize=size or 5.5,
            clip_on=False,
            zorder=3,
        )
    for point in atlas.points:
        marker, usual = MARKS.get(point.kind, OTHER_MARK)
        shown = copies_in_frame(
            place_in_frame(point.point.u[None, pick], scales)[0], scales
        )
        axes.plot(
            shown[:, 0],
            shown[:, 1],
            marker,
            markersize=size or usual,
            markerfacecolor="white",
            markeredgecolor="black",
            markeredgewidth=1.1,
            clip_on=False,
            zorder=4,
        )


def draw_legend(figure: Figure, atlas: Atlas) -> None:
    """Names of the forms and of the marks, at the right of the figure."""
    marks = [
        (MARKS.get(kind, OTHER_MARK), kind.value)
        for kind in dict.fromkeys(p.kind for p in atlas.points)
    ]
    entries = [
        Line2D(
            [],
            [],
            color=form_style(i).color,
            linestyle=form_style(i).dashes,
            linewidth=1.8,
            label=name,
        )
        for i, name in enumerate(_wrapped_names(atlas))
    ]
    entries += [
        Line2D(
            [],
            [],
            linestyle="",
            marker=marker,
            markersize=size,
            markerfacecolor="white",
            markeredgecolor="black",
            label=label,
        )
        for (marker, size), label in marks
    ]
    if len(atlas.rigid):
        entries.append(
            Line2D(
                [], [], linestyle="", marker="x", color="0.3", label="rigid assembly"
            )
        )
    if atlas.surfaces:
        entries.append(
            Line2D(
                [],
                [],
                linestyle="",
                marker=".",
                color="0.6",
                label="mobility 2 or more",
            )
        )
    if entries:
        figure.legend(
            handles=entries, loc="outside right upper", frameon=False, handlelength=3.2
        )


def legend_size(atlas: Atlas) -> tuple[float, float]:
    """Width and height that the legend takes, in inches."""
    lines = [line for name in _wrapped_names(atlas) for line in name.splitlines()]
    longest = max([len("rigid assembly"), *map(len, lines)])
    return 0.75 + 0.072 * longest, 0.17 * (len(lines) + 4)


def _wrapped_names(atlas: Atlas) -> list[str]:
    return [textwrap.fill(form.name, 24) for form in atlas.forms]


def note_emptiness(axes: Axes, atlas: Atlas) -> None:
    """Say so in the middle of the frame where there is no form."""
    if not atlas.forms:
        said = "no form" + (
            f"\nclosure gap {atlas.closure_gap:.1e}"
            if 0 < atlas.closure_gap < np.inf
            else ""
        )
        axes.text(
            0.5,
            0.5,
            said,
            transform=axes.transAxes,
            ha="center",
            va="center",
            color="0.4",
            fontsize=11,
        )


# --- names beside their marks -------------------------------------------------------------------------


def label_groups(axes: Axes, atlas: Atlas, plane: tuple[int, ...]) -> None:
    """Names beside the singular points, one label for those on one spot, where curves
    and other names leave room."""
    figure = axes.figure.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()
    to_points = 72.0 / figure.dpi

    def place(spots: np.ndarray) -> np.ndarray:
        return axes.transData.transform(np.atleast_2d(spots)) * to_points

    frame = axes.get_window_extent()
    corners = np.array([[frame.x0, frame.y0], [frame.x1, frame.y1]]) * to_points
    lines = [np.asarray(line.get_xydata()) for line in axes.lines]
    occupied = np.concatenate(
        [np.empty((0, 2))] + [_filled(place(rows)) for rows in lines]
    )
    groups = _groups(atlas, plane)
    scales = (scale_of(atlas, plane[0]), scale_of(atlas, plane[-1]))
    marks = [
        mark for _, spot in groups for mark in place(copies_in_frame(spot, scales))
    ]
    taken = [(mark, np.full(2, 3.5)) for mark in marks]
    for names, spot in groups:
        at = place(spot)[0]
        half = np.array([2.8 * len(names) + 1, 4.5])
        candidates = [
            at + (LABEL_REACH * reach - 4 + half * np.abs(push)) * push
            for reach in (1.0, 1.5, 2.2)
            for push in DIRECTIONS
        ]
        costs = [
            _cost(middle, half, occupied, taken, corners) + 0.1 * k
            for k, middle in enumerate(candidates)
        ]
        best = candidates[int(np.argmin(costs))]
        taken.append((best, half))
        axes.annotate(
            names,
            (spot[0], spot[1]),
            (best[0] - at[0], best[1] - at[1]),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=9,
            fontweight="bold",
            zorder=6,
            bbox={
                "boxstyle": "square,pad=0.1",
                "facecolor": "white",
                "alpha": 0.75,
                "linewidth": 0,
            },
        )


def _groups(atlas: Atlas, plane: tuple[int, ...]) -> list[tuple[str, np.ndarray]]:
    """Joined names and spot of the singular points that fall on one spot of the
    plane."""
    scales = (scale_of(atlas, plane[0]), scale_of(atlas, plane[-1]))
    pick = [plane[0], plane[-1]]
    span = np.array([s.half if np.isfinite(s.half) else np.inf for s in scales])
    every = np.concatenate(
        [curve.branch.sample(50)[:, pick] for curve in atlas.forms]
        or [np.zeros((1, 2))]
    )
    near = 0.01 * np.where(
        np.isfinite(span), 2 * span, np.maximum(np.ptp(every, axis=0), 1e-6)
    )
    groups: list[tuple[list[str], np.ndarray]] = []
    for point in atlas.points:
        spot = place_in_frame(point.point.u[None, pick], scales)[0]
        for names, other in groups:
            gap = np.abs(spot - other)
            if np.all(np.minimum(gap, np.abs(2 * span - gap)) < near):
                names.append(point.name)
                break
        else:
            groups.append(([point.name], spot))
    return [(", ".join(names), spot) for names, spot in groups]


def _filled(rows: np.ndarray) -> np.ndarray:
    """A polyline with points added so that none are more than about 3 apart."""
    parts = [rows]
    steps = np.linalg.norm(np.diff(rows, axis=0), axis=1)
    for i in np.flatnonzero(steps > 3.0):
        parts.append(np.linspace(rows[i], rows[i + 1], int(steps[i] / 3) + 2))
    out = np.concatenate(parts)
    return out[np.all(np.isfinite(out), axis=1)]


def _cost(
    middle: np.ndarray,
    half: np.ndarray,
    occupied: np.ndarray,
    taken: list[tuple[np.ndarray, np.ndarray]],
    corners: np.ndarray,
) -> float:
    """How bad a place for a label is: what it covers, and how far it sticks out of the
    frame."""
    covered = np.count_nonzero(np.all(np.abs(occupied - middle) < half, axis=1))
    clash = sum(
        100 for other, size in taken if np.all(np.abs(other - middle) < half + size)
    )
    outside = (
        np.maximum(corners[0] - (middle - half), 0).sum()
        + np.maximum(middle + half - corners[1], 0).sum()
    )
    return float(covered + clash + 20 * outside)
