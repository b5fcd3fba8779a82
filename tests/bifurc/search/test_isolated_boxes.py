"""Boxes show all isolated solutions, however small they are in the bounds."""

import numpy as np
import pytest

import bifurc
from bifurc.completeness import Level
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from bifurc.search.isolated_boxes import isolated_in_boxes
from tests.samples import one_in

MOST = 20_000


def cubic(size):
    """Solutions -0.4, 0.3 and 0.9 of a size, and the square of each."""

    def values(u):
        x, y = u[0] / size, u[1] / size
        return [(x + 0.4) * (x - 0.3) * (x - 0.9), y - x * x]

    return values, [[x, x * x] for x in (-0.4, 0.3, 0.9)], [(-1, 1)] * 2


def hyperbolic_tangent(size):
    def values(u):
        return [np.tanh(u[0] / size) - 0.5]

    return values, [[np.arctanh(0.5)]], [(-1, 1)]


def resonance(size):
    """Two solutions, 0.5 and 2 of a size, of a function that falls off on both sides."""

    def values(u):
        x = u[0] / size
        return [x / (1 + x * x) - 0.4]

    return values, [[0.5], [2.0]], [(-1, 1)]


def on_a_circle(size):
    def values(u):
        return [u[0] ** 2 + u[1] ** 2 - size**2, 3 * u[0] - 4 * u[1]]

    return values, [[-0.8, -0.6], [0.8, 0.6]], [(-1, 1)] * 2


def logarithm(size):
    def values(u):
        return [np.log(u[0] / size) - 0.1]

    return values, [[np.exp(0.1)]], [(1e-20, 1)]


SYSTEMS = [cubic, hyperbolic_tangent, resonance, on_a_circle, logarithm]


@pytest.mark.parametrize("size", one_in(3, [1e-14, 1e-9, 1e-3]))
@pytest.mark.parametrize("system", SYSTEMS)
def test_solutions_far_smaller_than_the_bounds_are_all_listed(system, size):
    function, solutions, bounds = system(size)
    atlas = bifurc.explore(bifurc.FunctionProblem(function, bounds))
    assert not atlas.forms and not atlas.points
    ordered = sorted(atlas.rigid.tolist())
    assert np.array(ordered) / size == pytest.approx(np.array(solutions), rel=1e-9)
    assert atlas.completeness.level is Level.COUNTED


def test_solutions_of_sizes_that_differ_by_ten_decades_are_told_apart():
    roots = np.array([0.3, 0.5, -2e-10])
    c = np.poly(roots)
    problem = bifurc.FunctionProblem(
        lambda u: [((u[0] + c[1]) * u[0] + c[2]) * u[0] + c[3]], [(-1, 1)]
    )
    atlas = bifurc.explore(problem)
    assert np.sort(atlas.rigid[:, 0]) == pytest.approx(np.sort(roots), rel=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_a_product_of_random_factors_has_its_roots(seed):
    rng = np.random.default_rng(seed)
    roots = np.sort(rng.uniform(-1, 1, 5) * 10.0 ** rng.uniform(-12, 0, 5))
    problem = bifurc.FunctionProblem(
        lambda u: [np.prod([u[0] - root for root in roots])], [(-1.3, 1.2)]
    )
    found = isolated_in_boxes(problem.recording.tape, problem.domain, MOST)
    assert found.is_complete
    assert np.sort(found.points[:, 0]) == pytest.approx(roots, rel=1e-12)


def test_a_solution_on_the_rim_of_two_boxes_is_one():
    problem = bifurc.FunctionProblem(lambda u: [u[0], u[1] - 0.25], [(-1, 1)] * 2)
    found = isolated_in_boxes(problem.recording.tape, problem.domain, MOST)
    assert found.is_complete
    assert found.points == pytest.approx(np.array([[0.0, 0.25]]))


def test_a_solution_where_a_circle_is_cut_open_is_one():
    problem = bifurc.FunctionProblem(
        lambda u: [np.sin(u[0])], [(-np.inf, np.inf)], periods=[2 * np.pi]
    )
    found = isolated_in_boxes(problem.recording.tape, problem.domain, MOST)
    assert found.is_complete
    assert len(found.points) == 2


def test_a_double_solution_is_left_open():
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1, u[0] - 1], [(-3, 3.1)] * 2
    )
    found = isolated_in_boxes(problem.recording.tape, problem.domain, MOST)
    assert not found.is_complete
    assert found.left.mean(axis=2) == pytest.approx(
        np.tile([1.0, 0.0], (len(found.left), 1)), abs=1e-6
    )


@pytest.mark.parametrize("side", ["low", "high"])
@pytest.mark.parametrize("turns", [1, 2, 3, 5])
def test_a_solution_in_a_bound_that_is_rounded_is_listed(turns, side):
    root = turns * np.pi  # off by rounding, to either side
    bounds = (root, root + 1.5) if side == "low" else (root - 1.5, root)
    problem = bifurc.FunctionProblem(
        lambda u: [np.sin(u[0]), np.sin(u[1])], [bounds, (-1, 1)]
    )
    found = isolated_in_boxes(problem.recording.tape, problem.domain, MOST)
    assert found.is_complete
    assert found.points == pytest.approx(np.array([[root, 0.0]]))


def test_a_solution_beyond_a_bound_by_rounding_is_listed():
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] - (0.1 + 0.2), np.log(u[1] + 1)], [(0, 0.3), (-1, 1)]
    )
    atlas = bifurc.explore(problem, settings=bifurc.SearchSettings(starts=3))
    assert atlas.rigid == pytest.approx(np.array([[0.3, 0.0]]))


def test_boxes_about_a_double_solution_are_cut_in_every_unknown():
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1, u[0] - 1], [(-2, 2)] * 2
    )
    found = isolated_in_boxes(problem.recording.tape, problem.domain, MOST)
    assert np.ptp(found.left[:, 1], axis=1).max() < 1e-6


def test_open_boxes_about_nothing_that_is_listed_are_a_doubt():
    settings = bifurc.SearchSettings(boxes=3, paths=0)
    problem = bifurc.FunctionProblem(lambda u: [np.tanh(1e9 * u[0]) - 0.5], [(-1, 1)])
    completeness = bifurc.explore(problem, settings=settings).completeness
    assert SearchDoubt.OPEN_BOXES.name in [one.kind for one in completeness.doubts]


def test_equations_that_are_nearly_zero_are_shown_to_have_no_solution():
    problem = bifurc.FunctionProblem(
        lambda x: [x[0] ** 2 + 3 * x[0] + 2.25 + 1e-12, x[1] - 2.6 * x[0]],
        [(-5, 5.1)] * 2,
    )
    atlas = bifurc.explore(problem)
    assert not len(atlas.rigid)
    (claim,) = [
        one
        for one in atlas.completeness.claims
        if SearchClaim.BOXES_OF_SOLUTIONS.is_kind_of(one)
    ]
    assert claim.level is Level.COUNTED
