"""What recorded equations are as polynomials: expanded, over the rational numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from bifurc.equations.tape import Node, Operation, Tape, TapeWriter

if TYPE_CHECKING:
    from flint import fmpq_mpoly  # few searches need it

BITS_OF_DOUBLES = 54  # ratios of more are no simpler than a double
ROUNDED = 0.5  # units in the last place by which a number is off that was rounded
Reading: TypeAlias = Callable[[float], Fraction]  # what a double stands for
MOST_TERMS = 400  # of a polynomial that is expanded

OF_POLYNOMIALS = (
    Operation.CONSTANT,
    Operation.ADD,
    Operation.SUBTRACT,
    Operation.MULTIPLY,
    Operation.SHIFT,
    Operation.SCALE,
    Operation.OVER,
)


def polynomial_part(writer: TapeWriter, output: int) -> list[int]:
    """The slots between that of a polynomial and its unknowns and functions, operands
    first."""
    needed = {output}
    for slot in range(output, -1, -1):
        node = writer.node(slot)
        is_inner = node.operation in OF_POLYNOMIALS
        if slot not in needed or not is_inner or node.operation is Operation.CONSTANT:
            continue
        needed.add(node.left)
        if node.operation in (Operation.ADD, Operation.SUBTRACT, Operation.MULTIPLY):
            needed.add(node.right)
    return sorted(needed)


def simplest_ratio(number: float, units: float = ROUNDED) -> Fraction:
    """The ratio of fewest digits, as a rule, that is so many ``units`` in the last place
    from a double: 9/100 of 0.09. With it x^2 - 0.6 x + 0.09 is a square, which it is not
    in doubles."""
    exact = Fraction(number)
    reach = Fraction(units) * Fraction(math.ulp(number))
    for bits in range(0, BITS_OF_DOUBLES, 3):
        near = exact.limit_denominator(1 << bits)
        if abs(near - exact) <= reach:
            return near
    return exact


def shortest_decimal(number: float) -> Fraction:
    """The decimal of fewest digits that is rounded to a double."""
    return Fraction(repr(number))


READINGS: tuple[Reading, ...] = (simplest_ratio, shortest_decimal)


def expanded(
    nodes: dict[int, Node],
    output: int,
    shifts: dict[int, float],
    reading: Reading,
) -> fmpq_mpoly | None:
    """The polynomial in slot ``output`` over the rational numbers, in the generators,
    given by their slots, less the ``shifts`` of them; None where it has more than
    `MOST_TERMS`. Its constants are what a ``reading`` makes of doubles."""
    from flint import fmpq, fmpq_mpoly_ctx

    domain = fmpq_mpoly_ctx.get([f"g{slot}" for slot in shifts])
    values: dict[int, fmpq_mpoly] = {
        slot: symbol + fmpq(*shift.as_integer_ratio())
        for (slot, shift), symbol in zip(shifts.items(), domain.gens(), strict=True)
    }
    for slot, node in nodes.items():
        if slot in values:
            continue
        number = fmpq(*reading(node.constant).as_integer_ratio())
        values[slot] = _value(node, domain.constant(number), values)
        if len(values[slot]) > MOST_TERMS:
            return None
    return values[output]


def _value(node: Node, number: fmpq_mpoly, values: dict[int, fmpq_mpoly]) -> fmpq_mpoly:
    """The polynomial that an operation on polynomials gives, with its constant as a
    ``number``."""
    if node.operation is Operation.CONSTANT:
        return number
    left = values[node.left]
    if node.operation is Operation.SHIFT:
        return left + number
    if node.operation is Operation.SCALE:
        return left * number
    if node.operation is Operation.OVER:
        return left / number
    right = values[node.right]
    if node.operation is Operation.ADD:
        return left + right
    if node.operation is Operation.SUBTRACT:
        return left - right
    return left * right


# --- systems --------------------------------------------------------------------------

# Exponents of the coordinates, and the coefficient of each such term.
Polynomial: TypeAlias = Mapping[tuple[int, ...], float]
# The number of an unknown, and whether it stands there itself or its cosine or sine.
_Coordinate: TypeAlias = tuple[int, Operation]
_Terms: TypeAlias = dict[tuple[_Coordinate, ...], float]
# What a coordinate is of its unknown.
OF_COORDINATES: dict[Operation, Callable[[np.ndarray], np.ndarray]] = {
    Operation.UNKNOWN: np.asarray,
    Operation.COS: np.cos,
    Operation.SIN: np.sin,
}


@dataclass(frozen=True, eq=False)
class PolynomialSystem:
    """Equations of n unknowns as ``polynomials`` in coordinates: of unknowns, or of
    their cosines and sines, which are on a circle by one further equation each.

    ``coordinates`` are the numbers of the unknowns, each with how it stands there, in
    ``sizes`` (c,) in which coefficients are near 1.
    """

    n: int
    sizes: np.ndarray
    coordinates: tuple[_Coordinate, ...]
    polynomials: tuple[Polynomial, ...]

    @property
    def is_square(self) -> bool:
        """Whether there are as many equations as coordinates."""
        return len(self.polynomials) == len(self.coordinates)

    @property
    def are_angles(self) -> np.ndarray:
        """Which of the unknowns (n,) stand there by their cosines and sines."""
        are_angles = np.zeros(self.n, dtype=bool)
        for number, kind in self.coordinates:
            are_angles[number] = kind is not Operation.UNKNOWN
        return are_angles

    def unknowns(self, points: np.ndarray) -> np.ndarray:
        """The unknowns (k, n) at real points (k, c); angles between -pi and pi."""
        values = np.zeros((len(points), self.n))
        columns = dict(zip(self.coordinates, (points * self.sizes).T, strict=True))
        for (number, kind), column in columns.items():
            if kind is Operation.UNKNOWN:
                values[:, number] = column
            elif kind is Operation.COS:
                sine = columns[number, Operation.SIN]
                values[:, number] = np.arctan2(sine, column)
        return values

    def places(self, unknowns: np.ndarray) -> np.ndarray:
        """The points (k, c) at which the unknowns are these (k, n)."""
        columns = [
            OF_COORDINATES[kind](unknowns[:, number])
            for number, kind in self.coordinates
        ]
        places: np.ndarray = np.array(columns).T / self.sizes
        return places


def polynomial_system(tape: Tape, reading: Reading) -> PolynomialSystem | None:
    """The equations of a ``tape`` as polynomials; None where they are none. Constants
    are what a ``reading`` makes of them."""
    writer = TapeWriter(tape.n)
    slots = tape.write_on(writer)
    rows: list[_Terms] = []
    for output in tape.outputs.tolist():
        row = _terms(writer, slots[output], reading)
        if not row:
            return None
        rows.append(row)
    angles = {
        number
        for row in rows
        for term in row
        for number, kind in term
        if kind is not Operation.UNKNOWN
    }
    for number in sorted(angles):
        cosine, sine = (number, Operation.COS), (number, Operation.SIN)
        rows.append({(cosine, cosine): 1.0, (sine, sine): 1.0, (): -1.0})
    used = {one for row in rows for term in row for one in term}
    if any((number, Operation.UNKNOWN) in used for number in angles):
        return None
    return _in_balance(tape.n, tuple(sorted(used)), rows)


def _in_balance(
    n: int, coordinates: tuple[_Coordinate, ...], rows: Sequence[_Terms]
) -> PolynomialSystem:
    """The system of polynomials in ``coordinates``, these in sizes of their own."""
    polynomials = [
        {tuple(map(term.count, coordinates)): value for term, value in row.items()}
        for row in rows
    ]
    sizes = _balancing_sizes(polynomials)
    sizes[[kind is not Operation.UNKNOWN for _, kind in coordinates]] = 1.0
    scaled = tuple(_in_sizes(one, sizes) for one in polynomials)
    return PolynomialSystem(n, sizes, coordinates, scaled)


def _balancing_sizes(polynomials: Sequence[Polynomial]) -> np.ndarray:
    """Powers of two (c,) in which to count the unknowns so that, the polynomials times
    factors, the logarithms of all coefficients are small (least squares)."""
    (count,) = {len(term) for one in polynomials for term in one}
    rows, logarithms = [], []
    for number, polynomial in enumerate(polynomials):
        factor = np.arange(len(polynomials)) == number
        for term, value in polynomial.items():
            rows.append([*term, *factor])
            logarithms.append(-np.log2(abs(value)))
    least = np.linalg.lstsq(np.array(rows, dtype=float), logarithms, rcond=None)[0]
    sizes: np.ndarray = np.exp2(np.round(least[:count]))
    return sizes


def _in_sizes(polynomial: Polynomial, sizes: np.ndarray) -> Polynomial:
    """A polynomial in unknowns over their ``sizes`` (c,), its largest coefficient 1."""
    scaled = {
        term: value * float(np.prod(sizes ** np.array(term)))
        for term, value in polynomial.items()
    }
    largest = max(map(abs, scaled.values()))
    return {term: value / largest for term, value in scaled.items()}


def _terms(writer: TapeWriter, output: int, reading: Reading) -> _Terms:
    """The coefficients of the polynomial in slot ``output``, by the coordinates that are
    multiplied; nothing where there is none."""
    nodes = {slot: writer.node(slot) for slot in polynomial_part(writer, output)}
    generators = {
        slot: _coordinate(writer, node)
        for slot, node in nodes.items()
        if node.operation not in OF_POLYNOMIALS
    }
    is_finite = all(math.isfinite(node.constant) for node in nodes.values())
    if not generators or not is_finite or None in generators.values():
        return {}
    polynomial = expanded(nodes, output, dict.fromkeys(generators, 0.0), reading)
    if polynomial is None:
        return {}
    terms = {}
    for exponents, value in polynomial.terms():
        product: list[_Coordinate] = []
        for one, exponent in zip(generators.values(), exponents, strict=True):
            assert one is not None
            product += [one] * int(exponent)
        terms[tuple(product)] = int(value.p) / int(value.q)
    return terms


def _coordinate(writer: TapeWriter, node: Node) -> _Coordinate | None:
    """The number of an unknown and how it stands in a generator; None where this is
    neither an unknown nor the cosine or sine of one."""
    if node.operation is Operation.UNKNOWN:
        return node.left, Operation.UNKNOWN
    if node.operation not in (Operation.COS, Operation.SIN):
        return None
    inner = writer.node(node.left)
    if inner.operation is not Operation.UNKNOWN:
        return None
    return inner.left, node.operation
