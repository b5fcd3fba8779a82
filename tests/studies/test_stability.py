"""The hard cases know the right answer, and the study tells right from wrong."""

import numpy as np
import pytest

from bifurc.curves.certificate import certify_branch
from bifurc.curves.continuation import trace_branch
from bifurc.curves.kantorovich import NODE_COUNT
from bifurc.curves.monitor import profile_branch
from studies.hard_cases import crossings, ladders, near_parallelogram, pitchfork
from studies.methods.counted import Counted
from studies.methods.detection import by_determinant, by_singular_value
from studies.stability import describe
from studies.stability_arcs import follow_ladder, followers
from studies.stability_figure import draw_stability
from studies.stability_points import report_points, reporters

CROSSINGS = {case.name: case for case in crossings()[:4]}


@pytest.mark.parametrize(
    "case",
    ladders(np.array([1e-1, 1e-8])),
    ids=lambda case: f"{case.name} {case.imperfection:g}",
)
def test_the_start_of_a_ladder_lies_on_its_curve(case):
    assert np.linalg.norm(case.problem.residuals(case.start[None])) < 1e-14
    assert (
        np.linalg.norm(case.problem.jacobians(case.start[None])[0] @ case.tangent)
        < 1e-7
    )
    assert case.stays(case.start[None])


def test_the_arcs_of_the_pitchfork_are_as_far_apart_as_stated():
    e = 1e-7
    x = np.geomspace(
        1e-6, 1e-1, 20001
    )  # beside the corner the upper arc is (x^2 - e / x, x), the lower its mirror image
    upper = np.column_stack([x**2 - e / x, x])
    corner = upper[np.argmin(np.linalg.norm(upper, axis=1))]
    assert 2 * np.linalg.norm(corner) == pytest.approx(pitchfork(e).width, rel=0.02)


def test_a_curve_on_the_other_arc_is_seen():
    case = pitchfork(1e-3)
    assert not case.stays(case.start * [1.0, -1.0] + np.zeros((2, 2)))


@pytest.mark.parametrize("imperfection", [1e-2, 1e-6, 1e-8])
def test_the_circuits_of_the_four_bar_are_as_far_apart_as_stated(imperfection):
    case = near_parallelogram(imperfection)
    branch = trace_branch(case.problem, case.start, case.tangent)
    points = branch(np.linspace(0, branch.length, 200001))
    closest = (
        2 * np.abs(np.sin(points[:, 2])).min()
    )  # the other circuit is the mirror image
    assert closest == pytest.approx(case.width, rel=0.25)


@pytest.mark.parametrize("make", [pitchfork, near_parallelogram])
@pytest.mark.parametrize("step", ["fine", "medium", "coarse"])
@pytest.mark.parametrize("imperfection", [1e-1, 1e-4, 1e-7, 1e-10])
def test_this_project_follows_the_true_arc_and_certifies_it(make, step, imperfection):
    run = follow_ladder(
        make(imperfection), "this project", followers()["this project"], step
    )
    assert (run.verdict, run.certificate) == ("right", "certified")


@pytest.mark.parametrize("make", [pitchfork, near_parallelogram])
def test_every_tenth_of_the_imperfection_adds_no_more_than_the_one_before(make):
    cases = [make(e) for e in 10.0 ** -np.arange(1.0, 11.0)]
    runs = [
        follow_ladder(case, "", followers()["this project"], "coarse") for case in cases
    ]
    pieces = np.diff([r.pieces for r in runs])
    # as the logarithm of 1 / imperfection, or slower
    assert pieces.max() < 15 and pieces[-1] <= pieces[0] + 5
    # an arc of the certificate for every piece, and a few more
    arcs = [r.certificate_points / NODE_COUNT for r in runs]
    assert np.all(np.array(arcs) <= 1.5 * np.array([r.pieces for r in runs]))


@pytest.mark.parametrize("make", [pitchfork, near_parallelogram])
@pytest.mark.parametrize("imperfection", 10.0 ** -np.arange(1, 13))
def test_a_curve_that_goes_over_to_the_other_arc_is_refused(make, imperfection):
    case, crossing = make(imperfection), make(1e-18)
    wrong = trace_branch(
        crossing.problem, case.start, case.tangent
    )  # without an imperfection it goes straight across
    points = wrong.sample(2000)
    assert not (case.stays(points) and case.arrives(points))
    assert (
        certify_branch(case.problem, wrong, profile_branch(case.problem, wrong)).status
        == "not certified"
    )


def test_large_steps_of_the_null_vector_jump_and_small_ones_do_not():
    follow = followers()["solve_ivp RK45"]
    assert (
        follow_ladder(near_parallelogram(1e-6), "", follow, "coarse").verdict
        == "jumped"
    )
    assert (
        follow_ladder(near_parallelogram(1e-2), "", follow, "fine").verdict == "right"
    )


def test_evaluations_are_counted_by_the_point():
    counted = Counted(pitchfork(0.1).problem)
    counted.residuals(np.zeros((5, 2)))
    counted.jacobians(np.zeros((2, 2)))
    assert counted.evaluations == 7


def test_the_determinant_sees_a_crossing_of_two_branches_but_not_of_three():
    assert (
        report_points(
            CROSSINGS["transcritical"], "", reporters()["pseudo-arclength, determinant"]
        ).verdict
        == "right"
    )
    assert (
        report_points(
            CROSSINGS["triple crossing"],
            "",
            reporters()["pseudo-arclength, determinant"],
        ).verdict
        == "missed"
    )


def test_small_singular_values_are_counted_once():
    x = np.linspace(-1, 1, 401)
    case = CROSSINGS["transcritical"]
    points = np.column_stack([x + 0.1234, np.zeros(401) - 0.0567])
    assert (
        by_singular_value(case.problem, points)
        == 1
        == by_determinant(case.problem, points)
    )


def test_this_project_finds_the_pitchfork_from_its_side_branch():
    assert (
        report_points(
            CROSSINGS["pitchfork from the side"], "", reporters()["this project"]
        ).verdict
        == "right"
    )


def test_tables_and_figure_show_every_method():
    runs = [
        follow_ladder(pitchfork(0.1), name, each, "coarse")
        for name, each in followers().items()
    ]
    runs.append(
        report_points(
            CROSSINGS["transcritical"], "this project", reporters()["this project"]
        )
    )
    text = describe(runs)
    assert all(name in text for name in followers())
    assert "certified" in text
    assert len(draw_stability(runs).axes) == 2 + 3
