"""Wohlhart's double-Goldberg 6R (WDG) and the double-subtractive-Goldberg 6R (DSG),
general and special, and
the former with kink angles.

Links 12 and 45 are a + c / alpha + gamma (WDG) or a - c / alpha - gamma (DSG), links 23
and 61 are d / delta, links 34 and 56 are b / beta; all four basic links have one
Bennett ratio and all offsets vanish. This is the convention of Song 2013, eq. (5.2.1);
that of Song and Chen 2012, eq. (5.1), is got by exchanging beta and delta. A ``sign``
is +1 for the WDG and -1 for the DSG throughout.

Forms. With t_i = tan(theta_i/2), the constructive Forms I and II have theta6 = -theta3,
t1 t2 = k_d, t4 t5 = k_b and theta1 + theta2 + theta4 + theta5 = 0, the non-constructive
Forms III and IV have theta6 = theta3, t1 t2 = K_d, t4 t5 = K_b and theta1 - theta2 =
theta4 - theta5, both modulo 2 pi. Each pair is one curve in t1 and t4,

    t4 + k'/t4 = slope (t1 + k/t1),

with two real circuits. A circuit passes through two of its four flat configurations,
where t1 and t4 are 0 or infinite, and that tells the two forms of a pair apart:
- Form I holds the plus root next to theta1 = pi in Song 2013, eq. (5.2.4), for the WDG,
  and next to theta1 = -pi in eq. (5.2.7) for the DSG. Wherever the printed switching of
  roots describes one smooth circuit, it is this one.
- Form III is the circuit through t1 = t4 = 0, where it meets Form I of the special
  linkages.

Closed forms. Forms I and II: Song (2013), equations (5.2.2)-(5.2.8); Song and Chen
(2012), equations (5.2)-(5.5). Both roots of the quadratic are configurations for every
input, whatever the printed switching says. Written for t1 and t4, the quadratic is
symmetric; the double-subtractive linkage has -gamma for gamma.

Forms III and IV are known in the sources as numerical paths. Here: theta6 = theta3, and
with the half-angle tangents a, b, g, d of the basic links, v = a + g, w = a g (g
negative for the double-subtractive linkage), N_x = v (1 + w x^2) + x (1 - w)^2 and D_x
= v (1 + w x^2) - x (1 - w)^2,

    d (D_b t4 + N_b / t4) = b (D_d t1 + N_d / t1),   t1 t2 = -N_d / D_d,
    t4 t5 = -N_b / D_b,   t3 = (b D_d t1 - d D_b t4) / E,   E = v (d - b) (1 + w b d).

Eliminating t4 gives E t3^2 + b (N_d / t1 - D_d t1) t3 + v (d + b) (1 - w b d) = 0.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple, TypeAlias

import numpy as np

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ZERO,
    ClosedForm,
    Pair,
    constant,
    joint,
    minus,
    negative,
    only,
    plus,
    reciprocal,
    symbols,
    tangent,
)
from linkages.construction.conditions import (
    bennett_length,
    require_different,
    require_equal,
    require_positive,
    require_twists,
)
from linkages.construction.constructions import superpose
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number, atan, tan
from linkages.construction.possible_angles import kink_pairs, twist_pairs
from linkages.construction.spatial_triangle import KinkAngle
from linkages.entry import FormPattern
from linkages.entry_table import Model, read_entries
from linkages.families.goldberg_5r import generalized_goldberg
from linkages.loop import Loop

POSITION = 80
WDG, DSG = "wohlhart-double-goldberg", "double-subtractive-goldberg"


def joined_double_goldberg(
    sign: int,
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """The double-Goldberg 6R of the links a/alpha, b/beta, c/gamma, d/delta: Wohlhart's,
    or for ``sign`` -1 the double-subtractive one, with a > c.

    Twists in rad, between 0 and pi; lengths b, c, d follow from the Bennett ratio, and
    are checked when given. Raises `GeometryError` for a ratio that differs. Sources:
    Wohlhart 1991; Song 2013, eqs (5.2.1)-(5.2.8), where the products m1 m2 of (5.2.4)
    and 2 m2 Q of (5.2.5) must be m1 m6 and 2 m6 Q.
    """
    require_positive("length a", a)
    require_twists(alpha=alpha, beta=beta, gamma=gamma, delta=delta)
    link_b = Link(bennett_length("b/beta", beta, b, a, alpha), beta)
    length_c = bennett_length("c/gamma", gamma, c, a, alpha)
    link_d = Link(bennett_length("d/delta", delta, d, a, alpha), delta)
    joined = Link(a + sign * length_c, alpha + sign * gamma)
    require_positive("length of links 12 and 45", joined.length)
    if sign < 0:
        require_different("twist gamma", gamma, alpha, "alpha, whose link it cancels")
    return closed_chain(joined, link_d, link_b, joined, link_b, link_d)


def special_joined_double_goldberg(
    sign: int,
    a: Number,
    alpha: Number,
    beta: Number,
    delta: Number,
    gamma: Number | None = None,
) -> Loop:
    """The same with tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2), by which the
    twist gamma (rad) follows; it is checked when given.

    Form I of Wohlhart's, Form II of the double-subtractive linkage is a Bennett linkage
    of the joints 1, 2, 4, 5. Sources: Song and Chen 2012, eqs (5.10)-(5.13), where m1/m2
    of Form II in (5.13) must be m2/tan(theta1/2); Song 2013, eqs (5.2.25),
    (5.2.33)-(5.2.34), where b must be 1.0572, not 1.5072.
    """
    require_twists(alpha=alpha)
    product = tan(beta / 2) * tan(delta / 2)
    if gamma is None:
        gamma = 2 * atan(product / tan(alpha / 2))
    else:
        require_equal(
            "tan(alpha/2) tan(gamma/2)",
            tan(alpha / 2) * tan(gamma / 2),
            product,
            "tan(beta/2) tan(delta/2)",
        )
    return joined_double_goldberg(sign, a, alpha, beta, gamma, delta)


wohlhart_double_goldberg = partial(joined_double_goldberg, +1)
double_subtractive_goldberg = partial(joined_double_goldberg, -1)
special_wohlhart_double_goldberg = partial(special_joined_double_goldberg, +1)
special_double_subtractive_goldberg = partial(special_joined_double_goldberg, -1)


def generalized_double_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Links b, [a c], b, d, [a c], d, the pair a, c locked at ``kink_1`` and at
    ``kink_2`` (rad, or a `Kink`).

    Twists in rad; the lengths b, c, d follow from the Bennett ratio and are checked if
    given. Kinks 0, 0 give Wohlhart's linkage, pi, pi the double-subtractive one, pi, 0
    the mixed Type I; equal kinks give a linkage of Mavroidis and Roth with R2 = R3 = -R5
    = -R6. Raises `GeometryError`. Source: Wohlhart (1991a), for equal kinks.
    """
    first = generalized_goldberg(a, alpha, beta, gamma, kink_1, b, c)
    second = generalized_goldberg(a, alpha, delta, gamma, kink_2, d, c)
    return superpose(first, second, shared=2)


