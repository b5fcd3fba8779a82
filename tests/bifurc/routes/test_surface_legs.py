"""Routes that lead over surfaces, where their length is known."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.problem import Problem
from bifurc.routes.route import find_route
from bifurc.search.explore import explore
from bifurc.seeds import Seeds
from bifurc.settings import SearchSettings
from tests.bifurc.known_surfaces import union
from tests.bifurc.routes.walks import assert_is_walk, dimensions_of, forms_of

PLANE_AND_LINES = union(
    lambda x, y, z: np.array([z]),
    lambda x, y, z: np.array([x, y]),
    lambda x, y, z: np.array([x - 1, y - 0.5]),
    lambda x, y, z: np.array([x + 1, y + 1 - z]),
)
SPHERE_AND_AXIS = union(
    lambda x, y, z: np.array([x * x + y * y + z * z - 1]),
    lambda x, y, z: np.array([x, y]),
)
PLANES = union(lambda x, y, z: np.array([z]), lambda x, y, z: np.array([y]))
CONE = union(lambda x, y, z: np.array([z * z - x * x - y * y]))


def search(
    problem: Problem,
    on_surfaces: list[list[float]],
    settings: SearchSettings = SearchSettings(),  # noqa: B008
) -> Atlas:
    """The atlas found from solutions on the surfaces alone, and what hangs on them."""
    points = np.array(on_surfaces, dtype=float)
    is_random = np.ones(len(points), dtype=bool)
    seeds = Seeds(points, is_random, np.empty(0), np.empty((0, problem.n)))
    return explore(problem, seeds=seeds, settings=settings)


@pytest.fixture(scope="module")
def lines() -> Atlas:
    return explore(PLANE_AND_LINES, settings=SearchSettings(starts=40))


@pytest.fixture(scope="module")
def sphere() -> Atlas:
    return search(SPHERE_AND_AXIS, [[0.6, 0.0, 0.8]])


# --- what is known exactly ------------------------------------------------------------


def test_a_route_crosses_a_plane_in_a_straight_line_from_one_curve_to_another(
    lines: Atlas,
) -> None:
    start, goal = np.array([0, 0, 1.2]), np.array([1, 0.5, -0.8])
    route = find_route(lines, start, goal, problem=PLANE_AND_LINES)
    assert dimensions_of(route) == [1, 2, 1]
    assert route.legs[1].form == "surface 1"
    assert route.legs[1].start == 0.0
    lengths = [leg.length for leg in route.legs]
    assert lengths == pytest.approx([1.2, np.hypot(1, 0.5), 0.8], abs=1e-9)
    assert route.travel == pytest.approx([1, 0.5, 2.0], abs=1e-9)
    assert_is_walk(lines, PLANE_AND_LINES, route)


def test_of_the_curves_that_meet_a_plane_the_nearer_way_is_taken(lines: Atlas) -> None:
    # the slanted line x = -1, y = z - 1 meets the plane in (-1, -1, 0)
    start, goal = np.array([-1, 0.5, 1.5]), np.array([0.3, 0.2, 0.0])
    route = find_route(lines, start, goal, problem=PLANE_AND_LINES)
    length = 1.5 * np.sqrt(2) + np.hypot(1.3, 1.2)
    assert route.length == pytest.approx(length, abs=1e-9)
    assert_is_walk(lines, PLANE_AND_LINES, route)
    back = find_route(lines, goal, start, problem=PLANE_AND_LINES)
    assert back.length == pytest.approx(route.length, abs=1e-12)
    assert dimensions_of(back) == [2, 1]
    np.testing.assert_allclose(back.path[[0, -1]], [goal, start], atol=1e-9)


def test_start_and_goal_on_one_surface_need_no_singular_point(lines: Atlas) -> None:
    start, goal = np.array([-1.5, 1, 0]), np.array([1.5, 1, 0])
    route = find_route(lines, start, goal, problem=PLANE_AND_LINES)
    (leg,) = route.legs
    assert (leg.form, leg.at) == ("surface 1", "")
    assert route.length == pytest.approx(3.0)


@pytest.mark.parametrize(
    "goal", [(0.6, 0.8, 0.0), (0.0, -0.6, -0.8), (0.8, 0.0, 0.6), (-0.28, 0.0, -0.96)]
)
def test_a_way_over_a_sphere_is_a_great_circle(
    sphere: Atlas, goal: tuple[float, ...]
) -> None:
    start = np.array([0.48, 0.6, 0.64])
    route = find_route(sphere, start, np.array(goal), problem=SPHERE_AND_AXIS)
    angle = np.arccos(start @ goal)
    assert route.length == pytest.approx(angle, rel=1e-5)
    assert_is_walk(sphere, SPHERE_AND_AXIS, route)


def test_through_the_sphere_it_is_shorter_than_around(sphere: Atlas) -> None:
    near_poles = np.array([[0.1, 0.0, np.sqrt(0.99)], [0.0, 0.1, -np.sqrt(0.99)]])
    route = find_route(sphere, *near_poles, problem=SPHERE_AND_AXIS)
    assert dimensions_of(route) == [2, 1, 2]
    assert route.length == pytest.approx(2 + 2 * np.arcsin(0.1), rel=1e-6)
    above, equator = np.array([0.0, 0.0, 1.5]), np.array([0.0, 1.0, 0.0])
    outside = find_route(sphere, above, equator, problem=SPHERE_AND_AXIS)
    assert outside.length == pytest.approx(0.5 + np.pi / 2, rel=1e-6)


def test_two_planes_are_joined_by_the_singular_points_found_on_both() -> None:
    atlas = search(PLANES, [[0.3, 0.4, 0.0], [0.3, 0.0, 0.4]])
    ends = np.array([[0.5, 0.7, 0.0], [-0.5, 0.0, 0.7]])
    route = find_route(atlas, *ends, problem=PLANES)
    assert set(forms_of(route)) == {"surface 1", "surface 2"}
    lengths = [np.linalg.norm(ends - p.point.u, axis=1).sum() for p in atlas.points]
    assert route.length == pytest.approx(min(lengths), abs=1e-9)


def test_from_one_half_of_a_cone_to_the_other_the_way_leads_through_the_tip_and_on_one_half_around_it() -> (
    None
):
    atlas = search(CONE, [[0.3, 0.4, 0.5], [0.3, 0.4, -0.5]])
    assert [p.surfaces for p in atlas.points] == [(0, 1)]
    start = np.array([0.3, 0.4, 0.5])
    through = find_route(atlas, start, np.array([-0.4, 0.3, -0.5]), problem=CONE)
    assert through.length == pytest.approx(np.sqrt(2), abs=1e-9)
    assert dimensions_of(through) == [2, 2]
    assert_is_walk(atlas, CONE, through)
    around = find_route(atlas, start, np.array([-0.3, -0.4, 0.5]), problem=CONE)
    # unrolled, the cone is a sector of sqrt(2) pi
    length = np.sqrt(2) * np.sin(np.sqrt(2) * np.pi / 4)
    assert around.length == pytest.approx(length, rel=1e-5)


# --- no route -------------------------------------------------------------------------


def test_a_configuration_beside_form_and_surface_is_refused_with_both_distances(
    lines: Atlas,
) -> None:
    distances = r"0\.3 away from the nearest form.* and 0\.1 away from 'surface 1'"
    start = np.array([0.3, 0.0, 0.1])
    with pytest.raises(RouteError, match=distances):
        find_route(lines, start, "surface 1", problem=PLANE_AND_LINES)


def test_where_charts_end_a_configuration_says_so() -> None:
    atlas = search(SPHERE_AND_AXIS, [[0.6, 0.0, 0.8]], SearchSettings(charts=10))
    charts = atlas.surfaces[0].charts
    assert charts is not None
    far = -charts.centers[0]
    ending = r"away from the charts of 'surface 1' \(incomplete: the largest number"
    with pytest.raises(RouteError, match=ending):
        find_route(atlas, far, "surface 1", problem=SPHERE_AND_AXIS)


def test_charts_that_do_not_hang_together_are_named(sphere: Atlas) -> None:
    charts = sphere.surfaces[0].charts
    assert charts is not None
    heights = charts.centers[charts.neighbours, 2]
    on_one_half = np.sign(heights).prod(axis=1) > 0
    torn_charts = replace(charts, neighbours=charts.neighbours[on_one_half])
    torn_surface = replace(sphere.surfaces[0], charts=torn_charts)
    torn = replace(sphere, points=(), forms=(), surfaces=(torn_surface,))
    above, below = np.array([0.6, 0.0, 0.8]), np.array([0.6, 0.0, -0.8])
    message = (
        r"only 'surface 1' can be reached.*surface 1 \(complete.*no chain of charts"
    )
    with pytest.raises(RouteError, match=message):
        find_route(torn, above, below, problem=SPHERE_AND_AXIS)
