"""Polynomials that stand for a surface above disks."""

from collections.abc import Callable

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.surfaces.patches import SHARES, Patches
from bifurc.surfaces.polygon import FlatCharts


def patch(height: Callable, degree: int) -> Patches:
    """That of z = height(x, y), above the unit disk about the origin."""
    problem = FunctionProblem(lambda u: [u[2] - height(u[0], u[1])], [(-2, 2)] * 3)
    charts = FlatCharts(
        centers=np.zeros((1, 3)),
        bases=np.eye(3)[None, :, :2],
        radii=np.ones(1),
        are_clear=np.ones(1, dtype=bool),
        polygons=[],
    )
    return Patches(problem, charts, np.array([0]), np.ones(1), degree)


def inside(count: int) -> np.ndarray:
    """Places (1, count, 2) in the unit disk."""
    rng = np.random.default_rng(0)
    angles, shares = 2 * np.pi * rng.random(count), np.sqrt(rng.random(count))
    return (shares * [np.cos(angles), np.sin(angles)]).T[None]


@pytest.mark.parametrize("degree", SHARES)
def test_a_polynomial_surface_is_taken_as_it_is(degree: int) -> None:
    own = patch(lambda x, y: 0.1 * (x * x - y**3) + 0.02 * x**4 * y**5, degree)
    x, y = inside(50)[0].T
    lifted = own.lifted(np.array([0]), inside(50))[0]
    # of the slopes a fit magnifies rounding some thousand times
    truth = 0.1 * (x * x - y**3) + 0.02 * x**4 * y**5
    assert np.abs(lifted[:, 2] - truth).max() < 1e-11
    assert own.misfits[0] < 1e-11


@pytest.mark.parametrize("degree", SHARES)
def test_the_error_of_ratios_of_areas_is_as_large_as_they_are_off(degree: int) -> None:
    # a sphere of radius 2 up to 30 degrees, with a metric of its own
    own = patch(lambda x, y: 2.0 - (4.0 - x * x - y * y) ** 0.5, degree)
    ratios = own.ratios(np.array([1.0, 1.0, 2.0]))
    places = inside(400)
    values = own.values(np.array([0]), places, ratios.terms)[0]
    squares = (places[0] ** 2).sum(axis=1)
    truth = np.sqrt(1.0 + 4.0 * squares / (4.0 - squares))
    off = values - truth
    # rounding of slopes is magnified some thousand times
    assert abs(off.mean()) < ratios.errors[0] + 1e-11
    assert np.sqrt((off**2).mean()) < 2.0 * ratios.errors[0] + 1e-11
    assert ratios.errors[0] < 1e-4
