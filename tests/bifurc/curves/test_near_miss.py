"""Values of near misses, with bounds of their errors."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.curves.near_miss import near_miss_values
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-8, 1e-10])
def test_the_bound_of_a_near_miss_holds_on_a_hyperbola(gap):
    # on x y = e the singular value is (x, y), at least sqrt(2 e)
    problem = FunctionProblem(
        lambda u: np.array([u[0] * u[1] - gap]), [[-2, 2], [-2, 2]]
    )
    atlas = explore(problem, settings=SearchSettings(starts=30))
    assert len(atlas.near_misses) == 2
    exact = np.sqrt(2 * gap) / problem.magnitude
    for event in atlas.near_misses:
        assert abs(event.value - exact) <= event.error
        assert event.error < 1e-4 * exact


def test_where_the_singular_value_is_zero_the_value_is_bounded():
    axes = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [[-2, 2], [-2, 2]])
    branch = trace_branch(axes, [1.0, 0.0])
    middle = np.array([branch.length / 2])
    ((value, error),) = near_miss_values(axes, branch, 1, middle)
    assert value < 1e-12
    assert np.isfinite(error)
