"""Constructors run on doubles, at 50 digits and on sympy expressions, with one
result."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy

from linkages.catalogue import catalogue
from linkages.entry import Entry
from linkages.families.goldberg_5r import generalized_goldberg
from linkages.families.goldberg_6r import serial_goldberg, syncopated_serial_goldberg
from linkages.families.waldron import waldron_hybrid
from linkages.loop import Loop

ENTRIES = list(catalogue().values())


def flat(loop: Loop) -> list:
    return [*loop.lengths, *loop.twists, *loop.offsets]


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.name)
def test_fifty_digits_agree_with_doubles(entry: Entry):
    doubles = np.concatenate(entry.build().arrays)
    with mpmath.workdps(50):
        precise = flat(
            entry.build(**{k: mpmath.mpf(v) for k, v in entry.defaults.items()})
        )
        gap = max(
            abs(float(x - mpmath.mpf(float(y))))
            for x, y in zip(precise, doubles, strict=True)
        )
    assert gap <= 2e-13 * max(
        1, np.abs(doubles).max()
    )  # doubles lose digits in folded links and nested kinks


def matrix_product(loop: Loop, theta: list) -> mpmath.matrix:
    total = mpmath.eye(4)
    for a, alpha, r, t in zip(
        loop.lengths, loop.twists, loop.offsets, theta, strict=True
    ):
        c, s, ca, sa = (
            mpmath.cos(t),
            mpmath.sin(t),
            mpmath.cos(alpha),
            mpmath.sin(alpha),
        )
        step = [
            [c, -s * ca, s * sa, a * c],
            [s, c * ca, -c * sa, a * s],
            [0, sa, ca, r],
            [0, 0, 0, 1],
        ]
        total *= mpmath.matrix(step)
    return total


def bennett_angle(twist, common, theta):
    """Second angle of a Bennett loop with the links of these twists, from the first."""
    half = mpmath.sin((common + twist) / 2) / mpmath.sin((common - twist) / 2)
    return 2 * mpmath.atan(half / mpmath.tan(theta / 2))


def test_generalized_goldberg_closes_at_fifty_digits():
    with mpmath.workdps(50):
        a, alpha, beta, gamma, t, u = (
            mpmath.mpf(x) / 10 for x in (13, 11, 9, 5, 12, 7)
        )
        # two Bennett loops on the link b; the joint between a and c is locked where t
        # and u put it
        first, second = bennett_angle(alpha, beta, t), bennett_angle(gamma, beta, u)
        kink = -first + second + mpmath.pi
        loop = generalized_goldberg(a, alpha, beta, gamma, kink)
        ca, sa, cc, sc = (
            mpmath.cos(alpha),
            mpmath.sin(alpha),
            mpmath.cos(gamma),
            mpmath.sin(gamma),
        )
        ck, sk = mpmath.cos(kink), mpmath.sin(kink)
        before = mpmath.atan2(sk * sc, ck * sc * ca + cc * sa)
        after = mpmath.atan2(sk * sa, ck * sa * cc + ca * sc)
        theta = [first, before - t, after + u, -second, t - u + mpmath.pi]
        gap = matrix_product(loop, theta) - mpmath.eye(4)
        assert max(abs(x) for x in gap) < mpmath.mpf(10) ** -45


def rational_twist(t: Fraction) -> sympy.Expr:
    """The angle with tan(angle/2) = t: its sine and cosine are rational."""
    return 2 * sympy.atan(sympy.Rational(t.numerator, t.denominator))


HALVES = [Fraction(1, 3), Fraction(2, 5), Fraction(3, 7), Fraction(1, 5)]


@pytest.mark.parametrize("construct", [serial_goldberg, syncopated_serial_goldberg])
def test_rational_half_tangents_give_exact_lengths(construct):
    twists = [rational_twist(t) for t in HALVES]
    exact = construct(sympy.Integer(2), *twists)
    doubles = construct(2.0, *(float(t) for t in twists))
    for x, y in zip(flat(exact), flat(doubles), strict=True):
        assert abs(float(sympy.sympify(x).evalf(30)) - float(y)) < 1e-13
    a, alpha = exact.lengths[-1], exact.twists[-1]
    for length, twist in zip(exact.lengths[3:], exact.twists[3:], strict=True):
        ratio = sympy.expand_trig(sympy.sin(alpha) / a) - sympy.expand_trig(
            sympy.sin(twist) / length
        )
        assert sympy.simplify(ratio) == 0


def test_kinks_work_on_expressions():
    twists = [rational_twist(t) for t in HALVES]
    kinks = [rational_twist(Fraction(1, 4)), rational_twist(Fraction(-1, 2))]
    exact = waldron_hybrid(2, *twists[:2], 3, *twists[2:], *kinks, sympy.Rational(1, 3))
    doubles = waldron_hybrid(
        2.0,
        *(float(t) for t in twists[:2]),
        3.0,
        *(float(t) for t in (*twists[2:], *kinks)),
        1 / 3,
    )
    for x, y in zip(flat(exact), flat(doubles), strict=True):
        assert abs(float(sympy.sympify(x).evalf(30)) - float(y)) < 1e-13


def test_symbols_pass_through():
    a, alpha, beta, gamma, delta = sympy.symbols(
        "a alpha beta gamma delta", positive=True
    )
    loop = serial_goldberg(a, alpha, beta, gamma, delta)
    assert sympy.simplify(loop.lengths[0] - a * sympy.sin(beta) / sympy.sin(alpha)) == 0
    assert loop.twists[1] == alpha + gamma + delta
