"""Exact numbers: rational numbers with square roots of such, and angles known by the tangent
of their half.

An angle whose half has a rational tangent has rational sine, cosine and tangent. The
constructors of the catalogue and the closed forms run on these types as they are, and a
closure computed with them is an identity between rational numbers, free of rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias


def rational_sqrt(x: Fraction) -> Fraction | None:
    """The rational square root of ``x`` if it has one."""
    if x < 0:
        return None
    top = math.isqrt(x.numerator)
    bottom = math.isqrt(x.denominator)
    root = Fraction(top, bottom)
    return root if root * root == x else None


@dataclass(frozen=True)
class Quadratic:
    """The number a + b sqrt(d) with exact a, b and a rational d; d is no square, and
    may be negative.

    a and b are rational, or hold roots of smaller d. Results without the root are a
    alone. Roots of different d count as independent unless the quotient of both d is a
    square: a number that is zero by a further relation is not seen to be zero.
    """

    a: Exact
    b: Exact
    d: Fraction

    def _alike(self, other: object) -> tuple[Exact, Exact] | None:
        """``other`` as (a, b) over the root of this number; None for a type that is not
        exact, and for a number that holds a larger root."""
        if isinstance(other, int | Fraction):
            return Fraction(other), Fraction(0)
        if not isinstance(other, Quadratic):
            return None
        if other.d == self.d:
            return other.a, other.b
        root = rational_sqrt(other.d / self.d)
        if root is not None:
            return other.a, other.b * root
        return (other, Fraction(0)) if self.d > other.d else None

    def _make(self, a: Exact, b: Exact) -> Exact:
        return Quadratic(a, b, self.d) if b else a

    def __add__(self, other: ExactOrInt) -> Exact:
        pair = self._alike(other)
        if pair is None:
            return other + self if isinstance(other, Quadratic) else NotImplemented
        a, b = pair
        return self._make(self.a + a, self.b + b)

    __radd__ = __add__

    def __neg__(self) -> Quadratic:
        return Quadratic(-self.a, -self.b, self.d)

    def __sub__(self, other: ExactOrInt) -> Exact:
        return self + (-other)

    def __rsub__(self, other: ExactOrInt) -> Exact:
        return -self + other

    def __mul__(self, other: ExactOrInt) -> Exact:
        pair = self._alike(other)
        if pair is None:
            return other * self if isinstance(other, Quadratic) else NotImplemented
        a, b = pair
        return self._make(self.a * a + self.d * self.b * b, self.a * b + self.b * a)

    __rmul__ = __mul__

    def inverse(self) -> Quadratic:
        """One over the number, which is never zero."""
        norm = self.a * self.a - self.d * self.b * self.b
        return Quadratic(self.a / norm, -self.b / norm, self.d)

    def __truediv__(self, other: ExactOrInt) -> Exact:
        if isinstance(other, Quadratic):
            return self * other.inverse()
        return self * (1 / Fraction(other))

    def __rtruediv__(self, other: ExactOrInt) -> Exact:
        return self.inverse() * other

    def __pow__(self, exponent: int) -> Exact:
        out: Exact = Fraction(1)
        for _ in range(exponent):
            out = out * self
        return out

    def __float__(self) -> float:
        return float(self.a) + float(self.b) * math.sqrt(self.d)


Exact: TypeAlias = Fraction | Quadratic
ExactOrInt: TypeAlias = Exact | int


@dataclass(frozen=True)
class HalfAngle:
    """Half an `Angle`, whose tangent is exact."""

    tangent: Exact

    def __rmul__(self, factor: int) -> Angle:
        if factor != 2:
            raise ArithmeticError(f"{factor} times half an angle has no exact sine")
        return Angle(self.tangent)


@dataclass(frozen=True)
class Angle:
    """The angle whose half has the tangent ``s / c``; kept as (s/c, 1), or (1, 0) for a
    half turn."""

    s: Exact
    c: Exact = Fraction(1)

    def __post_init__(self) -> None:
        s = self.s
        c = self.c
        if isinstance(s, float) or isinstance(c, float):
            raise TypeError(f"{s}/{c} is a floating-point number, which is not exact")
        if s == 0 and c == 0:
            raise ZeroDivisionError("0/0 is no tangent")
        s = Fraction(s) if isinstance(s, int) else s
        object.__setattr__(self, "s", s / c if c != 0 else Fraction(1))
        object.__setattr__(self, "c", Fraction(1 if c != 0 else 0))

    def __add__(self, other: Angle) -> Angle:
        if not isinstance(other, Angle):
            return NotImplemented
        s = self.s * other.c + self.c * other.s
        c = self.c * other.c - self.s * other.s
        return Angle(s, c)

    def __neg__(self) -> Angle:
        return Angle(-self.s, self.c)

    def __sub__(self, other: Angle) -> Angle:
        return self + (-other)

    def __rmul__(self, factor: int) -> Angle:
        out = Angle(Fraction(0))
        for _ in range(abs(factor)):
            out = out + self
        return out if factor > 0 else -out

    def __truediv__(self, divisor: int) -> HalfAngle:
        if divisor != 2:
            raise ArithmeticError(f"an angle over {divisor} has no exact tangent")
        return HalfAngle(self.s / self.c)

    def __float__(self) -> float:
        return 2 * math.atan2(self.s, self.c)


pi = Angle(Fraction(1), Fraction(0))


def sin(x: Angle) -> Exact:
    """Sine of an angle."""
    return 2 * x.s * x.c / (x.s * x.s + x.c * x.c)


def cos(x: Angle) -> Exact:
    """Cosine of an angle."""
    return (x.c * x.c - x.s * x.s) / (x.s * x.s + x.c * x.c)


def tan(x: Angle | HalfAngle) -> Exact:
    """Tangent of an angle or of half an angle."""
    return x.tangent if isinstance(x, HalfAngle) else sin(x) / cos(x)


def atan(x: Exact) -> HalfAngle:
    """Half the angle whose half has the tangent ``x``; twice the result is an
    `Angle`."""
    return HalfAngle(x)


def sqrt(x: Exact) -> Exact:
    """Square root of a rational number, in the quadratic extension if need be."""
    if isinstance(x, Quadratic):
        raise ArithmeticError("a root of a root is not exact here")
    root = rational_sqrt(Fraction(x))
    return Quadratic(Fraction(0), Fraction(1), Fraction(x)) if root is None else root


def atan2(y: Exact, x: Exact) -> Angle:
    """Angle of the point (x, y), whose distance from the origin must lie in the
    field."""
    if y == 0:
        return Angle(Fraction(0)) if float(x) > 0 else pi
    return Angle(y, sqrt(x * x + y * y) + x)


def acos(x: Exact) -> Angle:
    """The angle between 0 and pi whose cosine is ``x``."""
    return atan2(sqrt(1 - x * x), x)


def asin(x: Exact) -> Angle:
    """The angle between -pi/2 and pi/2 whose sine is ``x``."""
    return atan2(x, sqrt(1 - x * x))
