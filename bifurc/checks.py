"""Checks of what a user hands over: errors name the thing, the value and what is
allowed."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bifurc.errors import ProblemError

__all__ = ["check_callable", "check_number", "check_type", "check_whole", "floats_of"]


def check_type(name: str, value: object, kind: type) -> None:
    """Raises `ProblemError` for a ``value`` that is no ``kind``."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise ProblemError(name, repr(value), f"{article} {kind.__name__}")


def check_callable(name: str, value: object) -> None:
    """Raises `ProblemError` for a ``value`` that cannot be called."""
    if not callable(value):
        raise ProblemError(name, repr(value), "a function")


def check_whole(name: str, value: object, lowest: int) -> None:
    """Raises `ProblemError` unless ``value`` is a whole number, at least ``lowest``."""
    if not isinstance(value, int | np.integer) or isinstance(value, bool):
        raise ProblemError(name, repr(value), "a whole number")
    if value < lowest:
        raise ProblemError(name, value, f"at least {lowest}")


def check_number(name: str, value: object) -> None:
    """Raises `ProblemError` unless ``value`` is a real number; infinite and "not a
    number" are left to the caller."""
    is_number = isinstance(value, int | float | np.integer | np.floating)
    if not is_number or isinstance(value, bool):
        raise ProblemError(name, repr(value), "a number")


def floats_of(name: str, value: ArrayLike) -> np.ndarray:
    """``value`` as an array of floats; raises `ProblemError` where it is none."""
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ProblemError(name, repr(value), "numbers") from error
