"""Which linkages of the catalogue a Denavit-Hartenberg table is a case of.

The geometry of an entry follows from its free parameters by its constructor. So for
every entry and every way to read the table, the parameters are read off
(`linkages.identification.recovery`), the member is built and compared, and the best is
fitted by Gauss-Newton with the reversals of axes and links held. The table is a case of
the entry when the member so found is the same table up to
`linkages.identification.equivalence`, within a tolerance.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from linkages.catalogue import catalogue
from linkages.construction.constructions import lock
from linkages.construction.spatial_triangle import Kink
from linkages.entry import Entry
from linkages.identification.condition_residuals import condition_residual
from linkages.identification.equivalence import Reading, table
from linkages.identification.fitting import Member, best_member, joints_of, views_of
from linkages.loop import MIN_JOINTS, GeometryError, Loop

__all__ = ["Identification", "LockedJoint", "Match", "identify"]

TOLERANCE = 1e-8
# of fits that miss by amounts within this factor, the most special one counts as the
# nearest
ALIKE = 3.0


@dataclass(frozen=True)
class Match:
    """A member of an entry that a table is, or nearly is.

    ``parameters`` has lengths in the unit of the table, angles in rad; ``member`` is
    the table (3, n) of that member, read and signed as the given one; ``residuals`` (3,
    n) are given less member, lengths and offsets relative to the characteristic length,
    twists in rad; ``distance`` is their norm. ``freedom`` says how many parameters
    matter at this member, scale included; it is 0 for a guess too far off to be fitted.
    ``conditions`` pairs each condition of the entry with how far the given table is
    from it, see `linkages.identification.condition_residuals`.
    """

    entry: Entry
    parameters: dict[str, float]
    reading: Reading
    member: np.ndarray
    residuals: np.ndarray
    distance: float
    freedom: int
    conditions: tuple[tuple[str, float | None], ...]


@dataclass(frozen=True)
class LockedJoint:
    """A joint (from 1) that, locked at ``angle`` (0 or pi, rad), leaves a known linkage
    of one joint fewer."""

    joint: int
    angle: float
    matches: tuple[Match, ...]


@dataclass(frozen=True)
class Identification:
    """What a loop is: ``matches``, the most special first, ``nearest`` others by
    distance, and ``locked`` joints."""

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

    ``tolerance`` bounds `Match.distance`; ``entries`` restricts the search; ``locking``
    also locks each joint in turn.
    """
    given, unit = table(loop), loop.characteristic_length
    views, found = views_of(given), []
    for entry in catalogue().values() if entries is None else entries:
        member = best_member(entry, views, unit) if joints_of(entry) == loop.n else None
        if member is not None:
            found.append(_match(member, entry, given, unit))
    matches = sorted(
        (m for m in found if m.distance <= tolerance),
        key=lambda m: (m.freedom, len(m.parameters)),
    )
    others = _nearest_first([m for m in found if m.distance > tolerance])
    locked = _locked(loop, tolerance) if locking else ()
    return Identification(loop, tolerance, tuple(matches), others, locked)


def _match(member: Member, entry: Entry, given: np.ndarray, unit: float) -> Match:
    residuals = given - member.as_given
    residuals[[0, 2]] /= unit
    residuals[1] = np.mod(residuals[1] + np.pi, 2 * np.pi) - np.pi
    kinds = {p.name: p.kind for p in entry.parameters}
    parameters = {
        name: float(np.mod(value + np.pi, 2 * np.pi) - np.pi)
        if kinds[name] == "angle"
        else value
        for name, value in member.parameters.items()
    }
    expected = given - residuals * [[unit], [1.0], [unit]]
    labelled = member.signs.of(member.view.values) / [
        [unit],
        [1.0],
        [unit],
    ]  # reversing twice is not reversing
    conditions = tuple(
        (text, condition_residual(text, labelled)) for text in entry.conditions
    )
    return Match(
        entry,
        parameters,
        member.view.reading,
        expected,
        residuals,
        member.distance,
        member.freedom,
        conditions,
    )


def _nearest_first(matches: Sequence[Match]) -> tuple[Match, ...]:
    """By distance; those that miss by amounts alike come in the order of their freedom,
    the most special first.

    A distance is divided by the root of the number of conditions, so that a family with
    more parameters does not win by them.
    """
    left = sorted(matches, key=_spread)
    out: list[Match] = []
    while left:
        alike = [m for m in left if _spread(m) <= ALIKE * _spread(left[0])]
        out += sorted(alike, key=lambda m: (m.freedom or 99, len(m.parameters)))
        left = left[len(alike) :]
    return tuple(out)


def _spread(match: Match) -> float:
    """The distance per condition, of which there are as many as numbers in the table
    less the freedom."""
    return match.distance / max(match.residuals.size - match.freedom, 1) ** 0.5


@cache
def _for_locking() -> tuple[Entry, ...]:
    """The catalogue without the linkages of tori, which are Bennett and generalized
    Goldberg linkages."""
    return tuple(
        entry for entry in catalogue().values() if not entry.name.startswith("torus")
    )


def _locked(loop: Loop, tolerance: float) -> tuple[LockedJoint, ...]:
    """Every joint without offset that, straight or folded, leaves a known linkage."""
    out = []
    if loop.n > MIN_JOINTS:
        for joint, kink in itertools.product(range(1, loop.n + 1), Kink):
            if abs(loop.offsets[joint - 1]) > tolerance * loop.characteristic_length:
                continue
            try:
                smaller = lock(loop, joint, kink)
            except GeometryError:
                continue
            matches = identify(
                smaller, tolerance, _for_locking(), locking=False
            ).matches
            if matches:
                out.append(
                    LockedJoint(joint, np.pi if kink is Kink.FOLDED else 0.0, matches)
                )
    return tuple(out)
