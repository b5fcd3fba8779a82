"""Numbers and tables as text."""

from __future__ import annotations

import numpy as np

ROUNDING = 12  # decimals of a length, over the characteristic length, that are shown


def in_degrees(angle: float, digits: int = 4) -> str:
    """An angle (rad) in degrees, to so many decimals and without a negative zero."""
    shown = f"{np.degrees(angle) + 0.0:.{digits}f}"
    zero = f"{0.0:.{digits}f}"
    return zero if shown == f"-{zero}" else shown


def in_lengths(length: float, unit: float, digits: int = 6) -> str:
    """A length with so many digits; what is rounding of a ``unit`` is 0."""
    return f"{unit * round(length / unit, ROUNDING) + 0.0:.{digits}g}"


def known_to(rounding: float, unit: float) -> str:
    """The sentence on how far off coordinates of points are, in lengths and in shares of
    the characteristic length, the ``unit``."""
    return (
        f"Coordinates of points are known to {rounding:.2g} only, {rounding / unit:.2g} "
        "of the characteristic length."
    )
