"""The words of a CUIK world file, and its expressions.

The grammar is that of the CUIK suite (Porta, Ros, Thomas and Torras 2014,
"The CUIK Suite"): keywords in capitals or not, comments of four kinds, and arithmetic in
which a sign binds closer than a power.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

from linkages.values import GeometryError, quoted

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
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "cot": lambda angle: math.tan(math.pi / 2 - angle),
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "exp": math.exp,
    "sqrt": math.sqrt,
    "abs": abs,
}
COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
}
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

    def blank(match: re.Match[str]) -> str:
        return " " + "\n" * match.group().count("\n")

    tokens = []
    line = 1
    for match in TOKEN.finditer(COMMENT.sub(blank, text)):
        kind = str(match.lastgroup)
        word = match.group()
        if kind == "unknown":
            allowed = "a name, a number or a sign of a world file"
            raise GeometryError(f"line {line}", quoted(word), allowed)
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

    def refuse(self, allowed: str) -> None:
        """Raise `GeometryError` for the token here."""
        token = self.token
        shown = token.text if token.kind in ("end", "text") else quoted(token.text)
        raise GeometryError(f"line {token.line}", shown, allowed)

    # --- expressions ------------------------------------------------------------------

    def number(self) -> float:
        """The value of the expression that stands here; raises `GeometryError`."""
        line = self.token.line
        try:
            value = self._comparison()
        except (ArithmeticError, ValueError) as error:
            if isinstance(error, GeometryError):
                raise
            message = f"an expression without a value ({error})"
            raise GeometryError(f"line {line}", message, "a number") from None
        if isinstance(value, complex) or not math.isfinite(value):
            raise GeometryError(f"line {line}", value, "a finite number")
        return value

    def _comparison(self) -> float:
        value = self._sum()
        while self.token.text in COMPARISONS:
            compare = COMPARISONS[self.next().text]
            value = float(compare(value, self._sum()))
        return value

    def _sum(self) -> float:
        value = self._product()
        # "1+(0,1,0)" is a point and a vector, which `points` takes apart
        while self.token.text in ("+", "-"):
            sign = self.next().text
            term = self._product()
            value = value + term if sign == "+" else value - term
        return value

    def _product(self) -> float:
        value = self._power()
        while self.token.text in ("*", "/"):
            sign = self.next().text
            factor = self._power()
            value = value * factor if sign == "*" else value / factor
        return value

    def _power(self) -> float:
        value = self._signed()
        while self.take("^"):
            value = value ** self._signed()
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
        if token.text in self.constants:
            return self.constants[self.next().text]
        word = token.text.lower()
        if word == "pi":
            self.next()
            return math.pi
        if word == "atan2" or word in ONE_ARGUMENT:
            self.next()
            return self._function(word)
        self.refuse("a constant that stands before it, or a function")
        raise AssertionError("refuse raises")

    def _in_parentheses(self) -> float:
        if self._depth >= DEEPEST:
            self.refuse(f"at most {DEEPEST} parentheses inside each other")
        self._depth += 1
        value = self._comparison()
        if self.take("?"):
            yes = self._comparison()
            self.expect(":")
            no = self._comparison()
            value = yes if value else no
        self.expect(")")
        self._depth -= 1
        return value

    def _function(self, name: str) -> float:
        self.expect("(")
        value = self._comparison()
        if name == "atan2":
            self.expect(",")
            value = math.atan2(value, self._comparison())
        else:
            value = ONE_ARGUMENT[name](value)
        self.expect(")")
        return value
