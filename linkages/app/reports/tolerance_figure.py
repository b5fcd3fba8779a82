"""The figure of `bifurc tolerance`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.curves.valley import Unfolding
from linkages.app.reports.tolerance import Ladder, Tolerance, half_branches, room_beside
from linkages.app.texts.configurations import arclength_unit, unit_of_arclengths

COLOURS = (
    "#0077bb",
    "#ee7733",
    "#009988",
    "#cc3311",
    "#33bbee",
    "#ee3377",
    "#997700",
    "#555555",
)
FRACTIONS = np.linspace(0.0, 1.0, 20)  # of a piece of a valley
ALONG = np.linspace(-0.3, 0.3, 200)  # arclengths from a bifurcation


def draw_tolerance(atlas: Atlas, copy: Tolerance, ladder: Ladder) -> Figure:
    """Closure gap and width of the near misses against the error, and one near miss as
    it looks."""
    if not atlas.bifurcations:
        figure = Figure(figsize=(5.4, 4.6), layout="constrained")
        _draw_gaps(figure.subplots(), atlas, ladder)
        return figure
    figure = Figure(figsize=(15.0, 4.6), layout="constrained")
    gaps, widths, near_miss = figure.subplots(1, 3)
    _draw_gaps(gaps, atlas, ladder)
    _draw_widths(widths, atlas, ladder)
    _draw_widest(near_miss, atlas, copy)
    return figure


# --- against the error ----------------------------------------------------------------


def _draw_gaps(axes: Axes, atlas: Atlas, ladder: Ladder) -> None:
    """The closure gap grows like the error."""
    names = [form.name for form in atlas.forms]
    _draw_ladder(axes, ladder.errors, ladder.gaps, names)
    _draw_power_law(axes, ladder.errors, ladder.gaps, 1.0)
    axes.set(ylabel="largest closure gap along the form")
    axes.legend(fontsize=8, frameon=False)


def _draw_widths(axes: Axes, atlas: Atlas, ladder: Ladder) -> None:
    """The width of a near miss grows like the root of the error."""
    names = [point.name for point in atlas.bifurcations]
    _draw_ladder(axes, ladder.errors, ladder.widths, names)
    _draw_power_law(axes, ladder.errors, ladder.widths, 0.5)
    axes.set(ylabel=f"width of the near miss ({unit_of_arclengths(atlas)})")
    axes.legend(fontsize=8, frameon=False)


def _draw_ladder(
    axes: Axes, errors: np.ndarray, values: np.ndarray, names: Sequence[str]
) -> None:
    """Values (errors, copies, names): every copy as a dot, the medians as lines where
    no copy is missing."""
    for i, name in enumerate(names):
        colour = COLOURS[i % len(COLOURS)]
        for column in values[:, :, i].T:
            axes.plot(errors, column, ".", color=colour, ms=4, alpha=0.5)
        medians = np.median(values[:, :, i], axis=1)
        axes.plot(errors, medians, color=colour, lw=1.4, label=name)
    axes.set(xscale="log", yscale="log", xlabel="manufacturing error")
    axes.grid(alpha=0.3)


def _draw_power_law(
    axes: Axes, errors: np.ndarray, values: np.ndarray, power: float
) -> None:
    """A dashed line below the values."""
    positive = values[np.isfinite(values) & (values > 0)]
    if not len(positive):
        return
    middle_value = np.exp(np.median(np.log(positive)))
    middle_error = np.exp(np.median(np.log(errors)))
    level = middle_value / middle_error**power
    line = 0.15 * level * errors**power
    axes.plot(errors, line, "k--", lw=0.9, label=f"error to the {power:g}")


# --- a near miss ----------------------------------------------------------------------


def _draw_widest(axes: Axes, atlas: Atlas, copy: Tolerance) -> None:
    """The bifurcation that opens widest, nominal and as made, in the plane of its null
    space."""
    distances = np.array([unfolding.distance for unfolding in copy.unfoldings])
    number = int(np.argmax(np.where(np.isfinite(distances), distances, 0.0)))
    point = atlas.bifurcations[number]
    unfolding = copy.unfoldings[number]
    unit = arclength_unit(atlas)
    plane = unit.factor * point.point.null_space[:, :2]
    _draw_nominal(axes, atlas, point, plane)
    _draw_valleys(axes, unfolding, point.point.u, plane)
    starts, _ = half_branches(atlas, point)
    reach = 1.2 * np.abs((starts - point.point.u) @ plane).max()
    width = f"{unfolding.distance:.2g} apart"
    axes.set(
        xlim=(-reach, reach),
        ylim=(-reach, reach),
        aspect="equal",
        title=f"{point.name} with errors of {copy.error:g}: {width}",
        xlabel=f"along the null space, first direction ({unit.name})",
        ylabel=f"second direction ({unit.name})",
    )
    axes.legend(fontsize=8, frameon=False, loc="lower left")
    axes.grid(alpha=0.3)


def _draw_nominal(
    axes: Axes, atlas: Atlas, point: MeetingPoint, plane: np.ndarray
) -> None:
    """The forms that pass a bifurcation, without errors."""
    for k, (index, s) in enumerate(point.passes):
        form = atlas.forms[index]
        back, ahead = (room_beside(form.branch, s, sign) for sign in (-1, 1))
        along = np.clip(ALONG, -back, ahead)
        x, y = ((form.branch(s + along) - form.branch(s)) @ plane).T
        colour = COLOURS[(4 + k) % len(COLOURS)]
        label = f"{form.name}, nominal"
        axes.plot(x, y, color=colour, lw=1.2, ls="--", label=label)


def _draw_valleys(
    axes: Axes, unfolding: Unfolding, centre: np.ndarray, plane: np.ndarray
) -> None:
    """The valleys that a linkage as made follows instead."""
    for k, valley in enumerate(unfolding.valleys):
        if not len(valley.pieces):
            continue
        points = valley(valley.places(FRACTIONS).ravel())
        x, y = ((points - centre) @ plane).T
        axes.plot(x, y, color="k", lw=1.6, label="as made" if k == 0 else None)
