"""Motions of loops, traced: whole, one way, within tolerance."""

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.jumps import changes_of_course, kinks
from bifurc.curves.misclosure import largest_misclosure
from bifurc.function_problem import NumericalProblem
from bifurc.search.branches.canonical_course import canonical_course
from bifurc.search.explore import explore
from bifurc.settings import TraceSettings
from bifurc.system import relative_gaps
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import Loop
from tests.maps import curves_of


@pytest.mark.parametrize(
    "name",
    ["serial-goldberg-6r", "double-goldberg-type-iv", "syncopated-l-shape-goldberg-6r"],
)
def test_a_configuration_of_lower_rank_on_a_smooth_branch_is_passed(name):
    problem = LoopClosure(entry(name).build())
    seeds = problem.seeds(np.random.default_rng(1), 1).points
    values = np.linalg.svd(problem.jacobians(seeds), compute_uv=False)[:, 4]
    lengths = []
    for start in seeds[np.argsort(-values)[:5]]:
        branch = trace_branch(problem, start)
        assert branch.outcome is Outcome.CLOSED
        lengths.append(branch.length)
    assert lengths == pytest.approx([lengths[0]] * 5, abs=1e-8)


@pytest.mark.parametrize("order", [4, 8, 16, 24])
def test_every_order_meets_the_tolerance(order):
    problem = LoopClosure(entry("bricard-line-symmetric").build())
    start = problem.seeds(np.random.default_rng(0), 1).points[0]
    branch = trace_branch(
        problem, start, None, TraceSettings(order=order, tolerance=1e-10)
    )
    assert branch.outcome is Outcome.CLOSED
    assert np.linalg.norm(problem.residuals(branch.sample(3000)), axis=1).max() < 1e-9


def test_forms_through_bifurcations_keep_their_course():
    problem = LoopClosure(entry("special-double-subtractive-goldberg").build())
    atlas = explore(problem)
    for index, form in enumerate(atlas.forms):
        cuts = [s for p in atlas.bifurcations for i, s in p.passes if i == index]
        assert len(cuts) == 2
        changes = changes_of_course(form.branch, form.profile, np.sort(cuts))
        assert not len(changes) and not len(kinks(form.branch))


class WithoutSeries(LoopClosure):
    """The closure of a loop as any other problem: no Taylor series."""

    march = NumericalProblem.march


@pytest.mark.parametrize("name", ["bennett", "bricard-line-symmetric"])
def test_a_motion_traced_without_series_is_the_one_traced_with_it(name):
    loop = entry(name).build()
    problem = LoopClosure(loop)
    start = problem.seeds(np.random.default_rng(0), 1).points[0]
    series, plain = (
        trace_branch(problem, start),
        trace_branch(WithoutSeries(loop), start),
    )
    assert plain.outcome is series.outcome
    assert plain.length == pytest.approx(series.length, abs=1e-10)
    # both within tolerance 1e-13 over the smallest singular value, 0.02 to 0.1
    assert series.nearest(plain.sample(300))[0].max() < 1e-10


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
    atlas = curves_of(entry("special-double-subtractive-goldberg").build())
    for form in atlas.forms:
        turning = form.branch.winding[form.branch.winding != 0]
        assert turning[0] > 0
        assert np.all(np.abs(form.branch(0.0)) <= np.pi + 1e-6)


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
        gaps = relative_gaps(problem, form.branch.sample(3000))
        assert gaps.max() < 1e-12


def bennett_off(error):
    loop = entry("bennett").build()
    lengths, twists, offsets = loop.arrays
    twists[0] += error
    return LoopClosure(Loop(tuple(lengths), tuple(twists), tuple(offsets)))


@pytest.mark.parametrize("error", [1e-6, 1e-10, 1e-12, 1e-13, 2e-14])
def test_the_misclosure_of_a_linkage_is_measured_below_what_doubles_tell(error):
    # of a Bennett linkage with a twist off by e it is e at the worst place
    problem = bennett_off(error)
    start, _ = problem.project(np.array([[0.3, 0.9, -0.2, 0.4]]))
    branch = trace_branch(problem, start[0], closing=1e-2)
    assert largest_misclosure(problem, branch) == pytest.approx(error, rel=0.02)


def test_the_misclosure_of_a_true_motion_is_rounding():
    problem = bennett_off(0.0)
    start, _ = problem.project(np.array([[0.3, 0.9, -0.2, 0.4]]))
    assert largest_misclosure(problem, trace_branch(problem, start[0])) < 5e-15
