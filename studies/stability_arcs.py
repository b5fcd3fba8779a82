"""Part one of the stability study: every method follows an arc past another one."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bifurc import Branch, Problem, TraceSettings, trace_branch
from bifurc.curves.certificate import certify_branch
from bifurc.curves.monitor import profile_branch
from studies.hard_cases import Ladder
from studies.methods import natural, null_field, peers, point_by_point
from studies.methods.counted import Counted
from studies.methods.curve import Curve, MethodFailure
from studies.stability_runs import Run, Verdict

Floats: TypeAlias = NDArray[np.float64]

STEPS = {"fine": 0.02, "medium": 0.1, "coarse": 0.5}
DENSE = 4000  # places at which a curve is judged
TO_A_PIECE = 40  # places at which a piece of this project is judged
CERTIFIED = "certified"
FAILURES = (MethodFailure, ArithmeticError, ValueError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class FollowedCurve:
    """A curve as points (k, n), and for one of this project its pieces and its
    certificate."""

    points: Floats
    pieces: int = 0
    certificate: str = ""
    certificate_points: int = 0
    certificate_seconds: float = 0.0

    @property
    def is_refused(self) -> bool:
        """Whether there is a certificate, and it does not hold everywhere."""
        return self.certificate not in ("", CERTIFIED)


Follower: TypeAlias = Callable[[Ladder, Problem, float], FollowedCurve]


class PointByPoint(Protocol):
    """A method that takes a start, a tangent, a length and a tolerance."""

    def __call__(
        self,
        problem: Problem,
        start: Floats,
        tangent: Floats,
        length: float,
        tolerance: float,
    ) -> Curve: ...


def followers() -> dict[str, Follower]:
    """Every method as a function of a ladder, a problem that counts and a step."""
    svd = point_by_point.svd_predictor_corrector
    methods: dict[str, Follower] = {
        "this project": _this_project,
        "natural parameter": _natural,
        "solve_ivp RK45": partial(_null_field, projected=False),
        "solve_ivp RK45, projected": partial(_null_field, projected=True),
        "SVD predictor-corrector": partial(_fixed_steps, svd),
        "pseudo-arclength": _pseudo_arclength,
    }
    if peers.has_pycont():
        methods["pycont-lite"] = partial(_fixed_steps, peers.pycont_lite)
    return methods


def tolerance_for(step: float) -> float:
    """The tolerance at which the methods of `studies.methods` take steps of about
    ``step``."""
    return (step / 2.5) ** 4


def _this_project(case: Ladder, problem: Problem, step: float) -> FollowedCurve:
    settings = TraceSettings(longest=step / problem.domain.scale)
    branch = trace_branch(problem, case.start, case.tangent, settings)
    if not len(branch.pieces) or branch.outcome.name in ("STALLED", "OPEN"):
        raise MethodFailure(branch.outcome.value)
    points = branch(_places_on(branch))
    if (points[-1] - points[0]) @ case.tangent <= 0:
        points = points[::-1]
    start = time.process_time()
    profile = profile_branch(case.problem, branch)
    certificate = certify_branch(case.problem, branch, profile)
    return FollowedCurve(
        points=points,
        pieces=len(branch.pieces),
        certificate=certificate.status,
        certificate_points=certificate.points,
        certificate_seconds=time.process_time() - start,
    )


def _places_on(branch: Branch) -> Floats:
    """Arclengths, as many on every piece."""
    parts = []
    for start, end in pairwise(branch.breaks):
        parts.append(np.linspace(start, end, TO_A_PIECE, endpoint=False))
    return np.concatenate(parts)


def _natural(case: Ladder, problem: Problem, step: float) -> FollowedCurve:
    tolerance = (step / 1.25) ** 4
    curve = natural.natural_parameter(
        problem, case.start, case.travel, case.parameter, tolerance
    )
    return FollowedCurve(curve.sample(DENSE))


def _null_field(
    case: Ladder, problem: Problem, step: float, projected: bool
) -> FollowedCurve:
    curve = null_field.integrate_null_field(
        problem,
        case.start,
        case.tangent,
        case.length,
        tolerance_for(step),
        "RK45",
        projected,
        step,
    )
    return FollowedCurve(curve.sample(DENSE))


def _fixed_steps(
    follow: PointByPoint, case: Ladder, problem: Problem, step: float
) -> FollowedCurve:
    """A method whose steps are half of what its tolerance stands for."""
    tolerance = tolerance_for(2 * step)
    curve = follow(problem, case.start, case.tangent, case.length, tolerance)
    return FollowedCurve(curve.sample(DENSE))


def _pseudo_arclength(case: Ladder, problem: Problem, step: float) -> FollowedCurve:
    curve = point_by_point.pseudo_arclength_tangent(
        problem,
        case.start,
        case.tangent,
        case.length,
        tolerance_for(step),
        longest=step / problem.domain.scale,
    )
    return FollowedCurve(curve.sample(DENSE))


def follow_ladder(case: Ladder, name: str, follower: Follower, step: str) -> Run:
    """One method on one near miss."""
    problem = Counted(case.problem)
    start = time.process_time()
    curve = FollowedCurve(np.empty((0, case.problem.n)))
    try:
        with warnings.catch_warnings():
            # overflow on the way to a failure that is reported
            warnings.simplefilter("ignore")
            curve = follower(case, problem, STEPS[step])
    except FAILURES as failure:
        verdict = Verdict.FAILED
        note = str(failure).partition("\n")[0]
    else:
        verdict, note = _judge(case, curve)
    seconds = time.process_time() - start - curve.certificate_seconds
    return Run(
        case=case.name,
        difficulty=case.imperfection,
        method=name,
        step=step,
        verdict=verdict,
        found=0,
        evaluations=problem.evaluations,
        seconds=seconds,
        note=note,
        width=case.width,
        pieces=curve.pieces,
        certificate=curve.certificate,
        certificate_points=curve.certificate_points,
        certificate_seconds=curve.certificate_seconds,
    )


def _judge(case: Ladder, curve: FollowedCurve) -> tuple[Verdict, str]:
    """What a curve is worth, and a note."""
    if not case.stays(curve.points):
        if curve.is_refused:
            return Verdict.FAILED, curve.certificate
        return Verdict.JUMPED, ""
    if not case.arrives(curve.points):
        return Verdict.FAILED, "it stops before the end"
    return Verdict.RIGHT, ""
