"""From where the coordinates of a mechanism are counted.

A coordinate such as 30000.6 cannot be stored better than to 3.6e-12, and a bifurcation
misses a mechanism of size 1 by the root of that. So the coordinates of a file are
counted from a point of the mechanism where they are large beside it, and the
differences are taken of the decimals as they are written.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple, TypeAlias, TypeGuard

import numpy as np

from linkages.coordinates import DIGITS_OF_DOUBLES, are_near_origin
from linkages.values import checked_list, checked_vector

Place: TypeAlias = tuple[float, float, float]

LARGEST_EXPONENT = 150  # of ten: beyond, a number is left to the checks of its reader


class WrittenNumber(float):
    """A number that knows the decimal ``text`` it was read from."""

    text: str

    def __new__(cls, text: str) -> WrittenNumber:
        number = super().__new__(cls, text)
        number.text = text
        return number


class Coordinates(NamedTuple):
    """The rows of coordinates, None where one was None, counted from ``origin`` in
    the rows that were given, None where they are as they were; and how far off they may
    be, as decimals were doubles."""

    rows: list[Any]
    origin: Place | None = None
    rounding: float = 0.0


def counted_from_near(
    rows: Sequence[object], are_anywhere: Sequence[bool] = ()
) -> Coordinates:
    """The rows, lists of two or three coordinates, counted from the first one where
    they are far from the origin beside their own spread. Those that may be given
    anywhere, as the points of slides, do not say where the others are.

    Differences of `WrittenNumber`s and integers are exact but for one rounding. Where a
    row is no list of such numbers all are left as they are: their reader refuses them.
    """
    unchanged = Coordinates(list(rows))
    pairs = zip(rows, are_anywhere or [False] * len(rows), strict=True)
    given = [row for row, is_anywhere in pairs if _is_row(row) and not is_anywhere]
    are_alike = len({len(row) for row in given}) == 1
    if not are_alike or not all(row is None or _is_row(row) for row in rows):
        return unchanged
    places = np.array(given, dtype=float)
    if are_near_origin(places):
        return unchanged
    first = [exact_number(number) for number in given[0]]
    shifted = [
        [float(exact_number(x) - start) for x, start in zip(row, first, strict=True)]
        if _is_row(row)
        else None
        for row in rows
    ]
    x, y, z = [float(number) for number in first] + [0.0] * (3 - len(first))
    rounding = max(rounding_of_number(number) for row in given for number in row)
    return Coordinates(shifted, (x, y, z), rounding)


def origin_of(content: Mapping[str, Any], near: Place | None) -> Place:
    """The point from which the points of a file are counted: its ``origin``, and
    besides it the one that is ``near`` them. Raises `GeometryError`."""
    given = content.get("origin", [0.0, 0.0, 0.0])
    checked_list("origin", given, "a vector [x, y, z]", (3,))
    x, y, z = checked_vector("origin", given)
    if near is None:
        return (x, y, z)
    return (x + near[0], y + near[1], z + near[2])


def _is_row(row: object) -> TypeGuard[list[float]]:
    """Whether a row is a list of two or three finite numbers."""
    if not isinstance(row, list) or len(row) not in (2, 3):
        return False
    return all(_is_number(value) for value in row)


def _is_number(value: object) -> bool:
    """Whether a value is a finite number of ordinary size, 0 among them."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    if not -(10**LARGEST_EXPONENT) < value < 10**LARGEST_EXPONENT:
        return False
    is_tiny = 0 < abs(value) < 10.0**-LARGEST_EXPONENT
    # a fraction of 1e-999999999, which is 0 in doubles, would fill the memory
    is_hidden = value == 0 and bool(_digits(value))
    return not (is_tiny or is_hidden)


def exact_number(number: float) -> Fraction:
    """A number as its decimal says; a zero is one whatever its exponent."""
    if number and isinstance(number, WrittenNumber):
        return Fraction(number.text)
    return Fraction(number)


def _digits(number: float) -> str:
    """The digits of the decimal of a number, without zeros at the ends and without the
    exponent; empty where nothing is written."""
    mantissa = getattr(number, "text", "").lower().partition("e")[0]
    return "".join(filter(str.isdigit, mantissa)).strip("0")


def rounding_of_number(number: float) -> float:
    """How far off a number may be: a decimal of few digits is exact."""
    if isinstance(number, int):
        return 0.0
    if isinstance(number, WrittenNumber) and len(_digits(number)) < DIGITS_OF_DOUBLES:
        return 0.0
    return float(np.spacing(abs(number))) / 2
