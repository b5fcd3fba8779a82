"""What a fold costs with a hundred to a million unknowns, and how exact it is.

    python -m studies.many_unknowns [--out DIR] [--largest 511]

Bratu's problem u'' + p exp(u) = 0 by five-point differences on the unit square, traced
from u = 0 to beyond the fold, which is located: with sparse LU, and with the fast
Poisson solver (sine transforms) as the solver of the user, which preconditions GMRES.
The limit of the folds under refinement is extrapolated (Richardson), as their error goes
with the square of the step. Then the same in one dimension, where the fold is known in
closed form; and Swift and Hohenberg's equation, whose crossings are known for every
number of points, and the Brusselator, whose Hopf points are. Times are processor times;
memory is the largest resident one so far.

Writes costs.csv and many_unknowns.png.
"""

from __future__ import annotations

import csv
import resource
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from itertools import pairwise
from pathlib import Path

import click
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from bifurc import (
    LargeBranch,
    LargeProblem,
    LargeSettings,
    TraceSettings,
    trace_large_branch,
)
from studies.methods.fields import (
    FOLD_IN_1D,
    FOLD_IN_2D,
    Brusselator,
    SwiftHohenberg,
    bratu_field,
    fast_poisson,
)
from studies.study import Study

# Inner points a side of the square: halves of the step, and 10,000 unknowns, whose sine
# transforms are of a length that is no product of small primes, and slow.
HALVED, TEN_THOUSAND = (15, 31, 63, 127, 255, 511, 1023), 100
LARGEST_FACTORED = 127  # side up to which sparse LU is tried as well
IN_1D, LONGER = (99, 199, 399, 799), (1_000, 3_000, 10_000, 30_000, 100_000)
COARSE = (25, 50)  # sides of squares, which with 100 show the limit as well
FOLD_IS_PASSED = 3.7  # arclength of the branch
FITTED_FROM = 3000  # unknowns from which on exponents are fitted
LENGTH, WAVES = 6 * np.pi, 0.7  # of Swift and Hohenberg's interval, largest parameter
LARGEST_B = 8.0  # of the Brusselator's parameter


@dataclass(frozen=True)
class FoldCost:
    """The fold with ``unknowns`` by a ``solver``: its ``parameter`` and ``gap``, how many
    ``pieces`` led there, processor time (s) and megabytes."""

    dimensions: int
    side: int
    unknowns: int
    solver: str
    parameter: float
    gap: float
    pieces: int
    seconds: float
    memory: float


def cost_of_fold(side: int, dimensions: int, solver: str) -> FoldCost:
    """The fold of Bratu's problem by a solver, "sparse LU" or "fast Poisson"."""
    begin = time.process_time()
    field = bratu_field(side, dimensions)
    poisson = fast_poisson(side) if solver == "fast Poisson" else None
    problem = LargeProblem(
        field.residual,
        field.n,
        (0.0, 8.0),
        jacobian=field.jacobian,
        solver=None if poisson is None else lambda u: poisson,
    )
    branch = _traced(problem, FOLD_IS_PASSED)
    seconds = time.process_time() - begin
    (fold,) = branch.folds
    return FoldCost(
        dimensions=dimensions,
        side=side,
        unknowns=field.n - 1,
        solver=solver,
        parameter=fold.parameter,
        gap=fold.gap,
        pieces=len(branch.branch.pieces),
        seconds=seconds,
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )


def _traced(problem: LargeProblem, length: float) -> LargeBranch:
    """The branch from u = 0, p = 0."""
    tracing = TraceSettings(
        order=6, tolerance=1e-6, shortest=1e-7, longest=1.0, max_length=length
    )
    settings = LargeSettings(tracing=tracing)
    return trace_large_branch(problem, np.zeros(problem.n), settings=settings)


def richardson(costs: Sequence[FoldCost]) -> list[float]:
    """The limit of folds as their errors go with the square of the step, from every two
    in turn."""
    limits = []
    for coarse, fine in pairwise(costs):
        ratio = ((fine.side + 1) / (coarse.side + 1)) ** 2
        change = fine.parameter - coarse.parameter
        limits.append(fine.parameter + change / (ratio - 1.0))
    return limits


