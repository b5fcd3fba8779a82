"""What a curve of lower rank is, and where others meet it."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import Deflated, LowerRank, lower_rank_along
from bifurc.curves.monitor import profile_branch
from bifurc.function_problem import FunctionProblem


def seen_along(function, start, tangent) -> tuple[LowerRank, np.ndarray]:
    """What is seen along the curve through a start, and the places of crossings."""
    problem = FunctionProblem(function, [[-3.0, 3.0], [-3.0, 3.1], [-3.0, 3.2]])
    branch = trace_branch(Deflated(problem), np.array(start), np.array(tangent))
    seen = lower_rank_along(problem, branch, profile_branch(problem, branch))
    return seen, branch(seen.crossings)


def plane_on_a_torus(u):
    square = u[0] ** 2 + u[1] ** 2
    return [u[2] - 1, (square + u[2] ** 2 + 3) ** 2 - 16 * square]


def test_a_plane_on_a_torus_meets_it_in_a_double_circle():
    seen, _ = seen_along(plane_on_a_torus, [2.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    assert seen.multiplicity == 2
    assert len(seen.crossings) == 0


@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_double_lines_show_where_they_cross(size):
    def touching(u):
        return [u[2], size * (u[2] - (u[0] - 0.3) ** 2 * (u[1] + 0.2) ** 2)]

    seen, places = seen_along(touching, [0.3, 1.0, 0.0], [0.0, 1.0, 0.0])
    assert seen.multiplicity == 2
    assert places == pytest.approx(np.array([[0.3, -0.2, 0.0]]), abs=1e-8)


def test_the_multiplicity_of_more_than_two_lost_directions_is_not_known():
    seen, _ = seen_along(
        lambda u: [u[2] ** 2, u[0] ** 2], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]
    )
    assert seen.multiplicity == 0
