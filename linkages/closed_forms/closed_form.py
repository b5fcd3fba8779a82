"""Closed forms of motion: one pair of expressions per joint, for numbers, for LaTeX and
for proof.

With t_i = tan(theta_i/2) = s_i/c_i the angle of every joint is a homogeneous pair
(numerator, denominator) of polynomials in the pair (s_1, c_1) of the input joint and,
on curves that are not rational, in the pair of a second joint that is tied to it by one
quadratic relation. Pairs have no poles.

The expressions are sympy's. It is imported when the first symbol is made, so that the
catalogue, which names the type, starts without it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from linkages.construction import numbers
from linkages.construction.numbers import Number

if TYPE_CHECKING:
    import sympy as sp

Pair: TypeAlias = tuple[Number, Number]
ROUNDING = 1e-13  # a discriminant that is negative by less is zero


def joint(i: int) -> Pair:
    """The pair (s_i, c_i) of joint ``i``, from 1."""
    import sympy as sp

    s, c = sp.symbols(f"s_{i} c_{i}", real=True)
    return s, c


def tangent(name: str) -> Number:
    """The tangent of half the twist or kink called ``name``."""
    return constant(f"u_{name}")


def constant(name: str) -> Number:
    """A length or offset of the geometry, or a constant that a closed form defines."""
    import sympy as sp

    symbol: Number = sp.Symbol(name, real=True)
    return symbol


@dataclass(frozen=True)
class HalfTangent:
    """The angle whose half has the tangent ``top`` over ``bottom``; angles are added by
    multiplying pairs."""

    top: Number
    bottom: Number

    def __neg__(self) -> HalfTangent:
        return HalfTangent(-self.top, self.bottom)

    def __add__(self, other: HalfTangent) -> HalfTangent:
        top = self.top * other.bottom + self.bottom * other.top
        return HalfTangent(top, self.bottom * other.bottom - self.top * other.top)

    def __sub__(self, other: HalfTangent) -> HalfTangent:
        return self + (-other)

    @property
    def pair(self) -> Pair:
        """Top and bottom."""
        return self.top, self.bottom


def cosine_of(u: Number) -> Number:
    """Cosine of the angle whose half has the tangent ``u``."""
    return (1 - u**2) / (1 + u**2)


def sine_of(u: Number) -> Number:
    """Sine of the angle whose half has the tangent ``u``."""
    return 2 * u / (1 + u**2)


class _Root(NamedTuple):
    """A root of a quadratic equation as a pair of unit length, and where it is real."""

    pair: tuple[np.ndarray, np.ndarray]
    is_real: np.ndarray


@dataclass(frozen=True)
class ClosedForm:
    """The joint angles of one or two forms of a linkage along its motion.

    ``half_tangents`` holds for each joint one or more pairs that are equal by the
    relation; where one of them is 0/0 another is not. ``relation`` is homogeneous and
    quadratic in the pair of joint ``second``; its two roots are both configurations.
    ``constants`` are defined in order by the parameters ``angles`` (through `tangent`)
    and ``lengths`` of the catalogue entry ``linkage``. ``source`` says where the
    printed equation is wrong.
    """

    linkage: str
    form: str
    source: str
    angles: tuple[str, ...]
    half_tangents: tuple[tuple[Pair, ...], ...]
    constants: Mapping[str, Number] = field(default_factory=dict)
    lengths: tuple[str, ...] = ()
    relation: Number | None = None
    second: int = 0

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.half_tangents)

    @property
    def roots(self) -> tuple[int, ...]:
        """Signs of the square root: (+1, -1), or (+1,) where the motion is rational."""
        return (1,) if self.relation is None else (1, -1)

    @cached_property
    def _constant_symbols(self) -> list[Number]:
        return [constant(name) for name in self.constants]

    @cached_property
    def _constants(self) -> Callable[..., Sequence[Number]]:
        import sympy as sp

        values: dict[Number, sp.Expr] = {}
        for name, value in self.constants.items():
            values[constant(name)] = sp.sympify(value).subs(values)
        angles = [tangent(name) for name in self.angles]
        lengths = [constant(name) for name in self.lengths]
        return _compiled([*angles, *lengths], list(values.values()), sqrt=numbers.sqrt)

    @cached_property
    def _pairs(self) -> Callable[..., Sequence[list[Pair]]]:
        second = joint(self.second) if self.second else ()
        arguments = [*joint(1), *second, *self._constant_symbols]
        return _compiled(arguments, [list(pairs) for pairs in self.half_tangents])

    @cached_property
    def quadratic(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """Coefficients (A, B, C) of the relation A t^2 + B t + C = 0 of the second
        joint, without poles."""
        import sympy as sp

        s, c = joint(self.second)
        polynomial = sp.Poly(self.relation, s, c)
        return (
            polynomial.coeff_monomial(s**2),
            polynomial.coeff_monomial(s * c),
            polynomial.coeff_monomial(c**2),
        )

    @cached_property
    def evaluate_quadratic(self) -> Callable[..., Sequence[Number]]:
        """Gives the coefficients (A, B, C) for a pair of the input joint and the
        constants, of any number type."""
        return _compiled([*joint(1), *self._constant_symbols], list(self.quadratic))

    def evaluate_constants(self, parameters: Mapping[str, Number]) -> list[Number]:
        """Values of the constants for parameters of any number type, angles in rad or
        exact."""
        tangents = [numbers.tan(parameters[name] / 2) for name in self.angles]
        lengths = [parameters[name] for name in self.lengths]
        return list(self._constants(*tangents, *lengths))

    def evaluate_pairs(
        self, first: Pair, second: Pair | None, constants: list[Number]
    ) -> list[list[Pair]]:
        """For each joint its equivalent pairs, in the number type of the arguments."""
        return list(self._pairs(*first, *(second or ()), *constants))

    def configurations(
        self, theta_1: np.ndarray, parameters: Mapping[str, float], root: int = 1
    ) -> np.ndarray:
        """Joint angles (k, n), rad, for input angles (k,), rad; nan where the input is
        out of reach.

        ``root`` is one of `roots`. Angles at poles of the tangents are exact, for no
        tangent is formed.
        """
        theta_1 = np.asarray(theta_1, dtype=float)
        constants = self.evaluate_constants(parameters)
        first = np.sin(theta_1 / 2), np.cos(theta_1 / 2)
        second: tuple[np.ndarray, ...] = ()
        is_real = np.ones(len(theta_1), dtype=bool)
        if self.relation is not None:
            coefficients = self.evaluate_quadratic(*first, *constants)
            a, b, c = (_broadcast(x, theta_1) for x in coefficients)
            second, is_real = _root(a, b, c, root)
        out = np.empty((len(theta_1), self.n))
        for i, pairs in enumerate(self._pairs(*first, *second, *constants)):
            out[:, i] = _angles(pairs, theta_1)
        out[~is_real] = np.nan
        return np.remainder(out + np.pi, 2 * np.pi) - np.pi

    def latex(self) -> dict[str, str]:
        """LaTeX of the constants, of the relation and of tan(theta_i/2), by the name of
        what stands left."""
        import sympy as sp

        out = {}
        for name, value in self.constants.items():
            out[constant_latex(name)] = sp.latex(value)
        tangents = []
        plain: dict[Number, sp.Expr] = {}
        for i in (1, self.second):
            if i:
                s, c = joint(i)
                plain[s] = sp.Symbol(f"t_{i}", real=True)
                plain[c] = sp.Integer(1)
                tangents.append(plain[s])
        if self.relation is not None:
            expanded = sp.expand(sp.sympify(self.relation).subs(plain))
            out["0"] = sp.latex(sp.collect(expanded, tangents))
        for i, pairs in enumerate(self.half_tangents, start=1):
            top, bottom = (sp.sympify(x).subs(plain) for x in pairs[0])
            quotient = _quotient(top, bottom)
            out[rf"\tan\frac{{\theta_{i}}}{{2}}"] = sp.latex(quotient)
        return out


def constant_latex(name: str) -> str:
    """LaTeX of the symbol of a constant."""
    import sympy as sp

    return str(sp.latex(constant(name)))


def _quotient(top: sp.Expr, bottom: sp.Expr) -> sp.Expr:
    """The quotient as it is shown: infinite, a polynomial in factors, or a fraction as
    it stands."""
    import sympy as sp

    if bottom == 0:
        return sp.oo
    if bottom.is_number:
        return sp.factor(sp.cancel(top / bottom))
    return top / bottom


def _compiled(
    arguments: Sequence[Number], expressions: Sequence[object], **functions: object
) -> Callable[..., Any]:
    """A function that evaluates the expressions for numbers of any type."""
    import sympy as sp

    modules = [functions] if functions else []
    compiled: Callable[..., Any] = sp.lambdify(
        arguments, expressions, modules=modules, cse=True
    )
    return compiled


def _broadcast(value: Number, like: np.ndarray) -> np.ndarray:
    """``value``, a number or an array, in the shape of ``like``."""
    return np.asarray(value + 0 * like)


def _angles(pairs: Sequence[Pair], like: np.ndarray) -> np.ndarray:
    """The angles (k,), rad, of a joint, from the longest of its pairs at each input."""
    angles = []
    sizes = []
    for top, bottom in pairs:
        y = _broadcast(top, like)
        x = _broadcast(bottom, like)
        angles.append(2 * np.arctan2(y, x))
        sizes.append(np.hypot(y, x))
    best = np.argmax(sizes, axis=0)
    return np.asarray(np.choose(best, angles))


def _root(a: np.ndarray, b: np.ndarray, c: np.ndarray, sign: int) -> _Root:
    """A root of a t^2 + b t + c.

    Of the two equal quotients the longer pair is kept, so that nothing is lost by
    cancellation. A discriminant that is negative by rounding alone is taken as zero.
    """
    square = b * b - 4 * a * c
    size = np.abs(a) + np.abs(b) + np.abs(c)
    is_real = square > -ROUNDING * size**2
    root = sign * np.sqrt(np.maximum(square, 0.0))
    one_y = root - b
    one_x = 2 * a
    other_y = 2 * c
    other_x = -b - root
    one_length = np.hypot(one_y, one_x)
    other_length = np.hypot(other_y, other_x)
    is_one = one_length >= other_length
    norm = np.maximum(np.maximum(one_length, other_length), 1e-300)
    top = np.where(is_one, one_y, other_y) / norm
    bottom = np.where(is_one, one_x, other_x) / norm
    return _Root((top, bottom), is_real)