def exponent(costs: Sequence[FoldCost], quantity: str) -> float:
    """The exponent of time or memory against the number of unknowns, by least
    squares."""
    usual = [cost for cost in costs if cost.dimensions == 1 or cost.side in HALVED]
    fitted = [cost for cost in usual if cost.unknowns >= FITTED_FROM]
    if len(fitted) < 2:
        return float("nan")
    unknowns = np.log([cost.unknowns for cost in fitted])
    values = np.log([getattr(cost, quantity) for cost in fitted])
    return float(np.polyfit(unknowns, values, 1)[0])


def crossing_errors(points: int) -> tuple[np.ndarray, float]:
    """How far the crossings of u = 0 in Swift and Hohenberg's equation are from the known
    ones (k,), and the processor time (s)."""
    begin = time.process_time()
    field = SwiftHohenberg(points, LENGTH)
    problem = LargeProblem(
        field.residual, field.n, (-0.5, WAVES), pattern=field.pattern
    )
    start = np.zeros(field.n)
    start[-1] = -0.45
    branch = trace_large_branch(problem, start, settings=LargeSettings(values=4))
    located = np.array([crossing.parameter for crossing in branch.crossings])
    errors = located - field.crossings_below(WAVES)
    return errors, time.process_time() - begin


def hopf_errors(points: int) -> tuple[np.ndarray, float]:
    """How far the Hopf points of the Brusselator are from the known ones (k,), and the
    processor time (s)."""
    begin = time.process_time()
    field = Brusselator(points)
    problem = LargeProblem(
        field.residual, field.n, (4.0, LARGEST_B), pattern=field.pattern, size=field.a
    )
    settings = LargeSettings(eigenvalues=12)
    branch = trace_large_branch(problem, field.constant(4.2), settings=settings)
    located = np.array([point.parameter for point in branch.hopf_points])
    errors = located - field.hopf_points_below(LARGEST_B)[0]
    return errors, time.process_time() - begin


# --- figure and table -----------------------------------------------------------------


def draw(costs: Sequence[FoldCost]) -> Figure:
    """Time, memory and error of the fold against the number of unknowns; 10,000 of them
    apart, with its slow transforms."""
    figure = Figure(figsize=(11, 3.8), layout="constrained")
    times, memory, errors = figure.subplots(1, 3)
    square = [cost for cost in costs if cost.dimensions == 2]
    for solver, marker in (("fast Poisson", "o-"), ("sparse LU", "s--")):
        own = [cost for cost in square if cost.solver == solver]
        label = _with_exponent(f"2-D, {solver}", own)
        _line_and_apart(times, own, "seconds", marker, label)
    on_line = [cost for cost in costs if cost.dimensions == 1]
    label = _with_exponent("1-D, sparse LU", on_line)
    _line_and_apart(times, on_line, "seconds", "^-", label)
    times.set(xlabel="unknowns", ylabel="processor time (s)")
    times.set_ylim(bottom=0.01)  # room for the legend
    times.legend(loc="lower right")
    by_poisson = [cost for cost in square if cost.solver == "fast Poisson"]
    _line_and_apart(memory, by_poisson, "memory", "o-", "fast Poisson")
    memory.set(xlabel="unknowns", ylabel="resident memory (MB)")
    for name, own, limit in (
        ("1-D", on_line, FOLD_IN_1D),
        ("2-D", by_poisson, FOLD_IN_2D),
    ):
        parts = [cost.side + 1 for cost in own]
        gaps = [abs(cost.parameter - limit) for cost in own]
        errors.loglog(parts, gaps, "o-", label=name)
    errors.set(xlabel="1 / h", ylabel="distance of the fold to its limit")
    errors.legend()
    for axes in (times, memory, errors):
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_minor_formatter(NullFormatter())
    return figure


def _with_exponent(name: str, costs: Sequence[FoldCost]) -> str:
    """A name with the exponent of time, where enough runs say it."""
    power = exponent(costs, "seconds")
    return f"{name}: n^{power:.2f}" if np.isfinite(power) else name


