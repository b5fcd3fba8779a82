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

from studies.methods.cases import Case, all_cases
from studies.methods.curve import Curve, MethodFailure
from studies.methods.exact import COVER, distance_in_digits, largest_distance
from studies.methods.roster import Method, comparison_methods, orders_of_this_project

__all__ = [
    "Run",
    "fastest",
    "measure",
    "points_in_our_time",
    "ratios",
    "recommend",
    "summarise",
]

log = logging.getLogger(__name__)

TOLERANCES = tuple(10.0**-k for k in range(3, 15))
TARGETS = (1e-4, 1e-6, 1e-8, 1e-10)
DEFAULT_ORDER = 16
NOISE = 0.05  # by how much mean ratios differ from run to run
FAILURES = (MethodFailure, ArithmeticError, ValueError, np.linalg.LinAlgError)
POINT_BY_POINT = "pseudo-arclength, tangent"


@dataclass(frozen=True)
class Run:
    """One measured run: the median processor time, the error, and how many points or
    pieces it took."""

    case: str
    method: str
    order: int
    tolerance: float
    seconds: float
    error: float
    points: int
    note: str = ""


def measure(
    case: Case, method: Method, tolerance: float, floor: float, budget: float
) -> Run:
    """The median of as many runs as fit into ``budget`` seconds, 2 to 9, after one that
    warms up; a run that takes twice as long as that counts itself."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore"
            )  # overflow on the way to a failure that is reported
            curve, seconds = _timed(case, method, tolerance)
            repeats = min(
                9,
                max(2 if seconds < 2 * budget else 0, int(budget / max(seconds, 1e-6))),
            )
            times = [_timed(case, method, tolerance)[1] for _ in range(repeats)] or [
                seconds
            ]
            error = max(largest_distance(case, curve.sample(COVER)), floor)
    except FAILURES as failure:
        return Run(
            case.name,
            method.name,
            method.order,
            tolerance,
            np.nan,
            np.inf,
            0,
            str(failure).partition("\n")[0],
        )
    note = "" if np.isfinite(error) else "a part of the curve is left out"
    return Run(
        case.name,
        method.name,
        method.order,
        tolerance,
        statistics.median(times),
        error,
        curve.points,
        note,
    )


def _timed(case: Case, method: Method, tolerance: float) -> tuple[Curve, float]:
    began = time.process_time()
    curve = method.follow(case, tolerance)
    return (
        curve,
        time.process_time() - began if curve.seconds is None else curve.seconds,
    )


def _warm_up(case: Case, method: Method) -> None:
    """Has everything compiled and imported that a method needs."""
    with warnings.catch_warnings(), suppress(*FAILURES):
        warnings.simplefilter("ignore")
        method.follow(case, TOLERANCES[0])


def measure_case(
    case: Case, methods: Iterable[Method], longest: float
) -> tuple[list[Run], float]:
    """Runs of every method from loose to tight tolerances, and the error of the exact
    curve.

    A method is given up when a run takes ``longest`` seconds, times the patience of the
    case. Methods for small problems are left out where the Jacobian is sparse.
    """
    places = case.reference(case.length * (np.arange(12) + 0.5) / 12)
    floor = max(max(distance_in_digits(case, place) for place in places), 1e-16)
    longest *= case.patience
    runs: list[Run] = []
    for method in methods:
        if method.small and case.sparse:
            note = "not tried: it has no sparse matrices"
            runs.append(
                Run(
                    case.name,
                    method.name,
                    method.order,
                    TOLERANCES[0],
                    np.nan,
                    np.inf,
                    0,
                    note,
                )
            )
            continue
        _warm_up(case, method)
        for tolerance in (t for t in TOLERANCES if t >= case.tightest):
            began = time.process_time()
            run = measure(case, method, tolerance, floor, longest / 4)
            runs.append(run)
            log.info("%s", run)
            failed_after = (
                0.0 if np.isfinite(run.error) else time.process_time() - began
            )
            if run.seconds > longest or failed_after > longest:
                break
    return runs, floor


# --- what the runs say --------------------------------------------------------------------------------


def fastest(runs: Iterable[Run], error: float) -> float:
    """The least time of the runs within an error; nan where none is."""
    return min((run.seconds for run in runs if run.error <= error), default=np.nan)


def ratios(runs: Sequence[Run]) -> list[dict[str, str | float]]:
    """For each curve, comparison method and target error: how many times longer it
    takes than this project."""
    rows: list[dict[str, str | float]] = []
    for case in dict.fromkeys(run.case for run in runs):
        here = [run for run in runs if run.case == case]
        for method in dict.fromkeys(run.method for run in here if not run.order):
            theirs = [run for run in here if run.method == method]
            row: dict[str, str | float] = {"case": case, "method": method}
            for target in TARGETS:
                ours = fastest(
                    (run for run in here if run.order == DEFAULT_ORDER), target
                )
                row[f"{target:.0e}"] = fastest(theirs, target) / ours
            rows.append(row)
    return rows


def recommend(
    runs: Sequence[Run], error: float = 1e-12
) -> dict[int, tuple[float, float]]:
    """For each order of this project what it takes to reach ``error``: the time, as the
    geometric mean over the curves of its ratio to the fastest order, and the loosest
    tolerance that does it on the most curves. Curves that no order brings there are
    left out."""
    out = {}
    names = dict.fromkeys(run.case for run in runs)
    cases = [
        name
        for name in names
        if np.isfinite(fastest((r for r in runs if r.case == name and r.order), error))
    ]
    for order in sorted({run.order for run in runs if run.order}):
        ours = [run for run in runs if run.order == order]
        slower = []
        for case in cases:
            best = fastest((r for r in runs if r.case == case and r.order), error)
            slower.append(fastest((r for r in ours if r.case == case), error) / best)
        reached = {
            t: sum(
                r.error <= error for r in ours if r.tolerance == t and r.case in cases
            )
            for t in TOLERANCES
        }
        out[order] = (
            float(np.exp(np.mean(np.log(slower)))),
            max(reached, key=lambda t: (reached[t], t)),
        )
    return out


def points_in_our_time(runs: Sequence[Run], case: str, error: float) -> float:
    """Points a second that pseudo-arclength continuation with the tangent would have to
    make to be as fast: what it needs for an error on a curve, over the time of this
    project at the default order. nan where one does not get there.
    """
    here = [run for run in runs if run.case == case and run.error <= error]
    points = min(
        (run.points for run in here if run.method == POINT_BY_POINT), default=np.nan
    )
    return points / fastest((run for run in here if run.order == DEFAULT_ORDER), error)


def _best_order(advice: Mapping[int, tuple[float, float]]) -> int:
    """The fastest order; the default one unless it is slower by more than runs
    differ."""
    best = min(
        (o for o in advice if np.isfinite(advice[o][0])),
        key=lambda o: advice[o][0],
        default=DEFAULT_ORDER,
    )
    ours = advice.get(DEFAULT_ORDER, (np.inf, np.nan))[0]
    return DEFAULT_ORDER if ours <= (1 + NOISE) * advice[best][0] else best


def summarise(runs: Sequence[Run], floors: Mapping[str, float]) -> str:
    """The findings in words."""
    lines = ["Distance of the exact curve to the solution set, in 40 digits:"]
    lines += [f"  {case}: {floor:.1e}" for case, floor in floors.items()]
    lines += [
        "",
        "Time to reach 1e-12, over the fastest order (geometric mean; nan: not reached on every curve):",
    ]
    advice = recommend(runs)
    lines += [
        f"  order {order}: {ratio:.2f}, with tolerance {tol:.0e}"
        for order, (ratio, tol) in advice.items()
    ]
    best = _best_order(advice)
    lines += [
        f"The default should be order {best} and tolerance {advice[best][1]:.0e}.",
        "",
    ]
    lines += [
        "Time over that of this project (order 16), median over the curves, and on how many it gets there:"
    ]
    table = ratios(runs)
    for method in dict.fromkeys(row["method"] for row in table):
        said = []
        for target in TARGETS:
            values = [
                float(row[f"{target:.0e}"]) for row in table if row["method"] == method
            ]
            finite = [v for v in values if np.isfinite(v)]
            median = (
                f"{statistics.median(finite):.1f} ({len(finite)})" if finite else "-"
            )
            said.append(f"{target:.0e}: {median}")
        lines.append(f"  {method}: " + ", ".join(said))
    lines += [
        "",
        "Points a second at which pseudo-arclength steps of the same error would be as fast:",
    ]
    for case in dict.fromkeys(run.case for run in runs):
        rates = [(target, points_in_our_time(runs, case, target)) for target in TARGETS]
        lines.append(
            f"  {case}: "
            + ", ".join(f"{t:.0e}: {r:,.0f}" for t, r in rates if np.isfinite(r))
        )
    return "\n".join(lines) + "\n"


def _write_csv(
    path: Path, names: Sequence[str], rows: Iterable[Mapping[str, object]]
) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(rows)


@click.command()
@click.option(
    "--out",
    default="work_precision",
    show_default=True,
    type=click.Path(path_type=Path, file_okay=False),
)
@click.option(
    "--quick",
    is_flag=True,
    help="Give up tightening a method's tolerance after 0.1 s instead of 0.5 s.",
)
@click.option("--case", "names", multiple=True, help="Only these curves.")
def main(out: Path, quick: bool, names: tuple[str, ...]) -> None:
    """Measure every method on every curve, and draw time against error."""
    from studies.work_precision_figures import draw_case, draw_ratios

    out.mkdir(parents=True, exist_ok=True)
    cases = [case for case in all_cases() if not names or case.name in names]
    runs: list[Run] = []
    floors = {}
    for case in cases:
        click.echo(f"{case.title}: length {case.length:.4g}", err=True)
        found, floors[case.name] = measure_case(
            case,
            [*orders_of_this_project(), *comparison_methods()],
            0.1 if quick else 0.5,
        )
        runs += found
        draw_case(case.title, found, out / f"{case.name}.png")
        _write_csv(
            out / "runs.csv",
            [f.name for f in fields(Run)],
            (asdict(run) for run in runs),
        )
    table = ratios(runs)
    _write_csv(out / "ratios.csv", list(table[0]), table)
    draw_ratios(table, {case.name: case.title for case in cases}, out / "ratios.png")
    text = summarise(runs, floors)
    (out / "summary.txt").write_text(text, encoding="utf-8")
    click.echo(text)


if __name__ == "__main__":
    main()
