"""Exact proof that a closed form closes its loop, T_1 T_2 ... T_n = I, without floating
point.

The twists get rational half-angle tangents and the lengths and the input rational
values, so that every entry of every T_i is a rational number, or holds square roots of
such. The closure is then an identity of numbers, true or false.

What that proves: multiplied by their denominators, the twelve entries of T_1 ... T_n -
I are polynomials in the free tangents and lengths, of degree ``degree`` at most (with
the conjugates over each square root, twice that). A polynomial that is not zero vanishes
at a random point with probability at most its degree over the number of values that
each variable is drawn from (Schwartz 1980, Zippel 1979). `Proof.doubt` is that bound
for all points together.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import sympy as sp

from linkages.closed_forms.closed_form import (
    ClosedForm,
    Pair,
    constant,
    joint,
)
from linkages.construction import exact, numbers
from linkages.construction.exact import Angle, Exact, Quadratic
from linkages.construction.numbers import Number
from linkages.entry import Entry, ParameterKind
from linkages.loop import Loop
from linkages.values import GeometryError

# denominator of the random tangents and lengths: at least VALUES / 10 values of each
VALUES = 1_000_000_007
# degrees of the entries of a link, and what they and two offsets have more where it is
# the link of a spatial triangle
OF_LINK = 8
OF_TRIANGLE = 40
ATTEMPTS = 40  # random parameters that a constructor may refuse before a point is found
# angles (`Angle`) and lengths (fractions), which share no operation but the sum
ExactParameters: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Proof:
    """What exact arithmetic says about one closed form: at how many ``points`` it was
    tried and ``closed``.

    ``degree`` bounds the polynomials that vanish, ``doubt`` the probability that they
    are not zero although they vanish at every point.
    """

    linkage: str
    form: str
    points: int
    closed: int
    degree: int
    doubt: float

    @property
    def proved(self) -> bool:
        """Whether the loop closed exactly at every point."""
        return self.points > 0 and self.closed == self.points


def exact_parameters(linkage: Entry, rng: np.random.Generator) -> ExactParameters:
    """Random exact parameters within their ranges: angles with rational half tangents,
    rational lengths."""
    out: ExactParameters = {}
    for p in linkage.parameters:
        if p.kind is ParameterKind.ANGLE:
            low = np.tan(p.low / 2)
            high = np.tan(p.high / 2)
            out[p.name] = Angle(_random_fraction(rng, low, high))
        else:
            out[p.name] = _random_fraction(rng, p.low, p.high)
    return out


def _random_fraction(rng: np.random.Generator, low: float, high: float) -> Fraction:
    return Fraction(round(rng.uniform(low, high) * VALUES), VALUES)


def exact_angles(
    form: ClosedForm, parameters: Mapping[str, Number], t_1: Fraction, root: int
) -> list[list[Angle]] | None:
    """For each joint the angles that its pairs give at tan(theta1/2) = ``t_1``; None
    where a pair is 0/0.

    Every pair of a joint is there, for they must agree.
    """
    constants = form.evaluate_constants(parameters)
    one = Fraction(1)
    first = (t_1, one)
    second = None
    if form.relation is not None:
        a, b, c = form.evaluate_quadratic(*first, *constants)
        if a == 0:
            return None
        square = _exact(b * b - 4 * a * c)
        t_2 = (-b + root * numbers.sqrt(square)) / (2 * a)
        second = (t_2, one)
    out = []
    for pairs in form.evaluate_pairs(first, second, constants):
        if any(y == 0 and x == 0 for y, x in pairs):
            return None
        out.append([_angle(pair) for pair in pairs])
    return out


def _angle(pair: Pair) -> Angle:
    y, x = (_exact(value) for value in pair)
    return Angle(y, x)


def _exact(value: object) -> Exact:
    """The value itself; raises `TypeError` if it is not an exact number."""
    if isinstance(value, int):
        return Fraction(value)
    if isinstance(value, Fraction | Quadratic):
        return value
    raise TypeError(f"{value!r} is not an exact number")


def closing_defects(loop: Loop, theta: Sequence[Angle]) -> list[Exact]:
    """The twelve entries of the upper rows of T_1 ... T_n - I, exact. Raises
    `TypeError` if one is not."""
    identity = [[Fraction(int(i == j)) for j in range(4)] for i in range(4)]
    product: list[list[Exact]] = [list(row) for row in identity]
    for i, angle in enumerate(theta):
        step = _transform(angle, loop, i)
        product = [_row_times(row, step) for row in product]
    out = []
    for row, plain in zip(product[:3], identity[:3], strict=True):
        for value, unit in zip(row, plain, strict=True):
            out.append(_exact(value - unit))
    return out


def _transform(angle: Angle, loop: Loop, i: int) -> list[list[Exact]]:
    """The transform of joint ``i`` (from 0) and its link."""
    c = exact.cos(angle)
    s = exact.sin(angle)
    ca = numbers.cos(loop.twists[i])
    sa = numbers.sin(loop.twists[i])
    length = loop.lengths[i]
    offset = loop.offsets[i]
    rows = (
        (c, -s * ca, s * sa, length * c),
        (s, c * ca, -c * sa, length * s),
        (0, sa, ca, offset),
        (0, 0, 0, 1),
    )
    return [[_exact(value) for value in row] for row in rows]


def _row_times(row: Sequence[Exact], matrix: Sequence[Sequence[Exact]]) -> list[Exact]:
    out = []
    for column in zip(*matrix, strict=True):
        total: Exact = Fraction(0)
        for x, y in zip(row, column, strict=True):
            total = total + x * y
        out.append(total)
    return out


def prove(form: ClosedForm, linkage: Entry, points: int = 6, seed: int = 0) -> Proof:
    """Exact closure at random rational ``points`` of parameters, input and root.

    ``linkage`` is the entry whose motion the form is. Raises `GeometryError` when its
    constructor refuses all parameters that are drawn.
    """
    rng = np.random.default_rng(seed)
    count = 0
    closures = 0
    for attempt in range(ATTEMPTS * points):
        parameters = exact_parameters(linkage, rng)
        t_1 = Fraction(int(rng.integers(-3 * VALUES, 3 * VALUES)), VALUES)
        try:
            loop = linkage.build(**parameters)
        except GeometryError:
            continue
        root = form.roots[attempt % len(form.roots)]
        angles = exact_angles(form, parameters, t_1, root)
        if angles is None:
            continue
        count += 1
        closures += _closes(loop, angles)
        if count == points:
            break
    if not count:
        name = f"exact member of {form.linkage}"
        raise GeometryError(name, "none", "one that the constructor accepts")
    bound = degree(form)
    doubt = min(1.0, 20 * bound / VALUES) ** count
    return Proof(form.linkage, form.form, count, closures, bound, doubt)


def _closes(loop: Loop, angles: list[list[Angle]]) -> bool:
    """Whether the angles of each joint agree, and close the loop."""
    for of_joint in angles:
        if any(angle != of_joint[0] for angle in of_joint):
            return False
    defects = closing_defects(loop, [of_joint[0] for of_joint in angles])
    return all(defect == 0 for defect in defects)


class _Degrees(NamedTuple):
    """Bounds of the degrees of a fraction's numerator and denominator."""

    top: int
    bottom: int


