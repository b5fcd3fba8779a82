"""Back-to-back double-Goldberg 6R: two Goldberg 5R linkages on the link pair b, d, and
its isomer.

Equation (2.4.8) of Song (2013) for the links is not legible in the copy used; the links
here follow from the construction and were proved by closure.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from linkages.construction.conditions import require_different, require_equal
from linkages.construction.link import basic_links
from linkages.construction.numbers import Number, atan, tan
from linkages.construction.possible_angles import twist_pairs
from linkages.entry_table import Model, read_entries
from linkages.families.mavroidis_roth import OffsetPattern, mavroidis_roth
from linkages.loop import Loop

POSITION = 110


def matching_twist(alpha: Number, beta: Number, gamma: Number) -> Number:
    """The twist delta (rad) for which both 5R linkages share the motion of three
    joints.

    tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2); derived from the construction.
    Raises `GeometryError` for beta = 0.
    """
    bottom = tan(beta / 2)
    require_different("tan(beta/2)", bottom, 0, "no twist")
    return 2 * atan(tan(alpha / 2) * tan(gamma / 2) / bottom)


def back_to_back(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    R2: Number = 0,
    R3: Number = 0,
    delta: Number | None = None,
    sign: int = 1,
    isomer: bool = False,
) -> Loop:
    """Back-to-back double-Goldberg 6R: links a, b + d, a, c, b + d, c with R2 = R5, R3
    = R6; its ``isomer``: links a, b + d, c, a, b + d, c with R2 = R6, R3 = R5.

    ``sign`` -1 gives the case b - d. ``delta`` follows from the other twists (rad) and
    is checked if given; lengths follow from ``a`` and the Bennett ratio. Without the
    condition on delta the loop still moves, as a linkage of Mavroidis and Roth. Raises
    `GeometryError`. Source: Chen and You (2007), Wohlhart (1991b); equation (2.4.9) in
    Song (2013).
    """
    if delta is None:
        delta = matching_twist(alpha, beta, gamma)
    else:
        require_equal(
            "tan(beta/2) tan(delta/2)",
            tan(beta / 2) * tan(delta / 2),
            tan(alpha / 2) * tan(gamma / 2),
            "tan(alpha/2) tan(gamma/2)",
        )
    links = basic_links(a, alpha, beta, gamma, delta)
    pair = links["b"] + links["d"] if sign > 0 else links["b"] - links["d"]
    pattern = OffsetPattern.REFLECTED if isomer else OffsetPattern.OPPOSITE
    return mavroidis_roth(
        a, alpha, gamma, pair.length, pair.twist, R2, R3, pattern, exchanged=isomer
    )


def _guesses(sign: int, form: np.ndarray) -> Iterator[dict[str, float]]:
    """The twist beta of the joined link b + d or b - d: it, or delta."""
    lengths, twists, _ = form
    size = lengths[1] * np.sin(twists[0]) / lengths[0]
    for beta, delta in twist_pairs(twists[1], size, sign):
        yield {"beta": beta}
        yield {"beta": delta}


def _model(sign: int, isomer: bool) -> Model:
    construct = partial(back_to_back, sign=sign, isomer=isomer)
    return Model(construct, guesses=partial(_guesses, sign))


ENTRIES = read_entries(
    "back_to_back",
    {
        "back-to-back-double-goldberg-sum": _model(+1, False),
        "isomerized-back-to-back-double-goldberg-sum": _model(+1, True),
        "back-to-back-double-goldberg-difference": _model(-1, False),
        "isomerized-back-to-back-double-goldberg-difference": _model(-1, True),
    },
)
