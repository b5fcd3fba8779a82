"""What meets at a singular point: branches that pass it, branches that end there, and
surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bifurc.atlas import MeetingPoint, Surface
from bifurc.branch import Branch, Outcome
from bifurc.decisions import is_same_line, is_same_point, may_pass_beside
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.canonical_order import order_points
from bifurc.search.components import surfaces_through
from bifurc.singular.point import Kind, SingularPoint

ALONG = 0.95  # smallest cosine between a branch and the half-branch along which it runs
NEAR_END = 0.05  # length, over the scale, of a stalled end: it counts, not a pass there
# A stalled end is looked for up to a few radii of the section, or errors, from a cusp,
# and the direction in which it came is taken where it is clear of both.
FARTHEST_RADII, FARTHEST_ERRORS = 5, 4
CLEAR = 1.5  # distance over that of the end
LONGEST_APPROACH = 4  # over the distance at which it is clear
LOOKS = 33  # along that stretch


def meeting_points(
    problem: Problem,
    points: Sequence[SingularPoint],
    branches: Sequence[Branch],
    surfaces: tuple[Surface, ...],
    periods: np.ndarray,
) -> tuple[MeetingPoint, ...]:
    """The singular points with what meets there, kind by kind, numbered from 1.

    ``periods`` (n,) are those of the unknowns that were wrapped.
    """
    near = _branches_near(problem, points, branches)
    meeting = [
        _meeting_point(problem, point, branches, here, surfaces)
        for point, here in zip(points, near, strict=True)
    ]
    return in_order(problem, meeting, periods)


def _branches_near(
    problem: Problem, points: Sequence[SingularPoint], branches: Sequence[Branch]
) -> list[list[int]]:
    """The branches, by their numbers, that may pass each of the points or end there."""
    near: list[list[int]] = [[] for _ in points]
    if not points:
        return near
    places = np.array([point.u for point in points])
    within = 2 * np.array([_within(problem, point) for point in points])
    for index, branch in enumerate(branches):
        distances, _ = branch.nearest(places, float(within.max()))
        is_near = distances < within
        if branch.outcome is Outcome.STALLED:
            is_near[:] = True
        for k in np.flatnonzero(is_near).tolist():
            near[k].append(index)
    return near


def _within(problem: Problem, point: SingularPoint) -> float:
    """How near to a point a branch comes that passes it."""
    return is_same_point.threshold * problem.domain.scale + 2 * point.error


def in_order(
    problem: Problem, meeting: Sequence[MeetingPoint], periods: np.ndarray
) -> tuple[MeetingPoint, ...]:
    """The points kind by kind, numbered from 1. ``periods`` (n,) are those of the
    unknowns that were wrapped."""
    kinds = {point.kind for point in meeting}
    ordered: list[MeetingPoint] = []
    for kind in sorted(kinds, key=lambda kind: kind.value):
        of_kind = [point for point in meeting if point.kind is kind]
        places = np.array([point.point.u for point in of_kind])
        error = max(point.point.error for point in of_kind)
        order = order_points(places, periods, problem.domain.scale, error)
        ordered += [of_kind[k] for k in order]
    named = []
    for number, point in enumerate(ordered, start=1):
        named.append(replace(point, name=f"{point.kind.initial}{number}"))
    return tuple(named)


def _meeting_point(
    problem: Problem,
    point: SingularPoint,
    branches: Sequence[Branch],
    near: Sequence[int],
    surfaces: tuple[Surface, ...],
) -> MeetingPoint:
    """A singular point with the branches, of those ``near``, that pass it or end there,
    and the surfaces on which it lies; where the branches and the section disagree, a
    note."""
    point = _within_bounds(problem, point)
    through: list[tuple[int, float]] = []
    ending: list[tuple[int, float]] = []
    for index in near:
        ends = ends_at(problem, branches[index], point)
        passes = _passes_at(problem, branches[index], point, ends)
        ending += [(index, s) for s in ends]
        through += [(index, s) for s in passes]
    at_bounds = [_ends_at_bounds(branches[k], s, point) for k, s in through]
    traced = 2 * len(through) + len(ending) - sum(at_bounds)
    kind, note = _kind_of(point, traced, any(at_bounds))
    met: tuple[int, ...] = ()
    if point.dimension > 1:
        met = surfaces_through(problem, surfaces, point.u)
    return MeetingPoint(
        name="",
        kind=kind,
        point=point,
        passes=(*through, *ending),
        tangents=_tangents(branches, [*through, *ending], point),
        note=note,
        surfaces=met,
    )


def _kind_of(point: SingularPoint, traced: int, is_at_bounds: bool) -> tuple[Kind, str]:
    """What a point is of which so many half-branches were ``traced``, and a note where
    it shows others; branches may end there as they leave the bounds."""
    seen = len(point.half_branches)
    if traced != seen:
        kind = Kind.BIFURCATION if traced > 2 else Kind.UNDECIDED
        if point.dimension > 1:
            kind = Kind.DIMENSION_CHANGE
        return kind, f"{traced} half-branches were traced, the section shows {seen}"
    if is_at_bounds and point.dimension == 1:
        return (Kind.BIFURCATION if seen > 1 else Kind.RANK_DROP), ""
    return point.kind, ""


def _within_bounds(problem: Problem, point: SingularPoint) -> SingularPoint:
    """The point with those of its half-branches only that do not leave the bounds there,
    where it lies in them."""
    domain = problem.domain
    if not len(point.half_branches):
        return point
    reach = domain.slack + point.error
    low, high = domain.bounds.T
    is_low, is_high = point.u - low <= reach, high - point.u <= reach
    steps = point.radius * point.half_branches
    leaves = (is_low & (steps < -reach)) | (is_high & (steps > reach))
    inside = point.half_branches[~leaves.any(axis=1)]
    return replace(point, half_branches=inside) if np.any(leaves) else point


def _ends_at_bounds(branch: Branch, s: float, point: SingularPoint) -> bool:
    """Whether a branch that leaves the bounds ends where it is at a point, at ``s``."""
    to_end = min(s, branch.length - s)
    return branch.outcome is Outcome.LEFT_REGION and to_end < point.radius


def _tangents(
    branches: Sequence[Branch],
    passes: Sequence[tuple[int, float]],
    point: SingularPoint,
) -> np.ndarray:
    """Unit tangents (p, n) of the branches at the passes of a point.

    The derivative of a piece is known to rounding over the length of the piece, which
    is short beside a singular point: a tangent of second order, known to the error of
    the point, is taken where the branch runs along one.
    """
    tangents = np.empty((len(passes), len(point.u)))
    for row, (index, s) in enumerate(passes):
        tangents[row] = along = branches[index](s, 1)
        if not len(point.tangents):
            continue
        cosines = point.tangents @ along / np.linalg.norm(along)
        nearest = int(np.argmax(np.abs(cosines)))
        if is_same_line(1.0 - float(np.abs(cosines[nearest]))):
            tangents[row] = np.sign(cosines[nearest]) * point.tangents[nearest]
    return tangents


def ends_at(problem: Problem, branch: Branch, point: SingularPoint) -> list[float]:
    """Arclengths of the ends of a branch that stalled at a cusp, along a half-branch.

    Where it stalled hangs on rounding: before a sharp cusp, about where the section
    tells the half-branches apart, or beyond it, where nothing but rounding looks like
    solutions. Up to a few times the radius of the section an end belongs to the point
    if the branch came along a half-branch, and does not go on along another.
    """
    if branch.outcome is not Outcome.STALLED or not len(point.half_branches):
        return []
    ends = []
    if _stalled_at(problem, branch, point, 0.0, 1.0):
        ends.append(0.0)
    if _stalled_at(problem, branch, point, branch.length, -1.0):
        ends.append(branch.length)
    return ends


def _stalled_at(
    problem: Problem,
    branch: Branch,
    point: SingularPoint,
    end: float,
    inwards: float,
) -> bool:
    """Whether a branch stalled at a cusp with its end at the arclength ``end``, from
    which the sign ``inwards`` leads into the branch."""
    last = problem.domain.difference(branch(end), point.u)
    gap = float(np.linalg.norm(last))
    if gap > max(FARTHEST_RADII * point.radius, FARTHEST_ERRORS * point.error):
        return False
    clear = max(CLEAR * gap, point.radius)
    longest = min(LONGEST_APPROACH * clear, branch.length)
    approach = end + inwards * np.linspace(0.0, longest, LOOKS)
    offsets = problem.domain.difference(branch(approach), point.u)
    is_clear = np.linalg.norm(offsets, axis=1) >= clear
    if not np.any(is_clear):
        return False
    origin = offsets[np.argmax(is_clear)]
    is_beyond = last @ origin < 0 and gap > 2 * point.error
    goes_on = is_beyond and _is_along(point, last)
    return _is_along(point, origin) and not goes_on


def _is_along(point: SingularPoint, offset: np.ndarray) -> bool:
    """Whether an ``offset`` (n,) from a point has the direction of a half-branch."""
    along = float((point.half_branches @ offset).max())
    return along > ALONG * float(np.linalg.norm(offset))


def _distinct(passes: Sequence[float], within: float) -> list[float]:
    """The arclengths, those nearer to the one before than ``within`` left out: a curve
    does not come back to a point over so short a way."""
    distinct: list[float] = []
    for s in passes:
        if not distinct or s - distinct[-1] > within:
            distinct.append(s)
    return distinct


def _passes_at(
    problem: Problem, branch: Branch, point: SingularPoint, ends: Sequence[float]
) -> list[float]:
    """Arclengths at which a branch passes a point, but for the ``ends`` that lie
    there."""
    within = _within(problem, point)
    near = [float(s) for s in branch.passes(point.u, within)]
    passes = _distinct(
        [s for s in near if _may_pass(problem, branch(s), point)], 2 * within
    )
    if branch.outcome is not Outcome.STALLED:
        return passes
    for end in (0.0, branch.length):
        length = max(NEAR_END * problem.domain.scale, 2 * within)
        if end in ends:
            offset = problem.domain.difference(branch(end), point.u)
            gap = float(np.linalg.norm(offset))
            length = max(length, 2 * (gap + within))
        passes = [s for s in passes if abs(s - end) > length]
    return passes


def _may_pass(problem: Problem, place: np.ndarray, point: SingularPoint) -> bool:
    """Whether a branch that comes nearest to a point at a ``place`` (n,) may pass it: it
    does so there, or rounding hides that it does not.

    A point is known to a large error only where F' is singular to within rounding all
    about it; a branch along which F' is regular is another one.
    """
    distance = float(np.linalg.norm(problem.domain.difference(place, point.u)))
    if is_same_point(distance, problem.domain.scale):
        return True
    values = singular_values(problem, place[None])[0]
    return bool(may_pass_beside(float(values[problem.n - 2])))
