"""Interpolation at Chebyshev nodes stays within its bounds between them."""

import numpy as np
import pytest

from bifurc.curves.kantorovich import CELL_EDGES, CHEBYSHEV, ERRORS, NODES, RHOS

X = np.linspace(-1.0, 1.0, 5001)
CIRCLE = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 2000))

FUNCTIONS = {
    "pole": lambda x: 1.0 / (x - 1.8),
    "growth": lambda x: np.exp(9.0 * x),
    "wave": lambda x: np.cos(25.0 * x + 0.3),
}


def interpolant(values):
    """Chebyshev coefficients (N,) of the interpolant of values (N,)."""
    return CHEBYSHEV.coefficients(values[:, None])[:, 0]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_an_interpolant_is_off_by_no_more_than_the_bound_and_not_by_far_less(name):
    function = FUNCTIONS[name]
    sum_of_series = interpolant(function(NODES))
    values = np.polynomial.chebyshev.chebval(X, sum_of_series)
    error = np.abs(values - function(X)).max()
    largest = []
    for rho in RHOS:
        ellipse = 0.5 * (rho * CIRCLE + 1.0 / (rho * CIRCLE))
        inside = name != "pole" or 0.5 * (rho + 1.0 / rho) < 1.8
        largest.append(np.abs(function(ellipse)).max() if inside else np.inf)
    bound = np.min(ERRORS * largest)
    rounding = 1e-14 * np.abs(function(X)).max()
    assert error < bound + rounding
    assert bound < 300 * error + rounding


def test_a_polynomial_is_bounded_on_ellipses_by_its_coefficients():
    rng = np.random.default_rng(0)
    series = rng.normal(size=8)
    bounds = CHEBYSHEV.on_ellipses(np.abs(series))
    for rho, bound in zip(RHOS, bounds, strict=True):
        ellipse = 0.5 * (rho * CIRCLE + 1.0 / (rho * CIRCLE))
        values = np.polynomial.chebyshev.chebval(ellipse, series)
        assert np.abs(values).max() < bound


def test_an_interpolant_stays_within_the_slack_of_the_lines_between_cell_edges():
    rng = np.random.default_rng(1)
    series = rng.normal(size=len(NODES)) / (1.0 + np.arange(len(NODES))) ** 2
    edges = CHEBYSHEV.on_edges(series)
    lines = np.interp(-np.arccos(X), -np.arccos(CELL_EDGES), edges)
    values = np.polynomial.chebyshev.chebval(X, series)
    off = np.abs(values - lines).max()
    assert off < CHEBYSHEV.slack(series) < 30 * off


def test_the_largest_value_between_the_nodes_is_bounded():
    rng = np.random.default_rng(2)
    values = rng.normal(size=(len(NODES), 3))
    series = CHEBYSHEV.coefficients(values)
    between = np.polynomial.chebyshev.chebval(X, series)
    largest = np.linalg.norm(between, axis=0).max()
    sizes = [np.linalg.norm(rows, axis=1) for rows in (values, series)]
    assert largest < CHEBYSHEV.largest(*sizes) < 5 * largest


def test_what_does_not_fit_the_nodes_is_refused():
    with pytest.raises(ValueError, match="a row for each node"):
        CHEBYSHEV.coefficients(np.ones((3, 2)))
    with pytest.raises(ValueError, match="no more entries than nodes"):
        CHEBYSHEV.on_edges(np.ones(len(NODES) + 1))
