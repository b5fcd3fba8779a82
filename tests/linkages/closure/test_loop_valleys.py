"""The valley of a loop that nearly closes along a motion."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import points_on_piece
from bifurc.curves.valley_problem import ValleyProblem
from bifurc.noisy_problem import with_rounding_noise
from bifurc.numerics.collocation import march_by_collocation
from bifurc.numerics.null_spaces import correct_to_valley, null_vector
from bifurc.system import CurveNodes, MarchSettings
from linkages.closure.loop_closure import LoopClosure
from linkages.linkage import load
from linkages.loop import Loop
from tests.bifurc.known_curves import contradictory


class OneByOne(ValleyProblem):
    """A valley of which the points at nodes are corrected one by one."""

    def __init__(self, of):
        super().__init__(of)
        self.rules = replace(self.rules, corrector=None)


def nearly_bennett():
    """A loop of four joints that misses the condition of its motion by 1e-4."""
    lengths, twists, offsets = load("bennett").loop.arrays
    twists = twists + np.array([1e-4, 0, 0, 0])
    return LoopClosure(Loop(lengths, twists, offsets))


def on_the_valley(problem, start):
    """A point (n,) of the valley, and its tangent there."""
    (point,), _ = correct_to_valley(problem, np.array([start]))
    return point, null_vector(ValleyProblem(problem), point)


PROBLEMS = {
    "recorded": lambda: (contradictory(1e-3), [0.7, 0.6, 0.2]),
    "loop": lambda: (nearly_bennett(), [0.4, 2.4, -0.4, -2.4]),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_points_corrected_in_one_call_are_those_corrected_one_by_one(name):
    problem, start = PROBLEMS[name]()
    point, tangent = on_the_valley(problem, start)
    settings = MarchSettings(16, 1e-12, 1e-9, 1.0, 1, closing=1e-2)
    marches = [
        march_by_collocation(valley, point, tangent, settings)
        for valley in (ValleyProblem(problem), OneByOne(problem))
    ]
    assert ValleyProblem(problem).rules.corrector is not None
    assert len(marches[0].pieces) == len(marches[1].pieces) == 1
    # points are known to rounding over the smallest regular singular value, about 0.1
    assert marches[0].radii == pytest.approx(marches[1].radii, abs=1e-13)
    x = np.linspace(-1.0, 1.0, 7)
    places = [points_on_piece(march.pieces[0], x) for march in marches]
    assert places[0] == pytest.approx(places[1], abs=1e-13)


def nodes_from(point, heading, width, most=1e-6):
    """Nodes of a piece of which each point is predicted by the one before it."""
    predictors = np.eye(5, k=-1)
    return CurveNodes(point, heading, np.linspace(0, width, 5), predictors, 1e-15, most)


def test_where_a_point_cannot_be_corrected_there_are_none():
    problem = nearly_bennett()
    point, tangent = on_the_valley(problem, [0.4, 2.4, -0.4, -2.4])
    correct = problem.shortcuts.valley_corrector
    assert correct(nodes_from(point, tangent, 0.1)).shape == (5, 4)
    assert correct(nodes_from(point, tangent, 0.1, most=0.0)) is None
    assert correct(nodes_from(point * np.nan, tangent, 0.1)) is None
    with pytest.raises(ValueError, match="do not fit each other"):
        correct(nodes_from(point[:3], tangent, 0.1))


def test_points_of_a_noisy_problem_have_errors_too():
    problem = nearly_bennett()
    point, tangent = on_the_valley(problem, [0.4, 2.4, -0.4, -2.4])
    nodes = nodes_from(point, tangent, 0.1)
    exact = problem.shortcuts.valley_corrector(nodes)
    noisy = with_rounding_noise(problem, 1).shortcuts.valley_corrector(nodes)
    assert 0.0 < np.abs(noisy - exact).max() < 1e-14
