"""The order of forms and points comes from themselves, whatever the seeds."""

import numpy as np
import pytest

from bifurc.atlas import Surface
from bifurc.function_problem import FunctionProblem
from bifurc.search.canonical_order import (
    order_branches,
    order_points,
    order_surfaces,
    order_values,
)
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.surfaces.covering import cover_surface
from tests.bifurc.known_surfaces import level

NO_PERIODS = np.full(2, np.inf)


def circles(*centers):
    """Circles of radius 1/2 about centers in the plane, as one equation."""

    def product(u):
        factors = [(u[0] - x) ** 2 + (u[1] - y) ** 2 - 0.25 for x, y in centers]
        return np.array([np.prod(factors)])

    return FunctionProblem(product, [(-3, 3)] * 2)


def beginning_elsewhere(branch):
    """The same closed curve, begun at its third piece and run the other way."""
    return branch.begun_at(branch.breaks[2]).reversed()


@pytest.mark.parametrize("seed", range(4))
def test_forms_of_equal_length_stand_in_one_order_whatever_the_seed(seed):
    problem = circles((-1.5, 0.0), (1.5, 1.0), (1.5, -1.0), (0.0, 2.0))
    atlas = explore(problem, settings=SearchSettings(starts=60), seed=seed)
    centers = [form.branch.sample(8).mean(axis=0) for form in atlas.forms]
    expected = [(1.5, 1.0), (1.5, -1.0), (0.0, 2.0), (-1.5, 0.0)]
    assert np.array(centers) == pytest.approx(np.array(expected), abs=1e-9)


@pytest.mark.parametrize("seed", range(1, 4))
def test_dead_points_and_rigid_assemblies_keep_their_places(seed):
    pair = circles((1.0, 0.0), (-1.0, 0.0))
    isolated = FunctionProblem(
        lambda u: np.array([u[0] ** 2 - 1, u[1] ** 2 - 4 * u[0] ** 2]), [(-3, 3)] * 2
    )
    settings = SearchSettings(starts=60)
    for problem in (pair, isolated):
        one, other = (explore(problem, settings=settings, seed=k) for k in (0, seed))
        assert one.rigid == pytest.approx(other.rigid, abs=1e-9)
        for left, right in zip(one.dead_points, other.dead_points, strict=True):
            assert (left.form, left.index) == (right.form, right.index)
            assert left.u == pytest.approx(right.u, abs=1e-9)


def test_start_and_direction_of_a_branch_make_no_difference():
    problem = circles((-1.5, 0.0), (1.5, 1.0), (1.5, -1.0))
    forms = explore(problem, settings=SearchSettings(starts=60)).forms
    branches = [form.branch for form in forms]
    again = [beginning_elsewhere(branch) for branch in branches]
    for left, right in zip(branches, again, strict=True):
        assert left.nearest(right.sample(20))[0].max() < 1e-9
    for mixed in ([*branches], [*again], [again[0], branches[1], again[2]]):
        assert order_branches(problem, mixed).tolist() == [0, 1, 2]
        assert order_branches(problem, mixed[::-1]).tolist() == [2, 1, 0]


def test_last_bits_decide_nothing_however_the_values_lie():
    rng = np.random.default_rng(0)
    for value in (
        0.0,
        0.5e-6,
        1.5e-6,
        0.1234565,
    ):  # six digits round some of them apart
        points = np.array([[value, 3.0], [value, 1.0], [value, 2.0], [-1.0, 5.0]])
        noisy = points + rng.uniform(-1e-9, 1e-9, points.shape)
        assert order_points(noisy, NO_PERIODS, 1.0).tolist() == [3, 1, 2, 0]


def test_points_known_to_few_digits_are_compared_with_their_error():
    points = np.array([[1e-5, 1.0], [-1e-5, 2.0]])
    assert order_points(points, NO_PERIODS, 1.0).tolist() == [1, 0]
    assert order_points(points, NO_PERIODS, 1.0, error=1e-4).tolist() == [0, 1]


def test_points_on_both_sides_of_a_half_turn_lie_at_one_place():
    periods = np.full(2, 2 * np.pi)
    points = np.array([[np.pi, 2.0], [1e-9 - np.pi, 1.0], [np.pi - 1e-9, 3.0]])
    assert order_points(points, periods, 1.0).tolist() == [1, 0, 2]


def test_groups_come_before_places():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0]])
    groups = np.array([7, 2, 7])
    assert order_points(points, NO_PERIODS, 1.0, groups=groups).tolist() == [1, 2, 0]


def test_values_but_for_rounding_equal_keep_their_order():
    assert order_values(np.array([1.0, 0.5, 1.0 - 1e-9]), 1e-6).tolist() == [1, 0, 2]
    assert order_values(np.array([1.0, 0.5, 1.0 - 1e-5]), 1e-6).tolist() == [1, 2, 0]


def one_sphere(middle, begin):
    """A sphere on the x axis as a surface, charts laid out from the point at ``begin``
    (rad) from its far end."""
    problem = level(lambda x, y, z: (x - middle) ** 2 + y * y + z * z - 0.25, 2.0)
    far = middle + 0.5 * np.cos(begin)
    start = np.array([[far, 0.5 * np.sin(begin), 0.0]])
    charts = cover_surface(problem, start, radius=0.5)
    return problem, Surface(2, start, charts=charts)


def spheres_from(begin):
    """Two equal spheres as surfaces, the left one first."""
    problem, left = one_sphere(-1.0, begin)
    _, right = one_sphere(1.0, 0.7 * begin)
    return problem, [left, right]


def test_equal_surfaces_stand_in_one_order_whatever_their_charts():
    for begin in (0.0, 1.0):
        problem, surfaces = spheres_from(begin)
        for listed in (surfaces, surfaces[::-1]):
            first = listed[order_surfaces(problem, listed)[0]]
            assert first.charts.centers[:, 0].min() > 0


def test_surfaces_stand_by_dimension_and_those_with_charts_first():
    problem, surfaces = spheres_from(0.0)
    spread = Surface(2, np.zeros((4, 3)))
    solid = Surface(3, np.zeros((2, 3)))
    order = order_surfaces(problem, [solid, spread, *surfaces])
    assert order[2:].tolist() == [1, 0]


def test_nothing_to_order_is_no_error():
    problem = circles((0.0, 0.0))
    assert order_branches(problem, []).tolist() == []
    assert order_surfaces(problem, []).tolist() == []
    assert order_points(np.empty((0, 2)), NO_PERIODS, 1.0).tolist() == []
