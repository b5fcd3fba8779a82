"""Solutions are as exact as doubles make them, and it is known how exact."""

import numpy as np
import pytest

from bifurc.decisions import is_solution
from bifurc.function_problem import FunctionProblem
from bifurc.numerics.singular_values import singular_values
from bifurc.search.solutions import polished, sharpened, with_weak_solutions
from bifurc.seeds import Seeds
from bifurc.system import relative_gaps
from tests.bifurc.near_surfaces import CirclesBesideSphere


def test_a_solution_by_its_residual_moves_onto_its_curve():
    problem = CirclesBesideSphere(1e-8)
    exact = problem.points(7)
    rough = exact + np.array([1e-5, 0, 0])
    rough /= np.linalg.norm(rough, axis=1)[:, None]
    assert relative_gaps(problem, rough).max() < 1e-12
    sharp = sharpened(problem, rough, singular_values(problem, rough))
    assert np.abs(sharp.points[:, 0]).max() < 1e-6
    assert sharp.moved.tolist() == list(range(7))
    assert np.abs(rough[:, 0]).min() > 9e-6


def test_solutions_are_reached_from_starts_that_missed_by_little():
    problem = CirclesBesideSphere(1e-6)
    rng = np.random.default_rng(0)
    missed = rng.normal(size=(40, 3))
    missed /= np.linalg.norm(missed, axis=1)[:, None]
    gaps = relative_gaps(problem, missed)
    nowhere = np.empty((0, 3))
    seeds = Seeds(nowhere, np.empty(0, dtype=bool), gaps, missed)
    reached = with_weak_solutions(problem, seeds)
    assert len(reached.points) > 30
    assert np.all(is_solution(relative_gaps(problem, reached.points)))
    assert len(reached.points) + len(reached.missed) == 40
    assert len(reached.gaps) == len(reached.missed)
    assert reached.random.all()


def test_starts_that_missed_by_much_are_left_alone():
    problem = CirclesBesideSphere(1e-6)
    far = np.array([[1.5, 0.2, 0.1]])
    seeds = Seeds(far[:0], np.empty(0, dtype=bool), relative_gaps(problem, far), far)
    assert with_weak_solutions(problem, seeds) is seeds


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
