"""The figures of the work-precision study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.work_precision_runs import Run

Dashes: TypeAlias = Literal["-"] | tuple[float, tuple[float, ...]]


class Style(NamedTuple):
    """How the line of a method looks."""

    colour: str | tuple[float, ...]
    marker: str
    dashes: Dashes
    width: float = 1.0


SOLID: Dashes = "-"
DASHED: Dashes = (0, (4, 2))
ORDERS = (4, 8, 16, 24)  # orders drawn; all are in runs.csv
DEFAULT_ORDER = 16
STYLES = {  # two variants of one method share a colour
    "pseudo-arclength, tangent": Style("#cc3311", "o", SOLID),
    "pseudo-arclength, secant": Style("#cc3311", "v", DASHED),
    "SVD predictor-corrector": Style("#000000", "s", SOLID),
    "natural parameter": Style("#997700", "D", SOLID),
    "solve_ivp RK45": Style("#228833", "x", DASHED),
    "solve_ivp RK45, projected": Style("#228833", "x", SOLID),
    "solve_ivp DOP853": Style("#aa3377", "+", DASHED),
    "solve_ivp DOP853, projected": Style("#aa3377", "+", SOLID),
    "solve_ivp LSODA": Style("#888888", "1", SOLID),
    "pycont-lite": Style("#ccaa00", "*", SOLID),
    "AUTO-07p": Style("#ee7733", "^", SOLID),
}
OTHER_STYLE = Style("#555555", ".", SOLID)
TARGETS = ("1e-04", "1e-08")
# Markers of curves that are no linkages, which are dots.
GENERIC_MARKERS = {"circle": "^", "pitchfork": "v", "bratu-50": "s", "bratu-1000": "D"}
LINKAGE_COLOUR = "#4477aa"
GENERIC_COLOUR = "#ee7733"


# --- one curve ------------------------------------------------------------------------


def draw_case(title: str, runs: Sequence[Run], path: Path) -> None:
    """Time against error of every method on one curve, both on log scales.

    Of each method those runs alone that no other of it beats in both.
    """
    figure = Figure(figsize=(8.6, 5.0), layout="constrained")
    axes = figure.subplots()
    shades = colormaps["Blues"](np.linspace(0.45, 1.0, len(ORDERS)))
    for order, shade in zip(ORDERS, shades, strict=True):
        own = [run for run in runs if run.order == order]
        width = 2.4 if order == DEFAULT_ORDER else 1.0
        style = Style(tuple(shade), ".", SOLID, width)
        _draw_line(axes, own, f"this project, order {order}", style)
    for method in dict.fromkeys(run.method for run in runs if not run.order):
        own = [run for run in runs if run.method == method]
        _draw_line(axes, own, method, STYLES.get(method, OTHER_STYLE))
    axes.set(xscale="log", yscale="log", title=title)
    axes.set(xlabel="largest distance to the exact curve", ylabel="processor time (ms)")
    axes.invert_xaxis()
    axes.grid(alpha=0.3)
    axes.legend(
        fontsize=8,
        loc="center left",
        bbox_to_anchor=(1.01, 0.5),
        frameon=False,
        handlelength=3,
    )
    figure.savefig(path, dpi=150)


def _draw_line(axes: Axes, runs: Sequence[Run], label: str, style: Style) -> None:
    """A method without a result stands in the legend, which says so."""
    best = unbeaten(runs)
    if not best:
        is_tried = any(_is_tried(run) for run in runs)
        label = f"{label} ({'fails' if is_tried else 'not tried'})"
    axes.plot(
        [run.error for run in best],
        [1e3 * run.seconds for run in best],
        label=label,
        color=style.colour,
        marker=style.marker,
        lw=style.width,
        ls=style.dashes,
        ms=5,
    )


def _is_tried(run: Run) -> bool:
    return bool(np.isfinite(run.seconds)) or "not tried" not in run.note


def unbeaten(runs: Sequence[Run]) -> list[Run]:
    """The runs that no other comes as near in less time, from large to small errors."""
    finite = [run for run in runs if np.isfinite(run.error)]
    finite.sort(key=lambda run: (run.seconds, run.error))
    best: list[Run] = []
    for run in finite:
        if not best or run.error < best[-1].error:
            best.append(run)
    return best


# --- all curves -----------------------------------------------------------------------


def draw_ratios(
    table: Sequence[Mapping[str, str | float]], titles: Mapping[str, str], path: Path
) -> None:
    """How many times longer each method takes than this project to come within 1e-4 and
    1e-8 of each curve.

    Linkages as dots, each in its place within the row, and their median as a bar.
    """
    methods = list(dict.fromkeys(str(row["method"]) for row in table))
    figure = Figure(
        figsize=(11.0, 0.36 * len(methods) + 1.4),
        layout="constrained",
    )
    panels = figure.subplots(1, len(TARGETS), sharey=True, sharex=True)
    for axes, target in zip(panels, TARGETS, strict=True):
        for row, method in enumerate(methods):
            ratios = {
                str(entry["case"]): float(entry[target])
                for entry in table
                if entry["method"] == method
            }
            _draw_linkages(axes, row, ratios, titles)
            _draw_generic(axes, row, ratios, titles)
        axes.axvline(1.0, color="0.3", lw=1)
        exponent = round(np.log10(float(target)))
        title = f"to come within $10^{{{exponent}}}$ of the whole curve"
        axes.set(xscale="log", title=title)
        axes.grid(alpha=0.3, axis="x")
    panels[0].set_yticks(range(len(methods)), methods)
    panels[0].set_ylim(len(methods) - 0.5, -0.5)
    figure.supxlabel(
        "processor time over that of this project (order 16)", fontsize="medium"
    )
    panels[-1].legend(
        fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False
    )
    figure.savefig(path, dpi=150)


def _draw_linkages(
    axes: Axes, row: int, ratios: Mapping[str, float], titles: Mapping[str, str]
) -> None:
    """The ratios of a method on the linkages, and their median; the first row is in
    the legend."""
    linkages = [case for case in titles if case not in GENERIC_MARKERS]
    values = np.array([ratios.get(case, np.nan) for case in linkages])
    heights = row + np.linspace(-0.25, 0.25, len(values))
    label = None if row else "linkages"
    axes.plot(values, heights, "o", ms=4, color=LINKAGE_COLOUR, label=label)
    if np.isfinite(values).any():
        median = np.nanmedian(values)
        ends = [row - 0.36, row + 0.36]
        axes.plot([median, median], ends, color=LINKAGE_COLOUR, lw=2)


def _draw_generic(
    axes: Axes, row: int, ratios: Mapping[str, float], titles: Mapping[str, str]
) -> None:
    """The ratios of a method on the other curves; the first row is in the legend."""
    for case, marker in GENERIC_MARKERS.items():
        axes.plot(
            ratios.get(case, np.nan),
            row,
            marker,
            ms=6,
            color=GENERIC_COLOUR,
            mec="w",
            mew=0.5,
            label=None if row else titles.get(case),
        )
