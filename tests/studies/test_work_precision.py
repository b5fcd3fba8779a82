"""The methods of comparison follow simple curves, and the study reads its runs
right."""

import numpy as np
import pytest

from studies.methods.auto07p import auto_07p, has_auto
from studies.methods.cases import bratu, circle, linkage_cases, pitchfork
from studies.methods.curve import Curve, MethodFailure
from studies.methods.exact import distance_in_digits, largest_distance
from studies.methods.peers import has_pycont, pycont_lite
from studies.methods.roster import Method, comparison_methods, orders_of_this_project
from studies.work_precision import measure, measure_case
from studies.work_precision_figures import unbeaten
from studies.work_precision_findings import (
    fastest,
    points_in_our_time,
    ratios,
    recommend,
    summarise,
)
from studies.work_precision_runs import Run

METHODS = [*orders_of_this_project(), *comparison_methods()]


@pytest.fixture(scope="module")
def bennett():
    return next(case for case in linkage_cases() if case.name == "bennett")


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_every_method_follows_a_bennett_linkage_once_around(bennett, method):
    # a tolerance is met up to the factor by which errors of steps add up along the
    # curve
    loose_only = method.name in ("pycont-lite", "order 2")  # slow at tighter tolerances
    for tolerance, bound in ((1e-3, 1e-1), (1e-5, 1e-2))[: 1 if loose_only else 2]:
        curve = method.follow(bennett, tolerance)
        assert largest_distance(bennett, curve.sample(2000)) < bound


@pytest.mark.skipif(not has_auto(), reason="AUTO-07p or gfortran is not installed")
@pytest.mark.parametrize(
    "name", ["circle", "pitchfork", "bratu", "bennett", "general-7r"]
)
def test_auto_follows_every_kind_of_problem_and_says_how_long_it_took(name):
    cases = (
        {case.name: case for case in linkage_cases()}
        if name in ("bennett", "general-7r")
        else {}
    )
    case = (
        cases.get(name)
        or {"circle": circle, "pitchfork": pitchfork, "bratu": lambda: bratu(10)}[
            name
        ]()
    )
    curve = auto_07p(case, 1e-6)
    assert largest_distance(case, curve.sample(2000)) < 1e-5
    assert 0.0 < curve.seconds < 10.0


def test_the_first_run_of_a_method_is_not_measured():
    case, calls = circle(), []

    def follow(case, tolerance):
        calls.append(tolerance)
        return Curve(
            case.reference, case.length, 1, seconds=99.0 if len(calls) == 1 else 1.0
        )  # it compiles at first

    runs = measure_case(case, [Method("slow to begin", follow)], 1.0).runs
    assert runs
    assert {run.seconds for run in runs} == {1.0}


def test_a_method_that_takes_long_to_fail_is_given_up():
    def fail(case, tolerance):
        sum(range(100_000))
        raise MethodFailure("no")

    runs = measure_case(circle(), [Method("fails", fail)], 1e-6).runs
    assert len(runs) == 1


def test_a_method_that_runs_elsewhere_states_its_own_time():
    case = circle()
    elsewhere = Method(
        "elsewhere",
        lambda case, tolerance: Curve(case.reference, case.length, 1, seconds=42.0),
    )
    assert measure(case, elsewhere, 1e-4, 1e-16, 0.0).seconds == 42.0


@pytest.mark.skipif(not has_pycont(), reason="pycont-lite is not installed")
def test_a_peer_that_recurses_without_end_has_failed(monkeypatch):
    def recurse(*_):
        raise RecursionError

    monkeypatch.setattr("pycont.arclengthContinuation", recurse)
    case = circle()
    with pytest.raises(MethodFailure, match="without end"):
        pycont_lite(case.problem, case.start, case.tangent, case.length, 1e-3)


def test_natural_parameters_cannot_go_around_a_circle():
    natural = next(m for m in METHODS if m.name == "natural parameter")
    with pytest.raises(MethodFailure, match="dead point"):
        natural.follow(circle(), 1e-4)
    run = measure(circle(), natural, 1e-4, 1e-16, 0.0)
    assert run.error == np.inf
    assert "dead point" in run.note


