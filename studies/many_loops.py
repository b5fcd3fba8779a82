"""What a form costs with many loops: sheets of Miura-ori of 1 to 100 vertices.

    python -m studies.many_loops [--out DIR] [--largest 10]

A sheet with k x k inner vertices has k^2 loops, of which one freedom is left. It is given
folded, as a FOLD file; times are processor times of reading it, of writing its equations,
and of the one form through its state. The error is the largest residual at places all
along the form. Memory is the largest resident one so far, which sheets of ascending size
make that of the last one.
"""

from __future__ import annotations

import csv
import json
import resource
import time
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import click
import numpy as np
from matplotlib.figure import Figure

from bifurc.curves.continuation import trace_branch
from linkages.mechanisms.closure import MechanismClosure
from linkages.mechanisms.fold import read_fold
from studies.miura import miura

__all__ = ["SheetCost", "cost_of_sheet"]

FOLD = 0.8  # rad, along the zigzags
PLACES = 2000  # along a form, at which it is checked


@dataclass(frozen=True)
class SheetCost:
    """One sheet: its loops and unknowns, seconds of reading it, of its equations and of
    its form, the form's pieces, the largest residual along it, and megabytes."""

    loops: int
    unknowns: int
    read: float
    equations: float
    form: float
    pieces: int
    error: float
    memory: float


def cost_of_sheet(vertices: int) -> SheetCost:
    """What the form of a sheet with so many inner vertices a side costs."""
    text = json.dumps(miura(vertices + 1, vertices + 1, FOLD))
    begin = time.process_time()
    mechanism = read_fold(text, "sheet")
    read = time.process_time()
    problem = MechanismClosure(mechanism)
    problem.residuals(problem.reference[None])
    written = time.process_time()
    branch = trace_branch(problem, problem.reference)
    traced = time.process_time()
    residuals = problem.residuals(branch.sample(PLACES))
    return SheetCost(
        loops=mechanism.independent_loops,
        unknowns=problem.n,
        read=read - begin,
        equations=written - read,
        form=traced - written,
        pieces=len(branch.pieces),
        error=float(np.linalg.norm(residuals, axis=1).max()),
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )


def exponent(costs: list[SheetCost]) -> float:
    """The exponent of the time of a form against the number of loops, by least
    squares."""
    loops = np.log([cost.loops for cost in costs])
    seconds = np.log([cost.form for cost in costs])
    return float(np.polyfit(loops, seconds, 1)[0])


def draw(costs: list[SheetCost]) -> Figure:
    """Time and memory against the number of loops."""
    figure = Figure(figsize=(9, 4), layout="constrained")
    times, memory = figure.subplots(1, 2)
    loops = [cost.loops for cost in costs]
    for name in ("read", "equations", "form"):
        times.loglog(loops, [getattr(c, name) for c in costs], "o-", label=name)
    times.set(xlabel="loops", ylabel="processor time (s)")
    times.legend()
    memory.semilogx(loops, [cost.memory for cost in costs], "o-")
    memory.set(xlabel="loops", ylabel="resident memory (MB)", ylim=(0, None))
    return figure


@click.command()
@click.option("--out", type=Path, default=Path("out/many_loops"), show_default=True)
@click.option("--largest", type=click.IntRange(2, 20), default=10, show_default=True)
def main(out: Path, largest: int) -> None:
    """Measure sheets of Miura-ori up to the largest number of vertices a side."""
    sides = sorted({2, 3, 4, 5, 7, largest})
    cost_of_sheet(1)  # imports, which are no part of it
    costs = [cost_of_sheet(side) for side in sides if side <= largest]
    out.mkdir(parents=True, exist_ok=True)
    with (out / "costs.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(SheetCost)])
        writer.writeheader()
        writer.writerows(asdict(cost) for cost in costs)
    draw(costs).savefig(out / "many_loops.png", dpi=150)
    for cost in costs:
        click.echo(
            f"{cost.loops:4d} loops, {cost.unknowns:4d} unknowns: read {cost.read:.2f} s,"
            f" equations {cost.equations:.2f} s, form {cost.form:.2f} s in {cost.pieces}"
            f" pieces, within {cost.error:.1e}, {cost.memory:.0f} MB"
        )
    click.echo(f"exponent of a form's time against loops: {exponent(costs):.2f}")


if __name__ == "__main__":
    main()
