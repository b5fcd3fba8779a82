"""Invariants of singular points of plane curves, against tables and discriminants."""

import mpmath
import pytest
import sympy

import bifurc
from bifurc.singular.puiseux import half_branches, invariants_of, pairs_of

x, y = sympy.symbols("x y")

# name: polynomial, multiplicity, complex branches, delta, contacts of real branches
# (Arnold, Gusein-Zade and Varchenko 1985, chapter 15; Wall 2004)
KNOWN = {
    "A1, real": (y**2 - x**2, 2, 2, 1, (1,)),
    "A1, isolated": (y**2 + x**2, 2, 2, 1, ()),
    "A2": (y**2 - x**3, 2, 1, 1, ()),
    "A3": (y * (y - x**2), 2, 2, 2, (2,)),
    "A3, isolated": (y**2 + x**4, 2, 2, 2, ()),
    "A4": ((y - x**2) ** 2 - x**5, 2, 1, 2, ()),
    "A7": (y**2 - x**8, 2, 2, 4, (4,)),
    "D4, real": (y**3 - x**2 * y, 3, 3, 3, (1, 1, 1)),
    "D4, complex": (y**3 + x**3, 3, 3, 3, ()),
    "D5": ((y - x) * ((y + x) ** 2 - x**3), 3, 2, 3, (2,)),
    "E6": (y**3 - x**4, 3, 1, 3, ()),
    "E7": (y**3 - y * x**3, 3, 2, 4, (3,)),
    "E8": (y**3 - x**5, 3, 1, 4, ()),
    "J10": (y * (y - x**2) * (y + 2 * x**2), 3, 3, 6, (2, 2, 2)),
    "W12": (y**4 - x**5, 4, 1, 6, ()),
    "X9": ((y**2 - x**2) * (y**2 - 4 * x**2), 4, 4, 6, (1,) * 6),
    "two Puiseux pairs": ((y**2 - x**3) ** 2 - x**5 * y, 4, 1, 8, ()),
    "a parabola and cusps": (
        (y - x**2) * (y**2 - x**3) * (y**2 + x**3),
        5,
        3,
        14,
        (3, 3, 6),
    ),
}


def terms_of(polynomial):
    monomials = sympy.Poly(polynomial, x, y).terms()
    return {key: mpmath.mpf(int(value)) for key, value in monomials}


def invariants(polynomial):
    terms = terms_of(polynomial)
    with mpmath.workdps(100):
        halves = half_branches(terms, 13)
        real = [halves[one].series() for one, _ in pairs_of(halves)]
        return invariants_of(terms, 13, real)


@pytest.mark.parametrize("name", KNOWN)
def test_invariants_are_those_of_the_tables(name):
    polynomial, multiplicity, branches, delta, contacts = KNOWN[name]
    found = invariants(polynomial)
    counts = (found.multiplicity, found.branches, found.delta)
    assert counts == (multiplicity, branches, delta)
    assert found.contacts == contacts


@pytest.mark.parametrize("name", KNOWN)
def test_the_milnor_number_is_that_of_the_exact_discriminant(name):
    """mu = ord disc - multiplicity + 1 (Teissier 1973), no other point being on the
    line x = 0."""
    polynomial, multiplicity, *_ = KNOWN[name]
    disc = sympy.Poly(sympy.discriminant(polynomial, y), x)
    order = min(power for (power,) in disc.monoms())
    assert invariants(polynomial).milnor_number == order - multiplicity + 1


def test_no_invariants_where_branches_agree_in_all_known_terms():
    with mpmath.workdps(100):
        terms = terms_of((y - x**2) * (y**2 + x**14))
        assert invariants_of(terms, 13, ()) is None


# name: equation in the plane, and delta, multiplicity and contacts of its point at 0
IN_AN_ATLAS = {
    "a node": (lambda x, y: y**2 - x**2 - x**3, (1, 2, (1,))),
    "an isolated point": (lambda x, y: y**2 + x**2 - x**3, (1, 2, ())),
    "a tacnode": (lambda x, y: (y - x**2) * (y + x**2), (2, 2, (2,))),
    "a cusp of order 5": (lambda x, y: y**2 - x**5, (2, 2, ())),
    "three lines": (lambda x, y: y * (y - x) * (y + x), (3, 3, (1, 1, 1))),
}


@pytest.mark.parametrize("name", IN_AN_ATLAS)
def test_points_of_an_atlas_have_invariants_and_keep_them_in_a_file(name, tmp_path):
    function, expected = IN_AN_ATLAS[name]
    problem = bifurc.FunctionProblem(
        lambda u: [function(*u)], [(-0.71, 0.83), (-0.77, 0.69)]
    )
    atlas = bifurc.explore(problem)
    path = bifurc.save_atlas(atlas, tmp_path / "atlas.nc")
    for one in (atlas, bifurc.load_atlas(path)):
        (point,) = one.points
        found = point.point.invariants
        assert (found.delta, found.multiplicity, found.contacts) == expected
