import math

import numpy as np
import pytest

from linkages.catalogue import entry
from linkages.families.double_goldberg import (
    double_subtractive_goldberg,
    patterns,
    special_double_subtractive_goldberg,
    special_wohlhart_double_goldberg,
    wohlhart_double_goldberg,
)
from linkages.values import GeometryError

PUBLISHED = (
    1.0,
    math.radians(125),
    math.radians(60),
    math.radians(45),
)  # a, alpha, beta, delta


def _m(x, y):
    return math.sin((x + y) / 2) / math.sin((x - y) / 2)


def test_the_special_linkage_has_the_published_parameters():
    """Song 2013, eq. (5.2.34) to twelve decimals, with b = 1.0572 in place of the
    printed 1.5072."""
    loop = special_double_subtractive_goldberg(*PUBLISHED)
    assert loop.lengths[:3] == pytest.approx(
        (1 - 0.299313764821, 0.863217990013, 1.057221806162), abs=2e-12
    )
    assert 125 - math.degrees(loop.twists[0]) == pytest.approx(
        14.192677219748, abs=2e-12
    )


@pytest.mark.parametrize(
    "construct", [special_wohlhart_double_goldberg, special_double_subtractive_goldberg]
)
def test_a_twist_that_breaks_the_special_condition_is_refused_with_the_amount(
    construct,
):
    gamma = 2 * math.atan(
        math.tan(PUBLISHED[2] / 2)
        * math.tan(PUBLISHED[3] / 2)
        / math.tan(PUBLISHED[1] / 2)
    )
    construct(*PUBLISHED, gamma=gamma)
    with pytest.raises(
        GeometryError, match=r"tan\(alpha/2\) tan\(gamma/2\).*off by 0\.00097"
    ):
        construct(*PUBLISHED, gamma=gamma + 1e-3)


@pytest.mark.parametrize(
    "construct", [wohlhart_double_goldberg, double_subtractive_goldberg]
)
@pytest.mark.parametrize(
    ("length", "twist"), [("b", "beta"), ("c", "gamma"), ("d", "delta")]
)
def test_a_length_off_by_a_thousandth_is_refused_by_name(construct, length, twist):
    twists = {"alpha": 1.15, "beta": 0.87, "gamma": 0.49, "delta": 1.45}
    right = math.sin(twists[twist]) / math.sin(1.15)
    construct(1.0, **twists, **{length: right})
    with pytest.raises(
        GeometryError, match=rf"link {length}/{twist}: .*off by 0\.00091"
    ):
        construct(1.0, **twists, **{length: right * 1.001})


def test_a_subtraction_that_leaves_no_length_is_refused():
    with pytest.raises(GeometryError, match="links 12 and 45"):
        double_subtractive_goldberg(1.0, 0.4, 0.9, 1.2, 0.7)


def test_exchanging_beta_and_delta_gives_the_convention_of_the_paper():
    thesis = special_wohlhart_double_goldberg(*PUBLISHED)
    paper = special_wohlhart_double_goldberg(
        PUBLISHED[0], PUBLISHED[1], PUBLISHED[3], PUBLISHED[2]
    )
    assert paper.lengths[1] == pytest.approx(thesis.lengths[2], abs=1e-15)
    assert paper.twists[0] == pytest.approx(thesis.twists[0], abs=1e-15)


@pytest.mark.parametrize(
    ("sign", "build"),
    [(1, wohlhart_double_goldberg), (-1, double_subtractive_goldberg)],
)
def test_the_special_condition_makes_the_ratios_of_composite_links_equal(sign, build):
    a, alpha, beta, delta = PUBLISHED
    special = (
        special_wohlhart_double_goldberg
        if sign > 0
        else special_double_subtractive_goldberg
    )
    loop = special(*PUBLISHED)
    long = loop.lengths[2] + sign * loop.lengths[1]
    assert math.sin(loop.twists[0]) / loop.lengths[0] == pytest.approx(
        math.sin(beta + sign * delta) / long
    )
    general = build(a, alpha, beta, 0.4, delta)
    long = general.lengths[2] + sign * general.lengths[1]
    assert (
        abs(
            math.sin(general.twists[0]) / general.lengths[0]
            - math.sin(beta + sign * delta) / long
        )
        > 1e-2
    )


