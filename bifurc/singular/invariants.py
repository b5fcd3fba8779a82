"""Numbers that say of which type a singular point of a plane curve is."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Invariants:
    """What stays as it is where the coordinates change.

    ``multiplicity``: in how many points a line nearby meets the curve, at most, complex
    ones counted; ``branches`` through the point, complex ones counted; ``delta``: how
    many crossings the curve has nearby once it is deformed in general; ``contacts``: the
    orders of contact (intersection numbers) of any two real branches, in order, 1 where
    they cross.
    """

    multiplicity: int
    branches: int
    delta: int
    contacts: tuple[int, ...]

    @property
    def milnor_number(self) -> int:
        """mu = 2 delta - branches + 1 (Milnor 1968, theorem 10.5)."""
        return 2 * self.delta - self.branches + 1


CROSSING = Invariants(multiplicity=2, branches=2, delta=1, contacts=(1,))
LONE_POINT = Invariants(multiplicity=2, branches=2, delta=1, contacts=())
