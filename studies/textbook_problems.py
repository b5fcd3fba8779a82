"""Problems of continuation codes, against the points that their sources print.

The 20 problems of Rheinboldt's collection TEST_CON (after J. Burkardt's programs), the
algebraic demos of AUTO-07p and the algebraic tutorials of BifurcationKit. A problem is
right where all printed points are found to all digits that are printed, misprints put
right; in doubt where the atlas says so; wrong else. Seconds are those of the processor.

    python -m studies.textbook_problems --names "cell kinetics" --points
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence

import click
import numpy as np

from studies.study import Study, require_known
from studies.textbook.comparison import Comparison, Verdict, compare
from studies.textbook.problems import TextbookProblem, load_problems


def run_problem(problem: TextbookProblem, seed: int, budget: float) -> Comparison:
    """How the atlas of a problem, from one random seed, compares with its source."""
    began = time.process_time()
    atlas = problem.explore(seed, budget)
    seconds = time.process_time() - began
    return compare(problem, atlas, seconds)


def _print_points(comparison: Comparison) -> None:
    """One line for each printed point."""
    for match in comparison.matches:
        printed = match.printed
        print(f"  {printed.kind}: {match.units:.2g} units of the last digit")
        for name, value in printed.at.items():
            found = "" if match.found is None else f"{match.found[name]:.10g}"
            right = printed.misprints.get(name)
            note = "" if right is None else f", misprint for {right}"
            print(f"    {name}: {found} (printed {value}{note})")
        if printed.remark:
            print(f"    {printed.remark}")


def _row(comparison: Comparison) -> str:
    """A line of the table."""
    problem = comparison.problem
    met = sum(match.is_met for match in comparison.matches)
    misprints = sum(bool(match.printed.misprints) for match in comparison.matches)
    points = f"{met} of {len(comparison.matches)}"
    cells = [
        problem.collection,
        problem.name,
        problem.problem.n,
        comparison.forms,
        comparison.limits,
        comparison.bifurcations,
        comparison.hopf_points,
        points,
        misprints or "",
        f"{comparison.seconds:.2g}",
        comparison.verdict.value,
    ]
    return "| " + " | ".join(map(str, cells)) + " |"


HEAD = """\
| from | problem | unknowns | forms | limit points | bifurcations | Hopf points \
| printed points met | misprints | s | |
|---|---|---|---|---|---|---|---|---|---|---|"""


def _print_summary(comparisons: Sequence[Comparison]) -> None:
    counts = Counter(comparison.verdict for comparison in comparisons)
    words = ", ".join(f"{counts[verdict]} {verdict.value}" for verdict in Verdict)
    seconds = [comparison.seconds for comparison in comparisons]
    print(f"{words}; median {np.median(seconds):.2g} s, most {max(seconds):.2g} s")


@click.command(cls=Study, help=__doc__)
@click.option("--names", multiple=True, help="Only these problems.")
@click.option("--collections", multiple=True, help="Only problems of these.")
@click.option("--seeds", type=click.IntRange(1), default=1, show_default=True)
@click.option("--budget", default=60.0, show_default=True, help="Seconds for each.")
@click.option("--largest", default=1000, show_default=True, help="Unknowns at most.")
@click.option("--points", is_flag=True, help="Print every point.")
def main(
    names: tuple[str, ...],
    collections: tuple[str, ...],
    seeds: int,
    budget: float,
    largest: int,
    points: bool,
) -> None:
    """Run the problems and print the table."""
    problems = load_problems()
    require_known("--names", names, [problem.name for problem in problems])
    collected = [problem.collection for problem in problems]
    require_known("--collections", collections, collected)
    comparisons = []
    print(HEAD)
    for problem in problems:
        is_named = not names or problem.name in names
        is_of_one = not collections or problem.collection in collections
        if not is_named or not is_of_one or problem.problem.n > largest:
            continue
        for seed in range(seeds):
            comparison = run_problem(problem, seed, budget)
            print(_row(comparison), flush=True)
            if comparison.verdict is Verdict.IN_DOUBT:
                print(f"  {comparison.statement}")
            if points or comparison.verdict is Verdict.WRONG:
                _print_points(comparison)
            comparisons.append(comparison)
    _print_summary(comparisons)


if __name__ == "__main__":
    main()
