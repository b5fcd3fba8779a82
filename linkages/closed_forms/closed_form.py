"""Closed forms of motion: one pair of expressions per joint, for numbers, for LaTeX and
for proof.

With t_i = tan(theta_i/2) = s_i/c_i the angle of every joint is a homogeneous pair
(numerator, denominator) of polynomials in the pair (s_1, c_1) of the input joint and,
on curves that are not rational, in the pair of a second joint that is tied to it by one
quadratic relation. Pairs have no poles: angles are added by multiplying pairs. This
module and the modules of closed forms import sympy; the catalogue does not import them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from linkages.construction import numbers

__all__ = [
    "HALF_TURN",
    "ZERO",
    "ClosedForm",
    "Pair",
    "constant",
    "joint",
    "minus",
    "negative",
    "plus",
    "ratio",
    "reciprocal",
    "tangent",
]

Pair = tuple[Any, Any]
ZERO: Pair = (sp.Integer(0), sp.Integer(1))
HALF_TURN: Pair = (sp.Integer(1), sp.Integer(0))


def joint(i: int) -> Pair:
    """The pair (s_i, c_i) of joint ``i``, from 1."""
    s, c = sp.symbols(f"s_{i} c_{i}", real=True)
    return s, c


def tangent(name: str) -> sp.Symbol:
    """The tangent of half the twist or kink called ``name``."""
    return sp.Symbol(f"u_{name}", real=True)


def constant(name: str) -> sp.Symbol:
    """A length or offset of the geometry, or a constant that a closed form defines."""
    return sp.Symbol(name, real=True)


def plus(x: Pair, y: Pair) -> Pair:
    """The pair of the sum of two angles."""
    return x[0] * y[1] + x[1] * y[0], x[1] * y[1] - x[0] * y[0]


def negative(x: Pair) -> Pair:
    """The pair of the opposite angle."""
    return -x[0], x[1]


def minus(x: Pair, y: Pair) -> Pair:
    """The pair of the difference of two angles."""
    return plus(x, negative(y))


def reciprocal(x: Pair, factor: Any = 1) -> Pair:
    """The pair whose tangent is ``factor`` over that of ``x``."""
    return factor * x[1], x[0]


def ratio(x: str, y: str) -> Any:
    """sin((x + y)/2) / sin((x - y)/2) of two twists, by the tangents of their
    halves."""
    return (tangent(x) + tangent(y)) / (tangent(x) - tangent(y))


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
    constants: Mapping[str, Any] = field(default_factory=dict)
    lengths: tuple[str, ...] = ()
    relation: Any = None
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
    def _variables(self) -> list[sp.Symbol]:
        return [
            *joint(1),
            *(joint(self.second) if self.second else ()),
            *map(constant, self.constants),
        ]

    @cached_property
    def _constants(self) -> Any:
        known: dict[sp.Symbol, Any] = {}
        for name, value in self.constants.items():
            known[constant(name)] = sp.sympify(value).subs(known)
        arguments = [*map(tangent, self.angles), *map(constant, self.lengths)]
        return sp.lambdify(
            arguments, list(known.values()), modules=[{"sqrt": numbers.sqrt}], cse=True
        )

    @cached_property
    def _pairs(self) -> Any:
        return sp.lambdify(
            self._variables,
            [list(pairs) for pairs in self.half_tangents],
            modules=[],
            cse=True,
        )

    @cached_property
    def quadratic(self) -> tuple[Any, Any, Any]:
        """Coefficients (A, B, C) of the relation A t^2 + B t + C = 0 of the second
        joint, without poles."""
        s, c = joint(self.second)
        found = sp.Poly(self.relation, s, c)
        return (
            found.coeff_monomial(s**2),
            found.coeff_monomial(s * c),
            found.coeff_monomial(c**2),
        )

    @cached_property
    def _quadratic(self) -> Any:
        arguments = [*joint(1), *map(constant, self.constants)]
        return sp.lambdify(arguments, list(self.quadratic), modules=[], cse=True)

    def evaluate_constants(self, parameters: Mapping[str, Any]) -> list[Any]:
        """Values of the constants for parameters of any number type, angles in rad or
        exact."""
        tangents = [numbers.tan(parameters[name] / 2) for name in self.angles]
        return list(
            self._constants(*tangents, *(parameters[name] for name in self.lengths))
        )

    def evaluate_quadratic(self, first: Pair, constants: list[Any]) -> list[Any]:
        """Coefficients (A, B, C) for a pair of the input joint, of any number type."""
        return list(self._quadratic(*first, *constants))

    def evaluate_pairs(
        self, first: Pair, second: Pair | None, constants: list[Any]
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
        values = self.evaluate_constants(parameters)
        first = np.sin(theta_1 / 2), np.cos(theta_1 / 2)
        second, reached = None, np.ones(len(theta_1), dtype=bool)
        if self.relation is not None:
            a, b, c = (x + 0 * theta_1 for x in self.evaluate_quadratic(first, values))
            second, reached = _root(a, b, c, root)
        out = np.empty((len(theta_1), self.n))
        for i, pairs in enumerate(self.evaluate_pairs(first, second, values)):
            angles = [(y + 0 * theta_1, x + 0 * theta_1) for y, x in pairs]
            best = np.argmax([np.hypot(y, x) for y, x in angles], axis=0)
            out[:, i] = np.choose(best, [2 * np.arctan2(y, x) for y, x in angles])
        out[~reached] = np.nan
        return np.remainder(out + np.pi, 2 * np.pi) - np.pi

    def latex(self) -> dict[str, str]:
        """LaTeX of the constants, of the relation and of tan(theta_i/2), by the name of
        what stands left."""
        out = {
            constant_latex(name): sp.latex(value)
            for name, value in self.constants.items()
        }
        t = {joint(i)[0]: sp.Symbol(f"t_{i}", real=True) for i in (1, self.second) if i}
        plain = {**t, **{joint(i)[1]: sp.Integer(1) for i in (1, self.second) if i}}
        if self.relation is not None:
            out["0"] = sp.latex(
                sp.collect(sp.expand(self.relation.subs(plain)), list(t.values()))
            )
        for i, pairs in enumerate(self.half_tangents, start=1):
            top, bottom = (sp.sympify(x).subs(plain) for x in pairs[0])
            shown = (
                sp.oo
                if bottom == 0
                else sp.factor(sp.cancel(top / bottom))
                if bottom.is_number
                else top / bottom
            )
            out[rf"\tan\frac{{\theta_{i}}}{{2}}"] = sp.latex(shown)
        return out


def constant_latex(name: str) -> str:
    """LaTeX of the symbol of a constant."""
    return str(sp.latex(constant(name)))


def _root(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, sign: int
) -> tuple[Pair, np.ndarray]:
    """The root of a t^2 + b t + c as a pair of unit length, and where it is real.

    Of the two equal quotients the longer pair is kept, so that nothing is lost by
    cancellation. A discriminant that is negative by rounding alone is taken as zero.
    """
    square = b * b - 4 * a * c
    reached = square > -1e-13 * (np.abs(a) + np.abs(b) + np.abs(c)) ** 2
    size = sign * np.sqrt(np.maximum(square, 0.0))
    one, other = (size - b, 2 * a), (2 * c, -b - size)
    lengths = np.hypot(*one), np.hypot(*other)
    longer = lengths[0] >= lengths[1]
    norm = np.maximum(np.maximum(*lengths), 1e-300)
    return (
        np.where(longer, one[0], other[0]) / norm,
        np.where(longer, one[1], other[1]) / norm,
    ), reached
