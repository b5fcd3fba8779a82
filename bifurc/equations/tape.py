"""A tape: equations as a list of operations, and how one is written.

Every operation writes one slot. Equal operations share theirs, and what the arithmetic
of doubles makes of constants alone is a constant. The interpreter of tapes is compiled
(`bifurc/core/tape.hpp`); here they are written, kept and evaluated over numbers of any
other kind.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from bifurc import _core
from bifurc.tables import count_of

LONGEST = 200_000  # operations of a tape
LARGEST_POWER = 64  # whole exponent up to which a power is a chain of products
NOTHING = 2.0**-100  # factor of y - y: bounds on it are narrow, and none remain none


class Operation(IntEnum):
    """What a slot of a tape holds; the numbers are those of the compiled interpreter.

    Operands are the slots ``left`` and ``right`` and the number ``constant``.
    """

    UNKNOWN = 0
    CONSTANT = 1
    ADD = 2
    SUBTRACT = 3
    MULTIPLY = 4
    DIVIDE = 5
    SHIFT = 6  # left + constant
    SCALE = 7  # left * constant
    OVER = 8  # left / constant
    POWER = 9  # left ** constant
    EXP = 10
    EXPM1 = 11
    LOG = 12
    LOG1P = 13
    SQRT = 14
    CBRT = 15
    SIN = 16
    COS = 17
    TAN = 18
    ASIN = 19
    ACOS = 20
    ATAN = 21
    SINH = 22
    COSH = 23
    TANH = 24
    ASINH = 25
    ACOSH = 26
    ATANH = 27
    ANGLE = 28  # atan2(left, right)


# Those that are not defined, or not smooth, for some operands.
PARTIAL = frozenset(
    {
        Operation.DIVIDE,
        Operation.POWER,
        Operation.LOG,
        Operation.LOG1P,
        Operation.SQRT,
        Operation.TAN,
        Operation.ASIN,
        Operation.ACOS,
        Operation.ACOSH,
        Operation.ATANH,
        Operation.ANGLE,
    }
)

# Functions of one number, by their names in the standard library and in mpmath.
FUNCTIONS = {
    operation.name.lower(): operation
    for operation in Operation
    if Operation.POWER < operation < Operation.ANGLE
}
# the same in NumPy
IN_DOUBLES: Mapping[Operation, np.ufunc] = {
    operation: getattr(np, name) for name, operation in FUNCTIONS.items()
}


class TooLong(Exception):
    """A tape would have more operations than it may."""


class Node(NamedTuple):
    """One operation: on the slots ``left`` and ``right``, where it has two, and a
    ``constant``."""

    operation: Operation
    left: int = 0
    right: int = 0
    constant: float = 0.0


# --- a tape ---------------------------------------------------------------------------


class Tape:
    """m equations in n unknowns as a list of k operations.

    ``operations`` (k,), ``operands`` (k, 3) (left, right and the slot of the rule for
    derivatives), ``constants`` (k,), and ``outputs`` (m,), the slots of the equations.
    Immutable; copied and pickled by these arrays.
    """

    def __init__(
        self,
        n: int,
        operations: np.ndarray,
        operands: np.ndarray,
        constants: np.ndarray,
        outputs: np.ndarray,
    ):
        self.n = n
        self.operations = np.ascontiguousarray(operations, dtype=np.int64)
        self.operands = np.ascontiguousarray(operands, dtype=np.int64).reshape(-1, 3)
        self.constants = np.ascontiguousarray(constants, dtype=float)
        self.outputs = np.ascontiguousarray(outputs, dtype=np.int64)

    def __reduce__(self) -> tuple[type[Tape], tuple[Any, ...]]:
        arrays = (self.operations, self.operands, self.constants, self.outputs)
        return Tape, (self.n, *arrays)

    def __repr__(self) -> str:
        return (
            f"<Tape: {count_of(self.m, 'equation')} in {count_of(self.n, 'unknown')}, "
            f"{count_of(self.size, 'operation')}>"
        )

    @property
    def m(self) -> int:
        """Number of equations."""
        return len(self.outputs)

    @cached_property
    def size(self) -> int:
        """Number of operations that the equations are made of, without unknowns and
        constants."""
        operations = self.operations[self._needed]
        return int(np.count_nonzero(operations > Operation.CONSTANT))

    @cached_property
    def compiled(self) -> _core.Tape:
        """The compiled interpreter with this tape."""
        return _core.Tape(
            self.n, self.operations, self.operands, self.constants, self.outputs
        )

    @cached_property
    def _needed(self) -> list[int]:
        """The slots that the equations are made of, in order; the others serve
        derivatives."""
        operations = self.operations.tolist()
        operands = self.operands.tolist()
        needed = set(self.outputs.tolist())
        for slot in range(len(operations) - 1, -1, -1):
            operation = operations[slot]
            if slot not in needed or operation <= Operation.CONSTANT:
                continue
            left, right, _ = operands[slot]
            needed.add(left)
            if operation in BINARY:
                needed.add(right)
        return sorted(needed)

    def over(
        self,
        unknowns: Sequence[Any],
        library: Any,
        number_of: Callable[[float], Any] | None = None,
    ) -> list[Any]:
        """F, m numbers, of n ``unknowns`` of any kind, with the functions of a ``library``
        like mpmath, and constants that are what ``number_of`` makes of doubles, or the
        constructor ``mpf`` of the library."""
        number_of = number_of or library.mpf
        values: dict[int, Any] = {}
        for slot, (operation, left, right, constant) in self._program:
            if operation is Operation.UNKNOWN:
                values[slot] = unknowns[left]
            elif operation is Operation.CONSTANT:
                values[slot] = number_of(constant)
            elif operation in BINARY:
                second = values[right]
                values[slot] = _binary(operation, library)(values[left], second)
            elif operation in _WITH_CONSTANT:
                number = number_of(constant)
                values[slot] = _WITH_CONSTANT[operation](values[left], number)
            else:
                function = getattr(library, operation.name.lower())
                values[slot] = function(values[left])
        return [values[slot] for slot in self.outputs.tolist()]

    @cached_property
    def _program(self) -> list[tuple[int, Node]]:
        """The slots that the equations are made of, in order, and what they hold."""
        program = []
        for slot in self._needed:
            operation = Operation(int(self.operations[slot]))
            left, right, _ = self.operands[slot].tolist()
            constant = float(self.constants[slot])
            program.append((slot, Node(operation, left, right, constant)))
        return program

    def nodes(self) -> tuple[list[Node], list[int]]:
        """The operations that the equations are made of, their operands by their
        numbers in this list, and the numbers (m,) of the equations in it."""
        numbers = {slot: number for number, slot in enumerate(self._needed)}
        nodes = []
        for _, (operation, left, right, constant) in self._program:
            if operation > Operation.CONSTANT:
                left = numbers[left]
            right = numbers[right] if operation in BINARY else 0
            nodes.append(Node(operation, left, right, constant))
        return nodes, [numbers[slot] for slot in self.outputs.tolist()]

    def in_units(
        self, origin: np.ndarray, sizes: np.ndarray, weights: np.ndarray
    ) -> Tape:
        """The tape of ``weights`` (m,) times F at ``origin`` + ``sizes`` v, both (n,),
        in the unknowns v."""
        writer = TapeWriter(self.n)
        unknowns = []
        for number, (start, size) in enumerate(zip(origin, sizes, strict=True)):
            factor, shift = writer.constant(float(size)), writer.constant(float(start))
            scaled = writer.multiply(writer.unknown(number), factor)
            unknowns.append(writer.add(scaled, shift))
        slots = self.write_on(writer, unknowns)
        outputs = []
        for slot, weight in zip(self.outputs.tolist(), weights, strict=True):
            factor = writer.constant(float(weight))
            outputs.append(writer.multiply(slots[slot], factor))
        return writer.tape(outputs)

    def write_on(
        self,
        writer: TapeWriter,
        unknowns: Sequence[int] | None = None,
        values: Mapping[int, float] | None = None,
    ) -> dict[int, int]:
        """Write the equations on another tape, in terms of its slots ``unknowns`` (n,)
        or else its unknowns, and with ``values`` for what stands in some slots; where
        each slot of this one stands there."""
        slots: dict[int, int] = {}
        for slot, (operation, left, right, constant) in self._program:
            if values is not None and slot in values:
                slots[slot] = writer.constant(values[slot])
                continue
            if operation is Operation.UNKNOWN and unknowns is not None:
                slots[slot] = unknowns[left]
                continue
            first = slots[left] if operation > Operation.CONSTANT else left
            second = slots[right] if operation in BINARY else right
            node = Node(operation, first, second, constant)
            slots[slot] = writer.copy(_with_one_shift(node, writer))
        return slots


def _with_one_shift(node: Node, writer: TapeWriter) -> Node:
    """A node, or if it shifts what was shifted before, one shift by the sum, where that
    is exact: about an origin of its own a function then keeps its digits."""
    if node.operation is not Operation.SHIFT:
        return node
    before = writer.node(node.left)
    if before.operation is not Operation.SHIFT:
        return node
    total = before.constant + node.constant
    virtual = total - before.constant
    lost = (before.constant - (total - virtual)) + (node.constant - virtual)  # Knuth
    if lost != 0.0:
        return node
    return Node(Operation.SHIFT, before.left, before.right, total)


BINARY = {
    Operation.ADD: operator.add,
    Operation.SUBTRACT: operator.sub,
    Operation.MULTIPLY: operator.mul,
    Operation.DIVIDE: operator.truediv,
    Operation.ANGLE: None,
}
_WITH_CONSTANT: Mapping[Operation, Callable[[Any, Any], Any]] = {
    Operation.SHIFT: operator.add,
    Operation.SCALE: operator.mul,
    Operation.OVER: operator.truediv,
    Operation.POWER: operator.pow,
}


def real_values(values: Sequence[Any]) -> list[Any]:
    """The values (m,) of equations over mpmath numbers, in which powers and logarithms of
    negative numbers are complex. Raises `ValueError` where one is, or is no number."""
    import mpmath  # it takes long to import

    for value in values:
        if isinstance(value, mpmath.mpc) or not mpmath.isfinite(value):
            raise ValueError("F is no real number there")
    return list(values)


def _binary(operation: Operation, library: Any) -> Callable[[Any, Any], Any]:
    function = BINARY[operation]
    return library.atan2 if function is None else function


# --- writing --------------------------------------------------------------------------


class TapeWriter:
    """A tape while it is written, of at most ``longest`` operations. Every method returns
    the slot of its result."""

    def __init__(self, n: int, longest: float = LONGEST):
        self.n = n
        self.longest = longest
        self._nodes: list[Node] = []
        self._rules: dict[int, int] = {}
        self._slots: dict[Node, int] = {}
        self._dropped: set[int] = (
            set()
        )  # multiplied by 0, raised to the power 0, or less itself

    def tape(self, outputs: Sequence[int]) -> Tape:
        """The tape whose equations stand in the slots ``outputs``."""
        slot = 0
        while slot < len(self._nodes):  # rules may need rules
            self.rule(slot)
            slot += 1
        rules = [self._rules[slot] for slot in range(len(self._nodes))]
        operands = [
            (node.left, node.right, rule)
            for node, rule in zip(self._nodes, rules, strict=True)
        ]
        return Tape(
            self.n,
            np.array([node.operation for node in self._nodes], dtype=np.int64),
            np.array(operands, dtype=np.int64),
            np.array([node.constant for node in self._nodes]),
            np.array(outputs, dtype=np.int64),
        )

    def where_all_is_defined(self, outputs: Sequence[int]) -> list[int]:
        """The slots ``outputs`` of equations that are defined only where all that was
        written is: 0 log(x) is 0 for positive x only.

        What was multiplied by 0 and stands in no equation is added to the first one, as
        a difference from itself.
        """
        present = set(self.needed_for(*outputs))
        first = outputs[0]
        for slot in reversed(self.needed_for(*self._dropped)):
            if slot in present or self._nodes[slot].operation not in PARTIAL:
                continue
            present.update(self.needed_for(slot))
            zero = self._slot(Node(Operation.SUBTRACT, slot, slot))
            first = self.add(first, self._scaled(zero, NOTHING))
        return [first, *outputs[1:]]

    # --- leaves -----------------------------------------------------------------------

    def unknown(self, number: int) -> int:
        """Unknown ``number`` of n."""
        return self._slot(Node(Operation.UNKNOWN, number))

    def constant(self, value: float) -> int:
        """A number."""
        return self._slot(Node(Operation.CONSTANT, constant=value))

    def node(self, slot: int) -> Node:
        """What a slot holds."""
        return self._nodes[slot]

    def rule(self, slot: int) -> int:
        """The slot of the rule for the derivatives of a function."""
        if slot not in self._rules:
            self._write_rule(slot)
        return self._rules[slot]

    def needed_for(self, *slots: int) -> list[int]:
        """The slots that some are made of, and themselves, operands first."""
        needed = set(slots)
        for earlier in range(max(slots, default=-1), -1, -1):
            node = self._nodes[earlier]
            if earlier not in needed or node.operation <= Operation.CONSTANT:
                continue
            needed.add(node.left)
            if node.operation in BINARY:
                needed.add(node.right)
        return sorted(needed)

    def copy(self, node: Node) -> int:
        """An operation of another tape, on slots of this one."""
        return self._slot(node)

    def value(self, slot: int) -> float | None:
        """The number that a slot holds; None where it depends on the unknowns."""
        node = self._nodes[slot]
        return node.constant if node.operation is Operation.CONSTANT else None

    # --- arithmetic -------------------------------------------------------------------

    def add(self, left: int, right: int) -> int:
        """left + right."""
        a, b = self.value(left), self.value(right)
        if a is not None and b is not None:
            return self.constant(a + b)
        if a is not None:
            return self._shifted(right, a)
        if b is not None:
            return self._shifted(left, b)
        for operand, other in ((right, left), (left, right)):
            node = self._nodes[operand]
            if node.operation is Operation.SCALE and node.constant == -1.0:
                return self.subtract(other, node.left)
        return self._slot(Node(Operation.ADD, *sorted((left, right))))

    def subtract(self, left: int, right: int) -> int:
        """left - right."""
        a, b = self.value(left), self.value(right)
        if a is not None and b is not None:
            return self.constant(a - b)
        if a is not None:
            return self._shifted(self._scaled(right, -1.0), a)
        if b is not None:
            return self._shifted(left, -b)
        if left == right:
            self._dropped.add(left)
            return self.constant(0.0)
        return self._slot(Node(Operation.SUBTRACT, left, right))

    def multiply(self, left: int, right: int) -> int:
        """left * right."""
        a, b = self.value(left), self.value(right)
        if a is not None and b is not None:
            return self.constant(a * b)
        if a is not None:
            return self._scaled(right, a)
        if b is not None:
            return self._scaled(left, b)
        return self._slot(Node(Operation.MULTIPLY, *sorted((left, right))))

    def divide(self, left: int, right: int) -> int:
        """left / right."""
        a, b = self.value(left), self.value(right)
        if a is not None and b is not None:
            with np.errstate(all="ignore"):
                return self.constant(float(np.divide(a, b)))
        if b is not None:
            return left if b == 1.0 else self._slot(Node(Operation.OVER, left, 0, b))
        return self._slot(Node(Operation.DIVIDE, left, right))

    def negative(self, operand: int) -> int:
        """-operand."""
        return self.multiply(operand, self.constant(-1.0))

    def power(self, base: int, exponent: int) -> int:
        """base ** exponent; the base of an exponent that depends on the unknowns has to
        be positive where that is evaluated."""
        a, b = self.value(base), self.value(exponent)
        if a is not None and b is not None:
            with np.errstate(all="ignore"):
                return self.constant(float(np.float64(a) ** b))
        if b is None:
            if a is not None:
                logarithm_of_base = math.log(a) if a > 0.0 else math.nan
                scaled = self.multiply(exponent, self.constant(logarithm_of_base))
                return self.apply(Operation.EXP, scaled)
            logarithm = self.apply(Operation.LOG, base)
            return self.apply(Operation.EXP, self.multiply(exponent, logarithm))
        if b == 0.5:
            return self.apply(Operation.SQRT, base)
        if b.is_integer() and abs(b) <= LARGEST_POWER:
            return self._whole_power(base, int(b))
        return self._slot(Node(Operation.POWER, base, 0, b))

    def _whole_power(self, base: int, exponent: int) -> int:
        """By squares and products, which are defined and smooth at 0 as well."""
        if exponent < 0:
            one = self.constant(1.0)
            return self.divide(one, self._whole_power(base, -exponent))
        if exponent == 0:
            self._dropped.add(base)
            return self.constant(1.0)
        half = self._whole_power(base, exponent // 2)
        square = self.multiply(half, half) if exponent > 1 else half
        return self.multiply(square, base) if exponent % 2 else square

    def _shifted(self, operand: int, constant: float) -> int:
        if constant == 0.0:
            return operand
        return self._slot(Node(Operation.SHIFT, operand, 0, constant))

    def _scaled(self, operand: int, factor: float) -> int:
        if factor == 0.0:
            self._dropped.add(operand)
            return self.constant(0.0)
        if factor == 1.0:
            return operand
        return self._slot(Node(Operation.SCALE, operand, 0, factor))

    # --- functions --------------------------------------------------------------------

    def apply(self, operation: Operation, operand: int) -> int:
        """A function of one number."""
        value = self.value(operand)
        if value is not None:
            with np.errstate(all="ignore"):
                return self.constant(float(IN_DOUBLES[operation](value)))
        return self._slot(Node(operation, operand))

    def angle(self, y: int, x: int) -> int:
        """The angle of the vector (x, y): atan2(y, x)."""
        a, b = self.value(y), self.value(x)
        if a is not None and b is not None:
            return self.constant(float(np.arctan2(a, b)))
        return self._slot(Node(Operation.ANGLE, y, x))

    def _slot(self, node: Node) -> int:
        slot = self._slots.get(node)
        if slot is None:
            slot = len(self._nodes)
            if slot >= self.longest:
                raise TooLong
            self._slots[node] = slot
            self._nodes.append(node)
        return slot

    # --- rules ------------------------------------------------------------------------

    def _write_rule(self, slot: int) -> None:
        """Write what the derivatives of a slot y = f(x) are made of: w with y' = w x'
        or r with r y' = x'."""
        node = self._nodes[slot]
        rule = _RULES.get(node.operation)
        self._rules[slot] = 0 if rule is None else rule(self, slot, node)

    def _square(self, operand: int) -> int:
        return self.multiply(operand, operand)

    def _rule_of_power(self, slot: int, node: Node) -> int:
        return self._scaled(self.divide(slot, node.left), node.constant)

    def _rule_of_angle(self, slot: int, node: Node) -> int:
        return self.add(self._square(node.left), self._square(node.right))

    def _one_plus_square(self, operand: int) -> int:
        return self._shifted(self._square(operand), 1.0)

    def _one_minus_square(self, operand: int) -> int:
        return self._shifted(self._scaled(self._square(operand), -1.0), 1.0)

    def _root(self, operand: int) -> int:
        return self.apply(Operation.SQRT, operand)


Rule = Callable[[TapeWriter, int, Node], int]

_RULES: dict[Operation, Rule] = {
    # y' = w x'
    Operation.POWER: TapeWriter._rule_of_power,
    Operation.EXP: lambda t, y, node: y,
    Operation.EXPM1: lambda t, y, node: t._shifted(y, 1.0),
    Operation.SIN: lambda t, y, node: t.apply(Operation.COS, node.left),
    Operation.COS: lambda t, y, node: t._scaled(
        t.apply(Operation.SIN, node.left), -1.0
    ),
    Operation.TAN: lambda t, y, node: t._one_plus_square(y),
    Operation.SINH: lambda t, y, node: t.apply(Operation.COSH, node.left),
    Operation.COSH: lambda t, y, node: t.apply(Operation.SINH, node.left),
    Operation.TANH: lambda t, y, node: t._one_minus_square(y),
    # r y' = x'
    Operation.LOG: lambda t, y, node: node.left,
    Operation.LOG1P: lambda t, y, node: t._shifted(node.left, 1.0),
    Operation.SQRT: lambda t, y, node: t._scaled(y, 2.0),
    Operation.CBRT: lambda t, y, node: t._scaled(t._square(y), 3.0),
    Operation.ASIN: lambda t, y, node: t._root(t._one_minus_square(node.left)),
    Operation.ACOS: lambda t, y, node: t._scaled(
        t._root(t._one_minus_square(node.left)), -1.0
    ),
    Operation.ATAN: lambda t, y, node: t._one_plus_square(node.left),
    Operation.ASINH: lambda t, y, node: t._root(t._one_plus_square(node.left)),
    Operation.ACOSH: lambda t, y, node: t._root(t._shifted(t._square(node.left), -1.0)),
    Operation.ATANH: lambda t, y, node: t._one_minus_square(node.left),
    Operation.ANGLE: TapeWriter._rule_of_angle,
}


DIGITS = 40
DRAWS = 8  # times that all constants are moved, each up or down at random
MOST = 4.0  # times the largest change that is seen is the largest one there is
DYADIC = 2.0**20  # times a number is whole where it is meant as it stands


def rounding_of_constants(tape: Tape, point: np.ndarray) -> np.ndarray:
    """How far off the equations (m,) of a tape are at a point (n,) where each of its
    constants is off by the last bit; whole numbers and short binary fractions are not.

    Raises `ValueError` where an equation is not real.
    """
    is_rounded = tape.constants * DYADIC % 1 != 0
    if not is_rounded.any():
        return np.zeros(tape.m)
    import mpmath  # it takes long to import

    rng = np.random.default_rng(0)
    largest = np.zeros(tape.m)
    with mpmath.workdps(DIGITS):
        unknowns = [mpmath.mpf(float(x)) for x in point]
        plain = tape.over(unknowns, mpmath)
        for _ in range(DRAWS):
            ends = rng.choice([-np.inf, np.inf], len(tape.constants))
            moved = np.nextafter(tape.constants, ends)
            constants = np.where(is_rounded, moved, tape.constants)
            other = Tape(
                tape.n, tape.operations, tape.operands, constants, tape.outputs
            )
            values = other.over(unknowns, mpmath)
            pairs = zip(values, plain, strict=True)
            changes = [float(abs(value - before)) for value, before in pairs]
            largest = np.maximum(largest, changes)
    return MOST * largest
