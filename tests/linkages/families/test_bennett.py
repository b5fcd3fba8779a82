import math

import mpmath
import pytest
import sympy

from linkages.catalogue import entry
from linkages.families.bennett import bennett
from linkages.values import GeometryError

NAMES = ("bennett", "bennett-ab-2", "bennett-line-symmetric", "bennett-lb-2")
SET_UPS = tuple(entry(name).construct for name in NAMES)


@pytest.mark.parametrize("construct", SET_UPS)
def test_a_length_that_breaks_the_bennett_ratio_is_refused_with_the_amount(construct):
    b = math.sin(0.7) / math.sin(1.2)
    assert construct(1.0, 1.2, 0.7, b=b).lengths[1] == b
    with pytest.raises(
        GeometryError, match=r"link 23: sin\(twist\)/length.*off by 0\.000931"
    ):
        construct(1.0, 1.2, 0.7, b=b * 1.001)


@pytest.mark.parametrize("twist", [0.0, -0.3, math.pi, 100.0])
def test_a_twist_outside_the_half_turn_is_refused(twist):
    with pytest.raises(GeometryError, match="twist beta"):
        bennett(1.0, 1.2, twist)


def test_the_thesis_example_has_its_printed_length():
    assert bennett(1.0, math.radians(100), math.radians(40)).lengths[
        1
    ] == pytest.approx(0.6527, abs=5e-5)


@pytest.mark.parametrize("construct", SET_UPS)
def test_the_closed_form_closes_at_fifty_digits(construct, closure_entries):
    with mpmath.workdps(50):
        loop = construct(mpmath.mpf(1), mpmath.mpf("1.2"), mpmath.mpf("0.7"))
        alpha, second = loop.twists[:2]
        symmetric = construct in SET_UPS[2:]
        ratio = mpmath.cos if symmetric else mpmath.sin
        product = ratio((second + alpha) / 2) / ratio((second - alpha) / 2)
        t1 = mpmath.mpf("0.37")
        theta = [2 * mpmath.atan(t1), 2 * mpmath.atan(product / t1)]
        theta += theta if symmetric else [-theta[0], -theta[1]]
        assert (
            max(abs(x) for x in closure_entries(loop, theta, mpmath))
            < mpmath.mpf(10) ** -48
        )


def test_the_closed_form_closes_exactly_with_rational_half_angle_tangents(
    closure_entries,
):
    u, v, t1 = sympy.Rational(2, 5), sympy.Rational(7, 4), sympy.Rational(1, 3)
    loop = bennett(1, 2 * sympy.atan(u), 2 * sympy.atan(v))
    t2 = (v + u) / (v - u) / t1
    theta = [2 * sympy.atan(x) for x in (t1, t2, -t1, -t2)]
    entries = closure_entries(loop, theta, sympy)
    assert all(sympy.expand_trig(x).equals(0) for x in entries)


def test_symbols_pass_through_the_constructor():
    a, alpha, beta = sympy.symbols("a alpha beta", positive=True)
    assert bennett(a, alpha, beta).lengths[1] == a * sympy.sin(beta) / sympy.sin(alpha)
