"""The different factors of recorded equations, with the power of each.

The solutions of a^2 b = 0 are those of a b = 0. Where equations have repeated factors
their solutions have a multiplicity, and F' has a lower rank all along them; the
equations with every factor once have not. Factors are those that a tape is written as,
and of polynomials also those that Yun's algorithm (1976) finds, over the rational
numbers that the constants of a tape are.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.equations.polynomials import (
    OF_POLYNOMIALS,
    READINGS,
    Reading,
    expanded,
    polynomial_part,
    simplest_ratio,
)
from bifurc.equations.rims import NO_RIMS, Rims, at_rim, rims_of, without_root
from bifurc.equations.tape import PARTIAL, Node, Operation, Tape, TapeWriter

if TYPE_CHECKING:
    from flint import fmpq_mpoly  # few searches need it

COMPUTED = 4.0  # units in the last place by which a number is off that was computed


@dataclass(frozen=True)
class Factors:
    """The factors of m equations: those of equation ``rows[i]`` include number i of the
    equations of ``tape``, to the power ``powers[i]``; both (k,), ordered by rows. The
    ``rims`` are those of the equations that the factors do not have. ``are_plain``:
    their products are the equations."""

    tape: Tape
    rows: tuple[int, ...]
    powers: tuple[int, ...]
    rims: Rims
    are_plain: bool

    @property
    def are_simpler(self) -> bool:
        """Whether any factor has a power above one, or stands without a root."""
        return max(self.powers) > 1 or not self.are_plain

    def product(self, numbers: Sequence[int]) -> Tape:
        """The one equation that some of the factors, by their ``numbers``, make with
        their powers."""
        writer = TapeWriter(self.tape.n)
        slots = self.tape.write_on(writer)
        outputs = self.tape.outputs.tolist()
        product = writer.constant(1.0)
        for number in numbers:
            power = writer.constant(float(self.powers[number]))
            raised = writer.power(slots[outputs[number]], power)
            product = writer.multiply(product, raised)
        return writer.tape([product])

    def radical(self) -> Tape:
        """The m equations with every factor once."""
        writer = TapeWriter(self.tape.n)
        slots = self.tape.write_on(writer)
        outputs: dict[int, int] = {}
        for row, slot in zip(self.rows, self.tape.outputs.tolist(), strict=True):
            factor = slots[slot]
            known = outputs.get(row)
            outputs[row] = factor if known is None else writer.multiply(known, factor)
        return writer.tape([outputs[row] for row in sorted(outputs)])


def written_factors(tape: Tape) -> Factors:
    """The factors of the products and powers that the equations are written as.

    A root is zero where what it is of is zero, and so is any chain of functions that
    have an inverse on top of it: exp(sqrt(g)) - 1 has the factor g.
    """
    writer = TapeWriter(tape.n)
    slots = tape.write_on(writer)
    outputs = [slots[slot] for slot in tape.outputs.tolist()]
    entries: list[tuple[int, int, int]] = []
    roots: list[int] = []
    are_plain = True
    for row, output in enumerate(outputs):
        product = _product_of(writer, output)
        roots += product.roots
        are_plain = are_plain and product.is_plain
        for factor in sorted(product.powers):
            power = max(1, math.floor(product.powers[factor]))
            entries.append((row, factor, power))
    factors = _factors(writer, entries)
    rims = rims_of(writer, outputs, [slot for _, slot, _ in entries], roots)
    return replace(factors, rims=rims, are_plain=are_plain)


def polynomial_factors(tape: Tape, rows: Sequence[int], region: np.ndarray) -> Factors:
    """The same, with the square-free factors of polynomials for the equations ``rows``,
    where they are polynomials in the unknowns and in functions of them, of not too many
    terms.

    They are expanded about the middle of a ``region`` (n, 2) that is far from zero: there
    the terms of (u - c)^2 are as large as c^2, and what they add up to is lost. The
    constants of the tape are ratios or decimals that are rounded to them, or where this
    leaves no repeated factors next to them: 0.1**2 is not the double next to 0.01.
    """
    computed: Reading = partial(simplest_ratio, units=COMPUTED)
    for reading in (*READINGS, computed):
        factors = _factors_with(tape, rows, region, reading)
        if factors.are_simpler:
            return factors
    return factors


def irreducible_factors(tape: Tape, region: np.ndarray) -> Factors | None:
    """The factors of one equation of which none is a product any more, as far as it is
    written so or a polynomial, over the rational numbers, shows it in a ``region`` (n, 2);
    None where their product is not the equation."""
    written = written_factors(tape)
    if tape.m != 1 or not written.are_plain:
        return None
    writer = TapeWriter(tape.n)
    slots = written.tape.write_on(writer)
    origins = _origins(region)
    polynomials = _Polynomials(writer, origins, simplest_ratio, is_split=True)
    found: dict[int, int] = defaultdict(int)
    for output, power in zip(
        written.tape.outputs.tolist(), written.powers, strict=True
    ):
        parts = polynomials.powers_of(slots[output]) or {}
        if sum(parts.values()) < 2:
            parts = {slots[output]: 1}  # as it was written
        for part, multiplicity in parts.items():
            found[part] += power * multiplicity
    return _factors(writer, [(0, slot, power) for slot, power in found.items()])


def _factors_with(
    tape: Tape, rows: Sequence[int], region: np.ndarray, reading: Reading
) -> Factors:
    """The same with constants that are what a ``reading`` makes of doubles."""
    written = written_factors(tape)
    writer = TapeWriter(tape.n)
    slots = tape.write_on(writer)
    of_factors = written.tape.write_on(writer)
    entries: list[tuple[int, int, int]] = []
    polynomials = _Polynomials(writer, _origins(region), reading)
    for row, slot in enumerate(tape.outputs.tolist()):
        found = None
        if row in rows and written.are_plain:
            found = polynomials.powers_of(slots[slot])
        if found is None:
            found = {}
            for output, number, power in zip(
                written.tape.outputs.tolist(), written.rows, written.powers, strict=True
            ):
                if number == row:
                    found[of_factors[output]] = power
            if row in rows and not written.are_plain:
                found = polynomials.parts_of(found)
        for factor, power in found.items():
            entries.append((row, factor, power))
    factors = _factors(writer, entries)
    return replace(factors, rims=written.rims, are_plain=written.are_plain)


def _factors(writer: TapeWriter, entries: Sequence[tuple[int, int, int]]) -> Factors:
    """Factors on a tape, each by its equation, its slot and its power."""
    rows, slots, powers = zip(*entries, strict=True)
    return Factors(writer.tape(slots), rows, powers, NO_RIMS, True)


# --- as written -----------------------------------------------------------------------


class _Product(NamedTuple):
    """The slots whose product is zero where an equation is, and the ``powers`` of each;
    ``is_plain``: but for a number the product is the equation. What stands in the slots
    ``roots`` must not be negative."""

    powers: Mapping[int, Fraction]
    is_plain: bool
    roots: Sequence[int]


def _product_of(writer: TapeWriter, output: int) -> _Product:
    """What the equation in slot ``output`` is a product of."""
    is_plain = True
    roots: list[int] = []
    factors: dict[int, Fraction] = defaultdict(Fraction)
    pending: dict[int, Fraction] = defaultdict(Fraction, {output: Fraction(1)})
    while pending:
        slot = max(pending)  # operands stand before what is made of them
        power = pending.pop(slot)
        node = writer.node(slot)
        if node.operation is Operation.MULTIPLY:
            pending[node.left] += power
            pending[node.right] += power
        elif node.operation in (Operation.SCALE, Operation.OVER):
            pending[node.left] += power
        elif (rim := at_rim(writer, slot)) is not None:
            pending[rim.slot] += rim.power * power
            is_plain = False
        elif (squared := without_root(writer, slot)) is not None:
            pending[squared.slot] += power
            roots.append(squared.root)
            is_plain = False
        else:
            factors[slot] += power
    defined = _where_defined(writer, output, factors)
    return _Product(defined, is_plain and len(defined) == len(factors), roots)


def _where_defined(
    writer: TapeWriter, output: int, factors: Mapping[int, Fraction]
) -> Mapping[int, Fraction]:
    """The factors without those that are zero only where the equation in slot
    ``output`` is not defined, as x is in x log(x)."""
    nodes = [writer.node(slot) for slot in writer.needed_for(output)]
    logarithms = {node.left for node in nodes if node.operation is Operation.LOG}
    defined = {slot: factors[slot] for slot in factors if slot not in logarithms}
    return defined or factors


# --- of polynomials -------------------------------------------------------------------

# A quotient may be zero where what it is divided by is, and a root has no derivative.
_REFUSED = (Operation.DIVIDE, Operation.SQRT, Operation.CBRT, Operation.POWER)


def _origins(region: np.ndarray) -> list[float]:
    """From where each unknown is counted in a ``region`` (n, 2): from zero if that is
    inside, or else from a number of few digits next to the middle."""
    low, high = region.T
    middles, half_widths = 0.5 * (low + high), 0.5 * (high - low)
    units = np.exp2(np.floor(np.log2(half_widths)))
    rounded = units * np.round(middles / units)
    origins: list[float] = np.where((low <= 0) & (high >= 0), 0.0, rounded).tolist()
    return origins


@dataclass(frozen=True)
class _Polynomials:
    """Polynomials that stand on a tape while it is written, expanded in the unknowns less
    their ``origins`` (n,), with constants that are what a ``reading`` makes of
    doubles. Their factors are square-free ones, or irreducible ones where these are ``is_split``."""

    writer: TapeWriter
    origins: Sequence[float]
    reading: Reading
    is_split: bool = False

    def powers_of(self, output: int) -> dict[int, int] | None:
        """The slots of the factors of the polynomial in slot ``output``, newly
        written, and the power of each; None where there is none."""
        writer = self.writer
        inner = polynomial_part(writer, output)
        nodes = {slot: writer.node(slot) for slot in inner}
        if not all(math.isfinite(node.constant) for node in nodes.values()):
            return None
        generators = [
            slot for slot in inner if nodes[slot].operation not in OF_POLYNOMIALS
        ]
        if not generators or any(nodes[k].operation in _REFUSED for k in generators):
            return None
        shifts = {slot: _shift_of(nodes[slot], self.origins) for slot in generators}
        polynomial = expanded(nodes, output, shifts, self.reading)
        if polynomial is None or not polynomial:
            return None
        degrees = zip(generators, polynomial.degrees(), strict=True)
        if any(not degree and nodes[k].operation in PARTIAL for k, degree in degrees):
            return None  # log(x) - log(x) is zero for positive x only
        factors = self._factored(polynomial)
        shifted = [
            writer.add(slot, writer.constant(-shift)) if shift else slot
            for slot, shift in shifts.items()
        ]
        return {
            _written(writer, factor, shifted): int(power) for factor, power in factors
        }

    def _factored(self, polynomial: fmpq_mpoly) -> list[tuple[fmpq_mpoly, int]]:
        """The factors of a polynomial, with the power of each."""
        if self.is_split:
            return list(polynomial.factor()[1])
        return list(polynomial.factor_squarefree()[1])

    def parts_of(self, factors: Mapping[int, int]) -> dict[int, int]:
        """The same of each of the ``factors``, by their slots, with their powers; those
        that are no polynomials as they are."""
        parts: dict[int, int] = defaultdict(int)
        for slot, power in factors.items():
            found = self.powers_of(slot) or {slot: 1}
            for part, multiplicity in found.items():
                parts[part] += power * multiplicity
        return parts


def _shift_of(generator: Node, origins: Sequence[float]) -> float:
    """From where a generator is counted: an unknown from its origin, a function from
    zero."""
    if generator.operation is not Operation.UNKNOWN:
        return 0.0
    return origins[generator.left]


def _written(
    writer: TapeWriter, polynomial: fmpq_mpoly, generators: Sequence[int]
) -> int:
    """The slot of a polynomial, its largest coefficient 1, in slots ``generators``."""
    largest = max(abs(value) for value in polynomial.coeffs())
    total = writer.constant(0.0)
    for exponents, value in polynomial.terms():
        share = value / largest
        term = writer.constant(int(share.p) / int(share.q))
        for slot, exponent in zip(generators, exponents, strict=True):
            power = writer.power(slot, writer.constant(float(exponent)))
            term = writer.multiply(term, power)
        total = writer.add(total, term)
    return total
