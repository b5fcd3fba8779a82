"""Checks that constructors make of their parameters, each naming the quantity and the
amount.

A sympy expression with free symbols cannot be compared with a bound; it is taken as it
is.
"""

from __future__ import annotations

import math

from linkages.construction.numbers import Number, sin
from linkages.values import GeometryError, told_apart

TOLERANCE = 1e-9  # relative; parameters typed with ten digits pass, a misprint does not
ROUNDING = 1e-12  # relative; a difference below it is nothing but rounding


def decided(value: Number) -> float | None:
    """``value`` as a float, or None when it contains free symbols."""
    try:
        return float(value)
    except TypeError:
        return None


def require_positive(name: str, value: Number) -> None:
    """Raise `GeometryError` unless ``value`` is greater than zero."""
    number = decided(value)
    if number is not None and not number > 0:
        raise GeometryError(name, f"{number:.6g}", "greater than 0")


def require_within(
    name: str, value: Number, low: float, high: float, unit: str = "rad"
) -> None:
    """Raise `GeometryError` unless ``low < value < high``."""
    number = decided(value)
    if number is None or low < number < high:
        return
    shown, least, most = told_apart(number, low, high)
    is_end = number in (low, high)
    value_shown, range_shown = f"{shown} {unit}", f"{least} and {most} {unit}"
    if unit == "rad":
        value_shown += f" ({math.degrees(number):.6g} deg)"
        range_shown += f" ({math.degrees(low):.6g} and {math.degrees(high):.6g} deg)"
    allowed = f"between {range_shown}" + (", not at an end" * is_end)
    raise GeometryError(name, value_shown, allowed)


def require_twists(**twists: Number) -> None:
    """Raise `GeometryError` unless each of the ``twists`` (rad), by name, is between 0
    and pi."""
    for name, twist in twists.items():
        require_within(f"twist {name}", twist, 0.0, math.pi)


def require_equal(name: str, value: Number, expected: Number, meaning: str) -> None:
    """Raise `GeometryError` unless the two agree to a relative 1e-9; ``meaning`` says
    what is expected."""
    left = decided(value)
    right = decided(expected)
    if left is None or right is None:
        return
    amount = abs(left - right)
    if not amount <= TOLERANCE * max(abs(left), abs(right), 1e-300):
        shown, wanted = told_apart(left, right)
        allowed = f"{wanted}, {meaning} (off by {amount:.3g})"
        raise GeometryError(name, shown, allowed)


def require_different(
    name: str, value: Number, other: Number, meaning: str, scale: Number = 1.0
) -> None:
    """Raise `GeometryError` when the two differ by rounding alone, so that nothing can
    be divided by the difference; ``meaning`` says what ``other`` is.

    ``scale`` is the size of what the two were computed from: 1 for sines and tangents,
    a length, or 0 for numbers that are no differences.
    """
    left = decided(value)
    right = decided(other)
    size = decided(scale)
    if left is None or right is None or size is None:
        return
    largest = max(abs(left), abs(right), abs(size))
    if not abs(left - right) > ROUNDING * largest:
        allowed = f"different from {right:.6g}, {meaning}"
        raise GeometryError(name, f"{left:.6g}", allowed)


def _require_same_sense(
    link: str, twist: Number, reference_twist: Number, derived: Number
) -> None:
    """Raise `GeometryError` for twists (rad) whose sines have other signs, so that the
    length ``derived`` of the link is not positive."""
    length, angle, reference = map(decided, (derived, twist, reference_twist))
    if length is None or angle is None or reference is None or length > 0:
        return
    value = f"{math.degrees(angle):.6g} degrees beside {math.degrees(reference):.6g}"
    allowed = (
        "such that the sines of both have one sign, as the length of the link, which "
        f"follows from them, is positive; here it is {length:.6g}"
    )
    raise GeometryError(f"twist of link {link}", f"{value} of the first link", allowed)


def bennett_length(
    link: str,
    twist: Number,
    given: Number | None,
    length: Number,
    reference_twist: Number,
) -> Number:
    """Length of ``link`` with ``twist`` (rad) that has the Bennett ratio
    sin(twist)/length of the reference.

    A ``given`` length is checked against it and returned. Raises `GeometryError` for a
    ratio that differs, for a length that is not positive, and for a reference without
    twist.
    """
    sine = sin(reference_twist)
    require_different("sine of the twist of the first link", sine, 0, "no ratio")
    derived = length * sin(twist) / sine
    if given is None:
        _require_same_sense(link, twist, reference_twist, derived)
        return derived
    require_positive(f"length of link {link}", given)
    require_equal(
        f"link {link}: sin(twist)/length",
        sin(twist) / given,
        sine / length,
        "the Bennett ratio of the other links",
    )
    return given
