"""Isolated solutions are as exact as doubles make them, and it is known how exact."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.search.solutions import polished


def problem_of_order(order):
    """x**order = 0 along a parabola."""
    return FunctionProblem(
        lambda u: [u[0] ** order, u[1] - u[0] - 3.0 * u[0] ** 2],
        bounds=[(-1.0, 1.0), (-1.0, 1.0)],
        is_recorded=False,
    )


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize("x", [-1e-4, 2e-5])
def test_a_multiple_solution_is_the_middle_of_what_rounding_hides(order, x):
    problem = problem_of_order(order)
    start = np.array([x, x + 3.0 * x**2])
    solution = polished(problem, start)
    # the residual is rounding, 1e-14, up to there
    hidden = (1e-14 * problem.magnitude) ** (1.0 / order) * np.sqrt(2.0)
    assert solution.hidden == pytest.approx(hidden, rel=0.2)
    assert np.abs(solution.point).max() < 0.2 * hidden


def test_a_simple_solution_is_exact_and_hidden_nowhere():
    solution = polished(problem_of_order(1), np.array([1e-3, 1e-3]))
    assert np.abs(solution.point).max() < 1e-15
    assert solution.is_isolated
    assert solution.hidden == 0.0
