"""Back-to-back double-Goldberg 6R: two Goldberg 5R linkages on the link pair b, d, and
its isomer.

Equation (2.4.8) of Song (2013) for the links is not legible in the copy used; the links
here follow from the construction and were proved by closure.
"""

from __future__ import annotations

from functools import partial
from math import radians, sin
from typing import Any

from linkages.construction.conditions import require_equal
from linkages.construction.link import bennett_links, closed_chain
from linkages.construction.numbers import atan, tan
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "back_to_back", "isomerized_back_to_back", "matching_twist"]


def matching_twist(alpha: Any, beta: Any, gamma: Any) -> Any:
    """The twist delta (rad) for which both 5R linkages share the motion of three
    joints.

    tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2); derived from the construction.
    """
    return 2 * atan(tan(alpha / 2) * tan(gamma / 2) / tan(beta / 2))


def back_to_back(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    R2: Any = 0,
    R3: Any = 0,
    delta: Any = None,
    sign: int = 1,
) -> Loop:
    """Back-to-back double-Goldberg 6R: links a, b + d, a, c, b + d, c with R2 = R5, R3
    = R6.

    ``sign`` -1 gives the case b - d. ``delta`` follows from the other twists (rad) and
    is checked if given; lengths follow from ``a`` and the Bennett ratio. Without the
    condition on delta the loop still moves, as a linkage of Mavroidis and Roth. Raises
    `GeometryError`. Source: Chen and You (2007); equation (2.4.9) in Song (2013).
    """
    a, pair, c = _links(a, alpha, beta, gamma, delta, sign)
    return closed_chain(a, pair, a, c, pair, c, offsets=(0, R2, R3, 0, R2, R3))


def isomerized_back_to_back(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    R2: Any = 0,
    R3: Any = 0,
    delta: Any = None,
    sign: int = 1,
) -> Loop:
    """The isomer of `back_to_back`: links a, b + d, c, a, b + d, c with R2 = R6, R3 =
    R5.

    Source: Chen and You (2007), Wohlhart (1991b); equation (2.4.9) in Song (2013).
    """
    a, pair, c = _links(a, alpha, beta, gamma, delta, sign)
    return closed_chain(a, pair, c, a, pair, c, offsets=(0, R2, R3, 0, R3, R2))


def _links(
    a: Any, alpha: Any, beta: Any, gamma: Any, delta: Any, sign: int
) -> tuple[Any, Any, Any]:
    needed = matching_twist(alpha, beta, gamma)
    if delta is not None:
        product = tan(beta / 2) * tan(delta / 2)
        require_equal(
            "tan(beta/2) tan(delta/2)",
            product,
            tan(alpha / 2) * tan(gamma / 2),
            "tan(alpha/2) tan(gamma/2)",
        )
    twist = needed if delta is None else delta
    a, b, c, d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(twist, None)
    )
    return a, b + d if sign > 0 else b - d, c


_PARAMETERS = (
    Parameter("a", 1.7 * sin(radians(35)), "length", "length of link a", 0.3, 3.0),
    *(
        Parameter(
            name,
            radians(value),
            "angle",
            f"twist of link {link}",
            radians(20),
            radians(110),
        )
        for name, value, link in (
            ("alpha", 35, "a"),
            ("beta", 62, "b"),
            ("gamma", 81, "c"),
        )
    ),
    Parameter("R2", 0.31, "length", "offset R2", -0.5, 0.5),
    Parameter("R3", -0.47, "length", "offset R3", -0.5, 0.5),
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
            (
                *_RATIO,
                f"links a, {case}, a, c, {case}, c",
                "R1 = R4 = 0, R2 = R5, R3 = R6",
            ),
            facts=facts,
        ),
        Entry(
            f"isomerized-back-to-back-double-goldberg-{word}",
            f"Isomerized back-to-back double-Goldberg 6R ({case})",
            "Chen and You (2007); Song (2013), eq. 2.4.9",
            partial(isomerized_back_to_back, sign=sign),
            _PARAMETERS,
            (
                *_RATIO,
                f"links a, {case}, c, a, {case}, c",
                "R1 = R4 = 0, R2 = R6, R3 = R5",
            ),
            facts=facts,
        ),
    )


ENTRIES = (*_entries("b + d", 1), *_entries("b - d", -1))
