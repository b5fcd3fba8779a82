"""All isolated solutions of square systems of polynomials."""

import numpy as np
import pytest

from bifurc.limits import Deadline
from bifurc.paths.follow import PathEnd
from bifurc.paths.sparse import SparseFamily, have_curves
from tests.samples import one_in


def solved(polynomials, seed=0):
    family = SparseFamily.of(polynomials)
    rng = np.random.default_rng(seed)
    found = family.solve(polynomials, rng, Deadline(), 400)
    return found, have_curves(polynomials, rng, Deadline(), 400)


def real_ones(points):
    return points[np.abs(points.imag).max(axis=1) < 1e-9].real


def product(n, *numbers):
    """The exponents of a product of unknowns, counted from 0."""
    return tuple(map(numbers.count, range(n)))


def katsura(last):
    """Magnetism: u_0 to u_last (Katsura 1990); 2^last solutions."""
    n = last + 1
    polynomials = []
    for k in range(last):
        row = {product(n, k): -1.0}
        for i in range(-last, last + 1):
            if abs(k - i) <= last:
                term = product(n, abs(i), abs(k - i))
                row[term] = row.get(term, 0.0) + 1.0
        polynomials.append(row)
    total = {product(n, k): 2.0 for k in range(1, n)}
    return [*polynomials, total | {product(n, 0): 1.0, product(n): -1.0}]


def economics(n):
    """An economic model (Morgan 1987); 2^(n - 2) solutions."""
    polynomials = []
    for k in range(1, n):
        row = {product(n): -float(k), product(n, k - 1, n - 1): 1.0}
        row |= {product(n, i, i + k, n - 1): 1.0 for i in range(n - 1 - k)}
        polynomials.append(row)
    return [
        *polynomials,
        {product(n, i): 1.0 for i in range(n - 1)} | {product(n): 1.0},
    ]


# complex and real solutions of systems of the literature
KNOWN = {
    "economics 5": (economics(5), 8, 4),
    "katsura 5": (katsura(5), 32, 16),
    "economics 8": (economics(8), 64, 8),
}


@pytest.mark.parametrize("name", one_in(3, KNOWN))
def test_systems_have_as_many_solutions_as_in_the_literature(name):
    polynomials, complex_ones, real = KNOWN[name]
    paths, has_curves = solved(polynomials)
    assert not np.any(paths.is_lost)
    assert has_curves is False
    assert len(paths.regular) == complex_ones
    assert len(real_ones(paths.regular)) == real


SMALL = {
    "a circle and a line": (
        [{(2, 0): 1, (0, 2): 1, (0, 0): -1}, {(1, 0): 1, (0, 1): -1}],
        2,
    ),
    "each root of one is a root of the other": (
        [{(2, 0): 1, (0, 0): -2}, {(0, 2): 1, (1, 0): 1}],
        4,
    ),
    "none but at infinity": ([{(1, 1): 1, (0, 0): -1}, {(1, 0): 1}], 0),
    "through the origin": ([{(1, 1): 1, (1, 0): -1}, {(0, 1): 1, (1, 0): 2}], 2),
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", SMALL)
def test_solutions_with_zeros_and_of_parts_are_found(name, seed):
    polynomials, count = SMALL[name]
    paths, has_curves = solved(polynomials, seed)
    assert len(paths.regular) == count
    others = ~(paths.is_regular & paths.solves_all)
    assert np.all(paths.ends[others] == PathEnd.AT_INFINITY)
    assert has_curves is False


def test_a_double_solution_is_singular():
    polynomials = [{(2, 0): 1, (0, 2): 1, (0, 0): -1}, {(1, 0): 1, (0, 0): -1}]
    paths, has_curves = solved(polynomials)
    assert paths.ends.tolist() == [PathEnd.SINGULAR] * 2
    assert np.allclose(paths.points, [1, 0], atol=1e-6)
    assert has_curves is False


CURVES = {
    "a line, to which no path leads": [{(1, 0): 1}, {(1, 0): 2}],
    "a line and no other solution": [{(1, 1): 1}, {(1, 1): 1, (1, 0): -1}],
    "a twisted cubic": [
        {(0, 1, 0): 1, (2, 0, 0): -1},
        {(0, 0, 1): 1, (1, 1, 0): -1},
        {(1, 0, 1): 1, (0, 2, 0): -1},
    ],
    "a sphere": [{(2, 0, 0): 1, (0, 2, 0): 1, (0, 0, 2): 1, (0, 0, 0): -1}] * 3,
    "a line and a point": [{(1, 1): 1, (1, 0): -1}, {(2, 0): 1, (1, 0): -2}],
}


@pytest.mark.parametrize("name", CURVES)
def test_curves_are_seen(name):
    paths, has_curves = solved(CURVES[name])
    assert has_curves
    assert not np.any(paths.is_lost)


def test_no_more_solutions_are_followed_than_are_allowed():
    family = SparseFamily.of(katsura(5))
    rng = np.random.default_rng(0)
    assert family.generic_solutions(rng, Deadline(), 10) is None