def test_a_distance_far_below_rounding_is_measured():
    case = circle()
    point = np.array(
        [0.6, 0.8]
    )  # the two decimals are not exact in binary: some 1e-17 from the circle
    assert 1e-18 < distance_in_digits(case, point) < 1e-16
    assert distance_in_digits(case, point * (1 + 1e-9)) == pytest.approx(1e-9, rel=1e-6)


def test_what_lies_beyond_the_ends_of_an_open_curve_is_not_compared():
    case = pitchfork()
    beyond = case.reference(case.length) + np.outer(
        np.linspace(0.0, 0.1, 50), case.reference(case.length, 1)
    )
    whole = case.reference(np.linspace(0, case.length, 2000))
    assert largest_distance(case, np.concatenate([whole, beyond])) < 1e-13


def test_half_a_curve_has_an_infinite_error():
    case = pitchfork()
    assert largest_distance(case, case.reference.sample(2000)) < 1e-13
    half = case.reference(np.linspace(0, 0.5 * case.length, 2000))
    assert largest_distance(case, half) == np.inf


def runs_of(method, order, seconds, errors):
    return [
        Run("c", method, order, 10.0**-k, t, e, 1)
        for k, (t, e) in enumerate(zip(seconds, errors, strict=True), 3)
    ]


def test_ratios_compare_the_fastest_runs_within_an_error():
    runs = runs_of("order 16", 16, (1.0, 2.0), (1e-5, 1e-12)) + runs_of(
        "slow", 0, (3.0, 8.0), (1e-4, 1e-9)
    )
    (row,) = ratios(runs)
    assert (row["1e-04"], row["1e-06"], row["1e-08"]) == (3.0, 4.0, 4.0)
    assert np.isnan(row["1e-10"])
    assert fastest(runs, 1e-10) == 2.0


def test_the_recommended_tolerance_is_the_loosest_that_is_tight_enough():
    runs = runs_of("order 8", 8, (1.0, 2.0, 4.0), (1e-8, 1e-12, 1e-13)) + runs_of(
        "order 4", 4, (8.0,), (1e-13,)
    )
    assert recommend(runs) == {4: (4.0, 1e-3), 8: (1.0, 1e-4)}


def test_a_figure_shows_the_runs_that_no_other_beats():
    runs = runs_of("slow", 0, (1.0, 0.5, 2.0, 3.0), (1e-4, 1e-5, 1e-6, np.inf))
    assert [run.error for run in unbeaten(runs)] == [1e-5, 1e-6]


def test_points_of_usual_steps_are_counted_in_our_time():
    usual = [Run("c", "pseudo-arclength, tangent", 0, 1e-6, 1.0, 1e-6, 1000)]
    runs = usual + runs_of("order 16", 16, (0.5,), (1e-9,))
    assert points_in_our_time(runs, "c", 1e-6) == 2000.0
    assert np.isnan(points_in_our_time(runs, "c", 1e-8))


def test_a_sparse_problem_is_left_to_methods_with_sparse_matrices():
    case = bratu(150)
    assert case.sparse
    assert np.allclose(
        case.problem.jacobians(case.start[None] + 0.1)[0],
        bratu_by_differences(case, case.start + 0.1),
    )
    few = [METHODS[4], *(m for m in METHODS if m.small)]
    assert few[0].name == "order 16"
    measured = measure_case(case, few, 0.0)
    ours, *others = measured.runs
    assert measured.floor < 1e-8
    assert ours.error < 1e-3
    assert others
    assert all("not tried" in run.note for run in others)


def bratu_by_differences(case, x):
    step = 1e-6 * np.eye(len(x))
    return (
        (case.problem.residuals(x + step) - case.problem.residuals(x - step)) / 2e-6
    ).T


def test_the_default_order_is_kept_where_others_are_faster_by_less_than_noise():
    def runs(seconds):
        return runs_of("order 16", 16, (seconds,), (1e-13,)) + runs_of(
            "order 24", 24, (1.0,), (1e-13,)
        )

    assert "should be order 16" in summarise(runs(1.02), {})
    assert "should be order 24" in summarise(runs(1.50), {})
