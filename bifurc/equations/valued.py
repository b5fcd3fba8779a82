"""Recorded numbers that have a value as well, that at one point.

Code that checks or compares its numbers while it computes with them, as the constructor
of a linkage does, can be recorded so: it takes the way that it takes at that point, and
the tape holds along with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bifurc.equations.recorded import RecordedNumber, Recorder


class ValuedRecorder(Recorder):
    """A tape that is being written, with the values of its unknowns at a ``point``
    (n,)."""

    def __init__(self, point: Sequence[float]):
        super().__init__(len(point))
        self.point = np.array(point, dtype=float)
        self._values: dict[int, float] = {}

    def number(self, slot: int) -> ValuedNumber:
        """What a slot holds, as a number to compute with."""
        return ValuedNumber(self, slot)

    def value_at_point(self, slot: int) -> float:
        """What a slot holds at the point."""
        if slot not in self._values:
            single = self.tape([slot])
            self._values[slot] = float(
                single.compiled.residuals(self.point[None])[0, 0]
            )
        return self._values[slot]


class ValuedNumber(RecordedNumber):
    """A number on a tape that is being written, and its value at the point of the
    tape."""

    __slots__ = ()
    writer: ValuedRecorder

    def __float__(self) -> float:
        return float(self.writer.value_at_point(self.slot))

    def __bool__(self) -> bool:
        return float(self) != 0.0

    def __abs__(self) -> ValuedNumber:
        return -self if float(self) < 0.0 else self  # type: ignore[return-value]

    def __lt__(self, other: Any) -> bool:
        return float(self) < float(other)

    def __le__(self, other: Any) -> bool:
        return float(self) <= float(other)

    def __gt__(self, other: Any) -> bool:
        return float(self) > float(other)

    def __ge__(self, other: Any) -> bool:
        return float(self) >= float(other)

    def __eq__(self, other: object) -> bool:
        return float(self) == other

    def __ne__(self, other: object) -> bool:
        return float(self) != other

    __hash__ = None  # type: ignore[assignment]
