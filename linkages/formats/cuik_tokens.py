"""The words of a CUIK world file, and its expressions.

The grammar is that of the CUIK suite (Porta, Ros, Thomas and Torras 2014,
"The CUIK Suite"): keywords in capitals or not, comments of four kinds, and arithmetic in
which a sign binds closer than a power.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

from linkages.values import GeometryError, quoted, require

COMMENT = re.compile(r"/\*.*?\*/|%[^\n]*|#[^\n]*|//[^\n]*", re.DOTALL)
TOKEN = re.compile(
    r"(?P<section>\[\s*[A-Za-z_]{3,}\s*\](?=\s*(?:\n|$)))"
    r"|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<word>[A-Za-z][A-Za-z0-9_]*(?:::[A-Za-z][A-Za-z0-9_]*)*)"
    r'|(?P<text>"[^"\n]*")'
    r"|(?P<sign>:=|==|!=|<=|>=|[-+*/^()\[\],;:?<>])"
    r"|(?P<space>\s+)"
    r"|(?P<unknown>.)"
)
ONE_ARGUMENT: dict[str, Callable[[float], float]] = {
    name: getattr(math, name)
    for name in ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "sqrt")
}
ONE_ARGUMENT["cot"] = lambda angle: math.tan(math.pi / 2 - angle)
ONE_ARGUMENT["abs"] = abs
# what stands between two numbers, from what binds least
OPERATIONS: tuple[dict[str, Callable[[float, float], float]], ...] = (
    {
        "==": operator.eq,
        "!=": operator.ne,
        "<=": operator.le,
        ">=": operator.ge,
        "<": operator.lt,
        ">": operator.gt,
    },
    {"+": operator.add, "-": operator.sub},
    {"*": operator.mul, "/": operator.truediv},
    {"^": operator.pow},
)
END = "the end of the file"
DEEPEST = 100  # parentheses inside each other


@dataclass(frozen=True)
class Token:
    """A word of a file: its ``kind``, ``text`` and ``line``, from 1."""

    kind: str
    text: str
    line: int


def tokens_of(text: str) -> list[Token]:
    """The tokens of a file; raises `GeometryError` for a character that none begins
    with."""
    tokens = []
    line = 1
    bare = COMMENT.sub(lambda match: " " + "\n" * match.group().count("\n"), text)
    for match in TOKEN.finditer(bare):
        kind = str(match.lastgroup)
        word = match.group()
        allowed = "a name, a number or a sign of a world file"
        require(kind != "unknown", f"line {line}", quoted(word), allowed)
        if kind == "section":
            tokens.append(Token(kind, word.strip("[] \t").upper(), line))
        elif kind != "space":
            tokens.append(Token(kind, word, line))
        line += word.count("\n")
    return tokens


class Cursor:
    """A place in a list of ``tokens``, and the ``constants`` that stand before it."""

    def __init__(self, tokens: list[Token]):
        self.tokens = tokens
        self.place = 0
        self.constants: dict[str, float] = {}
        self._depth = 0

    @property
    def token(self) -> Token:
        """The token here."""
        if self.place < len(self.tokens):
            return self.tokens[self.place]
        line = self.tokens[-1].line if self.tokens else 1
        return Token("end", END, line)

    @property
    def is_at_section(self) -> bool:
        """Whether a section begins or the file ends here."""
        return self.token.kind in ("section", "end")

    def ahead(self, count: int) -> str:
        """The text of the token so many places further, empty behind the end."""
        place = self.place + count
        return self.tokens[place].text if place < len(self.tokens) else ""

    def next(self) -> Token:
        """The token here; the cursor goes on."""
        token = self.token
        self.place += 1
        return token

    def is_word(self, *words: str) -> bool:
        """Whether one of these keywords stands here."""
        return self.token.kind == "word" and self.token.text.lower() in words

    def take(self, text: str) -> bool:
        """Whether this sign or keyword stands here; the cursor goes on if it does."""
        if self.token.text.lower() != text:
            return False
        self.place += 1
        return True

    def expect(self, text: str) -> None:
        """Go on behind this sign; raises `GeometryError` where it does not stand
        here."""
        if not self.take(text):
            self.refuse(quoted(text))

    def name(self, what: str) -> str:
        """The name that stands here; raises `GeometryError`."""
        if self.token.kind != "word":
            self.refuse(what)
        return self.next().text

    def refuse(self, allowed: str) -> NoReturn:
        """Raise `GeometryError` for the token here."""
        token = self.token
        shown = token.text if token.kind in ("end", "text") else quoted(token.text)
        raise GeometryError(f"line {token.line}", shown, allowed)

    def numbers(self, count: int) -> list[float]:
        """So many numbers with commas between them."""
        numbers = [self.number()]
        while len(numbers) < count:
            self.expect(",")
            numbers.append(self.number())
        return numbers

    def row(self, brackets: str, count: int) -> list[float]:
        """So many numbers with commas between them, in these brackets."""
        self.expect(brackets[0])
        numbers = self.numbers(count)
        self.expect(brackets[1])
        return numbers

    # --- expressions ------------------------------------------------------------------

    def number(self) -> float:
        """The value of the expression that stands here; raises `GeometryError`."""
        line = self.token.line
        try:
            value = self._value()
        except (ArithmeticError, ValueError) as error:
            if isinstance(error, GeometryError):
                raise
            message = f"an expression without a value ({error})"
            raise GeometryError(f"line {line}", message, "a number") from None
        if isinstance(value, complex) or not math.isfinite(value):
            raise GeometryError(f"line {line}", value, "a finite number")
        return float(value)

    def _value(self, level: int = 0) -> float:
        """The value of operations that bind so much at least."""
        if level == len(OPERATIONS):
            return self._signed()
        value = self._value(level + 1)
        # "1+(0,1,0)" is a point and a vector, which `read_end` takes apart
        while self.token.text in OPERATIONS[level]:
            operate = OPERATIONS[level][self.next().text]
            value = operate(value, self._value(level + 1))
        return value

    def _signed(self) -> float:
        sign = 1.0
        while self.token.text in ("+", "-"):
            if self.next().text == "-":
                sign = -sign
        return sign * self._atom()

    def _atom(self) -> float:
        token = self.token
        if token.kind == "number":
            return float(self.next().text)
        if self.take("("):
            return self._in_parentheses()
        if token.kind != "word":
            self.refuse("a number, a constant or a function")
        word = token.text.lower()
        if token.text in self.constants:
            return self.constants[self.next().text]
        if word not in ("pi", "atan2", *ONE_ARGUMENT):
            self.refuse("a constant that stands before it, or a function")
        self.next()
        return math.pi if word == "pi" else self._function(word)

    def _in_parentheses(self) -> float:
        if self._depth >= DEEPEST:
            self.refuse(f"at most {DEEPEST} parentheses inside each other")
        self._depth += 1
        value = self._value()
        if self.take("?"):
            yes = self._value()
            self.expect(":")
            no = self._value()
            value = yes if value else no
        self.expect(")")
        self._depth -= 1
        return value

    def _function(self, name: str) -> float:
        self.expect("(")
        value = self._value()
        if name == "atan2":
            self.expect(",")
            value = math.atan2(value, self._value())
        else:
            value = ONE_ARGUMENT[name](value)
        self.expect(")")
        return value
