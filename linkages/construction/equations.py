"""Equations in the notation of the sources: of what the conditions of the catalogue are
made.

A link is named as in the sources, 12 from joint 1 to joint 2, 61 from joint 6 to joint
1 of a 6R, a joint by its number: a12 and alpha12 are length and twist, R1 is an offset.
Plain a, alpha and R stand for all of them in turn. A space multiplies and ^ is a power:
``R2 = -R1 sin(alpha34)/sin(alpha12 + alpha34)``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from functools import cache
from types import CodeType
from typing import Any

import numpy as np

NAMES = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "sqrt": math.sqrt,
    "pi": math.pi,
    "deg": math.pi / 180,
    "rad": 1.0,
}


@cache
def _compiled(formula: str) -> CodeType:
    python = re.sub(r"(?<=[\w)]) (?=[\w(])", "*", formula).replace("^", "**")
    return compile(python, formula, "eval")


def evaluate(formula: str, names: Mapping[str, Any] | None = None) -> Any:
    """The value of a formula, such as ``1.7 sin(66 deg)``; ``names`` are those that it
    may use besides `NAMES`, for numbers of any type."""
    return eval(_compiled(formula), {"__builtins__": {}, **NAMES}, names or {})


def equation_gaps(equations: str, table: np.ndarray) -> list[float]:
    """For each of the ``equations``, which commas part, the largest difference between
    its first side and the others, for a table (3, n) of lengths, twists (rad) and
    offsets.

    An equation between twists holds modulo a full turn. One that has no value is left
    out: a ratio to a link of no length.
    """
    gaps = []
    for equation in equations.split(", "):
        try:
            gaps.append(max(_gap(equation, names) for names in _numbers(table)))
        except ArithmeticError:
            continue
    return gaps


def numbers_of(table: np.ndarray) -> dict[str, float]:
    """The numbers of a table (3, n) by their names: length, twist and offset of link
    and joint 1, then those of the others."""
    names: dict[str, float] = {}
    n = table.shape[1]
    for i, (length, twist, offset) in enumerate(table.T.tolist(), start=1):
        link = f"{i}{i % n + 1}"
        names |= {f"a{link}": length, f"alpha{link}": twist, f"R{i}": offset}
    return names


def _numbers(table: np.ndarray) -> Iterator[dict[str, float]]:
    """The names of all numbers, and those of one joint and its link, for each in
    turn."""
    names = numbers_of(table)
    for length, twist, offset in table.T.tolist():
        yield {**names, "a": length, "alpha": twist, "R": offset}


def _gap(equation: str, names: Mapping[str, float]) -> float:
    first, *others = (evaluate(side, names) for side in equation.split(" = "))
    gaps = [first - other for other in others]
    if "alpha" in equation and "(" not in equation:
        gaps = [(gap + math.pi) % (2 * math.pi) - math.pi for gap in gaps]
    return float(max(map(abs, gaps)))
