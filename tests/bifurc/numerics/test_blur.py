"""How well points are known, and how far singular points are from them."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.numerics.blur import (
    ROUNDING,
    blur,
    distance_to_singular,
    rounding_unit,
    same_reach,
    smallest_regular,
)
from tests.bifurc.near_surfaces import CirclesBesideSphere

SMALL = (1e-1, 1e-4, 1e-8)


def test_a_point_is_known_to_rounding_over_the_singular_value_where_there_is_one():
    known_to = blur(np.array([1.0, 1e-6, 0.0]))
    assert known_to == pytest.approx([ROUNDING, 1e-9, 0.0])
    assert np.all(same_reach(np.array([1e-6])) > known_to[1])


@pytest.mark.parametrize("e", SMALL)
def test_the_distance_to_a_crossing_does_not_shrink_with_all_of_the_equations(e):
    problem = CirclesBesideSphere(e)
    angles = np.array([0.01, 0.1])
    points = np.stack([0 * angles, np.sin(angles), np.cos(angles)], axis=1)
    distances = [distance_to_singular(problem, point) for point in points]
    assert distances == pytest.approx(angles, rel=0.6)
    assert smallest_regular(problem, points) == pytest.approx(e * angles, rel=0.6)


def test_rounding_is_seen_where_large_terms_cancel():
    def function(u):
        return np.array([(u[0] + 1e5) - 1e5 - u[1] ** 2])

    careless = FunctionProblem(function, [(-1, 1)] * 2)
    points = np.array([[0.25, 0.5], [0.04, 0.2]])
    assert 1e2 < rounding_unit(careless, points) < 1e5
    assert rounding_unit(CirclesBesideSphere(1e-3), points[:0]) == 1.0
    sphere = CirclesBesideSphere(1e-3)
    assert rounding_unit(sphere, sphere.points(20)) < 2.0
