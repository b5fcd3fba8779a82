"""The figure of the stability study."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.stability_runs import Run

__all__ = ["draw_stability"]

UNCERTIFIED = "right; a place is singular to rounding"
LOOKS = {
    "right": ("#009988", "o"),
    "failed": ("#bbbbbb", "s"),
    "jumped": ("#cc3311", "X"),
    "missed": ("#ee7733", "v"),
    "invented": ("#cc3311", "^"),
}
WORDS = {
    "right": "right",
    "failed": "says that it failed",
    "jumped": "jumps to the other arc, and says nothing",
    "missed": "reports too few",
    "invented": "reports too many",
}
COSTS = {
    "pieces": lambda r: r.pieces,
    "points of the certificate": lambda r: r.certificate_points,
    "time of the certificate (ms)": lambda r: 1e3 * r.certificate_seconds,
}
COLOURS, STYLES = ("#0077bb", "#ee7733"), ("o-", "s--", "^:")


def draw_stability(runs: Sequence[Run]) -> Figure:
    """A mark for every run: near misses over their imperfection, three steps to a
    method, and the curves with bifurcations; below, what this project's answers on the
    near misses cost."""
    ladder, points = [r for r in runs if r.step], [r for r in runs if not r.step]
    cases = list(dict.fromkeys(r.case for r in ladder))
    figure = Figure(figsize=(5.2 * len(cases) + 5.4, 9.6), layout="constrained")
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=[1.9, 1.0])[
        :, 0
    ]
    panels = above.subplots(
        1, len(cases) + 1, width_ratios=[1.0] * len(cases) + [1.05], squeeze=False
    )[0]
    for axes, case in zip(panels, cases, strict=False):
        _draw_ladder(
            axes, [r for r in ladder if r.case == case], case, axes is panels[0]
        )
    _draw_points(panels[-1], points)
    handles = [
        Line2D([], [], color=c, marker=m, ls="", label=WORDS[v])
        for v, (c, m) in LOOKS.items()
    ]
    colour, marker = LOOKS["right"]
    handles.insert(
        1,
        Line2D(
            [], [], color=colour, marker=marker, mfc="white", ls="", label=UNCERTIFIED
        ),
    )
    above.legend(
        handles=handles, loc="outside lower center", ncols=6, frameon=False, fontsize=9
    )
    _draw_costs(below.subplots(1, len(COSTS)), [r for r in ladder if r.certificate])
    return figure


def _draw_costs(panels: np.ndarray, runs: Sequence[Run]) -> None:
    """Costs over the imperfection: on these scales a straight line is a logarithm."""
    for axes, (title, cost) in zip(panels, COSTS.items(), strict=True):
        for case, step in dict.fromkeys((r.case, r.step) for r in runs):
            some = [r for r in runs if (r.case, r.step) == (case, step)]
            colour = COLOURS[
                list(dict.fromkeys(r.case for r in runs)).index(case) % len(COLOURS)
            ]
            style = STYLES[
                list(dict.fromkeys(r.step for r in runs)).index(step) % len(STYLES)
            ]
            axes.plot(
                [r.difficulty for r in some],
                [cost(r) for r in some],
                style,
                color=colour,
                ms=4,
                lw=1.2,
                label=f"{case}, {step}",
            )
        axes.set(xscale="log", xlabel="imperfection", title=title)
        axes.set_ylim(bottom=0.0)
        axes.invert_xaxis()
        axes.grid(alpha=0.3)
    panels[-1].legend(
        fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False
    )


def _draw_ladder(axes: Axes, runs: Sequence[Run], title: str, named: bool) -> None:
    rows = list(dict.fromkeys((r.method, r.step) for r in runs))
    for run in runs:
        colour, marker = LOOKS[run.verdict]
        inside = "white" if run.certificate not in ("", "certified") else colour
        axes.plot(
            run.difficulty,
            -rows.index((run.method, run.step)),
            marker,
            color=colour,
            mfc=inside,
            ms=6,
        )
    labels = [
        f"{method}, {step}" if k % 3 == 0 else step
        for k, (method, step) in enumerate(rows)
    ]
    axes.set_yticks(
        -np.arange(len(rows)), labels if named else [""] * len(rows), fontsize=8
    )
    for k in range(3, len(rows), 3):
        axes.axhline(0.5 - k, color="#dddddd", lw=0.8)
    axes.set(xscale="log", xlabel="imperfection", title=title)
    axes.invert_xaxis()
    axes.grid(axis="x", alpha=0.3)


def _draw_points(axes: Axes, runs: Sequence[Run]) -> None:
    methods, cases = (
        list(dict.fromkeys(r.method for r in runs)),
        list(dict.fromkeys(r.case for r in runs)),
    )
    for run in runs:
        colour, marker = LOOKS[run.verdict]
        x, y = methods.index(run.method), -cases.index(run.case)
        axes.plot(x, y, marker, color=colour, ms=9)
        if run.verdict != "failed":
            axes.annotate(
                str(run.found), (x, y), (9, -3), textcoords="offset points", fontsize=9
            )
    counts = {r.case: int(r.difficulty) for r in runs}
    axes.set_yticks(
        -np.arange(len(cases)),
        [f"{case} ({counts[case]})" for case in cases],
        fontsize=8,
    )
    axes.set_xticks(
        range(len(methods)), [m.replace(" ", "\n", 1) for m in methods], fontsize=7
    )
    axes.set(
        xlim=(-0.5, len(methods) - 0.3), title="bifurcations reported (true number)"
    )
    axes.grid(alpha=0.3)