# --- forms

Function: TypeAlias = Callable[[np.ndarray], np.ndarray]
SPECIAL_TOLERANCE = 1e-9  # of the products of tangents
ALIKE = 1e-12  # rad: twists of links that are alike
FORM_I = "Form I (constructive 6R)"
FORM_II = "Form II (constructive 6R)"
FORM_III = "Form III (non-constructive 6R)"
FORM_IV = "Form IV (non-constructive 6R)"


def _ratio(x: float, y: float) -> float:
    return math.sin((x + y) / 2) / math.sin((x - y) / 2)


def _constructive(sign: int, alpha: float, gamma: float, x: float) -> float:
    """t_i t_j of the joints on either side of link x, in Forms I and II."""
    return _ratio(x, alpha) * _ratio(x, sign * gamma)


class _Fraction(NamedTuple):
    """A quotient whose denominator may vanish."""

    top: float
    bottom: float

    @property
    def value(self) -> float:
        """The quotient."""
        return self.top / self.bottom


def _non_constructive(sign: int, alpha: float, gamma: float, x: float) -> _Fraction:
    """t_i t_j of the joints on either side of link x, in Forms III and IV."""
    g = sign * gamma
    total = math.sin(alpha) + math.sin(g)
    part = math.sin(x)
    top = total + part + math.sin(alpha + g + x)
    bottom = total - part + math.sin(alpha + g - x)
    return _Fraction(-top, bottom)


