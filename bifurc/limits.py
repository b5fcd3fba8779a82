"""A limit on time that is handed down through a search."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

__all__ = ["Deadline"]


@dataclass(frozen=True)
class Deadline:
    """The moment at which work has to stop: ``seconds`` after it was made, never where
    these are infinite."""

    seconds: float = float("inf")
    began: float = field(default_factory=time.perf_counter)

    @property
    def left(self) -> float:
        """Seconds that are left, 0 once it has passed."""
        return max(0.0, self.began + self.seconds - time.perf_counter())

    @property
    def passed(self) -> bool:
        """Whether the time is over."""
        return self.left == 0.0
