"""The figure of `bifurc tolerance`."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from linkages.app.tolerance import Ladder, Tolerance, half_branches

__all__ = ["draw_tolerance"]

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


def draw_tolerance(atlas: Atlas, copy: Tolerance, ladder: Ladder) -> Figure:
    """Closure gap and width of the near misses against the error, and one near miss as
    it looks."""
    wide = bool(atlas.bifurcations)
    figure = Figure(figsize=(15.0 if wide else 5.4, 4.6), layout="constrained")
    panels = figure.subplots(1, 3 if wide else 1, squeeze=False)[0]
    _draw_ladder(
        panels[0], ladder.errors, ladder.gaps, [form.name for form in atlas.forms], 1.0
    )
    panels[0].set(
        xlabel="manufacturing error", ylabel="largest closure gap along the form"
    )
    if wide:
        names = [point.name for point in atlas.bifurcations]
        _draw_ladder(panels[1], ladder.errors, ladder.widths, names, 0.5)
        panels[1].set(
            xlabel="manufacturing error", ylabel="width of the near miss (rad)"
        )
        _draw_near_miss(panels[2], atlas, copy)
    return figure


def _draw_ladder(
    axes: Axes, errors: np.ndarray, values: np.ndarray, names: list[str], power: float
) -> None:
    """Every copy as a dot, the medians as lines where no copy is missing, and the power
    law as a dashed one."""
    for i, name in enumerate(names):
        colour = COLOURS[i % len(COLOURS)]
        for column in values[:, :, i].T:
            axes.plot(errors, column, ".", color=colour, ms=4, alpha=0.5)
        axes.plot(
            errors, np.median(values[:, :, i], axis=1), color=colour, lw=1.4, label=name
        )
    finite = values[np.isfinite(values) & (values > 0)]
    if len(finite):
        level = (
            np.exp(np.median(np.log(finite)))
            / np.exp(np.median(np.log(errors))) ** power
        )
        axes.plot(
            errors,
            0.15 * level * errors**power,
            "k--",
            lw=0.9,
            label=f"error to the {power:g}",
        )
    axes.set(xscale="log", yscale="log")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)


def _draw_near_miss(axes: Axes, atlas: Atlas, copy: Tolerance) -> None:
    """The bifurcation that opens widest, nominal and as made, in the plane of its null
    space."""
    known = [u.distance if np.isfinite(u.distance) else 0.0 for u in copy.unfoldings]
    number = int(np.argmax(known))
    point, unfolding = atlas.bifurcations[number], copy.unfoldings[number]
    plane = point.point.null_space[:, :2]
    for k, (index, s) in enumerate(point.passes):
        form = atlas.forms[index]
        x = (form.branch(s + np.linspace(-0.3, 0.3, 200)) - form.branch(s)) @ plane
        colour = COLOURS[(4 + k) % len(COLOURS)]
        axes.plot(
            *np.degrees(x.T),
            color=colour,
            lw=1.2,
            ls="--",
            label=f"{form.name}, nominal",
        )
    for k, valley in enumerate(unfolding.valleys):
        x = (valley.dense() - point.point.u) @ plane
        axes.plot(
            *np.degrees(x.T), color="k", lw=1.6, label="as made" if k == 0 else None
        )
    starts = (half_branches(atlas, point)[0] - point.point.u) @ plane
    reach = 1.2 * np.degrees(np.abs(starts).max())
    axes.set(
        xlim=(-reach, reach),
        ylim=(-reach, reach),
        aspect="equal",
        title=f"{point.name} with errors of {copy.error:g}: {unfolding.distance:.2g} rad apart",
        xlabel="along the null space, first direction (deg)",
        ylabel="second direction (deg)",
    )
    axes.legend(fontsize=8, frameon=False, loc="lower left")
    axes.grid(alpha=0.3)