def _products(sign: int, k_d: float, k_b: float) -> Function:
    """Residuals of theta6 = -sign theta3, the angle sum, t1 t2 = k_d and t4 t5 = k_b,
    without poles."""
    norm_d = math.hypot(1, k_d)
    norm_b = math.hypot(1, k_b)

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.moveaxis(np.asarray(theta) / 2, -1, 0)
        s = np.sin(h)
        c = np.cos(h)
        before = h[0] + sign * h[1]
        after = h[3] + sign * h[4]
        by_d = s[0] * s[1] - k_d * c[0] * c[1]
        by_b = s[3] * s[4] - k_b * c[3] * c[4]
        rows = [
            np.sin(h[5] + sign * h[2]),
            np.sin(before + sign * after),
            by_d / norm_d,
            by_b / norm_b,
        ]
        return np.stack(rows, axis=-1)

    return residual


def _circuit(
    k: float, k_other: float, slope: float, t1_infinite: bool, t4_infinite: bool
) -> Function:
    """A function that is not negative on one circuit of the curve and not positive on
    the other.

    The one circuit passes through the flat configuration where t1 and t4 are infinite
    or 0, as said. Where t1 (or t4) never meets its other root k/t1 it stays the larger
    or the smaller of the pair along a circuit; where both products are negative, the
    signs of t1 and t4 agree, or not.
    """
    if k < 0 and k_other < 0:
        agreement = 1 if t1_infinite == t4_infinite else -1
        side = math.copysign(1.0, slope) * agreement
        return lambda theta: side * np.sin(theta[..., 0]) * np.sin(theta[..., 3])
    t1_is_split = k_other > 0 and (
        k < 0 or math.sqrt(k_other) > abs(slope) * math.sqrt(k)
    )
    i, infinite = (0, t1_infinite) if t1_is_split else (3, t4_infinite)
    larger = 1.0 if infinite else -1.0
    return lambda theta: larger * (np.cos(theta[..., i + 1]) - np.cos(theta[..., i]))


def _on_side(base: Function, circuit: Function, side: int) -> Function:
    """The residual of ``base`` on the circuit where ``circuit`` has the sign
    ``side``."""

    def residual(theta: np.ndarray) -> np.ndarray:
        theta = np.asarray(theta)
        outside = np.maximum(0.0, -side * circuit(theta))
        return np.concatenate([base(theta), outside[..., None]], axis=-1)

    return residual


def _non_constructive_patterns(
    sign: int, alpha: float, beta: float, gamma: float, delta: float
) -> tuple[FormPattern, ...]:
    fraction_d = _non_constructive(sign, alpha, gamma, delta)
    fraction_b = _non_constructive(sign, alpha, gamma, beta)
    if min(abs(fraction_d.bottom), abs(fraction_b.bottom)) < ALIKE:
        return ()
    k_d = fraction_d.value
    k_b = fraction_b.value
    base = _products(-1, k_d, k_b)
    # with t2 and t5 negated this is the curve of the module's head, of products -k_d
    # and -k_b; the slope is (1 + k_b) / (1 + k_d), which is 0/0 for alpha + gamma = pi
    slope_top = math.sin(beta) * fraction_d.bottom
    slope = slope_top / (math.sin(delta) * fraction_b.bottom)
    circuit = _circuit(-k_d, -k_b, slope, t1_infinite=False, t4_infinite=False)
    return (
        FormPattern(FORM_III, _on_side(base, circuit, +1)),
        FormPattern(FORM_IV, _on_side(base, circuit, -1)),
    )


def _has_equal_links(alpha: float, beta: float, gamma: float, delta: float) -> bool:
    gaps = [abs(x - y) for x in (beta, delta) for y in (alpha, gamma)]
    return min(gaps) < ALIKE


