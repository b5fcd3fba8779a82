"""Joint variables that follow others: gears, racks, motions kept symmetric.

A coupled variable is a ratio times another one plus an offset. That one may be coupled
as well; where the chain ends is the variable that all of them follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from linkages.values import GeometryError, check_number, quoted, require


@dataclass(frozen=True)
class Coupling:
    """A variable that is ``ratio`` times the variable labelled ``to``, plus ``offset``,
    in rad and the user's unit: the ratio of a slide to a turn is a length a radian.

    Raises `GeometryError` for a label that is no text, a ratio of 0 and values that are
    not finite.
    """

    to: str
    ratio: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.to, str):
            raise GeometryError("to of a coupling", quoted(self.to), "a text in quotes")
        for key in ("ratio", "offset"):
            value = getattr(self, key)
            check_number(f"{key} of the coupling to {self.to}", value)
            object.__setattr__(self, key, float(value))
        allowed = "other than 0; a joint that stands still is locked"
        what = f"ratio of the coupling to {self.to}"
        require(self.ratio != 0.0, what, 0, allowed)


class Leader(NamedTuple):
    """What a variable follows: the variable of this ``number`` times ``ratio``, plus
    ``offset``."""

    number: int
    ratio: float = 1.0
    offset: float = 0.0

    def value(self, of_leader: float) -> float:
        """The value of the variable where the leader has this one."""
        return self.ratio * of_leader + self.offset

    def value_of_leader(self, value: float) -> float:
        """The value of the leader where the variable has this one."""
        return (value - self.offset) / self.ratio


def leaders(
    labels: Sequence[str], couplings: Mapping[str, Coupling]
) -> tuple[Leader, ...]:
    """What each of the variables with these ``labels`` follows in the end; itself where
    it is not coupled. ``couplings`` are by label.

    Raises `GeometryError` for a coupling to what is no variable, and for couplings that
    lead back to themselves.
    """
    for label, coupling in couplings.items():
        is_known = coupling.to in labels
        allowed = f"one of the variables {', '.join(labels)}"
        require(is_known, f"coupled of {label}", quoted(coupling.to), allowed)
    numbers = {label: number for number, label in enumerate(labels)}
    return tuple(_leader(label, numbers, couplings) for label in labels)


def _leader(
    label: str, numbers: Mapping[str, int], couplings: Mapping[str, Coupling]
) -> Leader:
    chain = [label]
    ratio, offset = 1.0, 0.0
    while chain[-1] in couplings:
        coupling = couplings[chain[-1]]
        chain.append(coupling.to)
        is_new = coupling.to not in chain[:-1]
        allowed = "a chain of couplings that ends at a variable that is not coupled"
        require(is_new, f"coupled of {label}", " -> ".join(chain), allowed)
        offset += ratio * coupling.offset
        ratio *= coupling.ratio
    return Leader(numbers[chain[-1]], ratio, offset)
