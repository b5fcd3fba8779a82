"""Time against error on the problems of textbooks: this project and AUTO-07p.

The longest form of each problem that stands in a file is followed from its begin, by
this project at order 16 and by AUTO-07p with the equations in Fortran, at tolerances
from 1e-2 to 1e-12. Of each the tolerance counts with which the whole curve is soonest
right to an error, relative to the scale of the unknowns; with these they then take
turns of three runs, and the least time of each is printed. How errors are measured, and
how AUTO-07p is run: `studies.work_precision`.

    python -m studies.textbook_times
"""

from __future__ import annotations

from collections.abc import Sequence

import click

from bifurc import TraceSettings, trace_branch
from bifurc.equations.expression_problem import ExpressionProblem
from studies.methods import auto07p
from studies.methods.cases import Case
from studies.methods.roster import Method, orders_of_this_project
from studies.study import Study, require_known
from studies.textbook.fortran import fortran_of
from studies.textbook.problems import TextbookProblem, load_problems
from studies.work_precision import least_in_turn, measure
from studies.work_precision_runs import Run

ORDER = 16
TOLERANCES = [10.0**-k for k in range(2, 13)]
ERRORS = (1e-6, 1e-8)
EXACT = (
    1e-14,
    1e-13,
    1e-12,
)  # tolerances of the exact curve, the first that gets through
WHOLE = 0.999  # share of a curve that is all of it
FLOOR = 1e-15
BUDGET = 0.02  # s, for the repeats of a run
TURNS = 5  # of each method


def case_of(problem: TextbookProblem) -> Case | None:
    """The longest form of a problem, from its begin to its end; None for a problem that
    is not in a file, and where no exact curve is traced in the units of the file."""
    equations = problem.problem
    if not isinstance(equations, ExpressionProblem):
        return None
    atlas = problem.explore(0, 60.0)
    branch = max(atlas.forms, key=lambda form: form.branch.length).branch
    start, tangent = branch(0.0), branch(0.0, 1)
    precise = equations.precise_residual()
    for tolerance in EXACT:
        settings = TraceSettings(order=20, tolerance=tolerance, max_length=1e5)
        reference = trace_branch(equations, start, tangent, settings)
        if reference.length < WHOLE * branch.length:
            continue
        return Case(
            name=problem.name,
            title=problem.name,
            problem=equations,
            start=reference(0.0),
            tangent=reference(0.0, 1),
            exact_residual=lambda unknowns: list(precise(unknowns)),
            settings=settings,
            fortran=fortran_of(equations),
        )
    return None


def fastest_within(runs: Sequence[Run], error: float) -> Run | None:
    """The quickest of the runs with no larger error; None where there is none."""
    enough = [run for run in runs if run.error <= error]
    return min(enough, key=lambda run: run.seconds, default=None)


def _runs(case: Case, method: Method) -> list[Run]:
    return [measure(case, method, tol, FLOOR, BUDGET) for tol in TOLERANCES]


def _cells(
    case: Case, methods: Sequence[Method], runs: Sequence[Sequence[Run]], error: float
) -> list[str]:
    """Milliseconds of each method to come within an error, a dash where none of its runs
    does."""
    fastest = [fastest_within(own, error) for own in runs]
    settled = [
        (method, run.tolerance)
        for method, run in zip(methods, fastest, strict=True)
        if run is not None
    ]
    times = iter(least_in_turn(case, settled, TURNS))
    return ["-" if run is None else f"{1e3 * next(times):.2g}" for run in fastest]


@click.command(cls=Study, help=__doc__)
@click.option("--names", multiple=True, help="Only these problems.")
def main(names: tuple[str, ...]) -> None:
    """Measure both, and print times in milliseconds."""
    require_known("--names", names, [problem.name for problem in load_problems()])
    methods = [one for one in orders_of_this_project() if one.order == ORDER]
    if auto07p.has_auto():
        methods.append(Method("AUTO-07p", auto07p.auto_07p))
    heads = [f"{method.name}, {error:g}" for error in ERRORS for method in methods]
    print("| problem | " + " | ".join(heads) + " |")
    print("|---" * (len(heads) + 1) + "|")
    for problem in load_problems():
        if names and problem.name not in names:
            continue
        case = case_of(problem)
        if case is None:
            continue
        runs = [_runs(case, method) for method in methods]
        cells: list[str] = []
        for error in ERRORS:
            cells += _cells(case, methods, runs, error * case.problem.domain.scale)
        print(f"| {problem.name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
