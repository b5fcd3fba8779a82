"""Corrections onto a curve of redundant equations."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.limits import Deadline, until
from bifurc.numerics.corrector import (
    correct_across,
    correct_normal,
    limited,
    project_by_least_squares,
    project_to_sphere_by_newton,
)
from bifurc.system import jacobian_at

BOX = [(-2.0, 2.0)] * 3


def twisted_cubic(u):
    """Three equations of rank two for the curve (t, t^2, t^3)."""
    x, y, z = u
    return np.array([y - x * x, z - x * y, x * z - y * y])


def cylinder_and_plane(u):
    return np.array([u[0] ** 2 + u[1] ** 2 - 1.0, u[2] - u[0], u[2] - u[0]])


@pytest.fixture
def cubic():
    return FunctionProblem(twisted_cubic, BOX)


@pytest.mark.parametrize("weights", [(1.0, 1.0, 1.0), (1.0, 1e3, 1e-3)])
def test_a_correction_across_the_tangent_reaches_rounding_whatever_the_weights_of_the_equations(
    weights,
):
    problem = FunctionProblem(lambda u: np.array(weights) * twisted_cubic(u), BOX)
    t = 0.7
    tangent = np.array([1.0, 2 * t, 3 * t * t])
    tangent /= np.linalg.norm(tangent)
    start = np.array([t, t**2, t**3]) + 0.02 * np.array([0.3, -0.5, 0.8])
    point, gap, _ = correct_across(problem, start, tangent, 1e-13)
    assert gap < 1e-14
    assert point[1:] == pytest.approx(
        [point[0] ** 2, point[0] ** 3], abs=1e-12
    )  # 1e-15 over a weight of 1e-3
    assert (
        abs((point - start) @ tangent) < 1e-3 * 0.02
    )  # across the tangent to second order of the correction


def test_a_correction_of_inconsistent_equations_ends_at_the_smallest_residual():
    # y = 0 and y = 0.01 with x free: the valley is y = 0.005, and the residual there
    # 0.005 sqrt(2)
    problem = FunctionProblem(lambda u: np.array([u[1], u[1] - 0.01]), BOX[:2])
    point, gap, _ = correct_across(
        problem, np.array([0.3, 0.4]), np.array([1.0, 0.0]), 1e-13
    )
    assert point == pytest.approx([0.3, 0.005], abs=1e-12)
    assert gap * problem.magnitude == pytest.approx(0.005 * np.sqrt(2), abs=1e-12)


def test_projection_from_anywhere_ends_on_the_curve(cubic):
    starts = np.random.default_rng(0).uniform(-2, 2, (40, 3))
    points, gaps = project_by_least_squares(cubic, starts)
    assert np.median(gaps) < 1e-14
    solved = points[gaps < 1e-14]
    t = solved[:, 0]
    assert solved == pytest.approx(np.stack([t, t**2, t**3], axis=1), abs=1e-11)


def test_projection_is_fast_onto_a_crossing_as_well():
    lines = FunctionProblem(lambda u: np.array([u[0] * u[1]]), BOX[:2])
    _, gaps = project_by_least_squares(
        lines, np.array([[1e-3, 1e-3], [0.5, -0.5], [1e-8, 2e-8]])
    )
    assert gaps.max() < 1e-14


def test_projection_states_the_gap_where_there_is_no_solution():
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 + 0.25]), BOX[:2]
    )
    points, gaps = project_by_least_squares(
        problem, np.array([[0.3, 0.2], [1.0, -1.0]])
    )
    assert gaps * problem.magnitude == pytest.approx(0.25, abs=1e-9)
    assert points == pytest.approx(0.0, abs=1e-4)


def test_points_on_a_small_sphere_about_a_crossing_are_those_of_both_branches():
    problem = FunctionProblem(lambda u: np.array([u[0] * u[1] - u[0] ** 3]), BOX[:2])
    radius = 1e-3
    angles = 0.1 + np.arange(16) * np.pi / 8
    starts = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points, gaps, last = project_to_sphere_by_newton(
        problem, starts, np.zeros(2), radius
    )
    assert gaps.max() < 1e-15
    assert last.max() < 1e-12
    assert np.linalg.norm(points, axis=1) == pytest.approx(radius, abs=1e-15)
    exact = np.array(
        [[0, radius], [0, -radius], [radius, radius**2], [-radius, radius**2]]
    )
    nearest = np.linalg.norm(points[:, None] - exact, axis=2)
    assert (
        nearest.min(axis=1).max() < 1e-8
    )  # (r, r^2) lies r^5 / 2 beside the sphere and is that exact
    assert len(set(nearest.argmin(axis=1))) == 4


def test_cylinder_and_plane_meet_in_a_curve_of_rank_two_of_three_equations():
    problem = FunctionProblem(cylinder_and_plane, BOX)
    point, gap, _ = correct_across(
        problem, np.array([0.6, 0.9, 0.4]), np.array([0.5, -0.5, 0.5]), 1e-13
    )
    assert gap < 1e-14
    assert [np.hypot(point[0], point[1]), point[2]] == pytest.approx(
        [1.0, point[0]], abs=1e-14
    )


def test_long_steps_are_shortened_and_the_others_kept():
    steps = np.array([[3.0, 4.0], [0.3, 0.4], [0.0, 0.0]])
    expected = np.array([[0.6, 0.8], [0.3, 0.4], [0.0, 0.0]])
    assert limited(steps, 1.0) == pytest.approx(expected, abs=1e-15)


def test_equations_too_large_to_square_do_not_stop_the_others():
    problem = FunctionProblem(
        lambda u: [np.exp(300.0 * u[0]) - 1.0 + 0.0 * u[1] * u[2]], BOX
    )
    problem.magnitude = 1.0
    starts = np.array([[1e-4, 0.1, 0.2], [1.3, 0.0, 0.0], [0.06, 0.0, 0.0]])
    plane = np.tile(np.eye(3)[:, 1:], (3, 1, 1))
    points, gaps = correct_normal(problem, starts, plane)
    assert np.all(np.isfinite(points))
    assert points[0] == pytest.approx([0.0, 0.1, 0.2], abs=1e-9)
    assert gaps[0] < 1e-12 < gaps[1]


def test_points_onto_a_surface_settle_each_for_itself():
    # the last one has no solution above it: the others do not wait for it
    calls = []

    def sphere(u):
        return [u @ u - 1.0]

    problem = FunctionProblem(sphere, BOX, is_recorded=False)
    jacobians = problem.jacobians
    problem.jacobians = lambda points: calls.append(len(points)) or jacobians(points)
    starts = np.array(
        [[0.1, 0.2, 0.9], [0.3, -0.1, 1.2], [0.0, 0.0, 1.0 + 1e-12], [1.2, 0, 0]]
    )
    planes = np.tile(np.eye(3)[:, :2], (len(starts), 1, 1))
    points, gaps = correct_normal(problem, starts, planes)
    assert gaps[:3].max() < 1e-15 < 1e-3 < gaps[3]
    assert points[:3, :2] == pytest.approx(starts[:3, :2], abs=1e-15)
    assert calls[0] == 4
    assert calls[-1] == 1
    for start, plane, point in zip(starts[:3], planes, points, strict=False):
        alone, _ = correct_normal(problem, start[None], plane[None])
        assert alone[0] == pytest.approx(point, abs=1e-15)


def test_no_step_is_taken_once_the_time_is_over():
    problem = FunctionProblem(lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(-2, 2)] * 2)
    starts = np.array([[1.5, 0.7], [0.3, 0.1]])
    with until(Deadline(0.0)):
        points, gaps = project_by_least_squares(problem, starts)
    assert np.array_equal(points, starts) and np.all(gaps > 1e-3)


def test_sparse_equations_are_solved_as_dense_ones_are():
    n = 120

    def function(u):
        return 0.3 * u[:-1] ** 2 + u[1:] - 0.2

    problem = FunctionProblem(function, [(-3, 3)] * n)
    start = np.random.default_rng(0).uniform(-1, 1, (1, n))
    points, gaps = project_by_least_squares(problem, start)
    assert not isinstance(jacobian_at(problem, start[0]), np.ndarray)
    assert gaps[0] < 1e-14
    assert np.abs(problem.residuals(points)).max() < 1e-13
