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
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import TypeAlias

import numpy as np

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


def _non_constructive(
    sign: int, alpha: float, gamma: float, x: float
) -> tuple[float, float]:
    """t_i t_j of the joints on either side of link x, in Forms III and IV, as a quotient
    whose denominator may vanish."""
    g = sign * gamma
    total = math.sin(alpha) + math.sin(g)
    part = math.sin(x)
    top = total + part + math.sin(alpha + g + x)
    bottom = total - part + math.sin(alpha + g - x)
    return -top, bottom


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
    top_d, bottom_d = _non_constructive(sign, alpha, gamma, delta)
    top_b, bottom_b = _non_constructive(sign, alpha, gamma, beta)
    if min(abs(bottom_d), abs(bottom_b)) < ALIKE:
        return ()
    k_d = top_d / bottom_d
    k_b = top_b / bottom_b
    base = _products(-1, k_d, k_b)
    # with t2 and t5 negated this is the curve of the module's head, of products -k_d
    # and -k_b; the slope is (1 + k_b) / (1 + k_d), which is 0/0 for alpha + gamma = pi
    slope = math.sin(beta) * bottom_d / (math.sin(delta) * bottom_b)
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
            guesses=partial(_guesses, +1, False),
        ),
        DSG: Model(
            double_subtractive_goldberg,
            lambda a, **twists: patterns(-1, **twists),
            guesses=partial(_guesses, -1, False),
        ),
        f"special-{WDG}": Model(
            special_wohlhart_double_goldberg,
            lambda a, **twists: special_patterns(+1, **twists),
            guesses=partial(_guesses, +1, True),
        ),
        f"special-{DSG}": Model(
            special_double_subtractive_goldberg,
            lambda a, **twists: special_patterns(-1, **twists),
            guesses=partial(_guesses, -1, True),
        ),
        "generalized-double-goldberg": Model(
            generalized_double_goldberg, guesses=_generalized_guesses
        ),
    },
)
