"""What is otherwise in a mechanism than its structure says: where joints are on bodies,
locks and couplings. Numbers are of any kind: of errors, or parameters on a tape."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

from linkages.closure.motors import Number
from linkages.mechanisms.joint import Motion
from linkages.structure.cycles import Step

# elementary motions, the last one to act first, and their values in rad and the
# structure's unit
Elements: TypeAlias = Sequence[tuple[Motion, Number]]

NOWHERE = (0.0, 0.0, 0.0)


class Changes:
    """Nothing is otherwise; who inherits says what is."""

    def displacement(self, pair: int, side: int) -> Elements:
        """What stands in a chain on the base (``side`` 0) and on the moved body (1) of a
        pair, by number, on the way from base to moved body."""
        return ()

    def ends(self, closure: int) -> tuple[Sequence[Number], Sequence[Number]]:
        """How far off the two points (3,) are that a closure, by number, brings
        together, in the structure's unit."""
        return NOWHERE, NOWHERE

    def rod(self, closure: int) -> Number:
        """By how much the rod of a closure is longer, in the structure's unit."""
        return 0.0

    def lock(self, variable: int) -> Number | None:
        """Where a variable, by number, is locked in place of what is given, in rad and the
        structure's unit; None where it is as given."""
        return None

    def share(self, variable: int) -> tuple[Number, Number] | None:
        """The rate and the offset of a variable over its unknown in place of those that
        are given; None where they are."""
        return None

    def before(self, step: Step) -> Iterator[tuple[Motion, Number]]:
        """The displacement on the body from which a step begins."""
        return self._along(step, 0 if step.sign > 0 else 1)

    def after(self, step: Step) -> Iterator[tuple[Motion, Number]]:
        """The displacement on the body to which a step leads."""
        return self._along(step, 1 if step.sign > 0 else 0)

    def _along(self, step: Step, side: int) -> Iterator[tuple[Motion, Number]]:
        # on its way from moved body to base a chain has the inverse displacements
        for motion, value in self.displacement(step.pair, side)[:: step.sign]:
            yield motion, value if step.sign > 0 else -value


AS_GIVEN = Changes()
