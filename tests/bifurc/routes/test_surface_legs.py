"""Routes that lead over surfaces, where their length is known."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.files.dataset import load_atlas, save_atlas
from bifurc.files.graphml import plain_graph
from bifurc.graphs import arc_graph
from bifurc.problem import Problem
from bifurc.routes.route import Route, find_route
from bifurc.search.explore import explore
from bifurc.seeds import Seeds
from bifurc.settings import SearchSettings
from bifurc.torus import wrap
from tests.bifurc.known_surfaces import Union, equal_double_goldberg, planar, sarrus

PLANE_AND_LINES = Union(
    lambda x, y, z: np.array([z]),
    lambda x, y, z: np.array([x, y]),
    lambda x, y, z: np.array([x - 1, y - 0.5]),
    lambda x, y, z: np.array([x + 1, y + 1 - z]),
)
SPHERE_AND_AXIS = Union(
    lambda x, y, z: np.array([x * x + y * y + z * z - 1]),
    lambda x, y, z: np.array([x, y]),
)
PLANES = Union(lambda x, y, z: np.array([z]), lambda x, y, z: np.array([y]))
CONE = Union(lambda x, y, z: np.array([z * z - x * x - y * y]))
SARRUS = sarrus()
GOLDBERG = equal_double_goldberg()


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


@pytest.fixture(scope="module")
def goldberg() -> Atlas:
    return explore(GOLDBERG)


def on_torus(theta1: float, theta2: float) -> np.ndarray:
    return np.array([theta1, theta2, np.pi, -theta2, -theta1, np.pi])


def forms_of(route: Route) -> list[str]:
    return [leg.form for leg in route.legs]


def dimensions_of(route: Route) -> list[int]:
    return [leg.dimension for leg in route.legs]


def assert_is_walk(atlas: Atlas, problem: Problem, route: Route) -> None:
    """The path solves the equations, has no jump, is as long as the legs say, and the
    legs hang together."""
    assert np.abs(problem.residuals(route.path)).max() < 1e-12
    turns = np.diff(route.path, axis=0)
    steps = np.linalg.norm(turns, axis=1)
    assert steps.max() < 2 * route.length / len(steps)
    assert steps.sum() == pytest.approx(route.length, rel=1e-4)  # chords of 400 steps
    travel = np.abs(turns).sum(axis=0)
    assert travel == pytest.approx(route.travel, rel=1e-3, abs=1e-9)
    assert route.legs[-1].at == ""
    assert all(leg.at for leg in route.legs[:-1])
    points = {p.name: p.point.u for p in atlas.points}
    for before, after in pairwise(route.legs):
        end = before.path[-1]
        np.testing.assert_array_equal(end, after.path[0])
        assert np.abs(wrap(end - points[before.at], atlas.periods)).max() < 1e-9
    legs = [leg.path[1:] for leg in route.legs]
    np.testing.assert_array_equal(np.concatenate([route.path[:1], *legs]), route.path)
    for leg in route.legs:
        assert leg.path.shape[0] >= 2
        if leg.dimension > 1:
            assert (leg.start, leg.end) == (0.0, leg.length)


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


# --- linkages -------------------------------------------------------------------------


def test_a_sarrus_loop_goes_from_form_to_form_over_its_torus(
    folded_sarrus: Atlas,
) -> None:
    route = find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    assert forms_of(route) == ["Form 1", "surface 1", "Form 2"]
    # two joints turn by half a turn each
    assert route.legs[1].length == pytest.approx(np.sqrt(2) * np.pi, abs=1e-6)
    assert route.legs[-1].at == ""
    assert {leg.at for leg in route.legs} < {"", "D1", "D2", "D3", "D4"}
    assert_is_walk(folded_sarrus, SARRUS, route)
    back = find_route(folded_sarrus, "Form 2", "Form 1", problem=SARRUS)
    assert back.length == pytest.approx(route.length, abs=1e-9)


def test_the_middle_of_a_surface_stands_for_its_name(folded_sarrus: Atlas) -> None:
    route = find_route(folded_sarrus, "surface 1", "Form 2", problem=SARRUS)
    assert forms_of(route) == ["surface 1", "Form 2"]
    gap = wrap(route.path[0] - folded_sarrus.points[0].point.u, folded_sarrus.periods)
    assert np.linalg.norm(gap) > 1.0
    none = find_route(folded_sarrus, "surface 1", "surface 1", problem=SARRUS)
    assert none.legs == ()
    assert none.path.shape == (1, 6)


def test_a_path_stays_near_its_start_however_often_the_start_is_turned(
    folded_sarrus: Atlas,
) -> None:
    start, goal = folded_sarrus.surfaces[0].samples[[0, -1]] + 4 * np.pi
    route = find_route(folded_sarrus, start, goal, problem=SARRUS)
    np.testing.assert_allclose(route.path[0], start, atol=1e-9)
    end = route.path[-1]
    assert np.abs(wrap(end - goal, folded_sarrus.periods)).max() < 1e-9
    # the torus is flat
    assert route.length == pytest.approx(np.linalg.norm(end - start), rel=1e-9)


def test_a_start_at_a_dimension_change_lies_on_form_and_surface(
    folded_sarrus: Atlas,
) -> None:
    point = folded_sarrus.points[0]
    form, s = point.passes[0]
    on_form = folded_sarrus.forms[form].branch(s + 0.5)
    along = find_route(folded_sarrus, point.point.u, on_form, problem=SARRUS)
    assert dimensions_of(along) == [1]
    on_surface = folded_sarrus.surfaces[0].samples[0]
    over = find_route(folded_sarrus, point.point.u, on_surface, problem=SARRUS)
    assert dimensions_of(over) == [2]


def test_a_route_does_not_depend_on_how_densely_it_is_drawn(
    folded_sarrus: Atlas,
) -> None:
    few, many = (
        find_route(folded_sarrus, "Form 1", "Form 2", count=count, problem=SARRUS)
        for count in (20, 1000)
    )
    assert few.length == many.length
    assert len(few.path) < 30
    assert len(many.path) > 900
    np.testing.assert_array_equal(few.travel, many.travel)


def test_the_graphs_of_an_atlas_are_those_of_its_forms_after_a_route(
    folded_sarrus: Atlas,
) -> None:
    find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    for *_, arc in arc_graph(folded_sarrus).edges(data=True):
        assert "form" in arc
    for *_, edge in plain_graph(folded_sarrus).edges(data=True):
        assert edge["layer"] in ("forms", "arcs")


def test_an_atlas_from_a_file_needs_its_problem_for_legs_over_surfaces(
    folded_sarrus: Atlas, tmp_path: Path
) -> None:
    again = load_atlas(save_atlas(folded_sarrus, tmp_path / "sarrus.nc"))
    needed = "'surface 1': the problem of the atlas is needed there.*as problem="
    with pytest.raises(RouteError, match=needed):
        find_route(again, "Form 1", "Form 2")
    on_surface = folded_sarrus.surfaces[0].samples[0]
    perhaps = "perhaps on 'surface 1': only the problem of the atlas can tell"
    with pytest.raises(RouteError, match=perhaps):
        find_route(again, on_surface, "Form 2")
    route = find_route(again, "Form 1", "Form 2", problem=SARRUS)
    expected = find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    np.testing.assert_allclose(route.path, expected.path, atol=1e-9)
    # along forms it needs none
    on_form = folded_sarrus.forms[0].branch(0.3)
    assert find_route(again, "Form 1", on_form).length > 0


def test_of_the_ways_round_a_torus_the_shortest_is_taken(goldberg: Atlas) -> None:
    # theta1 and theta2 turn freely, each with another joint: the torus is flat, its
    # sides are sqrt(2) 2 pi long
    pairs = np.random.default_rng(0).uniform(-np.pi, np.pi, (25, 2, 2))
    for start, goal in pairs:
        route = find_route(
            goldberg, on_torus(*start), on_torus(*goal), count=60, problem=GOLDBERG
        )
        turned = wrap(goal - start, np.full(2, 2 * np.pi))
        length = np.sqrt(2) * np.linalg.norm(turned)
        assert route.length == pytest.approx(length, rel=1e-9)


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


def test_a_component_of_three_dimensions_is_only_sampled_and_no_route_goes_over_it() -> (
    None
):
    problem = planar(1, 1.2, 0.9, 1.3, 1.1, 0.8)
    atlas = explore(problem, settings=SearchSettings(starts=20))
    sampled = r"surface 1 \(dimension 3\): it is only sampled"
    with pytest.raises(RouteError, match=sampled):
        find_route(atlas, "surface 1", "surface 1", problem=problem)
    sample = atlas.surfaces[0].samples[0]
    with pytest.raises(RouteError, match=f"the atlas has no forms.*{sampled}"):
        find_route(atlas, sample, "surface 1", problem=problem)


def test_forms_that_never_meet_a_torus_have_no_route_to_it(goldberg: Atlas) -> None:
    with pytest.raises(RouteError, match="only 'Form 1', 'Form 2' can be reached"):
        find_route(goldberg, "Form 1", on_torus(0.3, 0.5), problem=GOLDBERG)
