"""Which linkages of the catalogue a Denavit-Hartenberg table is a case of.

The geometry of an entry follows from its free parameters by its constructor. So for
every entry and every way to read the table, the parameters are read off
(`linkages.identification.recovery`, and the guesses of the entry), the member is built
and compared, and the best is fitted by Gauss-Newton with the reversals of axes and
links held. The table is a case of the entry when the member so found is the same table
up to `linkages.identification.equivalence`, within a tolerance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bifurc.errors import BifurcError
from linkages.catalogue import catalogue, distinct_entries
from linkages.construction.constructions import lock
from linkages.construction.spatial_triangle import Kink
from linkages.entry import Entry
from linkages.identification.equivalence import table
from linkages.identification.fitting import (
    NEAR,
    best_member,
    joints_of,
    views_of,
)
from linkages.identification.match import Match, make_match
from linkages.loop import MIN_JOINTS, Loop
from linkages.values import GeometryError

TOLERANCE = 1e-8
# of fits that miss by amounts within this factor, the most special one counts as the
# nearest
ALIKE = 3.0


class ToleranceError(BifurcError, ValueError):
    """A tolerance that is no distance: ``value`` is what was given."""

    def __init__(self, value: float):
        self.value = value
        super().__init__(
            f"tolerance: {value} is not allowed; it must be a finite number, 0 or "
            "greater"
        )


@dataclass(frozen=True)
class LockedJoint:
    """A joint (from 1) that, locked at ``angle`` (0 or pi, rad), leaves a known linkage
    of one joint fewer."""

    joint: int
    angle: float
    matches: tuple[Match, ...]


@dataclass(frozen=True)
class Identification:
    """What a loop is: ``matches``, the most special first, the ``nearest`` others by
    distance, and ``locked`` joints. ``tolerance`` is what they were judged by: what was
    asked for, or what the rounding of lengths comes to where that is more.

    The nearest are those that miss by less than `NEAR`, a twentieth of the
    characteristic length and of a radian all numbers of the table together; a linkage
    that is further off is not a neighbour.
    """

    loop: Loop
    tolerance: float
    matches: tuple[Match, ...]
    nearest: tuple[Match, ...]
    locked: tuple[LockedJoint, ...] = field(default=())

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the entries that the loop is a case of."""
        return tuple(match.entry.name for match in self.matches)


def identify(
    loop: Loop,
    tolerance: float = TOLERANCE,
    entries: Iterable[Entry] | None = None,
    locking: bool = True,
) -> Identification:
    """The linkages of the catalogue that ``loop`` is a case of, up to relabelling,
    reversals, mirror image and scale.

    ``tolerance`` bounds `Match.distance`, where lengths are known to less what that may
    change of it; ``entries`` restricts the search; ``locking`` also locks each joint in
    turn. Raises `ToleranceError` for a tolerance that is negative or not finite.
    """
    if not (math.isfinite(tolerance) and tolerance >= 0):
        raise ToleranceError(tolerance)
    given = table(loop)
    unit = loop.characteristic_length
    # how far the loop is from itself with every length and offset off by as much as
    # it may be
    count = len(loop.lengths) + len(loop.offsets)
    tolerance = max(tolerance, math.sqrt(count) * loop.rounding / unit)
    views = views_of(given)
    candidates = []
    for entry in catalogue().values() if entries is None else entries:
        if joints_of(entry) == loop.n:
            member = best_member(entry, views, unit)
            if member is not None:
                candidates.append(make_match(member, entry, given, unit))
    matches = [match for match in candidates if match.distance <= tolerance]
    matches.sort(key=lambda match: (match.freedom, len(match.parameters)))
    others = [match for match in candidates if tolerance < match.distance < NEAR]
    locked = _locked_joints(loop, tolerance) if locking else ()
    nearest = _nearest_first(others)
    return Identification(loop, tolerance, tuple(matches), nearest, locked)


def _nearest_first(matches: Sequence[Match]) -> tuple[Match, ...]:
    """By distance; those that miss by amounts alike come in the order of their freedom,
    the most special first, and else as they are given.

    A distance is divided by the root of the number of conditions, so that a family with
    more parameters does not win by them.
    """
    left = list(matches)
    out: list[Match] = []
    while left:
        limit = ALIKE * min(map(_spread, left))
        group = [match for match in left if _spread(match) <= limit]
        out += sorted(group, key=lambda m: (m.freedom or 99, len(m.parameters)))
        left = [match for match in left if _spread(match) > limit]
    return tuple(out)


def _spread(match: Match) -> float:
    """The distance per condition, of which there are as many as numbers in the table
    less the freedom."""
    count = max(match.residuals.size - match.freedom, 1)
    return float(match.distance / count**0.5)


def _locked_joints(loop: Loop, tolerance: float) -> tuple[LockedJoint, ...]:
    """Every joint without offset that, straight or folded, leaves a known linkage."""
    if loop.n <= MIN_JOINTS:
        return ()
    out = []
    largest = tolerance * loop.characteristic_length
    for joint, kink in itertools.product(range(1, loop.n + 1), Kink):
        if abs(loop.offsets[joint - 1]) > largest:
            continue
        try:
            smaller = lock(loop, joint, kink)
        except GeometryError:
            continue
        matches = identify(
            smaller, tolerance, distinct_entries(), locking=False
        ).matches
        if matches:
            angle = np.pi if kink is Kink.FOLDED else 0.0
            out.append(LockedJoint(joint, angle, matches))
    return tuple(out)
