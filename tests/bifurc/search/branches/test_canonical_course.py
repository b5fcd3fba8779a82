"""Where forms begin and which way they run comes from themselves."""

import numpy as np

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.function_problem import FunctionProblem
from bifurc.search.branches.canonical_course import canonical_course
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


def circle(radius=1.0):
    return FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - radius**2]), [(-2, 2)] * 2
    )


def hyperbola():
    return FunctionProblem(lambda u: np.array([u[0] * u[1] - 0.1]), [(-1, 2), (-1, 1)])


def test_a_form_that_does_not_wind_leaves_its_start_with_the_first_unknown_growing():
    atlas = explore(circle(), settings=SearchSettings(starts=5))
    rates = atlas.forms[0].branch(0.0, 1)
    assert rates[0] > 0.05


def test_an_open_curve_begins_at_the_same_end():
    problem = hyperbola()
    starts = np.array([[0.4, 0.25], [0.2, 0.5]])
    directions = np.array([[1.0, -0.5], [-1.0, 2.0]])
    courses = []
    for start, direction in zip(starts, directions, strict=True):
        branch = trace_branch(problem, start, direction)
        assert branch.outcome is Outcome.LEFT_REGION
        courses.append(canonical_course(problem, branch))
    s = np.linspace(0.0, courses[0].length, 20)
    assert np.abs(courses[0](s) - courses[1](s)).max() < 1e-9


def test_a_branch_without_pieces_stays_as_it_is():
    problem = circle(radius=0.5)
    nothing = trace_branch(problem, np.array([1.5, 1.5]))
    if not len(nothing.pieces):
        assert canonical_course(problem, nothing) is nothing
