"""Solutions that walks over a component join."""

import numpy as np
import pytest

import bifurc
from bifurc.limits import Deadline
from bifurc.search.records import APART, JOINED
from bifurc.settings import SearchSettings
from bifurc.surfaces.joined import joined_parts

BOX = (-3.0, 3.0)


def problem_of(equations, count):
    return bifurc.FunctionProblem(equations, dict.fromkeys("abcdef"[:count], BOX))


def spheres(u):
    """Two spheres of dimension one less than the number of unknowns."""
    squares = sum(x**2 for x in u)
    return [(squares - 1) * (squares - 4)]


def sheets(u):
    return [u[0] ** 2 - u[1] ** 2 - u[2] ** 2 - u[3] ** 2 - 1]


def on_spheres(count, n):
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(count, n))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return np.concatenate([directions, 2 * directions])


@pytest.mark.parametrize("n", [3, 4, 5])
def test_solutions_on_two_spheres_are_in_two_parts(n):
    points = on_spheres(40, n)
    parts = joined_parts(problem_of(spheres, n), points, n - 1, Deadline())
    assert np.unique(parts[:40]).tolist() == [0]
    assert np.unique(parts[40:]).tolist() == [1]


def test_singular_solutions_are_in_no_part():
    def cone(u):
        return [u[0] ** 2 + u[1] ** 2 + u[2] ** 2 - u[3] ** 2]

    points = np.array([[0, 0, 0, 0], [1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, -1.0]])
    parts = joined_parts(problem_of(cone, 4), points, 3, Deadline())
    assert parts.tolist() == [-1, 0, 0, 1]


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(("equations", "count"), [(spheres, 2), (sheets, 2)])
def test_without_charts_components_of_dimension_three_are_listed_apart(
    equations, count, seed
):
    settings = SearchSettings(charts=0)
    atlas = bifurc.explore(problem_of(equations, 4), seed=seed, settings=settings)
    assert [surface.dimension for surface in atlas.surfaces] == [3] * count
    assert {surface.note for surface in atlas.surfaces} == {APART}


def test_without_charts_a_component_whose_starts_are_all_joined_is_one():
    def ellipsoid(u):
        return [u[0] ** 2 + u[1] ** 2 + 2 * u[2] ** 2 + 3 * u[3] ** 2 - 1]

    settings = SearchSettings(starts=50, charts=0)
    (surface,) = bifurc.explore(problem_of(ellipsoid, 4), settings=settings).surfaces
    assert surface.note == JOINED


def test_what_charts_leave_is_no_second_surface():
    def long_tube(u):
        return [u[0] ** 2 + u[1] ** 2 + 0.01 * u[0] * u[2] - 1 + 0.001 * u[2] ** 3]

    bounds = {"x": (-9, 9), "y": (-9, 9), "z": (-9, 9)}
    problem = bifurc.FunctionProblem(long_tube, bounds)
    settings = SearchSettings(charts=40)
    atlas = bifurc.explore(problem, settings=settings)
    (surface,) = atlas.surfaces
    assert surface.is_short_of_charts
    assert atlas.completeness.is_in_doubt
