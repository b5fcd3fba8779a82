"""Part two of the stability study: how many bifurcations every method reports on a
curve."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bifurc import Problem, Seeds, explore
from studies.hard_cases import CENTER, Crossing
from studies.methods import peers, point_by_point
from studies.methods.counted import Counted
from studies.methods.detection import by_determinant, by_singular_value
from studies.stability_arcs import FAILURES, tolerance_for
from studies.stability_runs import Run, Verdict

Reporter: TypeAlias = Callable[[Crossing, Problem], int]
Floats: TypeAlias = NDArray[np.float64]

STEP = 0.02  # of the methods that follow the curve
ON = 1e-6  # distance of the start below which a form is the curve


def reporters() -> dict[str, Reporter]:
    """Every way to find bifurcations on a curve that is given by a start."""
    methods: dict[str, Reporter] = {
        "this project": _explore,
        "pseudo-arclength, determinant": _determinant,
        "SVD predictor-corrector": _singular_value,
    }
    if peers.has_pycont():
        methods["pycont-lite"] = _pycont
    return methods


def _explore(case: Crossing, problem: Problem) -> int:
    """Bifurcations on the forms through the start, in the atlas that it leads to."""
    start = case.start[None]
    nothing = np.empty((0, problem.n))
    seeds = Seeds(start, np.ones(1, dtype=bool), np.empty(0), nothing)
    atlas = explore(problem, seeds=seeds)
    own = set()
    for index, form in enumerate(atlas.forms):
        distances, _ = form.branch.nearest(start)
        if distances[0] < ON:
            own.add(index)
    passing = [{index for index, _ in point.passes} for point in atlas.bifurcations]
    return sum(1 for forms in passing if forms & own)


def _determinant(case: Crossing, problem: Problem) -> int:
    return by_determinant(problem, _walk(case, problem))


def _singular_value(case: Crossing, problem: Problem) -> int:
    return by_singular_value(problem, _walk(case, problem))


def _pycont(case: Crossing, problem: Problem) -> int:
    increasing = bool(_heading(case, problem)[-1] > 0)
    return peers.count_branch_points(problem, case.start, case.length, STEP, increasing)


def _walk(case: Crossing, problem: Problem) -> Floats:
    """The curve in equal steps by the SVD predictor-corrector, from the start to the
    side of the singular point."""
    heading = _heading(case, problem)
    curve = point_by_point.svd_predictor_corrector(
        problem, case.start, heading, case.length, tolerance_for(2 * STEP)
    )
    return curve.sample(max(8, int(case.length / STEP)))


def _heading(case: Crossing, problem: Problem) -> Floats:
    """The tangent at the start, towards the singular point of a plane curve."""
    jacobian = problem.jacobians(case.start[None])[0]
    tangent: Floats = np.linalg.svd(jacobian)[2][-1]
    if problem.n == 2:
        tangent *= np.sign((CENTER - case.start) @ tangent)
    return tangent


def report_points(case: Crossing, name: str, reporter: Reporter) -> Run:
    """How many bifurcations one method reports on one curve."""
    problem = Counted(case.problem)
    start = time.process_time()
    count = 0
    note = ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            count = reporter(case, problem)
    except (*FAILURES, IndexError) as failure:
        verdict = Verdict.FAILED
        note = str(failure).partition("\n")[0]
    else:
        verdict = _judge(count, case.count)
    return Run(
        case=case.name,
        difficulty=case.count,
        method=name,
        step="",
        verdict=verdict,
        found=count,
        evaluations=problem.evaluations,
        seconds=time.process_time() - start,
        note=note,
    )


def _judge(count: int, true_count: int) -> Verdict:
    if count == true_count:
        return Verdict.RIGHT
    return Verdict.MISSED if count < true_count else Verdict.INVENTED
