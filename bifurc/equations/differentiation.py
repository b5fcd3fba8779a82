"""Derivatives of recorded equations as further equations on a tape."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.equations.tape import Node, Operation, Tape, TapeWriter


def with_gradients(tape: Tape, rows: Sequence[int]) -> Tape:
    """The tape with, for every one of the ``rows``, its n partial derivatives as
    further equations, after those that it has."""
    writer = TapeWriter(tape.n)
    slots = tape.write_on(writer)
    outputs = [slots[slot] for slot in tape.outputs.tolist()]
    gradients = _Gradients(writer)
    for row in rows:
        outputs += [gradients.of(outputs[row], j) for j in range(tape.n)]
    return writer.tape(outputs)


def with_null_vectors(tape: Tape, n: int, basis: np.ndarray) -> Tape:
    """The equations of a point where F' loses rank: F(u, p) = 0 (m equations), F_u V = 0
    (m k) and V'V = I, with the skew part of B'V = 0 (k^2), for a ``basis`` B (n, k).

    The unknowns of the ``tape`` are u (n,) and then p; those of the result are u, p and
    the entries of V, column by column. Of all bases V of one null space the last equations
    leave the one that is turned against B by as little as can be, and its opposite.
    """
    n_vectors = basis.shape[1]
    writer = TapeWriter(tape.n + n * n_vectors)
    slots = tape.write_on(writer)
    outputs = [slots[slot] for slot in tape.outputs.tolist()]
    vectors = [
        [writer.unknown(tape.n + n * column + row) for row in range(n)]
        for column in range(n_vectors)
    ]
    gradients = _Gradients(writer)
    rows = [[gradients.of(output, j) for j in range(n)] for output in outputs]
    outputs += [_dot(writer, row, vector) for vector in vectors for row in rows]
    return writer.tape(outputs + _turned_least(writer, vectors, basis))


def _turned_least(
    writer: TapeWriter, vectors: Sequence[Sequence[int]], basis: np.ndarray
) -> list[int]:
    """The slots of V'V - I, below the diagonal and on it, and of the skew part of B'V,
    for vectors V (k, n) by their slots and a ``basis`` B (n, k)."""
    fixed = [[writer.constant(float(b)) for b in column] for column in basis.T]
    outputs = []
    for i, one in enumerate(vectors):
        for j, other in enumerate(vectors[:i]):
            outputs.append(_dot(writer, one, other))
            first, second = _dot(writer, fixed[i], other), _dot(writer, fixed[j], one)
            outputs.append(writer.subtract(first, second))
        outputs.append(writer.add(_dot(writer, one, one), writer.constant(-1.0)))
    return outputs


def _dot(writer: TapeWriter, one: Sequence[int], other: Sequence[int]) -> int:
    """The slot of the sum of the products of slots."""
    total = writer.constant(0.0)
    for a, b in zip(one, other, strict=True):
        total = writer.add(total, writer.multiply(a, b))
    return total


class _Gradients:
    """Partial derivatives while they are written on a tape, each once."""

    def __init__(self, writer: TapeWriter):
        self._writer = writer
        self._known: dict[tuple[int, int], int] = {}

    def of(self, slot: int, unknown: int) -> int:
        """The slot of the derivative of a ``slot`` by an ``unknown``."""
        # operands stand before what is made of them: no recursion, however long it is
        for earlier in self._writer.needed_for(slot):
            key = (earlier, unknown)
            if key not in self._known:
                self._known[key] = self._written(earlier, unknown)
        return self._known[slot, unknown]

    def _written(self, slot: int, unknown: int) -> int:
        writer = self._writer
        node = writer.node(slot)
        operation = node.operation
        if operation is Operation.UNKNOWN:
            return writer.constant(1.0 if node.left == unknown else 0.0)
        if operation is Operation.CONSTANT:
            return writer.constant(0.0)
        left = self._known[node.left, unknown]
        if operation in _LINEAR:
            return self._of_linear(node, left)
        if operation in _OF_TWO:
            return self._of_two(slot, node, left, self._known[node.right, unknown])
        rule = writer.rule(slot)
        if operation in _RECIPROCAL:
            return writer.divide(left, rule)
        return writer.multiply(rule, left)

    def _of_linear(self, node: Node, left: int) -> int:
        if node.operation is Operation.SHIFT:
            return left
        factor = self._writer.constant(node.constant)
        if node.operation is Operation.SCALE:
            return self._writer.multiply(left, factor)
        return self._writer.divide(left, factor)

    def _of_two(self, slot: int, node: Node, left: int, right: int) -> int:
        writer = self._writer
        operation = node.operation
        if operation is Operation.ADD:
            return writer.add(left, right)
        if operation is Operation.SUBTRACT:
            return writer.subtract(left, right)
        if operation is Operation.MULTIPLY:
            first = writer.multiply(left, node.right)
            return writer.add(first, writer.multiply(node.left, right))
        if operation is Operation.DIVIDE:
            above = writer.subtract(left, writer.multiply(slot, right))
            return writer.divide(above, node.right)
        # the angle of (x, y), with y on the left
        first = writer.multiply(node.right, left)
        above = writer.subtract(first, writer.multiply(node.left, right))
        return writer.divide(above, writer.rule(slot))


_LINEAR = (Operation.SHIFT, Operation.SCALE, Operation.OVER)
_OF_TWO = (
    Operation.ADD,
    Operation.SUBTRACT,
    Operation.MULTIPLY,
    Operation.DIVIDE,
    Operation.ANGLE,
)
# y' = x' over the rule; of all other functions it is the rule times x'
_RECIPROCAL = (
    Operation.LOG,
    Operation.LOG1P,
    Operation.SQRT,
    Operation.CBRT,
    Operation.ASIN,
    Operation.ACOS,
    Operation.ATAN,
    Operation.ASINH,
    Operation.ACOSH,
    Operation.ATANH,
)
