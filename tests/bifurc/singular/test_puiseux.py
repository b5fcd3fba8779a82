"""Half-branches of plane curves whose branches are known."""

import mpmath
import pytest

from bifurc.singular.puiseux import half_branches, pairs_of, terms_above

# name: polynomial by exponents of x and y, half-branches, and of each branch whether it
# leaves the origin on the side from which it came
KNOWN = {
    "node": ({(2, 0): -1, (0, 2): 1}, 4, [False, False]),
    "isolated point": ({(2, 0): 1, (0, 2): 1}, 0, []),
    "cusp": ({(3, 0): -1, (0, 2): 1}, 2, [True]),
    "x^4 = y^3": ({(4, 0): -1, (0, 3): 1}, 2, [False]),
    "x^5 = y^4": ({(5, 0): -1, (0, 4): 1}, 2, [True]),
    "cusp of order 9": ({(9, 0): -1, (0, 2): 1}, 2, [True]),
    "tacnode": ({(2, 1): -1, (0, 2): 1}, 4, [False, False]),
    "contact of order 4": ({(4, 1): -1, (0, 2): 1}, 4, [False, False]),
    "y^2 + x^4": ({(4, 0): 1, (0, 2): 1}, 0, []),
    "three parabolas": ({(4, 1): -1, (0, 3): 1}, 6, [False] * 3),
    "line and cusp": ({(3, 1): 1, (0, 3): 1}, 4, [False, True]),
    # (y - x^2)^2 = x^5
    "ramphoid cusp": ({(4, 0): 1, (2, 1): -2, (0, 2): 1, (5, 0): -1}, 2, [True]),
    # (y - x)^2 (y + x) + x^4, of which a tangent is double
    "double tangent": (
        {(3, 0): 1, (2, 1): -1, (1, 2): -1, (0, 3): 1, (4, 0): 1},
        4,
        [False, True],
    ),
}


def terms_of(polynomial):
    return {key: mpmath.mpf(value) for key, value in polynomial.items()}


@pytest.mark.parametrize("name", KNOWN)
def test_half_branches_are_those_of_the_curve_and_belong_together(name):
    polynomial, count, returns = KNOWN[name]
    with mpmath.workdps(100):
        halves = half_branches(terms_of(polynomial), 13)
        pairs = pairs_of(halves)
    assert len(halves) == count
    assert sorted(halves[one].returns for one, _ in pairs) == returns


def test_curves_that_agree_in_all_known_terms_are_not_told_apart():
    with mpmath.workdps(100):
        assert half_branches(terms_of({(0, 2): 1}), 13) is None


@pytest.mark.parametrize("exponents", [(3, 0), (1, 1)])
def test_a_term_that_is_neither_zero_nor_plainly_none_leaves_open_what_it_decides(
    exponents,
):
    terms = {(0, 2): 1, (4, 0): -1, exponents: "1e-30"}
    with mpmath.workdps(100):
        assert half_branches(terms_of(terms), 13) is None


def test_a_term_in_doubt_that_decides_nothing_does_no_harm():
    with mpmath.workdps(100):
        terms = {(0, 2): 1, (3, 0): -1, (0, 7): "1e-30"}
        assert len(half_branches(terms_of(terms), 13)) == 2


def test_terms_that_rounding_left_are_zero():
    terms = {(0, 2): mpmath.mpf(1), (3, 0): mpmath.mpf(10) ** -70}
    assert list(terms_above(terms)) == [(0, 2)]