def patterns(
    sign: int, alpha: float, beta: float, gamma: float, delta: float
) -> tuple[FormPattern, ...]:
    """The four forms of the WDG (``sign`` +1) or the DSG (-1) with these twists, rad.

    Empty when two of the basic links are alike, where the ratios of Song 2013, eq.
    (5.2.3), are infinite; without Forms III and IV where K_d or K_b is.
    """
    if _has_equal_links(alpha, beta, gamma, delta):
        return ()
    product = math.tan(beta / 2) * math.tan(delta / 2)
    gap = math.tan(alpha / 2) * math.tan(gamma / 2) - product
    if abs(gap) < SPECIAL_TOLERANCE:
        return special_patterns(sign, alpha, beta, delta)
    k_d = _constructive(sign, alpha, gamma, delta)
    k_b = _constructive(sign, alpha, gamma, beta)
    base = _products(+1, k_d, k_b)
    # where tan(theta4/2) tends on the plus root as theta1 tends to pi in the WDG, to -pi
    # in the DSG
    t4_infinite = k_b < 1
    if sign < 0:
        m1 = _ratio(beta, alpha)
        m3 = _ratio(delta, alpha)
        m4 = _ratio(delta, gamma)
        m6 = _ratio(beta, gamma)
        t4_infinite = (m6 - m1) * m4 * (m4 - m3) > 0
    slope = (1 - k_b) / (k_d - 1)
    circuit = _circuit(k_d, k_b, slope, t1_infinite=True, t4_infinite=t4_infinite)
    return (
        FormPattern(FORM_I, _on_side(base, circuit, +1)),
        FormPattern(FORM_II, _on_side(base, circuit, -1)),
        *_non_constructive_patterns(sign, alpha, beta, gamma, delta),
    )


def special_patterns(
    sign: int, alpha: float, beta: float, delta: float
) -> tuple[FormPattern, ...]:
    """The four forms under tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2), for
    `patterns`.

    The curve of Forms I and II falls apart. WDG: theta4 = -theta1 in Form I, the
    Bennett form with theta3 = theta6 = 0, and theta5 = -theta1 in Form II. DSG: theta1
    + theta5 = pi in Form I, and theta1 + theta4 = pi in Form II, the Bennett form with
    theta3 = theta6 = pi.
    """
    product = math.tan(beta / 2) * math.tan(delta / 2)
    gamma = 2 * math.atan(product / math.tan(alpha / 2))
    if _has_equal_links(alpha, beta, gamma, delta):
        return ()
    k_d = _constructive(sign, alpha, gamma, delta)
    k_b = _constructive(sign, alpha, gamma, beta)
    base = _products(+1, k_d, k_b)
    bennett = _with_partner(base, sign, 3, is_bennett=True)
    other = _with_partner(base, sign, 4, is_bennett=False)
    if sign > 0:
        first = FormPattern("Form I (Bennett 4R)", bennett)
        second = FormPattern(FORM_II, other)
    else:
        first = FormPattern(FORM_I, other)
        second = FormPattern("Form II (Bennett 4R)", bennett)
    rest = _non_constructive_patterns(sign, alpha, beta, gamma, delta)
    return first, second, *rest


def _with_partner(
    base: Function, sign: int, partner: int, is_bennett: bool
) -> Function:
    """The residual of ``base`` where joint ``partner`` (from 0) turns against joint 1;
    in a Bennett form the joints 3 and 6 stand still."""
    zero = np.sin if sign > 0 else np.cos

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.asarray(theta) / 2
        rows = [zero(h[..., 0] + h[..., partner])]
        if is_bennett:
            rows += [zero(h[..., 2]), zero(h[..., 5])]
        return np.concatenate([base(theta), np.stack(rows, axis=-1)], axis=-1)

    return residual


# --- closed forms

TWISTS = ("alpha", "beta", "gamma", "delta")


class _Tangents:
    """Half tangents of the basic links: b and d ``exchanged`` if so, gamma negative in
    the DSG, and following from the others in the special linkages."""

    def __init__(self, sign: int, special: bool = False, exchanged: bool = False):
        alpha, beta, gamma, delta = (tangent(name) for name in TWISTS)
        self.a = alpha
        self.b = delta if exchanged else beta
        self.d = beta if exchanged else delta
        self.g = sign * (beta * delta / alpha if special else gamma)
        self.names = ("alpha", "beta", "delta") if special else TWISTS

    def ratios(self) -> dict[str, Number]:
        """The constants m_xy of the links b, d with a and c."""
        g = constant("g")
        return {
            "g": self.g,
            "m_da": _sum_over_difference(self.d, self.a),
            "m_dc": _sum_over_difference(self.d, g),
            "m_ba": _sum_over_difference(self.b, self.a),
            "m_bc": _sum_over_difference(self.b, g),
        }


