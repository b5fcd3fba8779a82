"""Time against error: this project, the usual ways, and the packages that are
installed, on the same curves in one run.

    python -m studies.work_precision [--out DIR] [--quick] [--case NAME ...]

The error of a run is the largest distance of its curve to the exact one, at 2000 places
along the whole of it and not only at the points it was made of; a run that leaves out a
part of the curve counts as failed. The exact curve is this project's at order 20 and
tolerance 1e-14, whose own distance to the solution set is measured in 40 digits and is
the least error shown. All methods call the same compiled residual and Jacobian; the
usual ways are NumPy and SciPy around them. AUTO-07p alone has the equations in Fortran,
as it is meant to be used. Times are processor times, so that other work on the machine
does not count. LSODA has no variant with projection: its history of steps cannot be
moved. Set OPENBLAS_NUM_THREADS=1, as threads only add up here.

Writes runs.csv, a figure for each curve, ratios.csv, ratios.png and summary.txt.
"""

from __future__ import annotations

import csv
import logging
import statistics
import time
import warnings
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import click
import numpy as np

from linkages.app.options import FOLDER
from studies.methods.cases import Case, all_cases
from studies.methods.curve import Curve, MethodFailure
from studies.methods.exact import COVER, distance_in_digits, largest_distance
from studies.methods.roster import Method, comparison_methods, orders_of_this_project
from studies.study import Study, require_known
from studies.work_precision_figures import draw_case, draw_ratios
from studies.work_precision_findings import TOLERANCES, ratios, summarise
from studies.work_precision_runs import Run

log = logging.getLogger(__name__)

FAILURES = (MethodFailure, ArithmeticError, ValueError, np.linalg.LinAlgError)
PLACES = 12  # of the exact curve, where its own error is measured
ROUNDING = 1e-16  # the least error shown
MOST_REPEATS = 9
IN_A_TURN = 3  # runs of one method where methods take turns
QUICK, PATIENT = 0.1, 0.5  # s, after which a method's tolerance is tightened no more


@dataclass(frozen=True)
class CaseRuns:
    """All runs on one curve, and ``floor``: the error of the exact curve."""

    runs: list[Run]
    floor: float


def measure(
    case: Case, method: Method, tolerance: float, floor: float, budget: float
) -> Run:
    """The median of as many runs as fit into ``budget`` seconds, 2 to 9, after one that
    warms up; a run that takes twice as long as that counts itself."""
    try:
        with warnings.catch_warnings():
            # overflow on the way to a failure that is reported
            warnings.simplefilter("ignore")
            curve, seconds = _timed(case, method, tolerance)
            times = []
            for _ in range(_repeats(seconds, budget)):
                _, again = _timed(case, method, tolerance)
                times.append(again)
            error = max(largest_distance(case, curve.sample(COVER)), floor)
    except FAILURES as failure:
        return _failed(case, method, tolerance, str(failure).partition("\n")[0])
    return Run(
        case=case.name,
        method=method.name,
        order=method.order,
        tolerance=tolerance,
        seconds=statistics.median(times or [seconds]),
        error=error,
        points=curve.points,
        note="" if np.isfinite(error) else "a part of the curve is left out",
    )


def least_in_turn(
    case: Case, runs: Sequence[tuple[Method, float]], turns: int
) -> list[float]:
    """The least processor time (s) of each of some runs, a method with a tolerance, that
    take turns of a few runs each: what else the machine does falls on all of them."""
    times: list[list[float]] = [[] for _ in runs]
    for _ in range(turns):
        for (method, tolerance), own in zip(runs, times, strict=True):
            own += [_timed(case, method, tolerance)[1] for _ in range(IN_A_TURN)]
    return [min(own) for own in times]


def _repeats(seconds: float, budget: float) -> int:
    """How often a run of so many seconds is repeated."""
    fewest = 2 if seconds < 2 * budget else 0
    return min(MOST_REPEATS, max(fewest, int(budget / max(seconds, 1e-6))))


