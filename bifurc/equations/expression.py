"""Expressions in plain mathematical syntax, read without ever running anything.

A text is cut into numbers, names and signs, and read by precedence climbing (Richards
1979; Pratt 1973). What is not a known symbol or function is refused, and so is every
constant that leaves the range of doubles before it is computed.

    sum      = product {("+" | "-") product}
    product  = signed {("*" | "/") signed}
    signed   = ("+" | "-") signed | power
    power    = atom ["^" signed]
    atom     = number | name | name "(" sum {"," sum} ")" | "(" sum ")"
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import sympy

from bifurc.errors import BifurcError

LONGEST_TEXT = 20_000  # characters
LARGEST = 20_000  # numbers, symbols and operations, those of definitions written out
DEEPEST = 100  # brackets, signs and powers inside one another
LONGEST_NUMBER = 40  # characters
LARGEST_EXPONENT = 1000  # of a power with a constant exponent
MOST_BITS = 20_000  # of a power of two exact numbers

TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[^\W\d]\w*)"
    r"|(?P<sign>\*\*|[-+*/^(),]))"
)
# what texts from elsewhere have in the place of signs
SYNONYMS = str.maketrans({"−": "-", "·": "*", "×": "*", "\u00a0": " "})


class ExpressionError(BifurcError, ValueError):
    """A text that is no expression in the known symbols: what is wrong with it."""


class _Function(NamedTuple):
    """A function by its number of arguments, in sympy and in doubles; ``is_partial``:
    whether there are arguments for which it is not defined."""

    arguments: int
    symbolic: Callable[..., sympy.Expr]
    in_doubles: Callable[..., float]
    is_partial: bool


_OF_ONE = (
    *("sin", "cos", "tan", "asin", "acos", "atan"),
    *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
    *("exp", "log", "sqrt"),
)
_PARTIAL = {"tan", "asin", "acos", "acosh", "atanh", "log", "sqrt"}
_FUNCTIONS: dict[str, _Function] = {
    name: _Function(1, getattr(sympy, name), getattr(math, name), name in _PARTIAL)
    for name in _OF_ONE
}
_FUNCTIONS["atan2"] = _Function(2, sympy.atan2, math.atan2, True)
_FUNCTIONS["ln"] = _FUNCTIONS["log"]
for _name in ("sin", "cos", "tan", "sinh", "cosh", "tanh"):
    _FUNCTIONS[f"arc{_name}"] = _FUNCTIONS[f"a{_name}"]

FUNCTION_NAMES = tuple(sorted(_FUNCTIONS))
CONSTANTS = ("pi", "e")
WITHOUT_DERIVATIVE = {
    "abs": "has no derivative at 0; sqrt(x^2) is |x| where x is never 0",
    "sign": "has no derivative at 0",
    "floor": "jumps",
    "ceil": "jumps",
    "round": "jumps",
    "max": "has no derivative where its arguments are equal",
    "min": "has no derivative where its arguments are equal",
    "mod": "jumps; a period of an unknown makes it a circle",
}


@dataclass(frozen=True)
class Part:
    """An expression or a part of one, its ``value`` where it is a constant, and of how
    many numbers, symbols and operations it is made.

    SymPy simplifies an ``expression``, as sqrt(x)^2 to x, without regard to where it is
    defined. ``unsimplified`` is what the text says, None where that is defined
    everywhere.
    """

    expression: sympy.Expr
    value: float | None = None
    size: int = 1
    unsimplified: sympy.Expr | None = None

    @property
    def as_written(self) -> sympy.Expr:
        """The expression, defined where the text is."""
        return self.expression if self.unsimplified is None else self.unsimplified

    def minus(self, other: Part) -> Part:
        """The difference to another part, as for the two sides of an equation."""
        parts = (self, other)
        written = _unsimplified(_difference, parts, False)
        expression = self.expression - other.expression
        return Part(expression, None, self.size + other.size, written)


_CONSTANT_PARTS = {
    "pi": Part(sympy.pi, math.pi),
    "e": Part(sympy.E, math.e),
}


class _Token(NamedTuple):
    """A piece of a text: its ``kind`` (a group of `TOKEN`, or "end") and its column."""

    kind: str
    text: str
    column: int


def parse_expression(text: str, symbols: Mapping[str, Part]) -> Part:
    """What a text in the known ``symbols`` says; decimals are exact.

    Raises `ExpressionError` that says what cannot be read, and at which column; of a
    name that is not known the nearest one.
    """
    if len(text) > LONGEST_TEXT:
        reason = f"it has {len(text)} characters; the most are {LONGEST_TEXT}"
        raise ExpressionError(reason)
    reader = _Reader(_tokens(text.translate(SYNONYMS)), symbols)
    return reader.whole()


def _tokens(text: str) -> list[_Token]:
    tokens = []
    place = 0
    stripped = text.rstrip()
    while place < len(stripped):
        match = TOKEN.match(stripped, place)
        if match is None:
            rest = stripped[place:].lstrip()
            column = len(stripped) - len(rest) + 1
            raise ExpressionError(f"{rest[0]!r} at column {column} cannot be read")
        kind = str(match.lastgroup)
        tokens.append(_Token(kind, match[kind], match.start(kind) + 1))
        place = match.end()
    tokens.append(_Token("end", "the end", len(stripped) + 1))
    return tokens


class _Reader:
    """The tokens of a text while they are read, one after the other."""

    def __init__(self, tokens: list[_Token], symbols: Mapping[str, Part]):
        self._tokens = tokens
        self._symbols = symbols
        self._place = 0
        self._depth = 0

    # --- grammar ----------------------------------------------------------------------

    def whole(self) -> Part:
        """The expression that all tokens together are."""
        part = self._sum()
        if self._next.kind != "end":
            raise self._misplaced()
        return part

    def _sum(self) -> Part:
        self._go_down()
        left = self._product()
        while self._next.text in ("+", "-"):
            sign = self._take()
            right = self._product()
            if sign.text == "+":
                left = _combined(sympy.Add, lambda a, b: a + b, sign, left, right)
            else:
                left = _combined(_difference, lambda a, b: a - b, sign, left, right)
        self._depth -= 1
        return left

    def _product(self) -> Part:
        left = self._signed()
        while self._next.text in ("*", "/"):
            sign = self._take()
            right = self._signed()
            if sign.text == "*":
                left = _combined(sympy.Mul, lambda a, b: a * b, sign, left, right)
            else:
                is_partial = right.value is None
                left = _combined(
                    _quotient,
                    lambda a, b: a / b,
                    sign,
                    left,
                    right,
                    is_partial=is_partial,
                )
        return left

    def _signed(self) -> Part:
        self._go_down()
        if self._next.text in ("+", "-"):
            sign = self._take()
            part = self._signed()
            if sign.text == "-":
                part = _combined(_negative, lambda a: -a, sign, part)
        else:
            part = self._power()
        self._depth -= 1
        return part

    def _power(self) -> Part:
        base = self._atom()
        if self._next.text not in ("^", "**"):
            return base
        sign = self._take()
        exponent = self._signed()
        value = exponent.value
        if value is not None and abs(value) > LARGEST_EXPONENT:
            raise ExpressionError(
                f"the exponent {value:g} at column {sign.column + len(sign.text)} is "
                f"larger than {LARGEST_EXPONENT}"
            )
        if _bits_of_power(base.expression, exponent.expression) > MOST_BITS:
            reason = f"the power at column {sign.column} is a number of too many digits"
            raise ExpressionError(reason)
        is_partial = not _is_power_everywhere(base.value, value)
        return _combined(
            sympy.Pow, math.pow, sign, base, exponent, is_partial=is_partial
        )

    def _atom(self) -> Part:
        token = self._take()
        if token.kind == "number":
            return _number(token)
        if token.kind == "name":
            if self._next.text == "(":
                return self._call(token)
            return self._symbol(token)
        if token.text != "(":
            self._place -= 1
            raise self._misplaced()
        inner = self._sum()
        self._expect(")", token)
        return inner

    def _call(self, name: _Token) -> Part:
        function = _FUNCTIONS.get(name.text)
        if function is None:
            raise self._no_function(name)
        bracket = self._take()
        arguments = [self._sum()]
        while self._next.text == ",":
            self._take()
            arguments.append(self._sum())
        self._expect(")", bracket)
        if len(arguments) != function.arguments:
            raise ExpressionError(
                f"{name.text} at column {name.column} has {len(arguments)} arguments; "
                f"it must have {function.arguments}"
            )
        return _combined(
            function.symbolic,
            function.in_doubles,
            name,
            *arguments,
            is_partial=function.is_partial,
        )

    def _symbol(self, name: _Token) -> Part:
        part = self._symbols.get(name.text) or _CONSTANT_PARTS.get(name.text)
        if part is None:
            raise self._no_symbol(name)
        return part

    # --- tokens -----------------------------------------------------------------------

    @property
    def _next(self) -> _Token:
        return self._tokens[self._place]

    def _take(self) -> _Token:
        token = self._next
        self._place += 1
        return token

    def _expect(self, text: str, opening: _Token) -> None:
        if self._next.text != text:
            if self._next.kind == "end":
                reason = f"the bracket at column {opening.column} is not closed"
                raise ExpressionError(reason)
            raise self._misplaced()
        self._take()

    def _go_down(self) -> None:
        self._depth += 1
        if self._depth > DEEPEST:
            reason = f"more than {DEEPEST} brackets or signs stand inside one another"
            raise ExpressionError(reason)

    # --- errors -----------------------------------------------------------------------

    def _misplaced(self) -> ExpressionError:
        token = self._next
        before = self._tokens[self._place - 1] if self._place else None
        is_after_factor = before is not None and (
            before.kind in ("number", "name") or before.text == ")"
        )
        if is_after_factor and (token.kind in ("number", "name") or token.text == "("):
            assert before is not None
            return ExpressionError(
                f"an operator is missing at column {token.column}; write "
                f"{before.text}*{token.text}"
            )
        if token.kind == "end":
            return ExpressionError("something is missing at the end")
        reason = f"{token.text!r} at column {token.column} is out of place"
        return ExpressionError(reason)

    def _no_function(self, name: _Token) -> ExpressionError:
        place = f"{name.text!r} at column {name.column}"
        if name.text in self._symbols or name.text in CONSTANTS:
            return ExpressionError(f"{place} is no function; write {name.text}*(...)")
        if name.text.lower() in WITHOUT_DERIVATIVE:
            reason = WITHOUT_DERIVATIVE[name.text.lower()]
            return ExpressionError(f"{place} cannot be used: it {reason}")
        hint = _nearest(name.text, FUNCTION_NAMES)
        return ExpressionError(f"there is no function {place}{hint}")

    def _no_symbol(self, name: _Token) -> ExpressionError:
        place = f"{name.text!r} at column {name.column}"
        if name.text in _FUNCTIONS:
            return ExpressionError(f"{place} is a function; write {name.text}(...)")
        hint = _nearest(name.text, [*self._symbols, *CONSTANTS])
        return ExpressionError(f"there is no symbol {place}{hint}")


def _nearest(name: str, names: object) -> str:
    """A hint at the nearest of the ``names``, or at all of them where they are few."""
    known = [str(one) for one in names]  # type: ignore[attr-defined]
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    if near:
        return f"; the nearest is {near[0]!r}"
    return f"; known are {', '.join(known)}" if len(known) <= 20 else ""


# --- arithmetic -----------------------------------------------------------------------


def _number(token: _Token) -> Part:
    """A number, exact; raises `ExpressionError` where no double is near it."""
    value = float(token.text)
    is_zero = not any(
        digit in "123456789" for digit in token.text.lower().split("e")[0]
    )
    if len(token.text) > LONGEST_NUMBER:
        reason = f"the number at column {token.column} has more than {LONGEST_NUMBER}"
        raise ExpressionError(f"{reason} characters")
    if not math.isfinite(value) or (value == 0.0 and not is_zero):
        reason = (
            f"the number {token.text} at column {token.column} is outside the range"
        )
        raise ExpressionError(f"{reason} of doubles")
    expression = sympy.Integer(0) if is_zero else sympy.Rational(token.text)
    return Part(expression, value)


def _combined(
    symbolic: Callable[..., sympy.Expr],
    in_doubles: Callable[..., float],
    token: _Token,
    *parts: Part,
    is_partial: bool = False,
) -> Part:
    """What a function makes of some parts; its value comes first, so that no constant
    grows beyond bounds. ``is_partial``: whether it may not be defined."""
    values = [part.value for part in parts if part.value is not None]
    value = None
    if len(values) == len(parts):
        value = _value(in_doubles, token, values)
    size = 1 + sum(part.size for part in parts)
    if size > LARGEST:
        reason = f"it is made of more than {LARGEST} operations with its definitions"
        raise ExpressionError(reason)
    expression = symbolic(*(part.expression for part in parts))
    if expression.has(sympy.zoo, sympy.nan, sympy.oo, sympy.I):
        reason = f"{token.text} at column {token.column} gives no real number"
        raise ExpressionError(reason)
    if value is not None:
        return Part(expression, value, size)
    return Part(expression, value, size, _unsimplified(symbolic, parts, is_partial))


def _unsimplified(
    symbolic: Callable[..., sympy.Expr], parts: Sequence[Part], is_partial: bool
) -> sympy.Expr | None:
    """What a function makes of some parts, nothing cancelled; None where that is defined
    everywhere."""
    if not is_partial and all(part.unsimplified is None for part in parts):
        return None
    written: sympy.Expr = symbolic(*(part.as_written for part in parts), evaluate=False)
    first = parts[0].unsimplified
    if first is None or not (written.is_Add or written.is_Mul):
        return written
    if first.func is not written.func or written.args[0] is not first:
        return written
    # one long sum or product, not one inside the other; real numbers commute
    together = [*first.args, *written.args[1:]]
    return written.func._from_args(together, is_commutative=True)


def _is_power_everywhere(base: float | None, exponent: float | None) -> bool:
    """Whether a power is defined for all values of what is no constant (None)."""
    if exponent is None:
        return base is not None and base > 0.0
    return exponent >= 0.0 and exponent.is_integer()


def _value(
    in_doubles: Callable[..., float], token: _Token, values: list[float]
) -> float:
    """The value of a constant; raises `ExpressionError` where it is no real number."""
    try:
        value = in_doubles(*values)
    except (ValueError, ZeroDivisionError, OverflowError):
        value = math.nan
    if not isinstance(value, float | int) or not math.isfinite(value):
        shown = ", ".join(f"{one:g}" for one in values)
        reason = (
            f"{token.text} at column {token.column} gives no real number for {shown}"
        )
        raise ExpressionError(reason)
    return float(value)


def _bits_of_power(base: sympy.Expr, exponent: sympy.Expr) -> int:
    """How long an exact power of an exact number is, 0 for any other."""
    if not base.is_Rational or not exponent.is_Rational:
        return 0
    bits = int(base.p).bit_length() + int(base.q).bit_length()
    return int(bits * abs(exponent))


def _difference(a: sympy.Expr, b: sympy.Expr, *, evaluate: bool = True) -> sympy.Expr:
    return sympy.Add(a, _negative(b, evaluate=evaluate), evaluate=evaluate)


def _quotient(a: sympy.Expr, b: sympy.Expr, *, evaluate: bool = True) -> sympy.Expr:
    reciprocal = sympy.Pow(b, -1, evaluate=evaluate)
    return sympy.Mul(a, reciprocal, evaluate=evaluate)


def _negative(a: sympy.Expr, *, evaluate: bool = True) -> sympy.Expr:
    return sympy.Mul(-1, a, evaluate=evaluate)
