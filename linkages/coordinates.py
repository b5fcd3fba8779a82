"""How exactly coordinates of points are known, as doubles and otherwise."""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from linkages.decisions import is_near_origin

EPSILON = float(np.finfo(float).eps)
DIGITS_OF_DOUBLES = 15  # from so many on, a decimal is a double that was printed
NOISE = 1e-12  # beside the largest coordinate, that stands for 0


def spread_of(places: np.ndarray) -> float:
    """The largest difference of a coordinate of places (k, d); their distance from the
    origin where all are one, 1 where that is 0."""
    spread = float(np.ptp(places, axis=0).max())
    return spread or float(np.abs(places).max()) or 1.0


def rounding_of_doubles(places: np.ndarray) -> float:
    """How far off coordinates of places (k, d) may be, as they are doubles."""
    return float(np.spacing(np.abs(places).max())) / 2


def are_near_origin(places: np.ndarray) -> bool:
    """Whether doubles of the coordinates of places (k, d) are about as exact as those
    of the distances between them."""
    return is_near_origin(float(np.abs(places).max()), spread_of(places))


def is_fine(rounding: float, places: np.ndarray) -> bool:
    """Whether coordinates of places (k, d) that are off by ``rounding`` are about as
    exact as doubles of the distances between them."""
    return is_near_origin(2 * rounding / EPSILON, spread_of(places))


def rounding_of_decimals(places: np.ndarray) -> float | None:
    """How far off coordinates of places (k, d) may be as decimals of few digits; None
    where most of them have as many digits as doubles."""
    sizes = np.abs(places).ravel()
    numbers = sizes[sizes > NOISE * sizes.max()].tolist()
    decimals = [Decimal(repr(number)).normalize().as_tuple() for number in numbers]
    short = [one for one in decimals if len(one.digits) < DIGITS_OF_DOUBLES]
    if 2 * len(short) <= len(decimals):
        return None
    return 0.5 * 10.0 ** min(0, *(int(one.exponent) for one in short))
