"""Where methods fail: near misses of any width, and singular points of every kind, for
this project and the usual ways.

    python -m studies.stability [--out DIR] [--quick]

Part one: an arc that passes another because of an imperfection from 1e-1 to 1e-12. A
method is right when it follows the true arc to its end, has failed when it says so, and
has jumped when it goes over to the other arc without a word. Fine, medium and coarse
are steps of at most 0.02, 0.1 and 0.5. This project says that it failed where it
stalls, and where its certificate refuses a wrong arc. Every curve of this project is
certified; the cost of that is listed apart.

Part two: how many bifurcations every method reports on a curve where their number is
known. Test functions see sign changes of a determinant or small singular values; this
project locates and classifies.

Cost is counted in evaluations of F and F' at a point (a compiled Taylor piece of this
project counts ten), and in processor time. The tests of right and wrong are exact: a
sign that cannot change on the true arc.
"""

from __future__ import annotations

import csv
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import click
import numpy as np

from bifurc.curves.certificate import certify_branch
from bifurc.curves.continuation import TraceSettings, trace_branch
from bifurc.curves.monitor import profile_branch
from bifurc.problem import Problem
from bifurc.search.explore import explore
from bifurc.seeds import Seeds
from linkages.app.texts import table
from studies.hard_cases import Crossing, Ladder, crossings, ladders
from studies.methods import natural, null_field, peers, point_by_point
from studies.methods.counted import Counted
from studies.methods.curve import MethodFailure
from studies.methods.detection import by_determinant, by_singular_value

__all__ = [
    "STEPS",
    "Followed",
    "Run",
    "follow_ladder",
    "followers",
    "report_points",
    "reporters",
]

STEPS = {"fine": 0.02, "medium": 0.1, "coarse": 0.5}
IMPERFECTIONS = 10.0 ** -np.arange(1.0, 13.0)
DENSE = 4000  # places at which a curve is judged
Points = np.ndarray
Reporter = Callable[[Crossing, Problem], int]


@dataclass(frozen=True)
class Run:
    """What one method did: ``verdict`` is right, failed, jumped, missed or invented;
    ``difficulty`` the imperfection or the true number of bifurcations, ``width`` that
    of the near miss, ``found`` the number reported. ``pieces`` and the ``certificate``
    with its points and its time (s), beside ``seconds``, are this project's."""

    case: str
    difficulty: float
    method: str
    step: str
    verdict: str
    found: int
    evaluations: int
    seconds: float
    note: str = ""
    width: float = 0.0
    pieces: int = 0
    certificate: str = ""
    certificate_points: int = 0
    certificate_seconds: float = 0.0


@dataclass(frozen=True)
class Followed:
    """A curve as points (k, n), and for one of this project its pieces and its
    certificate."""

    points: Points
    pieces: int = 0
    certificate: str = ""
    certificate_points: int = 0
    certificate_seconds: float = 0.0


Follower = Callable[[Ladder, Problem, float], Followed]


# --- part one: following ------------------------------------------------------------------------------


def followers() -> dict[str, Follower]:
    """Every method as a function of a ladder, a problem that counts and a step."""
    methods: dict[str, Follower] = {
        "this project": _this_project,
        "natural parameter": _natural,
        "solve_ivp RK45": lambda case, problem, step: _null_field(
            case, problem, step, False
        ),
        "solve_ivp RK45, projected": lambda case, problem, step: _null_field(
            case, problem, step, True
        ),
        "SVD predictor-corrector": lambda case, problem, step: _along(
            point_by_point.svd_predictor_corrector, case, problem, 2 * step
        ),
        "pseudo-arclength": lambda case, problem, step: _along(
            partial(
                point_by_point.pseudo_arclength_tangent, longest=step / problem.scale
            ),
            case,
            problem,
            step,
        ),
    }
    if peers.has_pycont():
        methods["pycont-lite"] = lambda case, problem, step: _along(
            peers.pycont_lite, case, problem, 2 * step
        )
    return methods


def _tolerance(step: float) -> float:
    """The tolerance at which the methods of `studies.methods` take steps of about
    ``step``."""
    return (step / 2.5) ** 4


