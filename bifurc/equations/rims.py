"""Where recorded equations are defined on one side only, and what they are on the rim.

A root, a logarithm, the inverse of a sine are not defined beyond some value of their
argument, and at it they have no derivative. What has the value zero on such a rim is
an equation without it: sqrt(g) = 0 is g = 0, and acos(g) = 0 is g = 1. An equation with
a root in one of its terms, sqrt(g) = h, is g = h^2 where h is not negative.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from bifurc.equations.tape import BINARY, Node, Operation, Tape, TapeWriter

ROUNDING = 8.0 * float(
    np.finfo(float).eps
)  # of a value that is meant to be one on a rim


class Rims(NamedTuple):
    """The rims of equations: each is defined where the outputs (k,) of the ``tape`` are
    positive or 0, the arguments of ``operations`` (k,) less their values on the rim; no
    tape where there are none."""

    tape: Tape | None = None
    operations: tuple[Operation, ...] = ()

    def __bool__(self) -> bool:
        return self.tape is not None

    def depths(self, points: np.ndarray, sizes: np.ndarray) -> np.ndarray:
        """How far inside every rim (j, k) points (j, n) are, to first order, with
        unknowns counted in ``sizes`` (n,); negative outside."""
        assert self.tape is not None
        points = np.ascontiguousarray(points, dtype=float)
        values = self.tape.compiled.residuals(points)
        slopes = self.tape.compiled.jacobians(points) * sizes
        lengths = np.linalg.norm(slopes, axis=2)
        # where a rim is a point of zero slope the value is zero as well
        known = np.where(lengths > 0.0, lengths, 1.0)
        return values / known

    def texts(self, names: Sequence[str]) -> list[str]:
        """What is 0 on each rim (k), in the ``names`` (n,) of the unknowns, and of which
        function the rim is."""
        assert self.tape is not None
        arguments = written_out(self.tape, names)
        pairs = zip(arguments, self.operations, strict=True)
        return [f"{text} = 0, the rim of {one.name.lower()}" for text, one in pairs]


NO_RIMS = Rims()


class Rim(NamedTuple):
    """A function is zero where what stands in ``slot`` is, on its rim, and grows there
    like this ``power`` of it."""

    slot: int
    power: Fraction


# --- equations as text ----------------------------------------------------------------

_SIGNS: Mapping[Operation, str] = {
    Operation.ADD: "{} + {}",
    Operation.SUBTRACT: "{} - {}",
    Operation.MULTIPLY: "{}*{}",
    Operation.DIVIDE: "{}/{}",
    Operation.ANGLE: "atan2({}, {})",
    Operation.SHIFT: "{} + {:.10g}",
    Operation.SCALE: "{1:.10g}*{0}",
    Operation.OVER: "{}/{:.10g}",
    Operation.POWER: "{}^{:.10g}",
}
_LEVEL = (Operation.ADD, Operation.SHIFT)  # what they are of needs no brackets
LONGEST = 80  # characters of an equation


def written_out(tape: Tape, names: Sequence[str]) -> list[str]:
    """The equations (m) of a tape in the ``names`` (n,) of the unknowns; of a long one
    the end is left out."""
    nodes, outputs = tape.nodes()
    texts: list[str] = []
    for node in nodes:
        text = _text(node, nodes, texts, names)
        texts.append(text if len(text) <= LONGEST else f"{text[:LONGEST]}...")
    return [texts[output] for output in outputs]


def _text(
    node: Node, nodes: Sequence[Node], texts: Sequence[str], names: Sequence[str]
) -> str:
    """What an operation on others, of which the ``texts`` are known, says."""
    operation, left, right, constant = node
    if operation is Operation.UNKNOWN:
        return names[left]
    if operation is Operation.CONSTANT:
        return f"{constant:.10g}"
    if operation not in _SIGNS:
        return f"{operation.name.lower()}({texts[left]})"

    def inner(number: int) -> str:
        is_whole = operation in _LEVEL or nodes[number].operation not in _SIGNS
        return texts[number] if is_whole else f"({texts[number]})"

    if operation is Operation.MULTIPLY and left == right:
        return f"{inner(left)}^2"
    is_of_two = operation in BINARY
    second = inner(right) if is_of_two else constant
    return _SIGNS[operation].format(inner(left), second).replace("+ -", "- ")


# --- the rims that equations have -----------------------------------------------------


def rims_of(
    writer: TapeWriter,
    outputs: Sequence[int],
    others: Sequence[int],
    roots: Sequence[int] = (),
) -> Rims:
    """The rims of the equations in slots ``outputs`` that what stands in slots
    ``others`` does not have; the slots ``roots`` hold what is equal to a root."""
    slots = list(roots)
    operations = [Operation.SQRT] * len(slots)
    lost = set(writer.needed_for(*outputs)) - set(writer.needed_for(*others))
    for slot in sorted(lost):
        node = writer.node(slot)
        for argument in _arguments(writer, node):
            slots.append(argument)
            operations.append(node.operation)
    return Rims(writer.tape(slots), tuple(operations)) if slots else Rims()


def _arguments(writer: TapeWriter, node: Node) -> list[int]:
    """The slots of what has to be positive or 0 where an operation is defined."""
    at_least, at_most = _INTERVALS.get(node.operation, (-math.inf, math.inf))
    if node.operation is Operation.POWER and node.constant.is_integer():
        return []
    arguments = []
    if math.isfinite(at_least):
        arguments.append(writer.add(node.left, writer.constant(-at_least)))
    if math.isfinite(at_most):
        arguments.append(writer.subtract(writer.constant(at_most), node.left))
    return arguments


_INTERVALS: Mapping[Operation, tuple[float, float]] = {
    Operation.SQRT: (0.0, math.inf),
    Operation.POWER: (0.0, math.inf),
    Operation.LOG: (0.0, math.inf),
    Operation.LOG1P: (-1.0, math.inf),
    Operation.ASIN: (-1.0, 1.0),
    Operation.ACOS: (-1.0, 1.0),
    Operation.ACOSH: (1.0, math.inf),
    Operation.ATANH: (-1.0, 1.0),
}


def on_rims(tape: Tape) -> Iterator[Tape]:
    """The equations on each of their rims: with the value there in the place of the
    function, and last what is zero on the rim."""
    operations = tape.operations.tolist()
    for slot, operation in enumerate(operations):
        exponent = float(tape.constants[slot])
        for value, argument in _ends(Operation(operation), exponent).items():
            writer = TapeWriter(tape.n)
            slots = tape.write_on(writer, values={slot: value})
            left = slots.get(int(tape.operands[slot, 0]))
            if left is not None and slot in slots:
                outputs = [slots[output] for output in tape.outputs.tolist()]
                rim = writer.add(left, writer.constant(-argument))
                yield writer.tape([*outputs, rim])


def _ends(operation: Operation, exponent: float) -> Mapping[float, float]:
    """The values of an operation on its rims, and its arguments there."""
    is_odd_root = operation is Operation.CBRT
    is_power = operation is Operation.POWER and not exponent.is_integer()
    if is_odd_root or (is_power and exponent > 0.0):
        return {0.0: 0.0}
    return _ENDS.get(operation, {})


# --- what is zero on a rim ------------------------------------------------------------


def at_rim(writer: TapeWriter, output: int) -> Rim | None:
    """What is zero where the function in slot ``output`` is, if that is on the rim of a
    root or an inverse function, below others that have an inverse; None elsewhere."""
    slot, value = output, 0.0
    while True:
        node = writer.node(slot)
        end = _end_of(node, value)
        if end is not None:
            shift = writer.constant(-end.argument)
            return Rim(writer.add(node.left, shift), end.power)
        inverse = _INVERSES.get(node.operation)
        if inverse is None:
            return None
        try:
            value = inverse(value, node.constant)
        except (ValueError, OverflowError, ZeroDivisionError):
            return None
        slot = node.left


class _End(NamedTuple):
    """On its rim a function has this ``argument``, and the ``power`` with which it
    grows from there."""

    argument: float
    power: Fraction


def _end_of(node: Node, value: float) -> _End | None:
    """Where an operation has a ``value``, if that is on its rim."""
    if node.operation is Operation.CBRT and value == 0.0:
        return _End(0.0, Fraction(1, 3))
    if node.operation is Operation.POWER and value == 0.0 and node.constant > 0.0:
        return _End(0.0, Fraction(node.constant).limit_denominator(1000))
    for end, argument in _ENDS.get(node.operation, {}).items():
        if abs(value - end) <= ROUNDING * abs(end):
            return _End(argument, Fraction(1, 2))
    return None


_ENDS: Mapping[Operation, Mapping[float, float]] = {
    Operation.SQRT: {0.0: 0.0},
    Operation.ASIN: {-math.pi / 2: -1.0, math.pi / 2: 1.0},
    Operation.ACOS: {0.0: 1.0, math.pi: -1.0},
    Operation.ACOSH: {0.0: 1.0},
}


def _within(
    low: float, high: float, inverse: Callable[[float], float]
) -> Callable[[float, float], float]:
    """The inverse of a function that has values from ``low`` to ``high``; elsewhere no
    number."""
    return lambda value, _: inverse(value) if low <= value <= high else math.nan


def _argument_of_power(value: float, exponent: float) -> float:
    return float(value ** (1.0 / exponent)) if value > 0.0 else math.nan


QUARTER = math.pi / 2
# The argument at which a function, with a constant, has a value; only of those that have
# an inverse. Where there is none it is no number, and comes to no rim.
_INVERSES: Mapping[Operation, Callable[[float, float], float]] = {
    Operation.SHIFT: lambda value, constant: value - constant,
    Operation.SCALE: lambda value, constant: value / constant,
    Operation.OVER: lambda value, constant: value * constant,
    Operation.POWER: _argument_of_power,
    Operation.SQRT: _within(0.0, math.inf, lambda value: value * value),
    Operation.CBRT: lambda value, _: value**3,
    Operation.EXP: _within(0.0, math.inf, math.log),
    Operation.EXPM1: lambda value, _: math.log1p(value),
    Operation.LOG: lambda value, _: math.exp(value),
    Operation.LOG1P: lambda value, _: math.expm1(value),
    Operation.ASIN: _within(-QUARTER, QUARTER, math.sin),
    Operation.ACOS: _within(0.0, math.pi, math.cos),
    Operation.ATAN: _within(-QUARTER, QUARTER, math.tan),
    Operation.SINH: lambda value, _: math.asinh(value),
    Operation.TANH: lambda value, _: math.atanh(value),
    Operation.ASINH: lambda value, _: math.sinh(value),
    Operation.ACOSH: _within(0.0, math.inf, math.cosh),
    Operation.ATANH: lambda value, _: math.tanh(value),
}


# --- equations with a root in one term ------------------------------------------------


class Squared(NamedTuple):
    """An equation is that in ``slot`` where what stands in ``root`` is not negative."""

    slot: int
    root: int


class _Term(NamedTuple):
    """A ``factor`` times what stands in a ``slot``."""

    factor: float
    slot: int


def without_root(writer: TapeWriter, output: int) -> Squared | None:
    """The equation in slot ``output`` without the root that is one of its terms; None
    where there is none, or one that stays beside others."""
    terms = _terms(writer, _Term(1.0, output))
    is_root = [writer.node(term.slot).operation is Operation.SQRT for term in terms]
    count = sum(is_root)
    others = [term for term in terms if writer.value(term.slot) is None]
    if len(others) < 2 or count not in (1, len(terms)) or count > 2:
        return None
    root = terms[is_root.index(True)]
    rest = [_Term(-one.factor / root.factor, one.slot) for one in terms if one != root]
    slots = [writer.multiply(slot, writer.constant(factor)) for factor, slot in rest]
    total = slots[0]
    for slot in slots[1:]:
        total = writer.add(total, slot)
    square = _square(writer, rest[0]) if count == 2 else writer.multiply(total, total)
    argument = writer.node(root.slot).left
    return Squared(writer.subtract(argument, square), total)


def _terms(writer: TapeWriter, term: _Term) -> list[_Term]:
    """The terms that a term is the sum of."""
    factor, slot = term
    operation, left, right, constant = writer.node(slot)
    if operation is Operation.SCALE:
        return _terms(writer, _Term(factor * constant, left))
    if operation is Operation.OVER:
        return _terms(writer, _Term(factor / constant, left))
    if operation is Operation.SHIFT:
        shift = _Term(factor, writer.constant(constant))
        return [*_terms(writer, _Term(factor, left)), shift]
    if operation is Operation.ADD:
        other = _Term(factor, right)
    elif operation is Operation.SUBTRACT:
        other = _Term(-factor, right)
    else:
        return [term]
    return [*_terms(writer, _Term(factor, left)), *_terms(writer, other)]


def _square(writer: TapeWriter, root: _Term) -> int:
    """The square of a root."""
    argument = writer.node(root.slot).left
    return writer.multiply(argument, writer.constant(root.factor**2))
