"""Following: from a singular point of one member to the curve of that point over all
members."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.continuation import DEFAULT_SETTINGS, trace_branch
from bifurc.decisions import is_null, is_start_solved
from bifurc.errors import BifurcError
from bifurc.following.places import FollowedPlace, places_on
from bifurc.following.singular_problem import SingularPointProblem
from bifurc.limits import Deadline
from bifurc.numerics.null_spaces import null_spaces
from bifurc.parametrised import ParametrisedProblem
from bifurc.settings import TraceSettings

NEARBY = 1e-3  # of the scale: as near as a point is known from which it is followed


class FollowError(BifurcError):
    """A singular point that cannot be followed over its parameters, and why."""


@dataclass(frozen=True, eq=False)
class FollowedPoint:
    """A singular point over its parameters: the ``branch`` in u (n,), p (q,) and a basis
    of the null space, and the ``places`` on it at which something happens, in order."""

    problem: SingularPointProblem
    branch: Branch
    places: tuple[FollowedPlace, ...]

    def unknowns(self, s: np.ndarray | float) -> np.ndarray:
        """u (..., n) at arclengths s (...)."""
        return self.problem.place(self.branch(s))[0]

    def parameters(self, s: np.ndarray | float) -> np.ndarray:
        """p (..., q) at arclengths s (...)."""
        return self.problem.place(self.branch(s))[1]


def follow_singular_point(
    parametrised: ParametrisedProblem,
    u: np.ndarray,
    p: np.ndarray,
    nullity: int,
    settings: TraceSettings = DEFAULT_SETTINGS,
    deadline: Deadline | None = None,
) -> FollowedPoint:
    """The curve on which F_u keeps a null space of dimension ``nullity`` while the
    parameters move from ``p`` (q,), where it has one at ``u`` (n,); as far as both stay
    within their bounds.

    A crossing of two curves has nullity 2; a fold along a parameter, which is then one of
    p, has nullity 1. Raises `FollowError` where there is no such point, where it is there
    for these values of the parameters alone, and where it has freedoms to spare.

    >>> import bifurc, numpy as np
    >>> cubic = bifurc.ParametrisedProblem.recorded(
    ...     lambda u, p: [u[0] ** 3 + p[0] * u[0] + p[1]], [(-3, 3)], [(-3, 3)] * 2
    ... )
    >>> folds = bifurc.follow_singular_point(cubic, [0.5], [-0.75, 0.25], nullity=1)
    >>> [place.kind.value for place in folds.places]
    ['cusp']
    """
    problem = SingularPointProblem(parametrised, u, p, nullity)
    starts, gaps = problem.project(problem.start[None])
    moved = np.abs(problem.domain.difference(starts[0], problem.start)).max()
    if not (is_start_solved(float(gaps[0])) and moved < NEARBY * problem.domain.scale):
        raise FollowError(
            f"no point with a null space of dimension {nullity} is there: its equations "
            f"miss by {float(np.abs(problem.residuals(problem.start[None])).max()):.1e}"
        )
    _require_one_freedom(problem, starts)
    branch = trace_branch(problem, starts[0], settings=settings, deadline=deadline)
    return FollowedPoint(problem, branch, places_on(problem, branch))


def _require_one_freedom(problem: SingularPointProblem, starts: np.ndarray) -> None:
    """Raise `FollowError` unless the equations leave one curve through a start
    (1, n)."""
    sigma, _ = null_spaces(problem, starts)
    freedoms = int(np.count_nonzero(is_null(sigma[0])))
    names = ", ".join(problem.parametrised.parameters.names)
    if freedoms == 0:
        raise FollowError(
            f"the point is there for these values of {names} alone; free one more "
            "parameter to follow it"
        )
    if freedoms > 1:
        raise FollowError(
            f"the point has {freedoms} freedoms while {names} move, and following takes "
            "one: fewer parameters are enough, or its tangents touch"
        )
