"""Members along whose curve an unknown rests."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.following.rest_problem import RestProblem, rest_problems
from bifurc.function_problem import FunctionProblem
from bifurc.parametrised import ParametrisedProblem

BOUNDS = [(-3.0, 3.0)] * 3


def equations(u, p):
    """An ellipse on a surface that is flat for p = 0.3; x = 2 y for no p."""
    x, y, z = u
    height = np.sin(p[0] - 0.3) * (x * y + x)
    return np.stack([x**2 + 4 * y**2 - 2 - p[0], z - 0.7 - height])


def curve(p):
    problem = FunctionProblem(lambda u: equations(u, [p]), BOUNDS)
    (start,), _ = problem.project(np.array([[1.0, 0.5, 0.7]]))
    return trace_branch(problem, start)


PARAMETRISED = ParametrisedProblem.recorded(equations, BOUNDS, [(-1.0, 1.0)])


def test_a_height_rests_where_its_surface_is_flat():
    (problem,) = rest_problems(PARAMETRISED, curve(0.5), np.array([0.5]), reach=0.4)
    assert problem.resting == 2
    points, gaps = problem.project(problem.start[None])
    u, p = problem.place(points[0])
    assert gaps[0] < 1e-14
    assert p == pytest.approx([0.3], abs=1e-13)
    assert u[:, 2] == pytest.approx([0.7] * len(u), abs=1e-13)


def test_a_rest_farther_away_than_asked_for_is_left_out():
    assert not rest_problems(PARAMETRISED, curve(0.5), np.array([0.5]), reach=0.1)


def test_derivatives_are_those_of_the_equations():
    branch, p = curve(0.5), np.array([0.5])
    s = np.linspace(0.0, branch.length, 4, endpoint=False)
    problem = RestProblem(PARAMETRISED, branch(s), branch(s, derivative=1), p, 1)
    point = problem.start + 0.1 * np.random.default_rng(0).normal(size=problem.n)
    steps = 1e-6 * np.eye(problem.n)
    differences = problem.residuals(point + steps) - problem.residuals(point - steps)
    exact = problem.jacobians(point[None])[0]
    assert np.abs(differences.T / 2e-6 - exact).max() < 1e-8