def _sum_over_difference(x: Number, y: Number) -> Number:
    return (x + y) / (x - y)


def _third_pair(fourth: Pair) -> Pair:
    """Joint 3 in the constructive forms."""
    before = reciprocal(joint(1), constant("m_da"))
    after = (fourth[0], constant("m_bc") * fourth[1])
    return minus(plus(before, after), HALF_TURN)


def constructive_closed_form(
    linkage: str, sign: int, exchanged: bool = False
) -> ClosedForm:
    """Forms I and II; ``exchanged`` where links b and d have changed places."""
    tangents = _Tangents(sign, exchanged=exchanged)
    first = joint(1)
    fourth = joint(4)
    s1, c1 = first
    s4, c4 = fourth
    k_d = constant("m_da") * constant("m_dc")
    k_b = constant("m_ba") * constant("m_bc")
    left = (k_d - 1) * (s4**2 + k_b * c4**2) * s1 * c1
    right = (1 - k_b) * (s1**2 + k_d * c1**2) * s4 * c4
    third = _third_pair(fourth)
    equations = "(5.2.2)-(5.2.5)" if sign > 0 else "(5.2.6)-(5.2.8)"
    half_tangents = only(
        first,
        reciprocal(first, k_d),
        third,
        fourth,
        reciprocal(fourth, k_b),
        negative(third),
    )
    return ClosedForm(
        linkage,
        "Forms I and II",
        f"Song 2013, eqs {equations}",
        tangents.names,
        half_tangents,
        tangents.ratios(),
        relation=left - right,
        second=4,
    )


def non_constructive_closed_form(
    linkage: str, sign: int, special: bool = False, exchanged: bool = False
) -> ClosedForm:
    """Forms III and IV, by t1 and t3: for nearly equal links b and d the difference of
    t1 and t4 loses digits."""
    tangents = _Tangents(sign, special, exchanged)
    first = joint(1)
    third = joint(3)
    s1, c1 = first
    s3, c3 = third
    b, d, n_b, d_b, n_d, d_d, e, f = symbols("b d N_b D_b N_d D_d E F")
    cross = b * (n_d * c1**2 - d_d * s1**2)
    relation = e * s1 * c1 * s3**2 + cross * s3 * c3 + f * s1 * c1 * c3**2
    fourth = (
        (b * d_d * s1 * c3 - e * s3 * c1, d * d_b * c1 * c3),
        (d * n_b * s1 * c3, e * s1 * s3 + b * n_d * c1 * c3),
    )
    fifth = tuple((-n_b * c, d_b * s) for s, c in fourth)
    second = (-n_d * c1, d_d * s1)
    return ClosedForm(
        linkage,
        "Forms III and IV",
        "not in the sources, which follow these forms numerically",
        tangents.names,
        ((first,), (second,), (third,), fourth, fifth, (third,)),
        _non_constructive_constants(tangents),
        relation=relation,
        second=3,
    )


def _non_constructive_constants(tangents: _Tangents) -> dict[str, Number]:
    g, v, w, b, d = symbols("g v w b d")
    constants = {
        "b": tangents.b,
        "d": tangents.d,
        "g": tangents.g,
        "v": tangents.a + g,
        "w": tangents.a * g,
    }
    for name, x in (("b", b), ("d", d)):
        even = v * (1 + w * x**2)
        odd = x * (1 - w) ** 2
        constants[f"N_{name}"] = even + odd
        constants[f"D_{name}"] = even - odd
    constants["E"] = v * (d - b) * (1 + w * b * d)
    constants["F"] = v * (d + b) * (1 - w * b * d)
    return constants


