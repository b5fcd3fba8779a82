"""The dimension of components of solutions, which is not their corank."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.numerics.null_spaces import null_spaces
from bifurc.problem import Problem
from bifurc.singular.dimension import local_dimensions, misclosures_beside
from tests.bifurc.known_surfaces import seeds, torus
from tests.bifurc.near_surfaces import CirclesBesideSphere


def plane_and_line() -> Problem:
    return FunctionProblem(
        lambda u: np.array([u[2] * u[0], u[2] * u[1]]), [(-1, 1)] * 3
    )


def test_a_plane_and_the_line_through_it_have_their_own_dimensions() -> None:
    points = np.array([[0.3, 0.2, 0.0], [0.0, 0.0, 0.4], [0.0, 0.0, 0.0]])
    local = local_dimensions(plane_and_line(), points)
    assert local.dimension.tolist() == [2, 1, 2]
    assert local.regular.tolist() == [True, True, False]
    assert not np.any(local.shaky)


def test_the_dimension_of_a_shaky_plane_is_not_its_corank() -> None:
    problem = FunctionProblem(lambda u: np.array([u[2] ** 2]), [(-1, 1)] * 3)
    local = local_dimensions(problem, np.array([[0.3, 0.2, 0.0]]))
    assert local.dimension[0] == 2
    assert local.nullity[0] == 3
    assert not local.regular[0]
    assert local.shaky[0]


def test_a_curve_at_a_bifurcation_keeps_dimension_one() -> None:
    problem = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [(-1, 1)] * 2)
    local = local_dimensions(problem, np.array([[0.0, 0.0], [0.5, 0.0]]))
    assert local.dimension.tolist() == [1, 1]
    assert local.nullity.tolist() == [2, 1]


@pytest.mark.parametrize("e", [1e-7, 1e-8, 1e-9])
def test_points_of_a_curve_beside_a_surface_are_on_no_surface(e: float) -> None:
    problem = CirclesBesideSphere(e)
    local = local_dimensions(problem, problem.points(9))
    assert np.all(local.dimension < 2)


def test_what_a_surface_misses_is_rounding_and_what_curves_on_it_miss_is_not() -> None:
    tube = torus(0.6)
    for problem, points, low, high in (
        (tube, seeds(tube, 40), 0.0, 5e-15),
        (beside := CirclesBesideSphere(1e-9), beside.points(9), 1e-12, 1e-9),
    ):
        _, right = null_spaces(problem, points)
        missed = misclosures_beside(problem, points, right[:, problem.n - 2 :])
        assert np.all((missed >= low) & (missed < high))
