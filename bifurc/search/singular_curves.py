"""Curves of singular points on surfaces along which F' has a lower rank.

All along such a curve F' has one rank, lower than on the surface about it. That F = 0
and that F' has no higher rank are equations of which the curve is a regular solution
(`bifurc.curves.deflation`): it is traced like a form.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import RankDeflated
from bifurc.decisions import is_same_point
from bifurc.limits import Deadline
from bifurc.problem import Problem
from bifurc.settings import TraceSettings
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.point import SingularPoint
from bifurc.text_tables import count_of

WHOLE = (Outcome.CLOSED, Outcome.LEFT_REGION)


class SingularCurve(NamedTuple):
    """A ``branch`` all along which F' has a ``rank``."""

    branch: Branch
    rank: int

    def holds(self, problem: Problem, point: SingularPoint) -> bool:
        """Whether a singular point is one of the curve."""
        if point.rank != self.rank:
            return False
        places, are_solved = RankDeflated(problem, self.rank).next_to(point.u[None])
        distance, _ = self.branch.nearest(places)
        return bool(are_solved[0] and is_same_point(distance[0], problem.scale))


def singular_curve_through(
    problem: Problem, point: SingularPoint, tracing: TraceSettings, deadline: Deadline
) -> SingularCurve | None:
    """The curve of singular points of one rank on which a singular point lies; None
    where it lies on none that is regular and can be followed to its end."""
    if problem.is_large or deadline.passed:
        return None
    deflated = RankDeflated(problem, point.rank)
    places, are_solved = deflated.next_to(point.u[None])
    if not are_solved[0]:
        return None
    local = local_dimensions(deflated, places, deadline)
    if local.dimension[0] != 1 or local.nullity[0] != 1 or not local.regular[0]:
        return None
    branch = trace_branch(deflated, places[0], settings=tracing, deadline=deadline)
    if branch.outcome not in WHOLE:
        return None
    return SingularCurve(branch, point.rank)


def describe_curves(curves: Sequence[SingularCurve]) -> str:
    """How many of them there are of every rank, empty where there is none."""
    kinds = Counter((curve.rank, curve.branch.closed) for curve in curves)
    parts = []
    for (rank, closed), count in sorted(kinds.items()):
        noun = "closed curve" if closed else "open curve"
        parts.append(f"singular points of rank {rank} form {count_of(count, noun)}")
    return "; ".join(parts)
