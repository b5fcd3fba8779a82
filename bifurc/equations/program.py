"""Expressions as steps, each written once, with exact numbers.

A tape is what comes of them in doubles; over other numbers a third stays a third.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from bifurc.equations.tape import FUNCTIONS, TapeWriter

DIGITS = 30  # to which a constant is known before it is rounded to a double
CONSTANTS = {"pi": math.pi, "e": math.e}
NEGATIVE = "negative"

SIGNS: Mapping[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "^": operator.pow,
    NEGATIVE: operator.neg,
}
_ON_TAPES: Mapping[str, Callable[..., int]] = {
    "+": TapeWriter.add,
    "-": TapeWriter.subtract,
    "*": TapeWriter.multiply,
    "/": TapeWriter.divide,
    "^": TapeWriter.power,
    NEGATIVE: TapeWriter.negative,
    "atan2": TapeWriter.angle,
}


class Step(NamedTuple):
    """A ``number``; or what ``name`` is: a symbol, a constant, or a sign or a function of
    the steps ``operands``."""

    name: str = ""
    operands: tuple[int, ...] = ()
    number: Fraction | None = None


class Program:
    """Expressions while they are written, and what they are over numbers of any kind."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._places: dict[Step, int] = {}
        self._hold_symbols: list[bool] = []

    def place(self, step: Step) -> int:
        """The place of a step, the one that it has where it is written already."""
        place = self._places.get(step)
        if place is None:
            place = self._places[step] = len(self.steps)
            is_symbol = step.number is None and step.name not in CONSTANTS
            holds_symbols = any(map(self.holds_symbols, step.operands))
            self.steps.append(step)
            self._hold_symbols.append(holds_symbols if step.operands else is_symbol)
        return place

    def holds_symbols(self, place: int) -> bool:
        """Whether what stands at a place is no constant."""
        return self._hold_symbols[place]

    def over(
        self,
        places: Sequence[int],
        symbols: Mapping[str, Any],
        library: Any,
        ratio: Callable[[int, int], Any],
    ) -> list[Any]:
        """What stands at some places, for values of the ``symbols`` of any kind: with the
        functions of a ``library`` like mpmath, and the ``ratio`` of two whole numbers as
        it is there."""
        leaves = {"pi": library.pi, "e": library.exp(ratio(1, 1)), **symbols}
        values: dict[int, Any] = {}
        for place in self._needed_for(places):
            name, operands, number = self.steps[place]
            if number is not None:
                values[place] = ratio(number.numerator, number.denominator)
            elif operands:
                function = SIGNS.get(name) or getattr(library, name)
                values[place] = function(*(values[operand] for operand in operands))
            else:
                values[place] = leaves[name]
        return [values[place] for place in places]

    def write_on(
        self, writer: TapeWriter, places: Sequence[int], unknowns: Sequence[str]
    ) -> list[int]:
        """The slots of what stands at some places, on a tape in the ``unknowns``;
        constants are rounded once."""
        slots: dict[int, int] = {}

        def slot_of(place: int) -> int:
            if self.holds_symbols(place):
                return slots[place]
            return writer.constant(self._in_doubles(place))

        for place in self._needed_for(places):
            if not self.holds_symbols(place):
                continue
            name, operands, _ = self.steps[place]
            written = [slot_of(operand) for operand in operands]
            if not operands:
                slots[place] = writer.unknown(unknowns.index(name))
            elif name in FUNCTIONS:
                slots[place] = writer.apply(FUNCTIONS[name], *written)
            else:
                slots[place] = _ON_TAPES[name](writer, *written)
        return [slot_of(place) for place in places]

    def _needed_for(self, places: Sequence[int]) -> list[int]:
        """The places that some are made of, and these, operands first."""
        needed = set(places)
        for place in range(max(places), -1, -1):
            if place in needed:
                needed.update(self.steps[place].operands)
        return sorted(needed)

    def _in_doubles(self, place: int) -> float:
        """The double next to a constant."""
        name, operands, number = self.steps[place]
        if number is not None:
            return float(number)
        if not operands:
            return CONSTANTS[name]
        import mpmath  # it takes longer to import than a small problem to solve

        with mpmath.workdps(DIGITS):
            return float(self.over([place], {}, mpmath, mpmath.fraction)[0])
