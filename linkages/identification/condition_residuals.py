"""How far a table is from each condition of a catalogue entry, as far as the condition
is written in symbols.

The conditions are texts such as "a12 = a45, R2 = R6 = 0" or "sin(alpha12)/a12 =
sin(alpha61)/a61". Equations between numbers of the table (a_{i,i+1}, alpha_{i,i+1},
R_i) are evaluated; words, and names of parameters, are not.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["condition_residual"]

FUNCTIONS: dict[str, Any] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "sqrt": math.sqrt,
    "pi": math.pi,
}
ALL_OFFSETS = re.compile(r"\b(all offsets(?: are)? (?:0|zero)|R = 0)\b")
BARE = re.compile(r"\b(sin|cos|tan) (\w+)")


def condition_residual(condition: str, values: np.ndarray) -> float | None:
    """The largest difference between the sides of the equations in ``condition``, or
    None where there are none.

    ``values`` is the table (3, n) in the labels of the entry, lengths and offsets in
    the unit in which the residual is wanted. Sides that are angles are compared modulo
    a full turn.
    """
    names = {**FUNCTIONS, **_symbols(values)}
    gaps = [float(np.abs(values[2]).max())] if ALL_OFFSETS.search(condition) else []
    for part in re.split(r", (?![^(]*\))| and |; ", ALL_OFFSETS.sub("", condition)):
        sides = [_value(side, names) for side in part.split("=")]
        known = [side for side in sides if side is not None]
        if len(sides) > 1 and len(known) == len(sides):
            is_angle = "alpha" in part and not re.search(r"sin|cos|tan", part)
            gaps += [
                _turn(x - known[0]) if is_angle else abs(x - known[0])
                for x in known[1:]
            ]
    return max(gaps) if gaps else None


def _symbols(values: np.ndarray) -> dict[str, float]:
    n = values.shape[1]
    links = [f"{i + 1}{(i + 1) % n + 1}" for i in range(n)]
    out = {f"a{link}": float(x) for link, x in zip(links, values[0], strict=True)}
    out |= {f"alpha{link}": float(x) for link, x in zip(links, values[1], strict=True)}
    return out | {f"R{i}": float(x) for i, x in enumerate(values[2], start=1)}


def _value(text: str, names: Mapping[str, Any]) -> float | None:
    """The value of one side, or None if it is not an expression in ``names``."""
    expression = BARE.sub(r"\1(\2)", text.strip()).replace("^", "**")
    expression = re.sub(
        r"([\w)]) (?=[a-zA-Z(])", r"\1*", expression
    )  # a product is written as two words
    if not set(re.findall(r"[A-Za-z_]\w*", expression)) <= set(names):
        return None
    try:
        return float(
            eval(
                compile(expression, "condition", "eval"),
                {"__builtins__": {}},
                dict(names),
            )
        )
    except (SyntaxError, TypeError, ArithmeticError, ValueError):
        return None


def _turn(angle: float) -> float:
    return abs((angle + math.pi) % (2 * math.pi) - math.pi)
