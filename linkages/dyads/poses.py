"""Displacements in a plane, as complex numbers."""

from __future__ import annotations

from typing import NamedTuple


class PlanePose(NamedTuple):
    """A displacement that takes z to ``turn`` z + ``shift``; ``turn`` is a unit
    number."""

    turn: complex
    shift: complex

    def __call__(self, place: complex) -> complex:
        """Where a place is taken."""
        return self.turn * place + self.shift

    def after(self, other: PlanePose) -> PlanePose:
        """The displacement that does the ``other`` one first."""
        return PlanePose(self.turn * other.turn, self(other.shift))

    def inverse(self) -> PlanePose:
        """The displacement back."""
        return PlanePose(1 / self.turn, -self.shift / self.turn)


AT_REST = PlanePose(1 + 0j, 0j)
