"""Boxes of the compiled core: what is empty, what has a single arc, what is left."""

import numpy as np
import pytest

from bifurc import FunctionProblem
from bifurc.search.subdivision import continuous_tape
from bifurc.system import relative_gaps


def quartic(u):
    x, y = u
    return [(x**2 + y**2) ** 2 - x**2 + 0.7 * y**2 + 0.01 * np.sin(3 * x)]


def curve_in_space(u):
    return [u @ u - 1, u[0] ** 2 + u[1] ** 2 - 0.3 * u[0] - 0.2]


def curve_of_four(u):
    x, y, z, w = u
    return [x**2 + y**2 - 1, z**2 + y**2 - 1.1, w - np.exp(x) * z]


def divided(function, n, most=50_000, smallest=1e-6):
    """The problem, and what became of its bounds; nothing is left out."""
    one = FunctionProblem(function, [(-1.53, 1.47)] * n)
    tape = continuous_tape(one)
    low, high = np.full((1, n), -1.53), np.full((1, n), 1.47)
    nowhere = (np.empty((0, n)), np.empty(0), np.full(n, np.inf))
    return one, tape.divide(low, high, *nowhere, smallest, most)


@pytest.mark.parametrize(
    ("function", "n"), [(quartic, 2), (curve_in_space, 3), (curve_of_four, 4)]
)
def test_every_solution_lies_in_a_box_with_an_arc(function, n):
    one, (_, waiting, small, (low, high), *_) = divided(function, n)
    assert not len(waiting[0]) and not len(small[0])
    starts = np.random.default_rng(0).uniform(-1.5, 1.4, (300, n))
    solutions, gaps = one.project(starts)
    inside = np.all((solutions > -1.53) & (solutions < 1.47), axis=1)
    solutions = solutions[(gaps < 1e-13) & inside]
    assert len(solutions) > 50
    slack = 1e-10
    above = solutions[:, None] >= low - slack
    below = solutions[:, None] <= high + slack
    assert np.all(np.any(np.all(above & below, axis=2), axis=1))


@pytest.mark.parametrize(("function", "n"), [(quartic, 2), (curve_in_space, 3)])
def test_the_points_of_an_arc_solve_the_equations(function, n):
    one, (_, _, _, (low, high), room, points, is_steady) = divided(function, n)
    assert relative_gaps(one, points.reshape(-1, n)).max() < 1e-13
    # one of the unknowns, the parameter, goes from one end of the box to the other
    is_end = np.isclose(points[:, 0], low, rtol=0, atol=1e-12)
    is_end &= np.isclose(points[:, 2], high, rtol=0, atol=1e-12)
    assert np.all(np.any(is_end & is_steady, axis=1))
    # what is steady rises or falls from place to place
    steps = np.diff(points, axis=1)
    assert np.all((steps[:, 0] * steps[:, 1] > 0)[is_steady])
    low, high = room
    assert np.all((points >= low[:, None] - 1e-12) & (points <= high[:, None] + 1e-12))


def test_boxes_that_are_not_looked_at_are_handed_back():
    _, whole = divided(quartic, 2)
    _, part = divided(quartic, 2, most=100)
    assert part[0] == 100
    low, high = part[1]
    assert len(low)
    one = FunctionProblem(quartic, [(-1.53, 1.47)] * 2)
    nowhere = (np.empty((0, 2)), np.empty(0), np.full(2, np.inf))
    rest = continuous_tape(one).divide(low, high, *nowhere, 1e-6, 50_000)
    assert part[0] + rest[0] == whole[0]
    assert len(part[3][0]) + len(rest[3][0]) == len(whole[3][0])


def test_small_boxes_about_a_crossing_are_left():
    _, (_, waiting, small, *_) = divided(lambda u: [u[0] * u[1]], 2, smallest=1e-3)
    assert not len(waiting[0])
    assert len(small[0])
    assert np.abs(small[0]).max() < 0.01


def test_balls_are_left_out_modulo_the_periods():
    period = 3.0
    one = FunctionProblem(lambda u: [u[0] * u[1]], [(-1.53, 1.47)] * 2)
    low, high = np.full((1, 2), -1.53), np.full((1, 2), 1.47)
    centers = np.array([[period, -period]])
    ball = (centers, np.array([0.1]), np.array([period, period]))
    _, waiting, small, *_ = continuous_tape(one).divide(low, high, *ball, 1e-3, 5000)
    assert not len(waiting[0]) and not len(small[0])


def test_sums_are_rounded_to_the_next_doubles():
    tape = continuous_tape(FunctionProblem(lambda u: [u[0] + u[1]], [(-1, 1)] * 2))
    rng = np.random.default_rng(0)
    points = rng.normal(size=(500, 2)) * 10.0 ** rng.integers(-300, 300, (500, 1))
    points = np.concatenate([points, [[0.5, 0.5], [-1.0, 2.0], [1.0, -1.0]]])
    low, high = tape.value_bounds(points, points)
    sums = points.sum(axis=1, keepdims=True)
    assert np.array_equal(low, np.nextafter(sums, -np.inf))
    assert np.array_equal(high, np.nextafter(sums, np.inf))
    huge = np.full((1, 2), 1e308)
    low, high = tape.value_bounds(huge, huge)
    assert 1.7e308 < low[0, 0] < np.inf == high[0, 0]


@pytest.mark.parametrize(
    ("low", "centers", "error"),
    [
        (np.zeros((1, 3)), np.empty((0, 2)), "low: 3 unknowns"),
        (np.zeros((1, 2)), np.empty((0, 3)), "centers: 3 unknowns"),
        (np.zeros((2, 2)), np.empty((0, 2)), "high: there must be a row"),
        (np.zeros((1, 2)), np.zeros((1, 2)), "radii: there must be one"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(low, centers, error):
    tape = continuous_tape(FunctionProblem(quartic, [(-1, 1)] * 2))
    periods = np.full(2, np.inf)
    with pytest.raises(ValueError, match=error):
        tape.divide(low, np.ones((1, 2)), centers, np.empty(0), periods, 1e-6, 10)
