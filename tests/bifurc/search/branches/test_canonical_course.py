"""Where forms begin and which way they run comes from themselves."""

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.function_problem import FunctionProblem
from bifurc.search.branches.canonical_course import canonical_course
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure


def circle(radius=1.0):
    return FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - radius**2]), [(-2, 2)] * 2
    )


def hyperbola():
    return FunctionProblem(lambda u: np.array([u[0] * u[1] - 0.1]), [(-1, 2), (-1, 1)])


# symmetries map some of these forms to themselves
@pytest.mark.parametrize(
    "name",
    ["parallelogram", "bricard-line-symmetric", "bricard-octahedral-line-symmetric"],
)
def test_forms_begin_at_one_place_and_run_one_way_whatever_the_seed(name):
    problem = LoopClosure(entry(name).build())
    one, other = (explore(problem, seed=seed) for seed in (0, 1))
    for left, right in zip(one.forms, other.forms, strict=True):
        s = np.linspace(0.0, left.branch.length, 50)
        assert np.abs(left.branch(s) - right.branch(s)).max() < 1e-9


def test_a_form_winds_forwards_and_begins_within_half_a_turn():
    atlas = explore(LoopClosure(entry("special-double-subtractive-goldberg").build()))
    for form in atlas.forms:
        turning = form.branch.winding[form.branch.winding != 0]
        assert turning[0] > 0
        assert np.all(np.abs(form.branch(0.0)) <= np.pi + 1e-6)


def test_a_form_that_does_not_wind_leaves_its_start_with_the_first_unknown_growing():
    atlas = explore(circle(), settings=SearchSettings(starts=5))
    rates = atlas.forms[0].branch(0.0, 1)
    assert rates[0] > 0.05


@pytest.mark.parametrize("begin", [0.0, 0.3, 0.77])
@pytest.mark.parametrize("turn_round", [False, True])
def test_a_curve_has_one_course_wherever_it_was_begun(begin, turn_round):
    problem = LoopClosure(entry("bennett").build())
    start = problem.seeds(np.random.default_rng(0), 1).points[0]
    branch = trace_branch(problem, start)
    course = canonical_course(problem, branch)
    moved = branch.begun_at(begin * branch.length)
    again = canonical_course(problem, moved.reversed() if turn_round else moved)
    s = np.linspace(0.0, branch.length, 40)
    assert np.abs(course(s) - again(s)).max() < 1e-11
    # once more from the start itself, which then lies where the curve closes
    assert np.abs(course(s) - canonical_course(problem, course)(s)).max() < 1e-11


def test_the_course_of_a_curve_takes_nothing_from_its_accuracy():
    problem = LoopClosure(entry("special-double-subtractive-goldberg").build())
    for form in explore(problem).forms:
        gaps = problem.gaps(form.branch.sample(3000))
        assert gaps.max() < 1e-12


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
