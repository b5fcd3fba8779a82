"""The record of a run of the work-precision study."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Run:
    """One measured run: the median processor time, the error, and how many points or
    pieces it took. ``order`` is 0 for methods other than this project's."""

    case: str
    method: str
    order: int
    tolerance: float
    seconds: float
    error: float
    points: int
    note: str = ""

    @property
    def reached_the_end(self) -> bool:
        """Whether the run gave the whole curve."""
        return math.isfinite(self.error)
