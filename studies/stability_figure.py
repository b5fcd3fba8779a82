"""The figure of the stability study."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D

from studies.stability_runs import Run


class Look(NamedTuple):
    """How a verdict is marked, and its words in the legend."""

    colour: str
    marker: str
    words: str


Cost: TypeAlias = Callable[[Run], float]

LOOKS = {
    "right": Look("#009988", "o", "right"),
    "failed": Look("#bbbbbb", "s", "says that it failed"),
    "jumped": Look("#cc3311", "X", "jumps to the other arc, and says nothing"),
    "missed": Look("#ee7733", "v", "reports too few"),
    "invented": Look("#cc3311", "^", "reports too many"),
}
UNCERTIFIED = "right; a place is singular to rounding"
COSTS: dict[str, Cost] = {
    "pieces": lambda run: run.pieces,
    "points of the certificate": lambda run: run.certificate_points,
    "time of the certificate (ms)": lambda run: 1e3 * run.certificate_seconds,
}
CASE_COLOURS = ("#0077bb", "#ee7733")
STEP_STYLES = ("o-", "s--", "^:")
STEPS_OF_A_METHOD = 3


def draw_stability(runs: Sequence[Run]) -> Figure:
    """A mark for every run: near misses over their imperfection, three steps to a
    method, and the curves with bifurcations; below, what this project's answers on the
    near misses cost."""
    ladder = [run for run in runs if run.step]
    crossings = [run for run in runs if not run.step]
    cases = list(dict.fromkeys(run.case for run in ladder))
    figure = Figure(figsize=(5.2 * len(cases) + 5.4, 9.6), layout="constrained")
    halves = figure.subfigures(2, 1, squeeze=False, height_ratios=[1.9, 1.0])
    upper, lower = halves[:, 0]
    widths = [1.0] * len(cases) + [1.05]
    panels = upper.subplots(1, len(cases) + 1, width_ratios=widths, squeeze=False)[0]
    for k, case in enumerate(cases):
        own = [run for run in ladder if run.case == case]
        _draw_ladder(panels[k], own, case, show_names=k == 0)
    _draw_crossings(panels[-1], crossings)
    _draw_legend(upper)
    certified = [run for run in ladder if run.certificate]
    cost_panels = lower.subplots(1, len(COSTS))
    for axes, (title, cost) in zip(cost_panels, COSTS.items(), strict=True):
        _draw_cost(axes, certified, title, cost)
    cost_panels[-1].legend(
        fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False
    )
    return figure


def _draw_legend(figure: SubFigure) -> None:
    """Verdicts, with those that are right but not certified beside those that are
    right."""
    handles = []
    for verdict, look in LOOKS.items():
        handles.append(_entry(look, look.colour, look.words))
        if verdict == "right":
            handles.append(_entry(look, "white", UNCERTIFIED))
    figure.legend(
        handles=handles, loc="outside lower center", ncols=6, frameon=False, fontsize=9
    )


def _entry(look: Look, face: str, words: str) -> Line2D:
    return Line2D(
        [], [], color=look.colour, marker=look.marker, mfc=face, ls="", label=words
    )


def _draw_ladder(axes: Axes, runs: Sequence[Run], title: str, show_names: bool) -> None:
    """A row for each method and step; the first step of a method carries its name."""
    rows = list(dict.fromkeys((run.method, run.step) for run in runs))
    for run in runs:
        look = LOOKS[run.verdict]
        whole = run.certificate in ("", "certified")
        row = rows.index((run.method, run.step))
        axes.plot(
            run.difficulty,
            -row,
            look.marker,
            color=look.colour,
            mfc=look.colour if whole else "white",
            ms=6,
        )
    labels = []
    for k, (method, step) in enumerate(rows):
        labels.append(f"{method}, {step}" if k % STEPS_OF_A_METHOD == 0 else step)
    shown = labels if show_names else [""] * len(rows)
    axes.set_yticks(-np.arange(len(rows)), shown, fontsize=8)
    for k in range(STEPS_OF_A_METHOD, len(rows), STEPS_OF_A_METHOD):
        axes.axhline(0.5 - k, color="#dddddd", lw=0.8)
    axes.set(xscale="log", xlabel="imperfection", title=title)
    axes.invert_xaxis()
    axes.grid(axis="x", alpha=0.3)


def _draw_crossings(axes: Axes, runs: Sequence[Run]) -> None:
    """A row for each curve and a column for each method, with the number that it
    reports."""
    methods = list(dict.fromkeys(run.method for run in runs))
    true_counts = {run.case: int(run.difficulty) for run in runs}
    cases = list(true_counts)
    for run in runs:
        look = LOOKS[run.verdict]
        x = methods.index(run.method)
        y = -cases.index(run.case)
        axes.plot(x, y, look.marker, color=look.colour, ms=9)
        if run.verdict != "failed":
            axes.annotate(
                str(run.found), (x, y), (9, -3), textcoords="offset points", fontsize=9
            )
    names = [f"{case} ({count})" for case, count in true_counts.items()]
    axes.set_yticks(-np.arange(len(cases)), names, fontsize=8)
    columns = [method.replace(" ", "\n", 1) for method in methods]
    axes.set_xticks(range(len(methods)), columns, fontsize=7)
    axes.set(
        xlim=(-0.5, len(methods) - 0.3), title="bifurcations reported (true number)"
    )
    axes.grid(alpha=0.3)


def _draw_cost(axes: Axes, runs: Sequence[Run], title: str, cost: Cost) -> None:
    """A cost over the imperfection: on these scales a straight line is a logarithm."""
    cases = list(dict.fromkeys(run.case for run in runs))
    steps = list(dict.fromkeys(run.step for run in runs))
    for case, step in dict.fromkeys((run.case, run.step) for run in runs):
        own = [run for run in runs if run.case == case and run.step == step]
        axes.plot(
            [run.difficulty for run in own],
            [cost(run) for run in own],
            STEP_STYLES[steps.index(step) % len(STEP_STYLES)],
            color=CASE_COLOURS[cases.index(case) % len(CASE_COLOURS)],
            ms=4,
            lw=1.2,
            label=f"{case}, {step}",
        )
    axes.set(xscale="log", xlabel="imperfection", title=title)
    axes.set_ylim(bottom=0.0)
    axes.invert_xaxis()
    axes.grid(alpha=0.3)
