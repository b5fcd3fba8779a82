"""What a branch costs: against its length, the number of joints, and the gap to a bifurcation.

    python -m studies.branch_cost [--out DIR]

A loop of n joints has at most rank 6, so a single motion curve needs n <= 7. Times are processor times of
`trace_branch`. The gap is that of a four-bar which misses the parallelogram: the smallest regular singular value.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import click
import numpy as np

from bifurc.continuation import trace_branch
from bifurc.monitor import profile_branch
from linkages.catalogue import entry
from linkages.closure import LoopClosure
from linkages.loop import Loop
from studies.bench import median_time

__all__ = ["Cost", "cost_against_gap", "cost_of_loops"]


@dataclass(frozen=True)
class Cost:
    """One closed branch: joints, arclength (rad), pieces, smallest regular singular value, seconds."""

    series: str
    joints: int
    length: float
    pieces: int
    gap: float
    seconds: float


def cost_of(series: str, loop: Loop) -> list[Cost]:
    """Cost of the closed branches through a few random closed configurations of a loop."""
    problem = LoopClosure(loop)
    points, gaps = problem.project(np.random.default_rng(1).uniform(-np.pi, np.pi, (8, loop.n)))
    out: list[Cost] = []
    for point in points[gaps < 1e-13]:
        branch = trace_branch(problem, point)
        if branch.closed and all(abs(branch.length - known.length) > 1e-6 for known in out):
            seconds = median_time(partial(trace_branch, problem, point), budget=0.1)
            gap = float(profile_branch(problem, branch).smallest.min())
            out.append(Cost(series, loop.n, branch.length, len(branch.pieces), gap, seconds))
    return out


def cost_of_loops(rng: np.random.Generator) -> list[Cost]:
    """Branches of 4R, 5R and 6R members of the catalogue and of general 7R loops, with random parameters."""
    out = []
    for family in ("bennett", "goldberg-5r", "double-subtractive-goldberg"):
        found = entry(family)
        for _ in range(6):
            try:
                out += cost_of("loops", found.build(**found.draw(rng)))
            except ValueError:  # the constructor refuses these parameters
                continue
    for _ in range(6):
        lengths, twists, offsets = rng.uniform(0.5, 1.5, 7), rng.uniform(0.6, 2.5, 7), rng.uniform(0.0, 0.4, 7)
        out += cost_of("loops", Loop(tuple(lengths), tuple(twists), tuple(offsets), "general 7R"))
    return out


def cost_against_gap() -> list[Cost]:
    """The four-bar 2, 1, 2, 1 with its last link too long by 1e-1 to 1e-10."""
    family = entry("four-bar")
    return [
        cost for k in range(1, 11) for cost in cost_of("gap", family.build(a=2.0, b=1.0, c=2.0, d=1.0 + 10.0**-k))
    ]


def draw(costs: list[Cost], path: Path) -> None:
    """Time against length, and time per piece against joints, and time against 1/gap."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
    loops, gaps = [c for c in costs if c.series == "loops"], [c for c in costs if c.series == "gap"]
    for joints in sorted({c.joints for c in loops}):
        here = [c for c in loops if c.joints == joints]
        left.plot([c.length for c in here], [1e3 * c.seconds for c in here], "o", ms=4, label=f"{joints} joints")
        middle.plot([joints] * len(here), [1e6 * c.seconds / c.pieces for c in here], "o", ms=4)
    right.semilogx([c.gap for c in gaps], [1e3 * c.seconds for c in gaps], "o", ms=4)
    right.invert_xaxis()
    left.set(xlabel="length of the branch (rad)", ylabel="processor time (ms)", xlim=(0, None), ylim=(0, None))
    middle.set(xlabel="joints", ylabel="processor time per piece (us)", ylim=(0, None), xticks=[4, 5, 6, 7])
    right.set(xlabel="smallest singular value along the branch", ylabel="processor time (ms)", ylim=(0, None))
    left.legend(frameon=False)
    for axes in (left, middle, right):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=150)
    plt.close(figure)


@click.command()
@click.option("--out", default="branch_cost", show_default=True, type=click.Path(path_type=Path, file_okay=False))
def main(out: Path) -> None:
    """Measure and draw what branches cost."""
    out.mkdir(parents=True, exist_ok=True)
    costs = cost_of_loops(np.random.default_rng(5)) + cost_against_gap()
    with (out / "costs.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["series", "joints", "length", "pieces", "gap", "seconds"])
        writer.writerows([c.series, c.joints, c.length, c.pieces, c.gap, c.seconds] for c in costs)
    draw(costs, out / "branch_cost.png")
    click.echo(f"wrote {out / 'costs.csv'} and branch_cost.png")


if __name__ == "__main__":
    main()
