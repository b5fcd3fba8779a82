"""By how much contradictory equations are missed along a curve."""

import numpy as np
import pytest

from bifurc.curves.misclosure import misclosures
from bifurc.function_problem import FunctionProblem

START = np.array([0.6, 0.8])


def two_circles(error):
    """The unit circle, and one whose radius is another."""
    return FunctionProblem(
        lambda u: np.array([u @ u - 1.0, u @ u - 1.0 + error]), [[-2, 2], [-2, 2]]
    )


@pytest.mark.parametrize("error", [1e-3, 1e-7, 1e-11])
def test_what_contradicts_itself_is_missed_whatever_the_place(error):
    problem = two_circles(error)
    expected = error / np.sqrt(2.0) / problem.magnitude
    points = np.array([START, START + 1e-9, [1.0, 0.0]])
    assert misclosures(problem, points) == pytest.approx(expected, rel=1e-4)


def test_a_system_of_fewer_equations_than_unknowns_misses_nothing():
    problem = FunctionProblem(lambda u: np.array([u @ u - 1.0]), [[-2, 2], [-2, 2]])
    off = np.array([[1.1, 0.0], [0.0, 2.0]])
    assert np.all(misclosures(problem, off) == 0.0)
