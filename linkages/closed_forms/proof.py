"""Exact proof that a closed form closes its loop, T_1 T_2 ... T_n = I, without floating
point.

The twists get rational half-angle tangents and the lengths and the input rational
values, so that every entry of every T_i is a rational number, or lies in one quadratic
extension of the rationals. The closure is then an identity of numbers, true or false.

What that proves: multiplied by their denominators, the twelve entries of T_1 ... T_n -
I are polynomials in the free tangents and lengths, of degree ``degree`` at most (with
the conjugate over the square root, twice that). A polynomial that is not zero vanishes
at a random point with probability at most its degree over the number of values that
each variable is drawn from (Schwartz 1980, Zippel 1979). `Proof.doubt` is that bound
for all points together.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from linkages.catalogue import entry
from linkages.closed_forms.closed_form import ClosedForm, constant, joint
from linkages.construction import numbers
from linkages.construction.exact import Angle, Quadratic
from linkages.entry import Entry
from linkages.loop import GeometryError, Loop

__all__ = [
    "Proof",
    "closing_defects",
    "exact_angles",
    "exact_parameters",
    "prove",
    "prove_symbolically",
]

# denominator of the random tangents and lengths: at least VALUES / 10 values of each
VALUES = 1_000_000_007
ATTEMPTS = 40  # random parameters that a constructor may refuse before a point is found


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


def exact_parameters(found: Entry, rng: np.random.Generator) -> dict[str, Any]:
    """Random exact parameters within their ranges: angles with rational half tangents,
    rational lengths."""
    out: dict[str, Any] = {}
    for p in found.parameters:
        low, high = (np.tan(x / 2) if p.kind == "angle" else x for x in (p.low, p.high))
        value = Fraction(round(rng.uniform(low, high) * VALUES), VALUES)
        out[p.name] = Angle(value) if p.kind == "angle" else value
    return out


def exact_angles(
    form: ClosedForm, parameters: dict[str, Any], t_1: Fraction, root: int
) -> list[list[Angle]] | None:
    """For each joint the angles that its pairs give at tan(theta1/2) = ``t_1``; None
    where a pair is 0/0.

    Every pair of a joint is there, for they must agree.
    """
    constants = form.evaluate_constants(parameters)
    first, second = (t_1, Fraction(1)), None
    if form.relation is not None:
        a, b, c = form.evaluate_quadratic(first, constants)
        if a == 0:
            return None
        second = (
            (-b + root * numbers.sqrt(Fraction(b * b - 4 * a * c))) / (2 * a),
            Fraction(1),
        )
    pairs = form.evaluate_pairs(first, second, constants)
    if any(y == 0 and x == 0 for alike in pairs for y, x in alike):
        return None
    return [[Angle(y, x) for y, x in alike] for alike in pairs]


def closing_defects(loop: Loop, theta: list[Angle]) -> list[Any]:
    """The twelve entries of the upper rows of T_1 ... T_n - I, exact. Raises
    `TypeError` if one is not."""
    product: list[list[Any]] = [
        [Fraction(int(i == j)) for j in range(4)] for i in range(4)
    ]
    for turn, length, twist, offset in zip(
        theta, loop.lengths, loop.twists, loop.offsets, strict=True
    ):
        c, s, ca, sa = (
            numbers.cos(turn),
            numbers.sin(turn),
            numbers.cos(twist),
            numbers.sin(twist),
        )
        step = [
            [c, -s * ca, s * sa, length * c],
            [s, c * ca, -c * sa, length * s],
            [0, sa, ca, offset],
            [0, 0, 0, 1],
        ]
        product = [
            [_dot(row, [line[j] for line in step]) for j in range(4)] for row in product
        ]
    out = [product[i][j] - (1 if i == j else 0) for i in range(3) for j in range(4)]
    for value in out:
        if not isinstance(value, int | Fraction | Quadratic):
            raise TypeError(f"{value!r} is not an exact number")
    return out


def _dot(x: list[Any], y: list[Any]) -> Any:
    return sum((a * b for a, b in zip(x, y, strict=True)), Fraction(0))


def prove(form: ClosedForm, points: int = 6, seed: int = 0) -> Proof:
    """Exact closure at random rational ``points`` of parameters, input and root. Raises
    `GeometryError` for none."""
    rng, found = np.random.default_rng(seed), entry(form.linkage)
    tried = closed = 0
    for attempt in range(ATTEMPTS * points):
        parameters = exact_parameters(found, rng)
        t_1 = Fraction(int(rng.integers(-3 * VALUES, 3 * VALUES)), VALUES)
        try:
            loop = found.build(**parameters)
        except GeometryError:
            continue
        angles = exact_angles(
            form, parameters, t_1, form.roots[attempt % len(form.roots)]
        )
        if angles is None:
            continue
        tried += 1
        alike = all(angle == same[0] for same in angles for angle in same)
        closed += alike and all(
            x == 0 for x in closing_defects(loop, [same[0] for same in angles])
        )
        if tried == points:
            break
    if not tried:
        raise GeometryError(
            f"exact member of {form.linkage}",
            "none",
            "one that the constructor accepts",
        )
    bound = degree(form)
    return Proof(
        form.linkage,
        form.form,
        tried,
        closed,
        bound,
        min(1.0, 20 * bound / VALUES) ** tried,
    )


def degree(form: ClosedForm) -> int:
    """A bound of the degree of the closure's numerators: twice that of each pair, and 8
    for each link.

    A link of two basic links has a twist of degree 2 (4 in its sine) and a length of
    degree 4; offsets and the links of spatial triangles stay below that as well.
    """
    known: dict[sp.Symbol, int] = {}
    for name, value in form.constants.items():
        known[constant(name)] = _degree(sp.sympify(value), known)
    second = 0
    if form.relation is not None:
        second = sum(_degree(x, known) for x in form.quadratic)
        known.update(dict.fromkeys(joint(form.second), second))
    joints = [
        max(_degree(sp.sympify(x), known) for x in pairs[0])
        for pairs in form.half_tangents
    ]
    return 2 * sum(2 * d + 8 for d in joints)


def _degree(value: sp.Expr, known: dict[sp.Symbol, int]) -> int:
    """A bound of the degree of numerator and denominator, ``known`` symbols having the
    degrees given."""
    if value.is_number:
        return 0
    if value.is_Symbol:
        return known.get(value, 1)
    parts = [_degree(part, known) for part in value.args]
    if value.is_Pow:
        return int(parts[0] * max(1, abs(value.exp)))
    return sum(parts)


def prove_symbolically(form: ClosedForm) -> bool:
    """Whether the closure vanishes identically in all symbols; for loops without
    offsets and rational closed forms.

    The first half of the loop is compared with the inverse of the rest. A second for a
    4R, half a minute for a 5R.
    """
    found = entry(form.linkage)
    loop = found.build(
        **{name: sp.Symbol(name, positive=True) for name in found.defaults}
    )
    tangents = {
        sp.Symbol(name, positive=True): sp.Symbol(f"u_{name}", real=True)
        for name in form.angles
    }
    halves = {name: _Symbolic(name) for name in form.angles}
    pairs = form.evaluate_pairs(
        (sp.Symbol("t_1", real=True), sp.Integer(1)),
        None,
        form.evaluate_constants(halves),
    )
    steps = []
    for alike, length, twist in zip(pairs, loop.lengths, loop.twists, strict=True):
        y, x = alike[0]
        c, s = (x**2 - y**2) / (x**2 + y**2), 2 * x * y / (x**2 + y**2)
        ca, sa, a = (
            _by_tangents(value, tangents)
            for value in (sp.cos(twist), sp.sin(twist), length)
        )
        turn = sp.Matrix([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        steps.append(
            (
                turn,
                sp.Matrix(
                    [[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]]
                ),
            )
        )
    ahead, back, middle = sp.eye(4), sp.eye(4), (loop.n + 1) // 2
    for turn, link in steps[:middle]:
        ahead = (ahead * turn * link).applyfunc(sp.factor)
    for turn, link in steps[middle:]:
        back = (_inverse(link) * turn.T * back).applyfunc(sp.factor)
    return bool(
        (ahead - back)
        .applyfunc(lambda x: sp.numer(sp.together(x)).expand())
        .is_zero_matrix
    )


def _inverse(transform: sp.Matrix) -> sp.Matrix:
    """The inverse of a rigid transform."""
    turn, shift = transform[:3, :3].T, transform[:3, 3]
    return sp.Matrix.vstack(
        sp.Matrix.hstack(turn, -turn * shift), sp.Matrix([[0, 0, 0, 1]])
    )


@dataclass(frozen=True)
class _Symbolic:
    """A twist known by the symbol of its half tangent."""

    name: str

    def __truediv__(self, two: int) -> sp.Expr:
        return sp.atan(sp.Symbol(f"u_{self.name}", real=True))


def _by_tangents(value: Any, tangents: dict[sp.Symbol, sp.Symbol]) -> Any:
    """``value`` with sines and cosines of the twists written by the tangents of their
    halves."""
    known = {sp.sin(x): 2 * u / (1 + u**2) for x, u in tangents.items()}
    known |= {sp.cos(x): (1 - u**2) / (1 + u**2) for x, u in tangents.items()}
    return sp.factor(sp.expand_trig(sp.sympify(value)).subs(known))