def _this_project(case: Ladder, problem: Problem, step: float) -> Followed:
    branch = trace_branch(
        problem, case.start, case.tangent, TraceSettings(longest=step / problem.scale)
    )
    if not len(branch.pieces) or branch.outcome.name in ("STALLED", "OPEN"):
        raise MethodFailure(branch.outcome.value)
    s = np.concatenate(
        [np.linspace(a, b, 40, endpoint=False) for a, b in pairwise(branch.breaks)]
    )
    points = branch(s)
    points = points if (points[-1] - points[0]) @ case.tangent > 0 else points[::-1]
    began = time.process_time()
    certificate = certify_branch(
        case.problem, branch, profile_branch(case.problem, branch)
    )
    seconds = time.process_time() - began
    return Followed(
        points, len(branch.pieces), certificate.status, certificate.points, seconds
    )


def _natural(case: Ladder, problem: Problem, step: float) -> Followed:
    tolerance = (step / 1.25) ** 4
    curve = natural.natural_parameter(
        problem, case.start, case.travel, case.parameter, tolerance
    )
    return Followed(curve.sample(DENSE))


def _null_field(
    case: Ladder, problem: Problem, step: float, projected: bool
) -> Followed:
    curve = null_field.integrate_null_field(
        problem,
        case.start,
        case.tangent,
        case.length,
        _tolerance(step),
        "RK45",
        projected,
        step,
    )
    return Followed(curve.sample(DENSE))


def _along(
    follow: Callable[..., Any], case: Ladder, problem: Problem, step: float
) -> Followed:
    curve = follow(problem, case.start, case.tangent, case.length, _tolerance(step))
    return Followed(curve.sample(DENSE))


def follow_ladder(case: Ladder, name: str, follower: Follower, step: str) -> Run:
    """One method on one near miss."""
    problem, began = Counted(case.problem), time.process_time()
    verdict, note, found = "right", "", Followed(np.empty((0, case.problem.n)))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore"
            )  # overflow on the way to a failure that is reported
            found = follower(case, problem, STEPS[step])
    except (
        MethodFailure,
        ArithmeticError,
        ValueError,
        np.linalg.LinAlgError,
    ) as failure:
        verdict, note = "failed", str(failure).partition("\n")[0]
    else:
        if not case.stays(found.points):
            refused = found.certificate not in ("", "certified")
            verdict, note = ("failed", found.certificate) if refused else ("jumped", "")
        elif not case.arrives(found.points):
            verdict, note = "failed", "it stops before the end"
    seconds = time.process_time() - began - found.certificate_seconds
    return Run(
        case.name,
        case.imperfection,
        name,
        step,
        verdict,
        0,
        problem.evaluations,
        seconds,
        note,
        case.width,
        found.pieces,
        found.certificate,
        found.certificate_points,
        found.certificate_seconds,
    )


# --- part two: counting bifurcations ------------------------------------------------------------------


def reporters() -> dict[str, Reporter]:
    """Every way to find bifurcations on a curve that is given by a start."""
    methods: dict[str, Reporter] = {
        "this project": _explore,
        "pseudo-arclength, determinant": lambda case, problem: by_determinant(
            problem, _walk(case, problem)
        ),
        "SVD predictor-corrector": lambda case, problem: by_singular_value(
            problem, _walk(case, problem)
        ),
    }
    if peers.has_pycont():
        methods["pycont-lite"] = _pycont
    return methods


def _explore(case: Crossing, problem: Problem) -> int:
    nothing = np.empty((0, problem.n))
    atlas = explore(
        problem,
        seeds=Seeds(case.start[None], np.ones(1, dtype=bool), np.empty(0), nothing),
    )
    own = [
        i
        for i, form in enumerate(atlas.forms)
        if form.branch.nearest(case.start[None])[0][0] < 1e-6
    ]
    return sum(
        1 for point in atlas.bifurcations if any(i in own for i, _ in point.passes)
    )


def _walk(case: Crossing, problem: Problem, step: float = 0.02) -> Points:
    """The curve in equal steps by the SVD predictor-corrector, from the start to the
    side of the singular point."""
    follow = point_by_point.svd_predictor_corrector
    curve = follow(
        problem, case.start, _heading(case, problem), case.length, _tolerance(2 * step)
    )
    return curve.sample(max(8, int(case.length / step)))


def _heading(case: Crossing, problem: Problem) -> np.ndarray:
    """The tangent at the start, towards the singular point of a plane curve."""
    tangent = np.linalg.svd(problem.jacobians(case.start[None])[0])[2][-1]
    center = np.array([0.1234, -0.0567]) if problem.n == 2 else case.start + tangent
    return tangent * np.sign((center - case.start) @ tangent)


def _pycont(case: Crossing, problem: Problem) -> int:
    increasing = bool(_heading(case, problem)[-1] > 0)
    return peers.count_branch_points(problem, case.start, case.length, 0.02, increasing)


