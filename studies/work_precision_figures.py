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

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studies.work_precision import Run

__all__ = ["draw_case", "draw_ratios"]

COLOURS = {
    "pseudo-arclength, tangent": ("#cc3311", "o"),
    "pseudo-arclength, secant": ("#ee7733", "v"),
    "SVD predictor-corrector": ("#000000", "s"),
    "natural parameter": ("#997700", "D"),
    "solve_ivp RK45": ("#88ccaa", "x"),
    "solve_ivp RK45, projected": ("#228833", "x"),
    "solve_ivp DOP853": ("#cc99bb", "+"),
    "solve_ivp DOP853, projected": ("#aa3377", "+"),
    "solve_ivp LSODA": ("#888888", "1"),
    "pycont-lite": ("#bbaa00", "*"),
}
TARGET = "1e-08"


def draw_case(title: str, runs: Sequence[Run], path: Path) -> None:
    """Time against error of every method on one curve, both on log scales."""
    figure, axes = plt.subplots(figsize=(8.6, 5.2), layout="constrained")
    orders = sorted({run.order for run in runs if run.order})
    shades = colormaps["Blues"](np.linspace(0.45, 1.0, len(orders)))
    for order, shade in zip(orders, shades, strict=True):
        width = 2.2 if order == 16 else 1.0
        _line(axes, [r for r in runs if r.order == order], f"this project, order {order}", shade, ".", width)
    for method in dict.fromkeys(run.method for run in runs if not run.order):
        colour, marker = COLOURS.get(method, ("#555555", "."))
        _line(axes, [r for r in runs if r.method == method], method, colour, marker, 0.9)
    axes.set(xscale="log", yscale="log", title=title)
    axes.set(xlabel="largest distance to the exact curve", ylabel="processor time (ms)")
    axes.invert_xaxis()
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    figure.savefig(path, dpi=150)
    plt.close(figure)


def _line(axes: Axes, runs: Sequence[Run], label: str, colour: Any, marker: str, width: float) -> None:
    good = [run for run in runs if np.isfinite(run.error)]
    if not good:
        axes.plot([], [], color=colour, marker=marker, lw=width, ms=5, label=f"{label} (fails)")
        return
    error, milliseconds = [run.error for run in good], [1e3 * run.seconds for run in good]
    axes.plot(error, milliseconds, color=colour, marker=marker, lw=width, ms=5, label=label)


def draw_ratios(table: Sequence[Mapping[str, Any]], titles: Mapping[str, str], path: Path) -> None:
    """How many times longer each method takes than this project to come within 1e-8 of each curve."""
    methods = list(dict.fromkeys(row["method"] for row in table))
    figure, axes = plt.subplots(figsize=(9.2, 0.42 * len(methods) + 1.8), layout="constrained")
    shades = colormaps["tab20"](np.linspace(0, 1, 20))
    for number, (case, title) in enumerate(titles.items()):
        shift = 0.5 * (number / max(len(titles) - 1, 1) - 0.5)
        found = {row["method"]: float(row[TARGET]) for row in table if row["case"] == case}
        reached = [m for m in methods if np.isfinite(found.get(m, np.nan))]
        height = [methods.index(m) + shift for m in reached]
        axes.plot([found[m] for m in reached], height, "o", ms=5, color=shades[number], label=title)
    axes.axvline(1.0, color="0.3", lw=1)
    axes.set(xscale="log", xlabel="time to come within 1e-8 of the whole curve, over that of this project (order 16)")
    axes.set_yticks(range(len(methods)), methods)
    axes.set_ylim(len(methods) - 0.5, -0.5)
    axes.grid(alpha=0.3, axis="x")
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    figure.savefig(path, dpi=150)
    plt.close(figure)
