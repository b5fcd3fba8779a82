"""Null spaces of F', and the steps that its decomposition gives."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.numerics.null_spaces import (
    decompose,
    null_spaces,
    null_vector,
    tangent_planes,
)
from bifurc.system import relative_gaps

BOX = [(-2.0, 2.0)] * 3


def twisted_cubic(u):
    """Three equations of rank two for the curve (t, t^2, t^3)."""
    x, y, z = u
    return np.array([y - x * x, z - x * y, x * z - y * y])


@pytest.fixture
def cubic():
    return FunctionProblem(twisted_cubic, BOX)


def test_the_null_vector_is_the_tangent_and_is_turned_to_the_given_side(cubic):
    expected = np.array([1.0, 1.0, 0.75]) / np.linalg.norm(
        [1.0, 1.0, 0.75]
    )  # (1, 2t, 3t^2) at t = 1/2
    point = np.array([0.5, 0.25, 0.125])
    assert null_vector(cubic, point, expected) == pytest.approx(expected, abs=1e-14)
    assert null_vector(cubic, point, -expected) == pytest.approx(-expected, abs=1e-14)


def test_at_a_crossing_the_null_vector_is_the_projection_of_the_given_direction():
    lines = FunctionProblem(lambda u: np.array([u[0] * u[1]]), BOX[:2])
    along = np.array([0.6, 0.8])
    assert null_vector(lines, np.zeros(2), along) == pytest.approx(along, abs=1e-15)


def test_singular_values_are_padded_to_the_number_of_unknowns():
    lines = FunctionProblem(lambda u: np.array([u[0] * u[1]]), BOX)
    sigma, right = null_spaces(lines, np.array([[0.6, 0.8, 0.3], [0.0, 0.0, 0.1]]))
    expected = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert sigma * lines.magnitude == pytest.approx(expected, abs=1e-15)
    assert right.shape == (2, 3, 3)


def test_a_tangent_plane_is_turned_as_little_as_possible():
    sphere = FunctionProblem(lambda u: np.array([u @ u - 1.0]), BOX)
    near = np.array([[1.0, 0.0], [0.0, 1.0], [0.1, -0.1]])
    plane = tangent_planes(sphere, np.array([[0.0, 0.0, 1.0]]), near)[0]
    assert plane == pytest.approx(np.eye(3)[:, :2], abs=1e-15)


def test_newton_steps_of_the_rank_of_a_curve_reach_it_from_redundant_equations(cubic):
    t = 0.7
    points = np.array([[t, t**2, t**3]]) + 1e-3 * np.array([[0.3, -0.5, 0.8]])
    for _ in range(5):
        decomposition = decompose(cubic, points)
        points = points + decomposition.newton_steps(rank=2)
    assert relative_gaps(cubic, points).max() < 1e-15


def test_the_components_of_the_residual_have_its_length(cubic):
    points = np.random.default_rng(0).uniform(-1, 1, (5, 3))
    decomposition = decompose(cubic, points)
    components = np.stack([decomposition.components(i) for i in range(3)], axis=1)
    assert np.linalg.norm(components, axis=1) == pytest.approx(
        relative_gaps(cubic, points)
    )


def test_a_part_of_a_decomposition_is_replaced(cubic):
    points = np.random.default_rng(0).uniform(-1, 1, (5, 3))
    rows = np.array([1, 3])
    decomposition = decompose(cubic, points)
    decomposition.replace(rows, decompose(cubic, points[[0, 2]]))
    assert np.array_equal(decomposition.sigma[rows], decomposition.sigma[[0, 2]])
    assert np.array_equal(decomposition.right[rows], decomposition.right[[0, 2]])


def test_a_step_where_a_singular_value_is_zero_has_a_finite_length():
    hyperbola = FunctionProblem(lambda u: np.array([u[0] * u[1] - 0.01]), BOX[:2])
    decomposition = decompose(hyperbola, np.zeros((1, 2)))
    assert decomposition.sigma[0, 0] == 0.0
    with np.errstate(all="raise"):
        length = np.linalg.norm(decomposition.newton_steps(rank=1), axis=1)[0]
    assert 1e100 < length < np.inf


def test_newton_steps_of_a_higher_rank_than_there_are_equations_are_the_shortest():
    line = FunctionProblem(lambda u: np.array([u[0] + u[1] - 1.0]), BOX[:2])
    step = decompose(line, np.zeros((1, 2))).newton_steps(2)[0]
    assert step == pytest.approx([0.5, 0.5], abs=1e-15)
