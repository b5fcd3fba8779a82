"""What a branch costs: against its length, the number of joints, and the gap to a
bifurcation.

    python -m studies.branch_cost [--out DIR]

A loop has at most rank 6, so a single motion curve has at most seven unknowns. Times
are processor times: of `trace_branch`, and of its compiled part alone for as many
pieces. The gap is that of a four-bar which misses the parallelogram: the smallest
regular singular value.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import astuple, dataclass, fields
from functools import partial
from pathlib import Path

import click
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc import Branch, MarchSettings, trace_branch
from bifurc.curves.continuation import DEFAULT_SETTINGS
from bifurc.curves.monitor import profile_branch
from linkages import Closure, GeometryError, Loop
from linkages.app.options import FOLDER
from linkages.catalogue import entry
from studies.bench import median_time
from studies.study import Study

MOST_JOINTS = 7  # of a loop that moves along curves


@dataclass(frozen=True)
class Cost:
    """One closed branch: joints, arclength (rad), pieces, smallest regular singular
    value, seconds, those compiled."""

    series: str
    joints: int
    length: float
    pieces: int
    gap: float
    seconds: float
    march: float


PARTS: dict[str, Callable[[Cost], float]] = {
    "whole": lambda c: c.seconds,
    "compiled part": lambda c: c.march,
}


def cost_of(series: str, problem: Closure) -> list[Cost]:
    """Cost of the closed branches through a few random closed configurations."""
    rng = np.random.default_rng(1)
    points, gaps = problem.project(rng.uniform(-np.pi, np.pi, (8, problem.n)))
    costs: list[Cost] = []
    for point in points[gaps < 1e-13]:
        branch = trace_branch(problem, point)
        is_new = all(abs(branch.length - cost.length) > 1e-6 for cost in costs)
        if branch.closed and is_new:
            costs.append(_measure(series, problem, point, branch))
    return costs


def _measure(
    series: str,
    problem: Closure,
    point: np.ndarray,
    branch: Branch,
) -> Cost:
    """Cost of one branch through ``point``."""
    settings = MarchSettings(
        order=DEFAULT_SETTINGS.order,
        tolerance=DEFAULT_SETTINGS.tolerance,
        shortest=DEFAULT_SETTINGS.shortest,
        longest=DEFAULT_SETTINGS.longest,
        count=len(branch.pieces),
    )
    march = partial(problem.march, branch(0.0), branch(0.0, 1), settings)
    return Cost(
        series=series,
        joints=problem.n,
        length=branch.length,
        pieces=len(branch.pieces),
        gap=float(profile_branch(problem, branch).smallest.min()),
        seconds=median_time(partial(trace_branch, problem, point), budget=0.1),
        march=median_time(march, budget=0.1),
    )


def random_loop(joints: int, rng: np.random.Generator) -> Closure:
    """A general loop."""
    lengths = rng.uniform(0.5, 1.5, joints)
    twists = rng.uniform(0.6, 2.5, joints)
    offsets = rng.uniform(0.0, 0.4, joints)
    loop = Loop(tuple(lengths), tuple(twists), tuple(offsets), f"general {joints}R")
    return Closure(loop)


def cost_of_loops(rng: np.random.Generator) -> list[Cost]:
    """Branches of 4R, 5R and 6R members of the catalogue and of general loops of 7
    joints, at random."""
    costs = []
    for name in ("bennett", "goldberg-5r", "double-subtractive-goldberg"):
        family = entry(name)
        for _ in range(6):
            try:
                loop = family.build(**family.draw(rng))
            except GeometryError:  # the constructor refuses these parameters
                continue
            costs += cost_of("loops", Closure(loop))
    for _ in range(12):
        costs += cost_of("loops", random_loop(MOST_JOINTS, rng))
    return costs


def cost_against_gap() -> list[Cost]:
    """The four-bar 2, 1, 2, 1 with its last link too long by 1e-1 to 1e-10."""
    family = entry("four-bar")
    loops = [family.build(a=2.0, b=1.0, c=2.0, d=1.0 + 10.0**-k) for k in range(1, 11)]
    return [cost for loop in loops for cost in cost_of("gap", Closure(loop))]


def line(costs: list[Cost], seconds: Callable[[Cost], float]) -> np.ndarray:
    """Slope and intercept (s) of the line through the ``seconds`` per piece over the
    joints."""
    joints = [cost.joints for cost in costs]
    per_piece = [seconds(cost) / cost.pieces for cost in costs]
    return np.polyfit(joints, per_piece, 1)


def exponent(costs: list[Cost]) -> float:
    """p of the power law seconds ~ length^p through the costs."""
    lengths = np.log([cost.length for cost in costs])
    seconds = np.log([cost.seconds for cost in costs])
    power, _ = np.polyfit(lengths, seconds, 1)
    return float(power)


def draw(costs: list[Cost], path: Path) -> None:
    """Time against length, and time per piece against joints, and time against
    1/gap."""
    loops = [cost for cost in costs if cost.series == "loops"]
    gaps = [cost for cost in costs if cost.series == "gap"]
    figure = Figure(figsize=(13, 4), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    _draw_lengths(left, loops)
    _draw_pieces(middle, loops)
    _draw_gaps(right, gaps)
    for axes in (left, middle, right):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=150)


def _draw_lengths(axes: Axes, costs: list[Cost]) -> None:
    """Time against length, a shade for every number of joints."""
    numbers = sorted({cost.joints for cost in costs})
    shades = colormaps["viridis"](np.linspace(0.0, 0.95, len(numbers)))
    for joints, shade in zip(numbers, shades, strict=True):
        group = [cost for cost in costs if cost.joints == joints]
        lengths = [cost.length for cost in group]
        times = [1e3 * cost.seconds for cost in group]
        axes.loglog(lengths, times, "o", ms=4, color=shade, label=joints)
    axes.set(xlabel="length of the branch (rad)", ylabel="processor time (ms)")
    axes.legend(frameon=False, title="joints", ncols=2)


def _draw_pieces(axes: Axes, costs: list[Cost]) -> None:
    """Time per piece against joints, with a straight line through each part of it."""
    joints = np.array([cost.joints for cost in costs])
    for name, seconds in PARTS.items():
        times = [1e6 * seconds(cost) / cost.pieces for cost in costs]
        (dots,) = axes.plot(joints, times, "o", ms=4, alpha=0.6, label=name)
        fit = 1e6 * np.polyval(line(costs, seconds), joints)
        axes.plot(joints, fit, lw=1, color=dots.get_color())
    axes.set(
        xlabel="joints",
        ylabel="processor time per piece (us)",
        ylim=(0, None),
        xticks=range(4, MOST_JOINTS + 1),
    )
    axes.legend(frameon=False)


def _draw_gaps(axes: Axes, costs: list[Cost]) -> None:
    """Time against the gap, from wide to narrow."""
    gaps = [cost.gap for cost in costs]
    axes.semilogx(gaps, [1e3 * cost.seconds for cost in costs], "o", ms=4)
    axes.invert_xaxis()
    axes.set(
        xlabel="smallest singular value along the branch",
        ylabel="processor time (ms)",
        ylim=(0, None),
    )


@click.command(cls=Study)
@click.option(
    "--out",
    default="branch_cost",
    show_default=True,
    type=FOLDER,
)
def main(out: Path) -> None:
    """Measure and draw what branches cost."""
    out.mkdir(parents=True, exist_ok=True)
    costs = cost_of_loops(np.random.default_rng(5)) + cost_against_gap()
    with (out / "costs.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([f.name for f in fields(Cost)])
        writer.writerows(astuple(c) for c in costs)
    draw(costs, out / "branch_cost.png")
    loops = [c for c in costs if c.series == "loops"]
    for name, seconds in PARTS.items():
        slope, constant = 1e6 * line(loops, seconds)
        click.echo(f"{name}: {constant:.1f} us + {slope:.2f} us a joint, per piece")
    click.echo(f"time grows with the power {exponent(loops):.2f} of the length")
    click.echo(f"wrote {out / 'costs.csv'} and branch_cost.png")


if __name__ == "__main__":
    main()
