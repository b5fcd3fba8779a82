"""The special points on a curve of a large problem: folds, crossings, near misses."""

from __future__ import annotations

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_crossing_of_many, is_passed, stands_out
from bifurc.large.crossings import LocatedCrossing, locate_crossing
from bifurc.large.folds import locate_fold
from bifurc.large.large_branch import last_unknown
from bifurc.large.large_point import LargeKind, LargePoint
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.singular_profile import SingularProfile, triples_at, unit_tangent
from bifurc.large.smallest_singular_values import SingularTriple
from bifurc.singular.second_order import lines_of_form

__all__ = ["crossings_on", "folds_on", "near_misses_on"]

BEYOND = 1.5  # distances to the next place within which a zero is looked for
FOOT_STEPS = 5  # of Newton's method to the foot of a point
SAME = 1e-4  # arclength: crossings of one curve no farther apart are one
CLOSED_IN = 1e-4  # share of the distance between places to which a minimum is located


# --- folds ----------------------------------------------------------------------------


def folds_on(problem: ScaledProblem, branch: Branch) -> list[LargePoint]:
    """The places of a curve where the parameter turns back, located."""
    if not len(branch.pieces):
        return []
    points = []
    for s in last_unknown(branch).turning_points(0).tolist():
        located = locate_fold(problem, branch(s), unit_tangent(branch, s))
        if located is None:
            continue
        u = problem.own_units.outwards(located.point)
        bend = located.bend * float(problem.own_units.sizes[-1])
        points.append(LargePoint(LargeKind.FOLD, s, u, located.gap, bend))
    return points


# --- crossings ------------------------------------------------------------------------


def crossings_on(
    problem: ScaledProblem, branch: Branch, profile: SingularProfile
) -> list[LargePoint]:
    """The singular points of a curve to which its smallest singular values lead.

    A value that goes to zero does so at the rate w^T F''(v, t): where that leads to
    between the places beside, a singular point is looked for.
    """
    points: list[LargePoint] = []
    for number, triples in enumerate(profile.triples):
        low, high = _beside(profile, number, branch.length)
        for triple in triples:
            zero = _zero_ahead(problem, branch, float(profile.places[number]), triple)
            if not low <= zero <= high:
                continue
            point = _crossing_at(problem, branch, zero, triple)
            if point is not None and _is_new(point, points):
                points.append(point)
    return points


def _beside(
    profile: SingularProfile, number: int, length: float
) -> tuple[float, float]:
    """Arclengths a little beyond the places before and after one of them."""
    ends = np.concatenate([[0.0], profile.places, [length]])
    before, s, after = ends[number : number + 3].tolist()
    low, high = s - BEYOND * (s - before), s + BEYOND * (after - s)
    return max(low, 0.0), min(high, length)


def _zero_ahead(
    problem: ScaledProblem, branch: Branch, s: float, triple: SingularTriple
) -> float:
    """Where a singular value would be zero by its slope along the curve."""
    tangent = unit_tangent(branch, s)
    change = problem.second_derivative(branch(s), tangent, triple.right)
    slope = float(triple.left @ change)
    return s - triple.value / slope if slope else np.inf


def _is_new(point: LargePoint, points: list[LargePoint]) -> bool:
    return all(abs(point.s - other.s) > SAME for other in points)


def _crossing_at(
    problem: ScaledProblem, branch: Branch, s: float, triple: SingularTriple
) -> LargePoint | None:
    """The singular point next to arclength ``s`` of a curve, None where there is none on
    it."""
    tangent = unit_tangent(branch, s)
    located = locate_crossing(problem, branch(s), tangent, triple)
    if located is None or not is_crossing_of_many(located.gap):
        return None
    place = _foot(branch, located.point, s)
    distance = float(np.linalg.norm(branch(place) - located.point))
    if not is_passed(distance, problem.scale):
        return None
    directions = _directions(located, unit_tangent(branch, place))
    kind = LargeKind.CROSSING if len(directions) > 1 else LargeKind.RANK_DROP
    restated = problem.own_units.sizes * directions
    u = problem.own_units.outwards(located.point)
    return LargePoint(kind, place, u, located.gap, directions=restated)


def _foot(branch: Branch, point: np.ndarray, s: float) -> float:
    """The arclength near ``s`` at which a curve is nearest to a point (n,)."""
    for _ in range(FOOT_STEPS):
        s += float((point - branch(s)) @ branch(s, 1))
        s = min(max(s, 0.0), branch.length)
    return s


def _directions(located: LocatedCrossing, tangent: np.ndarray) -> np.ndarray:
    """Unit tangents (k, n) of the curves through a singular point, first that along
    ``tangent`` (n,); it alone where second order shows no other."""
    lines = [located.basis @ line for line in lines_of_form(located.form)]
    if len(lines) < 2:
        return tangent[None]
    lines.sort(key=lambda line: -abs(float(line @ tangent)))
    own = lines[0] * np.sign(lines[0] @ tangent)
    return np.stack([own, lines[1]])


# --- near misses ----------------------------------------------------------------------


def near_misses_on(
    problem: ScaledProblem,
    branch: Branch,
    profile: SingularProfile,
    crossings: list[LargePoint],
) -> list[LargePoint]:
    """The minima of the smallest singular value that are no singular points."""
    smallest = profile.smallest
    points = []
    for k in range(1, len(smallest) - 1):
        is_minimum = smallest[k - 1] > smallest[k] <= smallest[k + 1]
        low, high = float(profile.places[k - 1]), float(profile.places[k + 1])
        is_singular = any(low <= crossing.s <= high for crossing in crossings)
        if not is_minimum or is_singular:
            continue
        s, value = _minimum(problem, branch, low, high)
        if stands_out(value, 0.5 * float(smallest.max())):
            u = problem.own_units.outwards(branch(s))
            points.append(LargePoint(LargeKind.NEAR_MISS, s, u, value))
    return points


def _minimum(
    problem: ScaledProblem, branch: Branch, low: float, high: float
) -> tuple[float, float]:
    """The arclength between two at which the smallest singular value is least, and that
    value."""
    from scipy.optimize import minimize_scalar

    result = minimize_scalar(
        lambda s: triples_at(problem, branch, s, 1)[0].value,
        bounds=(low, high),
        method="bounded",
        options={"xatol": CLOSED_IN * (high - low)},
    )
    return float(result.x), float(result.fun)
