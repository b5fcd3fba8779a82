"""Back-to-back double-Goldberg 6R: two Goldberg 5R linkages on the link pair b, d, and its isomer.

Equation (2.4.8) of Song (2013) for the links is not legible in the copy used; the links here follow from the
construction and were proved by closure.
"""

from __future__ import annotations

from functools import partial
from math import radians
from typing import Any

from linkages.entry import Entry, Parameter
from linkages.link import bennett_links, closed_chain
from linkages.loop import GeometryError, Loop
from linkages.numbers import atan, tan

__all__ = ["ENTRIES", "back_to_back", "isomerized_back_to_back", "matching_twist"]


def matching_twist(alpha: Any, beta: Any, gamma: Any) -> Any:
    """delta (rad) with tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2): both 5R then share three joints."""
    return 2 * atan(tan(alpha / 2) * tan(gamma / 2) / tan(beta / 2))


def back_to_back(
    alpha: Any, beta: Any, gamma: Any, scale: Any, r2: Any = 0, r3: Any = 0, sign: int = 1, delta: Any = None
) -> Loop:
    """Back-to-back double-Goldberg 6R: links a, b + d, a, c, b + d, c with R2 = R5, R3 = R6.

    ``sign`` -1 gives the case b - d. ``delta`` follows from the other twists (rad) and is checked if given;
    ``scale`` is length / sin(twist). Without the condition on delta the loop still moves, as a linkage of
    Mavroidis and Roth. Raises `GeometryError`. Source: Chen and You (2007); equation (2.4.9) in Song (2013).
    """
    a, pair, c = _links(alpha, beta, gamma, scale, sign, delta)
    return closed_chain(a, pair, a, c, pair, c, offsets=(0, r2, r3, 0, r2, r3))


def isomerized_back_to_back(
    alpha: Any, beta: Any, gamma: Any, scale: Any, r2: Any = 0, r3: Any = 0, sign: int = 1, delta: Any = None
) -> Loop:
    """The isomer of `back_to_back`: links a, b + d, c, a, b + d, c with R2 = R6, R3 = R5.

    Source: Chen and You (2007), Wohlhart (1991b); equation (2.4.9) in Song (2013).
    """
    a, pair, c = _links(alpha, beta, gamma, scale, sign, delta)
    return closed_chain(a, pair, c, a, pair, c, offsets=(0, r2, r3, 0, r3, r2))


def _links(alpha: Any, beta: Any, gamma: Any, scale: Any, sign: int, delta: Any) -> tuple[Any, Any, Any]:
    needed = matching_twist(alpha, beta, gamma)
    if delta is not None:
        gap = float(tan(alpha / 2) * tan(gamma / 2) - tan(beta / 2) * tan(delta / 2))
        if abs(gap) > 1e-9:
            raise GeometryError("tan(alpha/2) tan(gamma/2) - tan(beta/2) tan(delta/2)", gap, "0")
    a, b, c, d = bennett_links(scale, alpha, beta, gamma, needed if delta is None else delta)
    return a, b + d if sign > 0 else b - d, c


_PARAMETERS = (
    *(
        Parameter(name, radians(value), "angle", f"twist of link {link}", radians(20), radians(110))
        for name, value, link in (("alpha", 35, "a"), ("beta", 62, "b"), ("gamma", 81, "c"))
    ),
    Parameter("scale", 1.7, "length", "length / sin(twist) of the links a, b, c, d", 0.5, 3.0),
    Parameter("r2", 0.31, "length", "offset R2", -0.5, 0.5),
    Parameter("r3", -0.47, "length", "offset R3", -0.5, 0.5),
)
_RATIO = (
    "sin(twist)/length is the same for the links a, b, c, d",
    "tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2) for the construction; the 6R moves without it",
)


def _entries(case: str, sign: int) -> tuple[Entry, Entry]:
    word = "sum" if sign > 0 else "difference"
    facts = {"joints": 6, "mobility": 1}
    return (
        Entry(
            f"back-to-back-double-goldberg-{word}",
            f"Back-to-back double-Goldberg 6R ({case})",
            "Chen and You (2007); Song (2013), eq. 2.4.8, 2.4.9",
            partial(back_to_back, sign=sign),
            _PARAMETERS,
            (*_RATIO, f"links a, {case}, a, c, {case}, c", "R1 = R4 = 0, R2 = R5, R3 = R6"),
            facts=facts,
        ),
        Entry(
            f"isomerized-back-to-back-double-goldberg-{word}",
            f"Isomerized back-to-back double-Goldberg 6R ({case})",
            "Chen and You (2007); Song (2013), eq. 2.4.9",
            partial(isomerized_back_to_back, sign=sign),
            _PARAMETERS,
            (*_RATIO, f"links a, {case}, c, a, {case}, c", "R1 = R4 = 0, R2 = R6, R3 = R5"),
            facts=facts,
        ),
    )


ENTRIES = (*_entries("b + d", 1), *_entries("b - d", -1))
