"""Elementary functions that follow the type of their argument: float, mpmath, sympy or
exact number.

Constructors of the catalogue use these, so that one piece of code gives a linkage in
doubles, at 50 digits or exactly (`linkages.construction.exact`: fractions, and angles
known by the tangent of their half).
"""

from __future__ import annotations

import math
from typing import Any

__all__ = ["acos", "asin", "atan", "atan2", "cos", "pi_like", "sin", "sqrt", "tan"]


def _library(*values: Any) -> Any:
    """The module whose functions fit the widest type among ``values``: sympy, mpmath,
    exact numbers, math."""
    roots = {type(v).__module__.split(".")[0] for v in values}
    if "sympy" in roots:
        import sympy

        return sympy
    if "mpmath" in roots:
        import mpmath

        return mpmath
    if roots & {"linkages", "fractions"} and not any(
        isinstance(v, float) for v in values
    ):
        from linkages.construction import exact

        return exact
    return math


def sin(x: Any) -> Any:
    """Sine of ``x``, rad."""
    return _library(x).sin(x)


def cos(x: Any) -> Any:
    """Cosine of ``x``, rad."""
    return _library(x).cos(x)


def tan(x: Any) -> Any:
    """Tangent of ``x``, rad."""
    return _library(x).tan(x)


def asin(x: Any) -> Any:
    """Inverse sine, rad."""
    return _library(x).asin(x)


def acos(x: Any) -> Any:
    """Inverse cosine, rad."""
    return _library(x).acos(x)


def atan(x: Any) -> Any:
    """Inverse tangent, rad."""
    return _library(x).atan(x)


def atan2(y: Any, x: Any) -> Any:
    """Angle of the point (x, y), rad."""
    return _library(x, y).atan2(y, x)


def sqrt(x: Any) -> Any:
    """Square root."""
    return _library(x).sqrt(x)


def pi_like(*values: Any) -> Any:
    """Pi in the number type of ``values``."""
    library = _library(*values)
    return +library.pi if library.__name__ == "mpmath" else library.pi
