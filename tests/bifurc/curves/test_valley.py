"""Valleys of systems that contradict themselves a little, with known answers."""

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.valley import unfold_crossing
from bifurc.function_problem import FunctionProblem
from bifurc.numerics.null_spaces import correct_to_valley

BOX = [[-2.0, 2.0], [-2.0, 2.0]]


def contradicting_circles(error):
    """The unit circle twice, the second time with a square of the radius that is larger
    by ``error``."""
    return FunctionProblem(lambda u: np.array([u @ u - 1.0, u @ u - 1.0 - error]), BOX)


def opened_crossing(error):
    """x y = error, with a second equation that no point solves: 0 = error."""
    return FunctionProblem(
        lambda u: np.array([u[0] * u[1] - error, 0.0 * u[0] + error]), BOX
    )


ARMS = 0.5 * np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])


@pytest.mark.parametrize("error", [1e-2, 1e-6])
def test_the_valley_lies_between_equations_that_contradict_each_other(error):
    problem = contradicting_circles(error)
    points, gaps = correct_to_valley(problem, np.array([[1.1, 0.0], [0.5, -0.7]]))
    assert np.linalg.norm(points, axis=1) == pytest.approx(
        np.sqrt(1.0 + error / 2), abs=1e-12
    )
    assert gaps * problem.magnitude == pytest.approx(error / np.sqrt(2), rel=1e-6)


def test_a_consistent_system_has_the_curve_itself_as_its_valley():
    points, gaps = correct_to_valley(contradicting_circles(0.0), np.array([[1.1, 0.3]]))
    assert (
        np.linalg.norm(points[0]) == pytest.approx(1.0, abs=1e-14) and gaps[0] < 1e-15
    )


@pytest.mark.parametrize("error", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_crossing_opens_into_two_hyperbolas(error, sign):
    found = unfold_crossing(opened_crossing(sign * error), np.zeros(2), ARMS)
    expected = {(0, 2), (1, 3)} if sign > 0 else {(0, 3), (1, 2)}
    assert set(found.pairs) == expected
    assert found.distance == pytest.approx(
        2 * np.sqrt(2 * error), rel=0.02
    )  # between the vertices


def test_the_smallest_singular_value_is_that_of_the_vertex():
    problem = opened_crossing(1e-4)
    found = unfold_crossing(problem, np.zeros(2), ARMS)
    assert found.weakest * problem.magnitude == pytest.approx(np.sqrt(2e-4), rel=0.05)


def test_a_valley_that_is_not_near_the_start_is_none():
    far_away = FunctionProblem(lambda u: np.array([u[0] - 1.9]), BOX)
    found = unfold_crossing(far_away, np.zeros(2), ARMS)
    assert all(valley.outcome is Outcome.OPEN for valley in found.valleys)
