"""The hard cases know the right answer, and the study tells right from wrong."""

import numpy as np
import pytest

from bifurc.continuation import trace_branch
from studies.hard_cases import crossings, ladders, near_parallelogram, pitchfork
from studies.methods.counted import Counted
from studies.methods.detection import by_determinant, by_singular_value
from studies.stability import describe, follow_ladder, followers, report_points, reporters
from studies.stability_figure import draw_stability

CROSSINGS = {case.name: case for case in crossings()[:4]}


@pytest.mark.parametrize("case", ladders(np.array([1e-1, 1e-4])), ids=lambda case: f"{case.name} {case.gap:g}")
def test_the_start_of_a_ladder_lies_on_its_curve(case):
    assert np.linalg.norm(case.problem.residuals(case.start[None])) < 1e-14
    assert np.linalg.norm(case.problem.jacobians(case.start[None])[0] @ case.tangent) < 1e-7
    assert case.stays(case.start[None])


def test_the_arcs_of_the_pitchfork_are_as_far_apart_as_stated():
    e = 1e-3**2 / 8
    x = np.geomspace(1e-6, 1e-1, 20001)  # beside the corner the upper arc is (x^2 - e / x, x), the lower its mirror image
    upper = np.column_stack([x**2 - e / x, x])
    corner = upper[np.argmin(np.linalg.norm(upper, axis=1))]
    assert 2 * np.linalg.norm(corner) == pytest.approx(1e-3, rel=0.02)


def test_a_curve_on_the_other_arc_is_seen():
    case = pitchfork(1e-3)
    assert not case.stays(case.start * [1.0, -1.0] + np.zeros((2, 2)))


@pytest.mark.parametrize("make", [pitchfork, near_parallelogram])
@pytest.mark.parametrize("step", ["fine", "medium", "coarse"])
@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-5])
def test_this_project_follows_the_true_arc(make, step, gap):
    assert follow_ladder(make(gap), "this project", followers()["this project"], step).verdict == "right"


@pytest.mark.parametrize("make", [pitchfork, near_parallelogram])
def test_every_tenth_of_the_gap_adds_no_more_pieces_than_the_one_before(make):
    cases = [make(gap) for gap in 10.0 ** -np.arange(1.0, 6.0)]
    pieces = [len(trace_branch(case.problem, case.start, case.tangent).pieces) for case in cases]
    added = np.diff(pieces)
    assert added.max() < 25 and added[-1] <= added[0] + 5  # as the logarithm of 1 / gap, or slower


def test_large_steps_of_the_null_vector_jump_and_small_ones_do_not():
    follow = followers()["solve_ivp RK45"]
    assert follow_ladder(near_parallelogram(1e-3), "", follow, "coarse").verdict == "jumped"
    assert follow_ladder(near_parallelogram(1e-1), "", follow, "fine").verdict == "right"


def test_evaluations_are_counted_by_the_point():
    counted = Counted(pitchfork(0.1).problem)
    counted.residuals(np.zeros((5, 2)))
    counted.jacobians(np.zeros((2, 2)))
    assert counted.evaluations == 7


def test_the_determinant_sees_a_crossing_of_two_branches_but_not_of_three():
    assert report_points(CROSSINGS["transcritical"], "", reporters()["pseudo-arclength, determinant"]).verdict == "right"
    assert report_points(CROSSINGS["triple crossing"], "", reporters()["pseudo-arclength, determinant"]).verdict == "missed"


def test_small_singular_values_are_counted_once():
    x = np.linspace(-1, 1, 401)
    case = CROSSINGS["transcritical"]
    points = np.column_stack([x + 0.1234, np.zeros(401) - 0.0567])
    assert by_singular_value(case.problem, points) == 1 == by_determinant(case.problem, points)


def test_this_project_finds_the_pitchfork_from_its_side_branch():
    assert report_points(CROSSINGS["pitchfork from the side"], "", reporters()["this project"]).verdict == "right"


def test_tables_and_figure_show_every_method():
    runs = [follow_ladder(pitchfork(0.1), name, each, "coarse") for name, each in followers().items()]
    runs.append(report_points(CROSSINGS["transcritical"], "this project", reporters()["this project"]))
    text = describe(runs)
    assert all(name in text for name in followers())
    assert len(draw_stability(runs).axes) == 2
