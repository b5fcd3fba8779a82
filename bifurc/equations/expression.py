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
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from bifurc.equations.program import CONSTANTS, NEGATIVE, SIGNS, Program, Step
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


_OF_ONE = (
    *("sin", "cos", "tan", "asin", "acos", "atan"),
    *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
    *("exp", "log", "sqrt"),
)
_SYNONYMS = {
    "ln": "log",
    **{f"arc{name[1:]}": name for name in _OF_ONE if name.startswith("a")},
}
_IN_DOUBLES: dict[str, Callable[..., float]] = {
    **{name: getattr(math, name) for name in (*_OF_ONE, "atan2")},
    **SIGNS,
    "^": math.pow,
}

FUNCTION_NAMES = tuple(sorted((*_OF_ONE, *_SYNONYMS, "atan2")))
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


class Part(NamedTuple):
    """An expression or a part of one: its ``place`` in a program, its ``value`` where it
    is a constant, and of how many numbers, symbols and operations it is made."""

    place: int
    value: float | None = None
    size: int = 1


class _Token(NamedTuple):
    """A piece of a text: its ``kind`` (a group of `TOKEN`, or "end") and its column."""

    kind: str
    text: str
    column: int


def parse_expression(text: str, symbols: Mapping[str, Part], program: Program) -> Part:
    """What a text in the known ``symbols`` says, written on their ``program``; decimals
    are exact.

    Raises `ExpressionError` that says what cannot be read, and at which column; of a
    name that is not known the nearest one.
    """
    if len(text) > LONGEST_TEXT:
        reason = f"it has {len(text)} characters; the most are {LONGEST_TEXT}"
        raise ExpressionError(reason)
    reader = _Reader(_tokens(text.translate(SYNONYMS)), symbols, program)
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

    def __init__(
        self, tokens: list[_Token], symbols: Mapping[str, Part], program: Program
    ):
        self._tokens = tokens
        self._symbols = symbols
        self._program = program
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
            left = self._combined(sign.text, sign, left, self._product())
        self._depth -= 1
        return left

    def _product(self) -> Part:
        left = self._signed()
        while self._next.text in ("*", "/"):
            sign = self._take()
            left = self._combined(sign.text, sign, left, self._signed())
        return left

    def _signed(self) -> Part:
        self._go_down()
        if self._next.text in ("+", "-"):
            sign = self._take()
            part = self._signed()
            if sign.text == "-":
                part = self._combined(NEGATIVE, sign, part)
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
        if value is None and base.value is not None and base.value <= 0.0:
            raise ExpressionError(
                f"{sign.text} at column {sign.column} raises {base.value:g} to an unknown; "
                "what is raised to an unknown must be positive"
            )
        return self._combined("^", sign, base, exponent)

    def _atom(self) -> Part:
        token = self._take()
        if token.kind == "number":
            return self._number(token)
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
        if name.text not in FUNCTION_NAMES:
            raise self._no_function(name)
        bracket = self._take()
        arguments = [self._sum()]
        while self._next.text == ",":
            self._take()
            arguments.append(self._sum())
        self._expect(")", bracket)
        function = _SYNONYMS.get(name.text, name.text)
        right_number = 2 if function == "atan2" else 1
        if len(arguments) != right_number:
            raise ExpressionError(
                f"{name.text} at column {name.column} has {len(arguments)} arguments; "
                f"it must have {right_number}"
            )
        return self._combined(function, name, *arguments)

    def _symbol(self, name: _Token) -> Part:
        if name.text in self._symbols:
            return self._symbols[name.text]
        if name.text in CONSTANTS:
            return Part(self._program.place(Step(name.text)), CONSTANTS[name.text])
        raise self._no_symbol(name)

    def _number(self, token: _Token) -> Part:
        value = _value_of(token)
        number = Fraction(token.text) if value else Fraction(0)
        return Part(self._program.place(Step(number=number)), value)

    def _combined(self, function: str, token: _Token, *parts: Part) -> Part:
        """What a sign or a function makes of some parts; its value comes first, so that
        no constant grows beyond bounds."""
        places = tuple(part.place for part in parts)
        step = Step(function, places)
        values = [part.value for part in parts if part.value is not None]
        value = None
        if len(values) == len(parts):
            value = _value(_IN_DOUBLES[function], token, values)
            number = self._exact(function, token, places)
            if number is not None:
                step, value = Step(number=number), float(number)
        elif function == "/" and parts[1].value == 0.0:
            reason = "gives no real number: below it is 0"
            raise ExpressionError(f"/ at column {token.column} {reason}")
        size = 1 + sum(part.size for part in parts)
        if size > LARGEST:
            reason = (
                f"it is made of more than {LARGEST} operations with its definitions"
            )
            raise ExpressionError(reason)
        return Part(self._program.place(step), value, size)

    def _exact(
        self, function: str, token: _Token, places: Sequence[int]
    ) -> Fraction | None:
        """What a sign makes of rational numbers; None where it is not rational, or they
        are not. Raises `ExpressionError` for a power of too many digits."""
        numbers = []
        for place in places:
            number = self._program.steps[place].number
            if number is None:
                return None
            numbers.append(number)
        if function == "^":
            return _power(token, *numbers)
        if function in SIGNS:
            return Fraction(SIGNS[function](*numbers))
        return None

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
        if name.text in FUNCTION_NAMES:
            return ExpressionError(f"{place} is a function; write {name.text}(...)")
        hint = _nearest(name.text, [*self._symbols, *CONSTANTS])
        return ExpressionError(f"there is no symbol {place}{hint}")


def _nearest(name: str, names: Iterable[str]) -> str:
    """A hint at the nearest of the ``names``, or at all of them where they are few."""
    known = list(names)
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    if near:
        return f"; the nearest is {near[0]!r}"
    return f"; known are {', '.join(known)}" if len(known) <= 20 else ""


# --- arithmetic -----------------------------------------------------------------------


def _value_of(token: _Token) -> float:
    """The number that is written; raises `ExpressionError` where no double is near it."""
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
    return value


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


def _power(token: _Token, base: Fraction, exponent: Fraction) -> Fraction | None:
    """A power of rational numbers, None where it is not rational, as a rule; raises
    `ExpressionError` where it has too many digits."""
    bits = base.numerator.bit_length() + base.denominator.bit_length()
    if bits * abs(exponent) > MOST_BITS:
        reason = f"the power at column {token.column} is a number of too many digits"
        raise ExpressionError(reason)
    if exponent.denominator > 1:
        return None
    return base**exponent.numerator