def _special_closed_form(
    linkage: str, sign: int, form: str, fourth: Pair, fifth: Pair, bennett: bool
) -> ClosedForm:
    """Forms I and II under tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2), where
    each is rational."""
    tangents = _Tangents(sign, special=True)
    first = joint(1)
    third = _third_pair(fourth)
    if bennett:
        third = ZERO if sign > 0 else HALF_TURN
    source = "Song 2013, eqs (5.2.6)-(5.2.8) with (5.2.17), m2 being m6"
    if sign > 0:
        source = (
            "Song and Chen 2012, eqs (5.12), (5.13), "
            "m1/m2 of Form II being m2/tan(theta1/2)"
        )
    second = reciprocal(first, constant("m_da") * constant("m_dc"))
    return ClosedForm(
        linkage,
        form,
        source,
        tangents.names,
        only(first, second, third, fourth, fifth, negative(third)),
        tangents.ratios(),
    )


def _formulas(sign: int, linkage: str) -> tuple[ClosedForm, ...]:
    return (
        constructive_closed_form(linkage, sign),
        non_constructive_closed_form(linkage, sign),
    )


def _special_wdg_formulas(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    s1, c1 = first
    opposite = negative(first)
    other = (-constant("m_ba") * constant("m_bc") * c1, s1)
    return (
        _special_closed_form(
            linkage, +1, "Form I (Bennett 4R)", opposite, other, bennett=True
        ),
        _special_closed_form(linkage, +1, "Form II", other, opposite, bennett=False),
        non_constructive_closed_form(linkage, +1, special=True),
    )


def _special_dsg_formulas(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    s1, c1 = first
    rest = minus(HALF_TURN, first)
    other = (constant("m_ba") * constant("m_bc") * s1, c1)
    return (
        _special_closed_form(linkage, -1, "Form I", other, rest, bennett=False),
        _special_closed_form(
            linkage, -1, "Form II (Bennett 4R)", rest, other, bennett=True
        ),
        non_constructive_closed_form(linkage, -1, special=True),
    )


# --- first guesses


def _guesses(sign: int, special: bool, form: np.ndarray) -> Iterator[dict[str, float]]:
    """Links a + sign c, d, b twice over: a and c from their sum or difference."""
    lengths, twists, _ = form
    ratio = lengths[1] / np.sin(twists[1])
    for alpha, gamma in twist_pairs(twists[0], lengths[0] / ratio, sign):
        guess = {"a": ratio * np.sin(alpha), "alpha": alpha}
        yield guess if special else {**guess, "gamma": gamma}


def _generalized_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """Sum and product of the cosines of alpha and gamma are linear in the rest."""
    lengths, twists, offsets = form
    ratio = lengths[0] / np.sin(twists[0])
    joined = twists[1]
    for twist, sign in itertools.product((joined, joined + np.pi), (1, -1)):
        cosine = np.cos(twist)
        total = sign * lengths[1] / ratio / np.tan(twist / 2)
        shear = offsets[1] / ratio * (1 + cosine)
        top = cosine**2 + shear**2 - 1 + total**2
        product = top / (2 * (1 + cosine))
        mean = total / 2
        square = max(mean**2 - product, 0.0)
        root = np.sqrt(square)
        if abs(mean) + root >= 1:
            continue
        pair = np.arccos([mean + root, mean - root])
        for gamma, alpha in itertools.permutations(pair):
            links = {"a": ratio * np.sin(alpha), "alpha": alpha, "gamma": gamma}
            for kink_pair in kink_pairs(
                (alpha, gamma, twists[1]), (alpha, gamma, twists[4])
            ):
                yield {**links, **kink_pair}


ENTRIES = read_entries(
    "double_goldberg",
    {
        WDG: Model(
            wohlhart_double_goldberg,
            lambda a, **twists: patterns(+1, **twists),
            partial(_formulas, +1),
            partial(_guesses, +1, False),
        ),
        DSG: Model(
            double_subtractive_goldberg,
            lambda a, **twists: patterns(-1, **twists),
            partial(_formulas, -1),
            partial(_guesses, -1, False),
        ),
        f"special-{WDG}": Model(
            special_wohlhart_double_goldberg,
            lambda a, **twists: special_patterns(+1, **twists),
            _special_wdg_formulas,
            partial(_guesses, +1, True),
        ),
        f"special-{DSG}": Model(
            special_double_subtractive_goldberg,
            lambda a, **twists: special_patterns(-1, **twists),
            _special_dsg_formulas,
            partial(_guesses, -1, True),
        ),
        "generalized-double-goldberg": Model(
            generalized_double_goldberg, guesses=_generalized_guesses
        ),
    },
)
