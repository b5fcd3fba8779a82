"""Elementary functions that follow the type of their argument: float, mpmath, sympy or
exact number.

Constructors of the catalogue use these, so that one piece of code gives a linkage in
doubles, at 50 digits or exactly (`linkages.construction.exact`: fractions, and angles
known by the tangent of their half).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from importlib import import_module
from types import ModuleType
from typing import Any, Protocol, TypeAlias

from linkages.construction import exact

# the other side of an operation: each number type decides itself what it works with
Operand: TypeAlias = Any
# the module of the functions, by the package of a number type; those on a tape take
# NumPy's
_LIBRARIES = {"sympy": "sympy", "mpmath": "mpmath", "bifurc": "numpy"}
EXACT = (Fraction, exact.Quadratic, exact.Angle, exact.HalfAngle)


class Number(Protocol):
    """A number of any type that constructors work with: float, mpmath, sympy, exact."""

    def __add__(self, other: Operand, /) -> Number: ...
    def __radd__(self, other: Operand, /) -> Number: ...
    def __sub__(self, other: Operand, /) -> Number: ...
    def __rsub__(self, other: Operand, /) -> Number: ...
    def __mul__(self, other: Operand, /) -> Number: ...
    def __rmul__(self, other: Operand, /) -> Number: ...
    def __truediv__(self, other: Operand, /) -> Number: ...
    def __rtruediv__(self, other: Operand, /) -> Number: ...
    def __pow__(self, exponent: Operand, /) -> Number: ...
    def __neg__(self) -> Number: ...
    def __float__(self) -> float: ...


def _library(*values: Number) -> ModuleType:
    """The module whose functions fit the widest type among ``values``: sympy, mpmath,
    exact numbers, math."""
    for value in values:
        if type(value) is not float:
            break
    else:
        return math  # as a rule, and thousands of times when a linkage is identified
    roots = {type(v).__module__.split(".")[0] for v in values}
    for root, library in _LIBRARIES.items():
        if root in roots:
            return import_module(library)
    some_exact = any(isinstance(v, EXACT) for v in values)
    if some_exact and not any(isinstance(v, float) for v in values):
        return exact
    return math


def _function(name: str) -> Callable[..., Number]:
    """The function of this name, of the module that fits its arguments."""

    def function(*values: Number) -> Number:
        value: Number = getattr(_library(*values), name)(*values)
        return value

    return function


# angles in rad
sin = _function("sin")
cos = _function("cos")
tan = _function("tan")
asin = _function("asin")
acos = _function("acos")
atan = _function("atan")
atan2 = _function("atan2")
sqrt = _function("sqrt")


def pi_like(*values: Number) -> Number:
    """Pi in the number type of ``values``."""
    library = _library(*values)
    pi: Number = library.pi
    # mpmath's own pi is a constant that is evaluated at each use
    return +library.pi if library.__name__ == "mpmath" else pi