def degree(form: ClosedForm) -> int:
    """A bound of the degree of the closure's numerators: twice that of each pair, 8 for
    each link, and for each root of the constants what the link of a spatial triangle
    has more, with its offsets.

    A link of two basic links in line has a twist of degree 2 (4 in its sine) and a
    length of degree 4.
    """
    degrees: dict[Number, _Degrees] = {}
    for name, value in form.constants.items():
        degrees[constant(name)] = _degrees(sp.sympify(value), degrees)
    if form.relation is not None:
        coefficients = [_degrees(x, degrees) for x in form.quadratic]
        second = sum(one.top + one.bottom for one in coefficients)
        degrees.update(dict.fromkeys(joint(form.second), _Degrees(second, second)))
    total = OF_TRIANGLE * _roots(form)
    for pairs in form.half_tangents:
        y, x = (_degrees(sp.sympify(part), degrees) for part in pairs[0])
        total += 2 * max(y.top + x.bottom, x.top + y.bottom) + OF_LINK
    conjugates = _roots(form) + (form.relation is not None)
    factor = 2 ** max(1, conjugates)
    return int(factor * total)


def _roots(form: ClosedForm) -> int:
    """How many square roots the constants of the form hold."""
    half = sp.Rational(1, 2)
    powers = [
        power
        for value in form.constants.values()
        for power in sp.sympify(value).atoms(sp.Pow)
    ]
    return sum(bool(power.exp == half) for power in powers)


def _degrees(value: sp.Expr, degrees: Mapping[Number, _Degrees]) -> _Degrees:
    """Bounds of the degrees of an expression, some symbols having the ``degrees``
    given; a root counts as much as what stands below it."""
    if value.is_number:
        return _Degrees(0, 0)
    if value.is_Symbol:
        return degrees.get(value, _Degrees(1, 0))
    parts = [_degrees(part, degrees) for part in value.args]
    if value.is_Pow:
        times = math.ceil(abs(value.exp))
        top, bottom = times * parts[0].top, times * parts[0].bottom
        return _Degrees(top, bottom) if value.exp > 0 else _Degrees(bottom, top)
    bottom = sum(part.bottom for part in parts)
    if value.is_Mul:
        return _Degrees(sum(part.top for part in parts), bottom)
    return _Degrees(max(p.top + bottom - p.bottom for p in parts), bottom)