def _line_and_apart(
    axes: Axes, costs: Sequence[FoldCost], quantity: str, marker: str, label: str
) -> None:
    """A quantity against the unknowns, that of 10,000 as a point of its own."""
    halved = [cost for cost in costs if cost.dimensions == 1 or cost.side in HALVED]
    apart = [cost for cost in costs if cost not in halved]
    unknowns = [cost.unknowns for cost in halved]
    values = [getattr(cost, quantity) for cost in halved]
    (line,) = axes.loglog(unknowns, values, marker, label=label)
    for cost in apart:
        value = getattr(cost, quantity)
        axes.plot(cost.unknowns, value, "x", color=line.get_color())


def _line(cost: FoldCost) -> str:
    return (
        f"{cost.dimensions}-D {cost.unknowns:8d} unknowns, {cost.solver:12s}: fold at "
        f"{cost.parameter:.10f}, {cost.pieces} pieces, gap {cost.gap:.1e}, "
        f"{cost.seconds:.2f} s, {cost.memory:.0f} MB"
    )


def _write(costs: Sequence[FoldCost], out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    with (out / "costs.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(FoldCost)])
        writer.writeheader()
        writer.writerows(asdict(cost) for cost in costs)
    draw(costs).savefig(out / "many_unknowns.png", dpi=150)


@click.command(cls=Study)
@click.option("--out", type=Path, default=Path("out/many_unknowns"), show_default=True)
@click.option("--largest", type=click.IntRange(31), default=511, show_default=True)
def main(out: Path, largest: int) -> None:
    """Measure Bratu's problem up to the largest number of points a side."""
    cost_of_fold(15, 2, "fast Poisson")  # imports, which are no part of it
    runs = [(side, 1, "sparse LU") for side in IN_1D]
    for side in sorted((*HALVED, *COARSE, TEN_THOUSAND)):
        if side <= largest:
            runs.append((side, 2, "fast Poisson"))
            if side <= LARGEST_FACTORED:
                runs.append((side, 2, "sparse LU"))
    # last, as memory is the largest so far
    runs += [(side, 1, "sparse LU") for side in LONGER]
    costs: list[FoldCost] = []
    for run in runs:
        costs.append(cost_of_fold(*run))
        click.echo(_line(costs[-1]))
    _write(costs, out)
    _tell_of_costs(costs)
    _tell_of_points()


def _tell_of_costs(costs: Sequence[FoldCost]) -> None:
    """How time grows, and what folds tend to."""
    square = [cost for cost in costs if cost.dimensions == 2]
    for solver in ("fast Poisson", "sparse LU"):
        own = [cost for cost in square if cost.solver == solver]
        click.echo(f"{solver}: time goes with n^{exponent(own, 'seconds'):.2f}")
    line = [cost for cost in costs if cost.dimensions == 1]
    click.echo(f"1-D: time goes with n^{exponent(line, 'seconds'):.2f}")
    poisson = [cost for cost in square if cost.solver == "fast Poisson"]
    halved = [cost for cost in poisson if cost.side in HALVED]
    coarser = [cost for cost in poisson if cost.side in (*COARSE, TEN_THOUSAND)]
    short = [cost for cost in line if cost.side in IN_1D]
    for name, own in (("1-D", short), ("2-D", halved), ("2-D", coarser)):
        limits = ", ".join(f"{limit:.9f}" for limit in richardson(own))
        click.echo(f"Richardson {name}: {limits}")


def _tell_of_points() -> None:
    """How well crossings and Hopf points are found."""
    for points in (200, 800):
        errors, seconds = crossing_errors(points)
        click.echo(
            f"Swift-Hohenberg, {points} unknowns: {len(errors)} crossings within "
            f"{np.abs(errors).max():.1e}, {seconds:.2f} s"
        )
    for points in (100, 1_000, 10_000):
        errors, seconds = hopf_errors(points)
        click.echo(
            f"Brusselator, {2 * points} unknowns: {len(errors)} Hopf points within "
            f"{np.abs(errors).max():.1e}, {seconds:.2f} s"
        )


if __name__ == "__main__":
    main()
