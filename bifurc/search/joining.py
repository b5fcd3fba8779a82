"""A branch through a point at which it is continuous with its tangent, but not smooth.

At the origin of x^3 = y^4 a single branch passes, whose curvature is infinite there: no
Taylor series reaches it, and the trace from either side stalls before the point or a
little beyond it. There F is so flat that a short polynomial through the point solves
the equations to rounding.
"""

from __future__ import annotations

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.problem import Problem
from bifurc.search.branch_parts import joined_outcome, part_of, with_piece_between
from bifurc.singular.point import SingularPoint

BEYOND = 1.5  # times the farther end: so far from the point both branches are cut
LOOKS = 400  # along a branch for the place of the cut


def joined_through(
    problem: Problem,
    point: SingularPoint,
    one: tuple[Branch, float],
    other: tuple[Branch, float],
) -> Branch | None:
    """The branch that two branches are, which end at a point at the arclengths given
    with them, or the closed curve of one branch that ends there twice; None where what
    lies between them does not solve the equations."""
    is_loop = one[0] is other[0]
    before = one[0] if one[1] > 0.0 else one[0].reversed()
    after = other[0] if other[1] == 0.0 else other[0].reversed()
    ends = np.array([before(before.length), after(0.0)])
    gaps = np.linalg.norm(problem.difference(ends, point.u), axis=1)
    clear = max(BEYOND * float(gaps.max()), 2 * point.error)
    last = _clear_of(problem, point, before.reversed(), clear)
    first = _clear_of(problem, point, after, clear)
    if last is None or first is None:
        return None
    if is_loop:
        before = part_of(before, first, before.length - last)
        return with_piece_between(problem, point.u, before, before, Outcome.CLOSED)
    before = part_of(before, 0.0, before.length - last)
    after = part_of(after, first, after.length)
    outcome = joined_outcome(problem, before, after)
    return with_piece_between(problem, point.u, before, after, outcome)


def _clear_of(
    problem: Problem, point: SingularPoint, branch: Branch, distance: float
) -> float | None:
    """The arclength from the begin of a branch from which on it is farther than a
    ``distance`` from a point; None where it is too short."""
    places = np.linspace(0.0, min(10 * distance, branch.length), LOOKS)
    gaps = problem.difference(branch(places), point.u)
    is_clear = np.linalg.norm(gaps, axis=1) > distance
    return float(places[np.argmax(is_clear)]) if np.any(is_clear) else None
