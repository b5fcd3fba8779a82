"""How well points are known, and how far singular points are from them."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.numerics.blur import (
    ROUNDING,
    distance_to_singular,
    known_to,
    rounding_unit,
    same_reach,
)
from tests.bifurc.near_surfaces import CirclesBesideSphere

SMALL = (1e-1, 1e-4, 1e-8)


class Scaled(CirclesBesideSphere):
    """The sphere, and apart from it the bilinear function times e."""

    def residuals(self, points):
        residuals = super().residuals(points)
        x, y, z = points.T
        residuals[:, 1] = self.e * x * self.other(x, y, z)
        return residuals

    def jacobians(self, points):
        jacobians = super().jacobians(points)
        jacobians[:, 1] -= jacobians[:, 0]
        return jacobians


@pytest.mark.parametrize("e", SMALL[1:])
def test_a_point_is_known_to_rounding_over_the_singular_value(e):
    problem = CirclesBesideSphere(e)
    points = problem.points(5)
    distances = known_to(problem, points)
    assert np.all((distances > 0.01 * ROUNDING / e) & (distances < 10 * ROUNDING / e))
    assert np.all(same_reach(problem, points) > distances)


def test_scaling_an_equation_scales_its_rounding():
    problem = Scaled(1e-8)
    assert known_to(problem, problem.points(5)).max() < 1e-11


@pytest.mark.parametrize("e", SMALL)
def test_the_distance_to_a_crossing_does_not_shrink_with_all_of_the_equations(e):
    problem = CirclesBesideSphere(e)
    angles = np.array([0.01, 0.1])
    points = np.stack([0 * angles, np.sin(angles), np.cos(angles)], axis=1)
    distances = [distance_to_singular(problem, point) for point in points]
    assert distances == pytest.approx(angles, rel=0.6)


def test_rounding_is_seen_where_large_terms_cancel():
    def function(u):
        return np.array([(u[0] + 1e5) - 1e5 - u[1] ** 2])

    careless = FunctionProblem(function, [(-1, 1)] * 2)
    points = np.array([[0.25, 0.5], [0.04, 0.2]])
    assert 1e2 < rounding_unit(careless, points) < 1e5
    assert rounding_unit(CirclesBesideSphere(1e-3), points[:0]) == 1.0
    sphere = CirclesBesideSphere(1e-3)
    assert rounding_unit(sphere, sphere.points(20)) < 2.0
