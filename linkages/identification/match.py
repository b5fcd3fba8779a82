"""A member of the catalogue beside the table that it is, or nearly is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkages.entry import Entry, ParameterKind
from linkages.identification.equivalence import Reading
from linkages.identification.fitting import Member


@dataclass(frozen=True)
class Match:
    """A member of an entry that a table is, or nearly is.

    ``parameters`` has lengths in the unit of the table, angles in rad; ``member`` is
    the table (3, n) of that member, read and signed as the given one; ``residuals`` (3,
    n) are given less member, lengths and offsets relative to the characteristic length,
    twists in rad; ``distance`` is their norm. ``freedom`` says how many parameters
    matter at this member, scale included. ``conditions`` pairs the text of each
    condition of the entry with how far the given table is from it, see
    `linkages.entry.Condition`.
    """

    entry: Entry
    parameters: dict[str, float]
    reading: Reading
    member: np.ndarray
    residuals: np.ndarray
    distance: float
    freedom: int
    conditions: tuple[tuple[str, float | None], ...]


def make_match(member: Member, entry: Entry, given: np.ndarray, unit: float) -> Match:
    """The match of a member that was fitted to the table ``given`` (3, n)."""
    units = np.array([[unit], [1.0], [unit]])
    residuals = (given - member.as_given) / units
    residuals[1] = _wrapped(residuals[1])
    # reversing twice is not reversing
    labelled = member.signs.of(member.view.values) / units
    conditions = [(one.text, one.residual(labelled)) for one in entry.conditions]
    parameters = {}
    for parameter in entry.parameters:
        value = member.parameters[parameter.name]
        if parameter.kind is ParameterKind.ANGLE:
            value = float(_wrapped(np.array(value)))
        parameters[parameter.name] = value
    exact = given - residuals * units
    is_turned = (np.abs(exact[1]) > np.pi) & (np.abs(given[1]) <= np.pi)
    exact[1, is_turned] = _wrapped(exact[1, is_turned])
    return Match(
        entry,
        parameters,
        member.view.reading,
        exact,
        residuals,
        member.distance,
        member.freedom,
        tuple(conditions),
    )


def _wrapped(angles: np.ndarray) -> np.ndarray:
    return np.asarray(np.mod(angles + np.pi, 2 * np.pi) - np.pi)
