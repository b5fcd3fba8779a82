"""Checks that constructors make of their parameters, each naming the quantity and the
amount.

A sympy expression with free symbols cannot be compared with a bound; it is taken as it
is.
"""

from __future__ import annotations

from typing import Any

from linkages.construction.numbers import sin
from linkages.loop import GeometryError

__all__ = [
    "bennett_length",
    "decided",
    "require_equal",
    "require_positive",
    "require_within",
]

TOLERANCE = 1e-9  # relative; parameters typed with ten digits pass, a misprint does not


def decided(value: Any) -> float | None:
    """``value`` as a float, or None when it contains free symbols."""
    try:
        return float(value)
    except TypeError:
        return None


def require_positive(name: str, value: Any) -> None:
    """Raise `GeometryError` unless ``value`` is greater than zero."""
    number = decided(value)
    if number is not None and not number > 0:
        raise GeometryError(name, f"{number:.6g}", "greater than 0")


def require_within(
    name: str, value: Any, low: float, high: float, unit: str = "rad"
) -> None:
    """Raise `GeometryError` unless ``low < value < high``."""
    number = decided(value)
    if number is not None and not low < number < high:
        raise GeometryError(
            name, f"{number:.6g} {unit}", f"between {low:.6g} and {high:.6g} {unit}"
        )


def require_equal(name: str, value: Any, expected: Any, meaning: str) -> None:
    """Raise `GeometryError` unless the two agree to a relative 1e-9; ``meaning`` says
    what is expected."""
    left, right = decided(value), decided(expected)
    if left is None or right is None:
        return
    amount = abs(left - right)
    if not amount <= TOLERANCE * max(abs(left), abs(right), 1e-300):
        raise GeometryError(
            name, f"{left:.10g}", f"{right:.10g}, {meaning} (off by {amount:.3g})"
        )


def bennett_length(
    link: str, twist: Any, given: Any, length: Any, reference_twist: Any
) -> Any:
    """Length of ``link`` with ``twist`` (rad) that has the Bennett ratio
    sin(twist)/length of the reference.

    A ``given`` length is checked against it and returned. Raises `GeometryError` for a
    ratio that differs, and for a length that is not positive.
    """
    derived = length * sin(twist) / sin(reference_twist)
    require_positive(f"length of link {link}", derived if given is None else given)
    if given is None:
        return derived
    require_equal(
        f"link {link}: sin(twist)/length",
        sin(twist) / given,
        sin(reference_twist) / length,
        "the Bennett ratio of the other links",
    )
    return given
