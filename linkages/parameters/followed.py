"""Singular points followed over the members of a family, and compared with members that
are built anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.errors import BifurcError
from bifurc.following.follow import FollowedPoint, FollowError, follow_singular_point
from bifurc.limits import Deadline
from linkages.parameters.members import FreeParameters, PointToFollow

MEMBERS = 50  # that are built anew along a curve


@dataclass(frozen=True)
class MemberComparison:
    """With how many members, built anew, a curve was compared, the largest closure
    ``gap`` (over the characteristic length), the largest ``singular_value`` of those that
    are 0 at the point; and why the constructor refuses others, empty where it does not."""

    members: int
    gap: float
    singular_value: float
    refusal: str


@dataclass(frozen=True, eq=False)
class Followed:
    """What became of the ``point`` of a map: its ``curve`` and the ``comparison``, or the
    ``reason`` why it cannot be followed."""

    point: PointToFollow
    curve: FollowedPoint | None = None
    comparison: MemberComparison | None = None
    reason: str = ""


def follow_points(
    members: FreeParameters,
    points: Sequence[PointToFollow],
    deadline: Deadline | None = None,
) -> list[Followed]:
    """What becomes of ``points`` of the member from which the free parameters move.

    >>> import linkages
    >>> from linkages.catalogue import entry
    >>> family = entry("kite")
    >>> members = linkages.Members(family, family.defaults, {"a": (0.5, 1.8)})
    >>> atlas = linkages.map_linkage(members.load(members.start))
    >>> for followed in linkages.follow_points(members, members.points(atlas)):
    ...     print(followed.point.name, followed.comparison.members, followed.curve.places)
    B1 50 ()
    B2 50 ()
    """
    followed = []
    for point in points:
        try:
            curve = follow_singular_point(
                members.problem, point.u, point.p, point.nullity, deadline=deadline
            )
        except FollowError as error:
            followed.append(Followed(point, reason=str(error)))
            continue
        followed.append(Followed(point, curve, compare(members, curve)))
    return followed


def compare(members: FreeParameters, curve: FollowedPoint) -> MemberComparison:
    """Members along a curve, each built anew and compared with it."""
    count, gap, largest, refusal = 0, 0.0, 0.0, ""
    for s in np.linspace(0.0, curve.branch.length, MEMBERS):
        try:
            residual, jacobian = members.anew(curve.unknowns(s), curve.parameters(s))
        except BifurcError as error:
            refusal = refusal or str(error)
            continue
        rank = jacobian.shape[1] - curve.problem.nullity
        sigma = np.linalg.svd(jacobian, compute_uv=False)
        count += 1
        gap = max(gap, float(np.abs(residual).max()))
        largest = max(largest, float(sigma[rank:].max(initial=0.0)))
    return MemberComparison(count, gap, largest, refusal)
