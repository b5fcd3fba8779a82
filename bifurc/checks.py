"""Checks of what a user hands over: errors name the thing, the value and what is
allowed."""

from __future__ import annotations

import difflib
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from bifurc.errors import ProblemError

if TYPE_CHECKING:
    import sympy


UnknownName: TypeAlias = "str | sympy.Symbol"


def name_of(unknown: object) -> object:
    """The name of an unknown for a sympy symbol, and anything else as it is."""
    is_symbol = getattr(unknown, "is_Symbol", False)
    return getattr(unknown, "name", unknown) if is_symbol else unknown


def index_of_unknown(
    what: str, unknown: object, names: Sequence[str], others: str = ""
) -> int:
    """The index of an unknown among the ``names`` of all from its name or symbol;
    raises `ProblemError` with the nearest name, and with what ``others`` are allowed,
    where there is none."""
    name = name_of(unknown)
    if isinstance(name, str) and name in names:
        return list(names).index(name)
    near = difflib.get_close_matches(str(name), names, n=1)
    hint = f" (the nearest is {near[0]})" if near else ""
    allowed = f"{others}one of the unknowns {', '.join(names)}{hint}"
    raise ProblemError(what, repr(name), allowed)


def check_type(name: str, value: object, kind: type) -> None:
    """Raises `ProblemError` for a ``value`` that is no ``kind``."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise ProblemError(name, repr(value), f"{article} {kind.__name__}")


def check_callable(name: str, value: object) -> None:
    """Raises `ProblemError` for a ``value`` that cannot be called."""
    if not callable(value):
        raise ProblemError(name, repr(value), "a function")


def check_whole(name: str, value: object, lowest: float = -math.inf) -> None:
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


def check_finite(name: str, values: float | np.ndarray) -> None:
    """Raises `ProblemError` where one of the ``values`` is infinite or no number."""
    is_finite = np.isfinite(values)
    if not is_finite.all():
        raise ProblemError(name, np.asarray(values)[~is_finite][0], "finite")


def check_distance(name: str, value: float) -> None:
    """Raises `ProblemError` unless ``value`` is a number, 0 or more, which may be
    infinite."""
    check_number(name, value)
    if not value >= 0.0:
        raise ProblemError(name, value, "0 or more")


def floats_of(name: str, value: ArrayLike) -> np.ndarray:
    """``value`` as an array of floats; raises `ProblemError` where it is none."""
    if isinstance(value, np.ndarray) and value.dtype == float:
        return value.copy()
    try:
        if np.iscomplexobj(value):
            raise TypeError("complex numbers")
        return np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ProblemError(name, repr(value), "numbers") from error


def point_of(name: str, values: ArrayLike, n: int) -> np.ndarray:
    """``values`` as an array of floats (n,); raises `ProblemError` for a wrong shape or
    values not finite."""
    point = floats_of(name, values)
    if point.shape != (n,):
        raise ProblemError(f"shape of {name}", point.shape, f"({n},)")
    if not np.isfinite(point).all():
        raise ProblemError(name, point, "finite")
    return point


def rows_of(name: str, values: ArrayLike, n: int) -> np.ndarray:
    """``values`` as an array of floats (k, n); raises `ProblemError` where it is
    none."""
    if not isinstance(values, np.ndarray) or values.dtype != float:
        values = floats_of(name, values)
    rows: np.ndarray = values
    if rows.ndim != 2 or rows.shape[1] != n:
        raise ProblemError(f"shape of {name}", rows.shape, f"(k, {n})")
    return rows
