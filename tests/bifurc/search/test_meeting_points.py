"""What meets at a singular point."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore

BOX = [(-1.0, 1.0)] * 2


def test_where_second_order_gives_no_tangents_those_of_the_forms_are_taken():
    touching = FunctionProblem(lambda u: [u[1] * (u[1] - u[0] ** 2)], BOX)
    (point,) = explore(touching).bifurcations
    assert not len(point.point.tangents)
    assert np.abs(point.tangents) == pytest.approx(
        np.array([[1.0, 0.0], [1.0, 0.0]]), abs=1e-6
    )


def test_a_curve_beside_a_contact_of_high_order_does_not_pass_it():
    problem = FunctionProblem(lambda u: [(u[1] ** 2 - u[0] ** 8) * (u[1] - 0.05)], BOX)
    atlas = explore(problem)
    assert len(atlas.forms) == 3
    sizes = [len(point.passes) for point in atlas.bifurcations]
    assert sizes == [2, 2, 2]
    assert not any(point.note for point in atlas.points)