def _printed_root(sign, twists, t1):
    """Both roots of Song 2013, eqs (5.2.2)-(5.2.8) as corrected: the configuration, and
    whether it is Form I."""
    alpha, beta, gamma, delta = twists
    m1, m3, m4, m6 = (
        _m(beta, alpha),
        _m(delta, alpha),
        _m(delta, gamma),
        _m(beta, gamma),
    )
    for root in (1, -1):
        if sign > 0:
            k = m3 * m4
            q = (k - 1) * t1 / (k + t1 * t1)
            p = (
                (1 - m1 * m6)
                + root * math.sqrt((1 - m1 * m6) ** 2 - 4 * m1 * m6 * q * q)
            ) / (2 * m6 * q)
            halves = [t1, k / t1, None, m6 * p, m1 / p]
            third = math.pi + 2 * math.atan(m3 / t1) + 2 * math.atan(p)
            is_first = (root > 0) == (k > 0 or t1 * t1 > -k)
        else:
            q = (m3 + m4 * t1 * t1) / ((m4 - m3) * t1)
            p = (
                (m6 - m1) * q + root * math.sqrt(((m6 - m1) * q) ** 2 - 4 * m1 * m6)
            ) / 2
            halves = [t1, m3 / m4 / t1, None, -m1 / p, -p / m6]
            third = math.pi + 2 * math.atan(p) - 2 * math.atan(m4 * t1)
            is_first = (root > 0) == (t1 < 0)
        theta = [third if t is None else 2 * math.atan(t) for t in halves]
        yield np.array([*theta, -third]), is_first


@pytest.mark.parametrize(
    ("sign", "build"),
    [(1, wohlhart_double_goldberg), (-1, double_subtractive_goldberg)],
)
@pytest.mark.parametrize(
    "degrees", [(66, 50, 28, 83), (125, 60, 20, 45), (100, 70, 35, 50)]
)
def test_forms_one_and_two_are_told_apart_as_the_corrected_closed_form_does(
    sign, build, degrees, closure_gap
):
    twists = [math.radians(x) for x in degrees]
    loop = build(1.0, *twists)
    first, second = patterns(sign, *twists)[:2]
    for t1 in (-4.0, -0.9, -0.1, 0.2, 1.1, 5.0):
        for theta, is_first in _printed_root(sign, twists, t1):
            assert closure_gap(loop, theta) < 1e-12
            form, other = (first, second) if is_first else (second, first)
            assert np.abs(form.residual(theta)).max() < 1e-12
            assert np.abs(other.residual(theta)).max() > 1e-3


def test_the_general_patterns_turn_into_the_special_ones_under_the_special_condition():
    loop = special_wohlhart_double_goldberg(*PUBLISHED)
    gamma = loop.twists[0] - PUBLISHED[1]
    names = [
        p.name for p in patterns(1, PUBLISHED[1], PUBLISHED[2], gamma, PUBLISHED[3])
    ]
    assert "Form I (Bennett 4R)" in names
    assert "Form II (Bennett 4R)" not in names


def test_the_flat_bifurcations_of_the_special_linkage_close_with_rank_four(closure_gap):
    loop = entry("special-double-subtractive-goldberg").build()
    for flat in (
        (0, 1, 0, 0, 1, 0),
        (1, 0, 1, 0, 1, 1),
        (0, 1, 1, 1, 0, 1),
        (1, 0, 0, 1, 0, 0),
    ):
        theta = np.pi * np.array(flat)
        sigma = np.linalg.svd(loop.joint_screws(theta), compute_uv=False)
        assert closure_gap(loop, theta) < 1e-14
        assert np.count_nonzero(sigma > 1e-12) == 4
