"""What a branch costs: against its length, the number of joints, and the gap to a
bifurcation.

    python -m studies.branch_cost [--out DIR]

A loop has at most rank 6, so a single motion curve has at most seven unknowns: from
eight joints on, each joint more is geared to another one, 1 : 1 either way, with a
random phase. Times are processor times: of `trace_branch`, and of its compiled part
alone for as many pieces. The gap is that of a four-bar which misses the parallelogram:
the smallest regular singular value.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import astuple, dataclass, fields
from functools import partial
from pathlib import Path

import click
import numpy as np

from bifurc.curves.continuation import DEFAULT_SETTINGS, trace_branch
from bifurc.curves.monitor import profile_branch
from linkages.catalogue import entry
from linkages.closure.coupled import CoupledClosure
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import MAX_JOINTS, Loop
from studies.bench import median_time

__all__ = ["Cost", "cost_against_gap", "cost_of_loops"]


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


def cost_of(series: str, problem: LoopClosure | CoupledClosure) -> list[Cost]:
    """Cost of the closed branches through a few random closed configurations."""
    points, gaps = problem.project(
        np.random.default_rng(1).uniform(-np.pi, np.pi, (8, problem.n))
    )
    limits = (
        DEFAULT_SETTINGS.order,
        DEFAULT_SETTINGS.tolerance,
        DEFAULT_SETTINGS.shortest,
        DEFAULT_SETTINGS.longest,
    )
    out: list[Cost] = []
    for point in points[gaps < 1e-13]:
        branch = trace_branch(problem, point)
        if branch.closed and all(
            abs(branch.length - known.length) > 1e-6 for known in out
        ):
            count, ahead = len(branch.pieces), branch(0.0, 1)
            seconds = median_time(partial(trace_branch, problem, point), budget=0.1)
            march = median_time(
                partial(problem.march, branch(0.0), ahead, *limits, count), budget=0.1
            )
            gap = float(profile_branch(problem, branch).smallest.min())
            out.append(
                Cost(series, problem.loop.n, branch.length, count, gap, seconds, march)
            )
    return out


def random_loop(joints: int, rng: np.random.Generator) -> LoopClosure | CoupledClosure:
    """A general loop; its joints from the eighth on are geared to the first ones."""
    lengths, twists, offsets = (
        rng.uniform(*span, joints) for span in ((0.5, 1.5), (0.6, 2.5), (0.0, 0.4))
    )
    loop = Loop(tuple(lengths), tuple(twists), tuple(offsets), f"general {joints}R")
    extra = joints - 7
    if extra <= 0:
        return LoopClosure(loop)
    gears = rng.choice([-1.0, 1.0], extra)[:, None] * np.eye(extra, 7)
    phases = np.concatenate([np.zeros(7), rng.uniform(-np.pi, np.pi, extra)])
    return CoupledClosure(loop, np.vstack([np.eye(7), gears]), phases)


def cost_of_loops(rng: np.random.Generator) -> list[Cost]:
    """Branches of 4R, 5R and 6R members of the catalogue and of general loops of 7 to
    12 joints, at random."""
    out = []
    for family in ("bennett", "goldberg-5r", "double-subtractive-goldberg"):
        found = entry(family)
        for _ in range(6):
            try:
                out += cost_of("loops", LoopClosure(found.build(**found.draw(rng))))
            except ValueError:  # the constructor refuses these parameters
                continue
    for joints in range(7, MAX_JOINTS + 1):
        for _ in range(6):
            out += cost_of("loops", random_loop(joints, rng))
    return out


def cost_against_gap() -> list[Cost]:
    """The four-bar 2, 1, 2, 1 with its last link too long by 1e-1 to 1e-10."""
    family = entry("four-bar")
    loops = [family.build(a=2.0, b=1.0, c=2.0, d=1.0 + 10.0**-k) for k in range(1, 11)]
    return [cost for loop in loops for cost in cost_of("gap", LoopClosure(loop))]


def line(costs: list[Cost], seconds: Callable[[Cost], float]) -> np.ndarray:
    """Slope and intercept (s) of the line through the ``seconds`` per piece over the
    joints."""
    return np.polyfit(
        [c.joints for c in costs], [seconds(c) / c.pieces for c in costs], 1
    )


def exponent(costs: list[Cost]) -> float:
    """p of the power law seconds ~ length^p through the costs."""
    return float(
        np.polyfit(
            np.log([c.length for c in costs]), np.log([c.seconds for c in costs]), 1
        )[0]
    )


def draw(costs: list[Cost], path: Path) -> None:
    """Time against length, and time per piece against joints, and time against
    1/gap."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, (left, middle, right) = plt.subplots(
        1, 3, figsize=(13, 4), layout="constrained"
    )
    loops, gaps = (
        [c for c in costs if c.series == "loops"],
        [c for c in costs if c.series == "gap"],
    )
    shades = plt.get_cmap("viridis")(
        np.linspace(0.0, 0.95, len({c.joints for c in loops}))
    )
    for joints, shade in zip(sorted({c.joints for c in loops}), shades, strict=True):
        here = [c for c in loops if c.joints == joints]
        left.loglog(
            [c.length for c in here],
            [1e3 * c.seconds for c in here],
            "o",
            ms=4,
            color=shade,
            label=joints,
        )
    joints_of = np.array([c.joints for c in loops])
    for name, seconds in PARTS.items():
        per_piece = [1e6 * seconds(c) / c.pieces for c in loops]
        (drawn,) = middle.plot(joints_of, per_piece, "o", ms=4, alpha=0.6, label=name)
        middle.plot(
            joints_of,
            1e6 * np.polyval(line(loops, seconds), joints_of),
            lw=1,
            color=drawn.get_color(),
        )
    right.semilogx([c.gap for c in gaps], [1e3 * c.seconds for c in gaps], "o", ms=4)
    right.invert_xaxis()
    left.set(xlabel="length of the branch (rad)", ylabel="processor time (ms)")
    middle.set(
        xlabel="joints",
        ylabel="processor time per piece (us)",
        ylim=(0, None),
        xticks=range(4, MAX_JOINTS + 1),
    )
    right.set(
        xlabel="smallest singular value along the branch",
        ylabel="processor time (ms)",
        ylim=(0, None),
    )
    left.legend(frameon=False, title="joints", ncols=2)
    middle.legend(frameon=False)
    for axes in (left, middle, right):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=150)
    plt.close(figure)


@click.command()
@click.option(
    "--out",
    default="branch_cost",
    show_default=True,
    type=click.Path(path_type=Path, file_okay=False),
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
