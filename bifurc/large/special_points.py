"""The special points on a curve of a large problem: folds, crossings, near misses."""

from __future__ import annotations

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import (
    is_crossing_of_many,
    is_multiple_of_many,
    is_passed,
    stands_out,
)
from bifurc.large.crossing_tangents import null_vectors_across, tangents_at
from bifurc.large.large_branch import LargePoint, last_unknown
from bifurc.large.locators import LocatedCrossing, locate_crossing, locate_fold
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.singular_triples import (
    SingularProfile,
    SingularTriple,
    triples_at,
    unit_tangent,
    vanishing_group,
    zero_ahead,
)
from bifurc.singular.point import Kind

BEYOND = 1.5  # distances to the next place within which a zero is looked for
FOOT_STEPS = 5  # of Newton's method to the foot of a point
SAME = 1e-4  # arclength: crossings of one curve no farther apart may be one
HALF = 0.7  # cosine between the two cases, null vectors that agree or are square
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
        points.append(LargePoint(Kind.FOLD, s, u, located.gap, bend))
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
            s = float(profile.places[number])
            zero = zero_ahead(problem, branch, s, triple)
            if not low <= zero <= high:
                continue
            right = problem.own_units.sizes * triple.right
            if not _is_new(zero, right[None], points):
                continue
            point = _crossing_at(problem, branch, zero, high - low, triple)
            if point is not None and _is_new(point.s, point.null_vectors, points):
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


def _is_new(s: float, vectors: np.ndarray, points: list[LargePoint]) -> bool:
    """Whether a singular point at arclength ``s`` with null ``vectors`` (q, n) is none
    of those that are known: next to it on the branch, with a null space that holds
    these."""
    near = [other for other in points if abs(s - other.s) <= SAME]
    return not any(_is_part_of(vectors, one.null_vectors) for one in near)


def _is_part_of(vectors: np.ndarray, others: np.ndarray) -> bool:
    """Whether vectors (q, n) lie in the span of ``others`` (p, n), and not across it."""
    basis = np.linalg.qr(others.T)[0]
    shares = np.linalg.norm(vectors @ basis, axis=1) / np.linalg.norm(vectors, axis=1)
    return bool(np.all(shares > HALF))


def _crossing_at(
    problem: ScaledProblem,
    branch: Branch,
    s: float,
    width: float,
    triple: SingularTriple,
) -> LargePoint | None:
    """The singular point next to arclength ``s`` of a curve, where the value of a
    ``triple`` would be zero, None where there is none on it; places are about ``width``
    apart."""
    group = vanishing_group(problem, branch, s, width)
    tries = [group, [triple]] if len(group) > 1 else [[triple]]
    for triples in tries:
        located = locate_crossing(problem, branch(s), unit_tangent(branch, s), triples)
        if located is None or not is_crossing_of_many(located.gap):
            continue
        if len(triples) > 1 and not is_multiple_of_many(located.regular):
            continue
        place = _foot(branch, located.point, s)
        distance = float(np.linalg.norm(branch(place) - located.point))
        if is_passed(distance, problem.domain.scale):
            return _large_point(problem, branch, place, located)
    return None


def _foot(branch: Branch, point: np.ndarray, s: float) -> float:
    """The arclength near ``s`` at which a curve is nearest to a point (n,)."""
    for _ in range(FOOT_STEPS):
        s += float((point - branch(s)) @ branch(s, 1))
        s = min(max(s, 0.0), branch.length)
    return s


def _large_point(
    problem: ScaledProblem, branch: Branch, s: float, located: LocatedCrossing
) -> LargePoint:
    """A located singular point at arclength ``s`` of a curve, with what is known of the
    other curves through it."""
    tangent = unit_tangent(branch, s)
    tangents = tangents_at(problem, located, tangent)
    kind = Kind.CROSSING
    if len(tangents.directions) < 2:
        is_simple = located.multiplicity == 1
        kind = Kind.RANK_DROP if is_simple else Kind.MULTIPLE
    sizes = problem.own_units.sizes
    return LargePoint(
        kind,
        s,
        problem.own_units.outwards(located.point),
        located.gap,
        directions=sizes * tangents.directions,
        null_vectors=sizes * null_vectors_across(located, tangent),
        order=tangents.order,
    )


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
            points.append(LargePoint(Kind.NEAR_MISS, s, u, value))
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