def report_points(case: Crossing, name: str, reporter: Reporter) -> Run:
    """How many bifurcations one method reports on one curve."""
    problem, began = Counted(case.problem), time.process_time()
    verdict, note, found = "right", "", 0
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = reporter(case, problem)
    except (
        MethodFailure,
        ArithmeticError,
        ValueError,
        IndexError,
        np.linalg.LinAlgError,
    ) as failure:
        verdict, note = "failed", str(failure).partition("\n")[0]
    else:
        if found != case.count:
            verdict = "missed" if found < case.count else "invented"
    seconds = time.process_time() - began
    return Run(
        case.name,
        case.count,
        name,
        "",
        verdict,
        found,
        problem.evaluations,
        seconds,
        note,
    )


# --- what is shown ------------------------------------------------------------------------------------


def describe(runs: Sequence[Run]) -> str:
    """Three tables: how often each method was right on the near misses, what this
    project's answers cost, and what each method reported on the curves with
    bifurcations."""
    ladder, points = [r for r in runs if r.step], [r for r in runs if not r.step]
    rows = []
    for case, method, step in dict.fromkeys((r.case, r.method, r.step) for r in ladder):
        some = [r for r in ladder if (r.case, r.method, r.step) == (case, method, step)]
        count = [
            sum(r.verdict == v for r in some) for v in ("right", "failed", "jumped")
        ]
        effort, seconds = (
            np.median([getattr(r, what) for r in some])
            for what in ("evaluations", "seconds")
        )
        rows.append(
            (
                case,
                method,
                step,
                f"{count[0]} of {len(some)}",
                str(count[1]),
                str(count[2]),
                f"{effort:.0f}",
                f"{1e3 * seconds:.1f}",
            )
        )
    heads = (
        "near miss",
        "method",
        "step",
        "right",
        "says it failed",
        "jumps",
        "evaluations",
        "ms",
    )
    costs = [
        (
            r.case,
            f"{r.difficulty:.0e}",
            f"{r.width:.1e}",
            r.step,
            r.verdict,
            str(r.pieces),
            str(r.evaluations),
            f"{1e3 * r.seconds:.1f}",
            r.certificate,
            str(r.certificate_points),
            f"{1e3 * r.certificate_seconds:.1f}",
        )
        for r in ladder
        if r.certificate
    ]
    cost_heads = (
        "near miss",
        "imperfection",
        "width",
        "step",
        "verdict",
        "pieces",
        "evaluations",
        "ms",
        "certificate",
        "points",
        "ms",
    )
    listed = [
        (
            r.case,
            f"{r.difficulty:.0f}",
            r.method,
            "-" if r.verdict == "failed" else str(r.found),
            r.verdict,
            str(r.evaluations),
            f"{1e3 * r.seconds:.1f}",
            r.note[:60],
        )
        for r in points
    ]
    second = (
        "curve",
        "bifurcations",
        "method",
        "reported",
        "verdict",
        "evaluations",
        "ms",
        "note",
    )
    return "\n\n".join(
        [
            f"Following an arc past another\n{table(heads, rows)}",
            f"What this project's answers cost\n{table(cost_heads, costs)}",
            f"Bifurcations on a curve\n{table(second, listed)}",
        ]
    )


def run_all(imperfections: np.ndarray) -> list[Run]:
    """Every method on every case."""
    runs = [
        follow_ladder(case, name, follower, step)
        for case in ladders(imperfections)
        for name, follower in followers().items()
        for step in STEPS
    ]
    return runs + [
        report_points(case, name, each)
        for case in crossings()
        for name, each in reporters().items()
    ]


@click.command(help=__doc__)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("out/stability"),
)
@click.option("--quick", is_flag=True, help="Every third imperfection.")
def main(out: Path, quick: bool) -> None:
    """Run the study; write runs.csv, summary.txt and stability.png."""
    from studies.stability_figure import draw_stability

    out.mkdir(parents=True, exist_ok=True)
    for case in ladders(IMPERFECTIONS[:1]):
        follow_ladder(
            case, "this project", followers()["this project"], "coarse"
        )  # compiles what is not yet compiled
    runs = run_all(IMPERFECTIONS[::3] if quick else IMPERFECTIONS)
    text = describe(runs)
    click.echo(text)
    (out / "summary.txt").write_text(text + "\n", encoding="utf-8")
    with (out / "runs.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Run)])
        writer.writeheader()
        writer.writerows(asdict(run) for run in runs)
    draw_stability(runs).savefig(out / "stability.png", dpi=150)


if __name__ == "__main__":
    main()
