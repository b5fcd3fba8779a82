"""Problems from sympy expressions: the same tape, without a callable."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import sympy

from bifurc.equations.expression_problem import FirstOutput, TapeProblem
from bifurc.equations.tape import (
    FUNCTIONS,
    Operation,
    Tape,
    TapeWriter,
    TooLong,
    real_values,
)
from bifurc.errors import ProblemError

if TYPE_CHECKING:
    import mpmath

    from bifurc.checks import UnknownName
    from bifurc.function_problem import Bounds
    from bifurc.system import PreciseResidual

# of one number, by their names in sympy
_RECIPROCALS = {
    "sec": Operation.COS,
    "csc": Operation.SIN,
    "cot": Operation.TAN,
    "sech": Operation.COSH,
    "csch": Operation.SINH,
    "coth": Operation.TANH,
}


class SymbolicProblem(TapeProblem):
    """The problem that sympy ``expressions`` in the ``unknowns`` are zero.

    An expression may be an equation `sympy.Eq`. ``bounds`` (n, 2) and ``periods`` (n,)
    are in the order of the unknowns, or by these, as for `FunctionProblem`. At high precision the
    numbers in the expressions are exact: a third is a third. Raises `ProblemError` that
    names the expression and the symbol or the function which cannot be used.

    >>> import bifurc, sympy
    >>> x, p = sympy.symbols("x p")
    >>> bounds = {x: (-3, 3), p: (-3, 3)}
    >>> problem = bifurc.SymbolicProblem([sympy.Eq(x**2 + p**2, 4)], [x, p], bounds)
    >>> atlas = bifurc.explore(problem, parameter=p)
    >>> sorted(fold.u[1].round(12).item() for fold in atlas.diagram.folds)
    [-2.0, 2.0]
    """

    has_exact_constants = True

    def __init__(
        self,
        expressions: Sequence[Any],
        unknowns: Sequence[sympy.Symbol],
        bounds: Bounds,
        *,
        periods: Sequence[float] | Mapping[UnknownName, float] | None = None,
        units: Sequence[str] | Mapping[UnknownName, str] | None = None,
    ):
        self.unknowns = _checked_unknowns(unknowns)
        labelled = {f"expressions[{i}]": one for i, one in enumerate(expressions)}
        checked = {
            label: _checked_expression(label, one, self.unknowns)
            for label, one in labelled.items()
        }
        self.expressions = list(checked.values())
        if not self.expressions:
            raise ProblemError("expressions", "[]", "one expression or more")
        names = [symbol.name for symbol in self.unknowns]
        if len(bounds) != len(names):
            raise ProblemError("number of bounds", len(bounds), f"{len(names)}")
        tape = _tape_of(checked, self.unknowns)
        super().__init__(tape, bounds, names=names, units=units, periods=periods)

    def precise_residual(self) -> PreciseResidual:
        """F over mpmath numbers, to whatever precision is set; it raises `ValueError`
        where it is not real."""
        function = sympy.lambdify([self.unknowns], self.expressions, modules="mpmath")

        def residual(unknowns: Sequence[mpmath.mpf]) -> list[mpmath.mpf]:
            return real_values(function(unknowns))

        return residual


def function_of(expression: object, label: str, names: Sequence[str]) -> FirstOutput:
    """A sympy ``expression``, or what the left of a `sympy.Eq` is more than the right, as a
    function of the unknowns (n,) with these ``names``; raises `ProblemError`, in which it
    is called ``label``."""
    symbols = {
        symbol.name: symbol for symbol in getattr(expression, "free_symbols", ())
    }
    unknowns = [symbols.get(name, sympy.Symbol(name)) for name in names]
    checked = _checked_expression(label, expression, unknowns)
    return FirstOutput(_tape_of({label: checked}, unknowns))


# --- checks ---------------------------------------------------------------------------


def _checked_unknowns(unknowns: Sequence[sympy.Symbol]) -> list[sympy.Symbol]:
    """The unknowns as a list of different symbols."""
    symbols = list(unknowns)
    for i, symbol in enumerate(symbols):
        if not isinstance(symbol, sympy.Symbol):
            raise ProblemError(f"unknowns[{i}]", repr(symbol), "a sympy Symbol")
        if symbol in symbols[:i]:
            raise ProblemError(f"unknowns[{i}]", symbol, "another than those before")
    if not symbols:
        raise ProblemError("unknowns", symbols, "one symbol or more")
    return symbols


def _checked_expression(
    label: str, given: object, unknowns: Sequence[sympy.Symbol]
) -> sympy.Expr:
    """What is to be zero, in the ``unknowns`` only; errors call it ``label``."""
    try:
        expression = sympy.sympify(given, strict=True)
    except sympy.SympifyError:
        raise ProblemError(label, repr(given), "a sympy expression") from None
    if isinstance(expression, sympy.Equality):
        expression = _difference(expression.lhs, expression.rhs)
    if not isinstance(expression, sympy.Expr):
        raise ProblemError(label, given, "an expression or Eq")
    foreign = sorted(expression.free_symbols - set(unknowns), key=str)
    if foreign:
        names = ", ".join(symbol.name for symbol in unknowns)
        allowed = f"in the unknowns {names} only; it holds the symbol {foreign[0]}"
        raise ProblemError(label, expression, allowed)
    return expression


def _difference(left: sympy.Expr, right: sympy.Expr) -> sympy.Expr:
    """left - right; what need not be defined everywhere is not cancelled."""
    if left.is_polynomial() and right.is_polynomial():
        return left - right
    return sympy.Add(left, sympy.Mul(-1, right, evaluate=False), evaluate=False)


# --- translation ----------------------------------------------------------------------


def _tape_of(
    expressions: Mapping[str, sympy.Expr], unknowns: Sequence[sympy.Symbol]
) -> Tape:
    """The tape of the expressions, by what errors call them; what they have in common is
    evaluated once."""
    translation = _Translation(unknowns)
    outputs = []
    for label, expression in expressions.items():
        try:
            outputs.append(translation.slot_of(expression))
        except _Untranslatable as error:
            allowed = f"of functions that can be evaluated; it holds {error}"
            raise ProblemError(label, expression, allowed) from None
        except TooLong:
            allowed = "of fewer operations"
            raise ProblemError(label, "too long", allowed) from None
    writer = translation.writer
    return writer.tape(writer.where_all_is_defined(outputs))


class _Untranslatable(Exception):
    """A part of an expression that no tape can hold."""


class _Translation:
    """Expressions while they are written on a tape. Parts that have been written are
    known: they are written once."""

    def __init__(self, unknowns: Sequence[sympy.Symbol]):
        self.writer = TapeWriter(len(unknowns))
        self._slots: dict[sympy.Basic, int] = {
            symbol: self.writer.unknown(i) for i, symbol in enumerate(unknowns)
        }

    def slot_of(self, expression: sympy.Basic) -> int:
        """The slot that holds an expression; raises `_Untranslatable`."""
        slot = self._slots.get(expression)
        if slot is None:
            slot = self._write(expression)
            self._slots[expression] = slot
        return slot

    def _write(self, expression: sympy.Basic) -> int:
        if expression.is_number:
            return self._constant(expression)
        if expression.is_Add:
            return self._folded(self.writer.add, expression.args)
        if expression.is_Mul:
            return self._product(expression)
        if expression.is_Pow:
            base, exponent = expression.as_base_exp()
            return self.writer.power(self.slot_of(base), self.slot_of(exponent))
        return self._function(expression)

    def _constant(self, number: sympy.Basic) -> int:
        value = sympy.N(number, 30)
        if not value.is_Float and not value.is_Integer:
            raise _Untranslatable(f"the number {number}, which is not real")
        return self.writer.constant(float(value))

    def _folded(
        self, write: Callable[[int, int], int], parts: Sequence[sympy.Basic]
    ) -> int:
        slot = self.slot_of(parts[0])
        for part in parts[1:]:
            slot = write(slot, self.slot_of(part))
        return slot

    def _product(self, product: sympy.Basic) -> int:
        """A product as it is written: what stands above and below is not cancelled."""
        number = sympy.Integer(1)
        above, below = [], []
        for factor in product.args:
            if factor.is_Number:
                number *= factor
            elif factor.is_Pow and factor.exp.is_Number and factor.exp.is_negative:
                below.append(_reciprocal(factor))
            else:
                above.append(factor)
        slot = self._folded(self.writer.multiply, above or [sympy.Integer(1)])
        if below:
            divisor = self._folded(self.writer.multiply, below)
            slot = self.writer.divide(slot, divisor)
        if number == 1:
            return slot
        return self.writer.multiply(slot, self._constant(number))

    def _function(self, expression: sympy.Basic) -> int:
        name = expression.func.__name__
        if name == "atan2":
            y, x = expression.args
            return self.writer.angle(self.slot_of(y), self.slot_of(x))
        is_reciprocal = name in _RECIPROCALS
        operation = _RECIPROCALS.get(name) or FUNCTIONS.get(name)
        if operation is None or len(expression.args) != 1:
            raise _Untranslatable(name)
        slot = self.writer.apply(operation, self.slot_of(expression.args[0]))
        if is_reciprocal:
            return self.writer.divide(self.writer.constant(1.0), slot)
        return slot


def _reciprocal(power: sympy.Pow) -> sympy.Expr:
    """One over a power with a negative exponent."""
    exponent = -power.exp
    if exponent == 1:
        return power.base
    return sympy.Pow(power.base, exponent, evaluate=False)
