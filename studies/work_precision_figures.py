"""The figures of the work-precision study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import colormaps
from matplotlib import pyplot as plt

from studies.work_precision_runs import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_case", "draw_ratios", "unbeaten"]

SHOWN = (4, 8, 16, 24)  # orders drawn; all are in runs.csv
SOLID, DASHED = "-", (0, (4, 2))
STYLES: dict[
    str, tuple[str, str, Any]
] = {  # colour, marker, line; two variants of one method share a colour
    "pseudo-arclength, tangent": ("#cc3311", "o", SOLID),
    "pseudo-arclength, secant": ("#cc3311", "v", DASHED),
    "SVD predictor-corrector": ("#000000", "s", SOLID),
    "natural parameter": ("#997700", "D", SOLID),
    "solve_ivp RK45": ("#228833", "x", DASHED),
    "solve_ivp RK45, projected": ("#228833", "x", SOLID),
    "solve_ivp DOP853": ("#aa3377", "+", DASHED),
    "solve_ivp DOP853, projected": ("#aa3377", "+", SOLID),
    "solve_ivp LSODA": ("#888888", "1", SOLID),
    "pycont-lite": ("#ccaa00", "*", SOLID),
    "AUTO-07p": ("#ee7733", "^", SOLID),
}
TARGETS = ("1e-04", "1e-08")
GENERIC = {
    "circle": "^",
    "pitchfork": "v",
    "bratu-50": "s",
    "bratu-1000": "D",
}  # markers; linkages are dots


def draw_case(title: str, runs: Sequence[Run], path: Path) -> None:
    """Time against error of every method on one curve, both on log scales.

    Of each method those runs alone that no other of it beats in both.
    """
    figure, axes = plt.subplots(figsize=(8.6, 5.0), layout="constrained")
    shades = colormaps["Blues"](np.linspace(0.45, 1.0, len(SHOWN)))
    for order, shade in zip(SHOWN, shades, strict=True):
        width = 2.4 if order == 16 else 1.0
        _line(
            axes,
            [r for r in runs if r.order == order],
            f"this project, order {order}",
            shade,
            ".",
            width,
            SOLID,
        )
    for method in dict.fromkeys(run.method for run in runs if not run.order):
        colour, marker, line = STYLES.get(method, ("#555555", ".", SOLID))
        _line(
            axes,
            [r for r in runs if r.method == method],
            method,
            colour,
            marker,
            1.0,
            line,
        )
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
    plt.close(figure)


def _line(
    axes: Axes,
    runs: Sequence[Run],
    label: str,
    colour: Any,
    marker: str,
    width: float,
    line: Any,
) -> None:
    good = unbeaten(runs)
    style = {"color": colour, "marker": marker, "lw": width, "ls": line, "ms": 5}
    if good:
        axes.plot(
            [run.error for run in good],
            [1e3 * run.seconds for run in good],
            label=label,
            **style,
        )
        return
    tried = any(np.isfinite(run.seconds) or "not tried" not in run.note for run in runs)
    axes.plot([], [], label=f"{label} ({'fails' if tried else 'not tried'})", **style)


def unbeaten(runs: Sequence[Run]) -> list[Run]:
    """The runs that no other comes as near in less time, from large to small errors."""
    good = sorted(
        (run for run in runs if np.isfinite(run.error)),
        key=lambda run: (run.seconds, run.error),
    )
    out: list[Run] = []
    for run in good:
        if not out or run.error < out[-1].error:
            out.append(run)
    return out


def draw_ratios(
    table: Sequence[Mapping[str, Any]], titles: Mapping[str, str], path: Path
) -> None:
    """How many times longer each method takes than this project to come within 1e-4 and
    1e-8 of each curve.

    Linkages as dots, each in its place within the row, and their median as a bar.
    """
    methods = list(dict.fromkeys(row["method"] for row in table))
    linkages = [case for case in titles if case not in GENERIC]
    figure, panels = plt.subplots(
        1,
        len(TARGETS),
        figsize=(11.0, 0.36 * len(methods) + 1.4),
        layout="constrained",
        sharey=True,
        sharex=True,
    )
    for axes, target in zip(panels, TARGETS, strict=True):
        for row, method in enumerate(methods):
            found = {
                r["case"]: float(r[target]) for r in table if r["method"] == method
            }
            ours = [found.get(case, np.nan) for case in linkages]
            height = row + np.linspace(-0.25, 0.25, len(ours))
            axes.plot(
                ours,
                height,
                "o",
                ms=4,
                color="#4477aa",
                label="linkages" if not row else None,
            )
            if np.isfinite(ours).any():
                axes.plot(
                    [np.nanmedian(ours)] * 2,
                    [row - 0.36, row + 0.36],
                    color="#4477aa",
                    lw=2,
                )
            for case, marker in GENERIC.items():
                label = titles.get(case) if not row else None
                axes.plot(
                    found.get(case, np.nan),
                    row,
                    marker,
                    ms=6,
                    color="#ee7733",
                    mec="w",
                    mew=0.5,
                    label=label,
                )
        axes.axvline(1.0, color="0.3", lw=1)
        axes.set(
            xscale="log",
            title=f"to come within $10^{{{round(np.log10(float(target)))}}}$ of the whole curve",
        )
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
    plt.close(figure)
