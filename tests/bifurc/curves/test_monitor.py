"""Singular values, test functions and dead points along a curve."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.curves.minima import singular_value_minima, stand_out
from bifurc.curves.monitor import (
    dead_points,
    profile_branch,
    roots_along,
    singular_values,
)
from bifurc.function_problem import FunctionProblem


def traced(function, start, direction=None, low=-2.0, high=2.0):
    problem = FunctionProblem(lambda u: np.atleast_1d(function(*u)), [(low, high)] * 2)
    return problem, trace_branch(problem, start, direction)


def test_singular_values_are_those_of_the_jacobian_over_the_magnitude_padded_to_n():
    problem, _ = traced(lambda x, y: x * x + y * y - 1, [1.0, 0.0])
    values = singular_values(problem, np.array([[[0.6, 0.8], [1.2, 1.6]]]))
    assert values.shape == (1, 2, 2)
    assert values[0] * problem.magnitude == pytest.approx(
        np.array([[2.0, 0.0], [4.0, 0.0]]), abs=1e-14
    )


def test_the_rank_along_a_curve_counts_independent_equations_only():
    for repeat in (1, 3):
        problem, branch = traced(
            lambda x, y, r=repeat: np.full(r, x * x + y * y - 1), [1.0, 0.0]
        )
        profile = profile_branch(problem, branch)
        assert profile.rank == 1
        # a circle about the origin: |F'| = 2 sqrt(repeat) everywhere
        assert profile.smallest * problem.magnitude == pytest.approx(
            2 * np.sqrt(repeat), abs=1e-12
        )


@pytest.mark.parametrize("gap", [1e-1, 1e-2, 1e-4, 1e-6])
def test_a_near_miss_is_found_with_its_value_and_its_place(gap):
    # on x y = gap the derivative (y, x) is smallest at x = y = sqrt(gap): sqrt(2 gap)
    problem, branch = traced(lambda x, y: x * y - gap, [1.0, gap])
    s, value = singular_value_minima(problem, branch, profile_branch(problem, branch))
    k = np.argmin(value)
    assert value[k] * problem.magnitude == pytest.approx(np.sqrt(2 * gap), rel=1e-5)
    # a minimum is flat: its place is known to the root of the accuracy of its value
    assert branch(s[k]) == pytest.approx([np.sqrt(gap)] * 2, abs=5e-3 * np.sqrt(gap))
    points = branch(np.linspace(0.0, branch.length, 101))
    typical = np.median(singular_values(problem, points)[:, 0])
    assert np.count_nonzero(value < 0.5 * typical) == 1


def test_a_crossing_shows_as_a_minimum_of_nearly_zero():
    problem, branch = traced(lambda x, y: y * (y - x), [1.0, 0.0])
    s, value = singular_value_minima(problem, branch, profile_branch(problem, branch))
    assert len(s) == 1
    assert value[0] < 1e-2
    assert np.abs(branch(s[0])).max() < 1e-2


def test_a_curve_of_constant_singular_value_has_no_near_miss_below_it():
    problem, branch = traced(lambda x, y: x * x + y * y - 1, [1.0, 0.0])
    profile = profile_branch(problem, branch)
    _, value = singular_value_minima(problem, branch, profile)
    assert not np.any(value < 0.999 * profile.smallest.max())


def with_singular_values(*values, low=-1.0, high=1.3):
    """A problem whose curve is the line of all z, where the ``values`` of z are
    singular."""
    names = [f"x{i}" for i in range(len(values))]

    def function(u):
        return np.array(
            [value(u[-1]) * x for value, x in zip(values, u[:-1], strict=True)]
        )

    bounds = [(low, high)] * (len(values) + 1)
    problem = FunctionProblem(function, bounds, names=[*names, "z"])
    return problem, trace_branch(problem, np.eye(len(names) + 1)[-1] * 0.05)


def minima(problem, branch):
    s, value = singular_value_minima(problem, branch, profile_branch(problem, branch))
    return branch(s)[:, -1], value * problem.magnitude


WITHOUT_MINIMUM = {
    "constant": [lambda z: 0.7 + 0 * z],
    "two constants": [lambda z: 0.7 + 0 * z, lambda z: 0.3 + 0 * z],
    "monotone": [lambda z: 0.02 + 0.01 * z, lambda z: 0.7 + 0 * z],
    "constant, falling from a kink on": [lambda z: 0.7 + 0 * z, lambda z: 1 - 0.6 * z],
    "a tent": [lambda z: 1 - 0.4 * z, lambda z: 1 + 0.3 * z],
}


@pytest.mark.parametrize("functions", WITHOUT_MINIMUM.values(), ids=WITHOUT_MINIMUM)
def test_a_constant_or_monotone_value_or_a_kink_upwards_has_no_minimum(functions):
    _, value = minima(*with_singular_values(*functions))
    assert not len(value)


WITH_MINIMA = {
    "a dip": ([lambda z: 0.02 + (z - 0.3) ** 2, lambda z: 1.5 + z], [(0.3, 0.02)]),
    "a narrow dip": ([lambda z: np.sqrt(1e-12 + (z - 0.3) ** 2)], [(0.3, 1e-6)]),
    "a dip and a kink": (
        [lambda z: 0.2 + (z - 0.3) ** 2, lambda z: 0.8 - z],
        [(0.3, 0.2), (0.8, 0.0)],
    ),
    "a dip and a zero": (
        [lambda z: z - 0.3, lambda z: 0.1 + z * z],
        [(0.0, 0.1), (0.3, 0.0)],
    ),
    "a flat zero": ([lambda z: (z - 0.3) ** 3], [(0.3, 0.0)]),
    "two zeros": ([lambda z: (z - 0.3) * (z - 0.4)], [(0.3, 0.0), (0.4, 0.0)]),
}


@pytest.mark.parametrize("case", WITH_MINIMA.values(), ids=WITH_MINIMA)
def test_minima_of_singular_values_are_converged(case):
    functions, known = case
    places, values = minima(*with_singular_values(*functions))
    expected_places, expected_values = zip(*known, strict=True)
    order = np.argsort(places)
    assert values[order] == pytest.approx(expected_values, rel=1e-9, abs=1e-11)
    assert places[order] == pytest.approx(expected_places, abs=1e-4)


@pytest.mark.parametrize(("below", "stands_out"), [(0.0, False), (1e-5, True)])
def test_a_minimum_at_half_of_the_largest_value_does_not_stand_out(below, stands_out):
    low = 0.5 * (1 - below)
    for begin in (
        -0.83,
        -0.79,
        -0.71,
        -0.67,
    ):  # the largest value lies between the nodes
        problem, branch = with_singular_values(
            lambda z: 1 - (1 - low) * np.cos(np.pi * z) ** 2, low=begin, high=0.9
        )
        profile = profile_branch(problem, branch)
        _, value = singular_value_minima(problem, branch, profile)
        found = stand_out(problem, branch, profile, value)
        assert list(found) == [stands_out]


def test_dead_points_of_a_circle_are_where_a_coordinate_turns_back():
    _, branch = traced(lambda x, y: x * x + y * y - 1, [np.sqrt(0.5), np.sqrt(0.5)])
    first, second = (branch(s) for s in dead_points(branch))
    assert np.sort(first, axis=0) == pytest.approx(
        np.array([[-1, 0], [1, 0]]), abs=1e-8
    )
    assert np.sort(second, axis=0) == pytest.approx(
        np.array([[0, -1], [0, 1]]), abs=1e-8
    )


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("middle", [0.0, 0.137, 0.8311])
def test_dead_points_close_together_are_all_found(is_recorded, middle):
    # y = x^3 / 3 - e^2 x turns at two places, a few thousandths of a piece apart
    e = 1e-3

    def function(u):
        x = u[0] - middle
        return [u[1] - x**3 / 3 + e**2 * x]

    problem = FunctionProblem(function, [(-1, 1)] * 2, is_recorded=is_recorded)
    branch = trace_branch(problem, [middle, 0.0])
    x = branch(dead_points(branch)[1])[:, 0] - middle
    assert np.sort(x) == pytest.approx([-e, e], rel=1e-6)


@pytest.mark.parametrize("is_recorded", [True, False])
def test_an_unknown_that_slows_down_and_goes_on_has_no_dead_point(is_recorded):
    problem = FunctionProblem(
        lambda u: [u[1] - u[0] ** 3], [(-1, 1)] * 2, is_recorded=is_recorded
    )
    for start in (0.0, 0.3, -0.7):
        branch = trace_branch(problem, [start, start**3])
        assert [len(s) for s in dead_points(branch)] == [0, 0]


def test_an_unknown_that_stands_still_has_no_dead_points():
    _, branch = traced(lambda x, y: y - 0.25, [0.0, 0.25])
    assert [len(s) for s in dead_points(branch)] == [0, 0]


def test_roots_of_test_functions_are_those_of_the_exact_functions():
    _, branch = traced(lambda x, y: x * x + y * y - 1, [1.0, 0.0], [0.0, 1.0])
    roots = roots_along(
        branch,
        lambda s: np.stack(
            [branch(s)[:, 0] - 0.3, np.sin(5 * s + 1), np.ones_like(s)], axis=1
        ),
    )
    angle = np.arccos(0.3)
    assert np.sort(roots[0]) == pytest.approx([angle, 2 * np.pi - angle], abs=1e-10)
    assert np.sort(roots[1]) == pytest.approx(
        (np.arange(1, 11) * np.pi - 1) / 5, abs=1e-10
    )
    assert len(roots[2]) == 0


def test_two_sign_changes_close_to_each_other_are_both_found():
    _, branch = traced(lambda x, y: y, [0.0, 0.0])
    roots = roots_along(
        branch, lambda s: ((branch(s)[:, 0] - 0.5) ** 2 - 0.15**2)[:, None]
    )[0]
    assert np.sort(branch(roots)[:, 0]) == pytest.approx([0.35, 0.65], abs=1e-10)