def _failed(case: Case, method: Method, tolerance: float, note: str) -> Run:
    """A run without a curve."""
    return Run(
        case=case.name,
        method=method.name,
        order=method.order,
        tolerance=tolerance,
        seconds=np.nan,
        error=np.inf,
        points=0,
        note=note,
    )


def _timed(case: Case, method: Method, tolerance: float) -> tuple[Curve, float]:
    """A curve and the processor time (s) that it took."""
    start = time.process_time()
    curve = method.follow(case, tolerance)
    seconds = time.process_time() - start
    return curve, seconds if curve.seconds is None else curve.seconds


def _warm_up(case: Case, method: Method) -> None:
    """Has everything compiled and imported that a method needs."""
    with warnings.catch_warnings(), suppress(*FAILURES):
        warnings.simplefilter("ignore")
        method.follow(case, TOLERANCES[0])


def measure_case(case: Case, methods: Iterable[Method], longest: float) -> CaseRuns:
    """Runs of every method from loose to tight tolerances, and the error of the exact
    curve.

    A method is given up when a run takes ``longest`` seconds, times the patience of the
    case. Methods for small problems are left out where the Jacobian is sparse.
    """
    places = case.reference(case.length * (np.arange(PLACES) + 0.5) / PLACES)
    floor = max(ROUNDING, *(distance_in_digits(case, place) for place in places))
    patience = longest * case.patience
    runs: list[Run] = []
    for method in methods:
        if method.small and case.sparse:
            note = "not tried: it has no sparse matrices"
            runs.append(_failed(case, method, TOLERANCES[0], note))
        else:
            runs += _measure_method(case, method, floor, patience)
    return CaseRuns(runs, floor)


def _measure_method(
    case: Case, method: Method, floor: float, patience: float
) -> list[Run]:
    """Runs of one method from loose to tight tolerances, until one of them takes
    longer than ``patience``."""
    _warm_up(case, method)
    runs = []
    for tolerance in TOLERANCES:
        if tolerance < case.tightest:
            break
        start = time.process_time()
        run = measure(case, method, tolerance, floor, patience / 4)
        spent = time.process_time() - start
        runs.append(run)
        log.info("%s", run)
        if run.seconds > patience or (not run.reached_the_end and spent > patience):
            break
    return runs


def _write_csv(
    path: Path, names: Sequence[str], rows: Iterable[Mapping[str, object]]
) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(rows)


@click.command(cls=Study)
@click.option(
    "--out",
    default="work_precision",
    show_default=True,
    type=FOLDER,
)
@click.option(
    "--quick",
    is_flag=True,
    help=(
        f"Give up tightening a method's tolerance after {QUICK} s instead of "
        f"{PATIENT} s."
    ),
)
@click.option("--case", "names", multiple=True, help="Only these curves.")
def main(out: Path, quick: bool, names: tuple[str, ...]) -> None:
    """Measure every method on every curve, and draw time against error."""
    require_known("--case", names, [case.name for case in all_cases()])
    out.mkdir(parents=True, exist_ok=True)
    cases = [case for case in all_cases() if not names or case.name in names]
    methods = [*orders_of_this_project(), *comparison_methods()]
    columns = [field.name for field in fields(Run)]
    runs: list[Run] = []
    floors = {}
    for case in cases:
        click.echo(f"{case.title}: length {case.length:.4g}", err=True)
        measured = measure_case(case, methods, QUICK if quick else PATIENT)
        runs += measured.runs
        floors[case.name] = measured.floor
        draw_case(case.title, measured.runs, out / f"{case.name}.png")
        _write_csv(out / "runs.csv", columns, (asdict(run) for run in runs))
    table = ratios(runs)
    titles = {case.name: case.title for case in cases}
    _write_csv(out / "ratios.csv", list(table[0]), table)
    draw_ratios(table, titles, out / "ratios.png")
    text = summarise(runs, floors)
    (out / "summary.txt").write_text(text, encoding="utf-8")
    click.echo(text)


if __name__ == "__main__":
    main()
