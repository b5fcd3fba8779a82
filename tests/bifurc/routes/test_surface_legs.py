"""Routes that lead over surfaces, where their length is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.files.dataset import load_atlas, save_atlas
from bifurc.files.graphml import plain_graph
from bifurc.function_problem import NumericalProblem
from bifurc.graphs import arc_graph
from bifurc.problem import Problem
from bifurc.routes.route import Route, find_route
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Seeds
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.geodesic import shortest_path
from bifurc.torus import wrap
from linkages.axes import loop_from_axes
from linkages.closure.loop_closure import LoopClosure
from linkages.families.double_goldberg import double_subtractive_goldberg
from linkages.loop import Loop


def sarrus() -> LoopClosure:
    """Two legs of three parallel joints each, with links that are alike in each leg."""
    points = [(0, 1, 0), (0, 1.5, 1), (0, 1, 2), (1, 0, 2), (1.7, 0, 1), (1, 0, 0)]
    return LoopClosure(loop_from_axes(points, [(1, 0, 0)] * 3 + [(0, 1, 0)] * 3)[0])


def search(
    problem: Problem,
    on_surfaces: list[list[float]],
    settings: SearchSettings = SearchSettings(),  # noqa: B008
) -> Atlas:
    """The atlas found from solutions on the surfaces alone, and what hangs on them."""
    points = np.array(on_surfaces, dtype=float)
    seeds = Seeds(
        points, np.ones(len(points), dtype=bool), np.empty(0), np.empty((0, problem.n))
    )
    return explore(problem, seeds=seeds, settings=settings)


class Union(NumericalProblem):
    """The union, in a cube, of sets: each given by functions (p, k) of x, y, z (k,)
    whose common zeros it is."""

    def __init__(self, *sets: Callable, size: float = 2.0):
        self.names, self.units, self.periods = (
            ("x", "y", "z"),
            ("",) * 3,
            np.full(3, np.inf),
        )
        self.bounds, self.sets = np.full((3, 2), [-size, size]), sets

    def residuals(self, points: np.ndarray) -> np.ndarray:
        out = np.ones((len(points), 1))
        for functions in self.sets:
            out = (out[:, :, None] * functions(*points.T).T[:, None]).reshape(
                len(points), -1
            )
        return out

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        return np.stack(
            [
                self.residuals(points + 1e-100j * step).imag / 1e-100
                for step in np.eye(3)
            ],
            axis=2,
        )


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
ALPHA, BETA, GAMMA = np.radians([66, 50, 28])
GOLDBERG = LoopClosure(
    double_subtractive_goldberg(1.7 * np.sin(ALPHA), ALPHA, BETA, GAMMA, BETA)
)


@pytest.fixture(scope="module")
def lines() -> Atlas:
    return explore(PLANE_AND_LINES, settings=SearchSettings(starts=40))


@pytest.fixture(scope="module")
def sphere() -> Atlas:
    return search(SPHERE_AND_AXIS, [[0.6, 0.0, 0.8]])


@pytest.fixture(scope="module")
def folded() -> Atlas:
    return explore(SARRUS)


@pytest.fixture(scope="module")
def goldberg() -> Atlas:
    """The double-subtractive-Goldberg loop with b = d: two forms, and a torus that they
    never meet."""
    return explore(GOLDBERG)


def on_torus(theta1: float, theta2: float) -> np.ndarray:
    return np.array([theta1, theta2, np.pi, -theta2, -theta1, np.pi])


def assert_is_walk(atlas: Atlas, problem: Problem, route: Route) -> None:
    """The path solves the equations, has no jump, is as long as the legs say, and the
    legs hang together."""
    assert np.abs(problem.residuals(route.path)).max() < 1e-12
    steps = np.linalg.norm(np.diff(route.path, axis=0), axis=1)
    assert steps.max() < 2 * route.length / len(steps)
    assert steps.sum() == pytest.approx(route.length, rel=1e-4)  # chords of 400 steps
    assert np.all(
        np.abs(np.diff(route.path, axis=0)).sum(axis=0)
        == pytest.approx(route.travel, rel=1e-3, abs=1e-9)
    )
    assert route.legs[-1].at == "" and all(leg.at for leg in route.legs[:-1])
    points = {p.name: p.point.u for p in atlas.points}
    for before, after in pairwise(route.legs):
        np.testing.assert_array_equal(before.path[-1], after.path[0])
        assert (
            np.abs(wrap(before.path[-1] - points[before.at], atlas.periods)).max()
            < 1e-9
        )
    np.testing.assert_array_equal(
        np.concatenate([route.path[:1], *(leg.path[1:] for leg in route.legs)]),
        route.path,
    )
    for leg in route.legs:
        assert leg.path.shape[0] >= 2 and (
            leg.dimension == 1 or (leg.start, leg.end) == (0.0, leg.length)
        )


# --- what is known exactly ----------------------------------------------------------------------------


def test_a_route_crosses_a_plane_in_a_straight_line_from_one_curve_to_another(
    lines: Atlas,
) -> None:
    route = find_route(
        lines, np.array([0, 0, 1.2]), np.array([1, 0.5, -0.8]), problem=PLANE_AND_LINES
    )
    assert [leg.dimension for leg in route.legs] == [1, 2, 1]
    assert route.legs[1].form == "surface 1" and route.legs[1].start == 0.0
    assert [leg.length for leg in route.legs] == pytest.approx(
        [1.2, np.hypot(1, 0.5), 0.8], abs=1e-9
    )
    assert route.travel == pytest.approx([1, 0.5, 2.0], abs=1e-9)
    assert_is_walk(lines, PLANE_AND_LINES, route)


def test_of_the_curves_that_meet_a_plane_the_nearer_way_is_taken(lines: Atlas) -> None:
    # the slanted line x = -1, y = z - 1 meets the plane in (-1, -1, 0)
    start, goal = np.array([-1, 0.5, 1.5]), np.array([0.3, 0.2, 0.0])
    route = find_route(lines, start, goal, problem=PLANE_AND_LINES)
    assert route.length == pytest.approx(
        1.5 * np.sqrt(2) + np.hypot(1.3, 1.2), abs=1e-9
    )
    assert_is_walk(lines, PLANE_AND_LINES, route)
    back = find_route(lines, goal, start, problem=PLANE_AND_LINES)
    assert back.length == pytest.approx(route.length, abs=1e-12) and [
        leg.dimension for leg in back.legs
    ] == [2, 1]
    np.testing.assert_allclose(back.path[[0, -1]], [goal, start], atol=1e-9)


def test_start_and_goal_on_one_surface_need_no_singular_point(lines: Atlas) -> None:
    route = find_route(
        lines, np.array([-1.5, 1, 0]), np.array([1.5, 1, 0]), problem=PLANE_AND_LINES
    )
    assert [(leg.form, leg.at) for leg in route.legs] == [
        ("surface 1", "")
    ] and route.length == pytest.approx(3.0)


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
    assert [leg.dimension for leg in route.legs] == [2, 1, 2]
    assert route.length == pytest.approx(2 + 2 * np.arcsin(0.1), rel=1e-6)
    outside = find_route(
        sphere,
        np.array([0.0, 0.0, 1.5]),
        np.array([0.0, 1.0, 0.0]),
        problem=SPHERE_AND_AXIS,
    )
    assert outside.length == pytest.approx(0.5 + np.pi / 2, rel=1e-6)


def test_around_the_waist_of_a_hyperboloid_the_way_is_a_circle() -> None:
    # on so strong a saddle pulling without a measured step would swing from side to
    # side
    problem = Union(
        lambda x, y, z: np.array([4 * x * x + 4 * y * y - 4 * z * z - 1]), size=0.7
    )
    charts = cover_surface(problem, np.array([[0.5, 0.0, 0.0]]))
    path = shortest_path(
        problem, charts, np.array([0.5, 0.0, 0.0]), np.array([-0.5, 0.0, 0.0]), 0.02
    )
    assert (
        np.abs(path[:, 2]).max() < 1e-4
        and np.abs(problem.residuals(path)).max() < 1e-12
    )
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).sum() == pytest.approx(
        0.5 * np.pi, rel=1e-4
    )


def test_two_planes_are_joined_by_the_singular_points_found_on_both() -> None:
    atlas = search(PLANES, [[0.3, 0.4, 0.0], [0.3, 0.0, 0.4]])
    ends = np.array([[0.5, 0.7, 0.0], [-0.5, 0.0, 0.7]])
    route = find_route(atlas, *ends, problem=PLANES)
    assert {leg.form for leg in route.legs} == {"surface 1", "surface 2"}
    over = min(sum(np.linalg.norm(ends - p.point.u, axis=1)) for p in atlas.points)
    assert route.length == pytest.approx(over, abs=1e-9)


def test_from_one_half_of_a_cone_to_the_other_the_way_leads_through_the_tip_and_on_one_half_around_it() -> (
    None
):
    atlas = search(CONE, [[0.3, 0.4, 0.5], [0.3, 0.4, -0.5]])
    assert [p.surfaces for p in atlas.points] == [(0, 1)]
    start = np.array([0.3, 0.4, 0.5])
    through = find_route(atlas, start, np.array([-0.4, 0.3, -0.5]), problem=CONE)
    assert through.length == pytest.approx(np.sqrt(2), abs=1e-9) and [
        leg.dimension for leg in through.legs
    ] == [2, 2]
    assert_is_walk(atlas, CONE, through)
    around = find_route(
        atlas, start, np.array([-0.3, -0.4, 0.5]), problem=CONE
    )  # unrolled, the cone is a sector of sqrt(2) pi
    assert around.length == pytest.approx(
        np.sqrt(2) * np.sin(np.sqrt(2) * np.pi / 4), rel=1e-5
    )


# --- linkages -----------------------------------------------------------------------------------------


def test_a_sarrus_loop_goes_from_form_to_form_over_its_torus(folded: Atlas) -> None:
    route = find_route(folded, "Form 1", "Form 2", problem=SARRUS)
    assert [leg.form for leg in route.legs] == ["Form 1", "surface 1", "Form 2"]
    assert route.legs[1].length == pytest.approx(
        np.sqrt(2) * np.pi, abs=1e-6
    )  # two joints turn by half a turn each
    assert [leg.at for leg in route.legs][-1] == "" and {
        leg.at for leg in route.legs
    } < {"", "D1", "D2", "D3", "D4"}
    assert_is_walk(folded, SARRUS, route)
    assert find_route(
        folded, "Form 2", "Form 1", problem=SARRUS
    ).length == pytest.approx(route.length, abs=1e-9)


def test_the_middle_of_a_surface_stands_for_its_name(folded: Atlas) -> None:
    route = find_route(folded, "surface 1", "Form 2", problem=SARRUS)
    assert [leg.form for leg in route.legs] == ["surface 1", "Form 2"]
    assert (
        np.linalg.norm(wrap(route.path[0] - folded.points[0].point.u, folded.periods))
        > 1.0
    )
    none = find_route(folded, "surface 1", "surface 1", problem=SARRUS)
    assert none.legs == () and none.path.shape == (1, 6)


def test_a_path_stays_near_its_start_however_often_the_start_is_turned(
    folded: Atlas,
) -> None:
    start, goal = folded.surfaces[0].samples[[0, -1]] + 4 * np.pi
    route = find_route(folded, start, goal, problem=SARRUS)
    np.testing.assert_allclose(route.path[0], start, atol=1e-9)
    assert np.abs(wrap(route.path[-1] - goal, folded.periods)).max() < 1e-9
    assert route.length == pytest.approx(
        np.linalg.norm(route.path[-1] - start), rel=1e-9
    )  # the torus is flat


def test_a_start_at_a_dimension_change_lies_on_form_and_surface(folded: Atlas) -> None:
    point = folded.points[0]
    on_form = folded.forms[point.passes[0][0]].branch(point.passes[0][1] + 0.5)
    assert [
        leg.dimension
        for leg in find_route(folded, point.point.u, on_form, problem=SARRUS).legs
    ] == [1]
    assert [
        leg.dimension
        for leg in find_route(
            folded, point.point.u, folded.surfaces[0].samples[0], problem=SARRUS
        ).legs
    ] == [2]


def test_a_route_does_not_depend_on_how_densely_it_is_drawn(folded: Atlas) -> None:
    few, many = (
        find_route(folded, "Form 1", "Form 2", count=count, problem=SARRUS)
        for count in (20, 1000)
    )
    assert few.length == many.length and len(few.path) < 30 < 900 < len(many.path)
    np.testing.assert_array_equal(few.travel, many.travel)


def test_the_graphs_of_an_atlas_are_those_of_its_forms_after_a_route(
    folded: Atlas,
) -> None:
    find_route(folded, "Form 1", "Form 2", problem=SARRUS)
    assert all("form" in arc for *_, arc in arc_graph(folded).edges(data=True))
    assert all(
        edge["layer"] in ("forms", "arcs")
        for *_, edge in plain_graph(folded).edges(data=True)
    )


def test_an_atlas_from_a_file_needs_its_problem_for_legs_over_surfaces(
    folded: Atlas, tmp_path
) -> None:
    again = load_atlas(save_atlas(folded, tmp_path / "sarrus.nc"))
    with pytest.raises(
        RouteError, match="'surface 1': the problem of the atlas is needed there"
    ):
        find_route(again, "Form 1", "Form 2")
    with pytest.raises(
        RouteError,
        match="perhaps on 'surface 1': only the problem of the atlas can tell",
    ):
        find_route(again, folded.surfaces[0].samples[0], "Form 2")
    route = find_route(again, "Form 1", "Form 2", problem=SARRUS)
    np.testing.assert_allclose(
        route.path,
        find_route(folded, "Form 1", "Form 2", problem=SARRUS).path,
        atol=1e-9,
    )
    assert (
        find_route(again, "Form 1", folded.forms[0].branch(0.3)).length > 0
    )  # along forms it needs none


def test_of_the_ways_round_a_torus_the_shortest_is_taken(goldberg: Atlas) -> None:
    # theta1 and theta2 turn freely, each with another joint: the torus is flat, its
    # sides are sqrt(2) 2 pi long
    for start, goal in np.random.default_rng(0).uniform(-np.pi, np.pi, (25, 2, 2)):
        turned = wrap(goal - start, np.full(2, 2 * np.pi))
        route = find_route(
            goldberg, on_torus(*start), on_torus(*goal), count=60, problem=GOLDBERG
        )
        assert route.length == pytest.approx(
            np.sqrt(2) * np.linalg.norm(turned), rel=1e-9
        )


# --- no route -----------------------------------------------------------------------------------------


def test_a_configuration_beside_form_and_surface_is_refused_with_both_distances(
    lines: Atlas,
) -> None:
    with pytest.raises(
        RouteError,
        match=r"0\.3 away from the nearest form.* and 0\.1 away from 'surface 1'",
    ):
        find_route(
            lines, np.array([0.3, 0.0, 0.1]), "surface 1", problem=PLANE_AND_LINES
        )


def test_where_charts_end_a_configuration_says_so() -> None:
    atlas = search(SPHERE_AND_AXIS, [[0.6, 0.0, 0.8]], SearchSettings(charts=10))
    far = -atlas.surfaces[0].charts.centers[0]
    with pytest.raises(
        RouteError,
        match=r"away from the charts of 'surface 1' \(incomplete: the largest number",
    ):
        find_route(atlas, far, "surface 1", problem=SPHERE_AND_AXIS)


def test_charts_that_do_not_hang_together_are_named() -> None:
    atlas = search(SPHERE_AND_AXIS, [[0.6, 0.0, 0.8]])
    charts = atlas.surfaces[0].charts
    cut = charts.neighbours[
        np.sign(charts.centers[charts.neighbours, 2]).prod(axis=1) > 0
    ]
    torn = replace(
        atlas,
        points=(),
        forms=(),
        surfaces=(replace(atlas.surfaces[0], charts=replace(charts, neighbours=cut)),),
    )
    with pytest.raises(
        RouteError,
        match=r"only 'surface 1' can be reached.*surface 1 \(complete.*no chain of charts",
    ):
        find_route(
            torn,
            np.array([0.6, 0.0, 0.8]),
            np.array([0.6, 0.0, -0.8]),
            problem=SPHERE_AND_AXIS,
        )


def test_a_component_of_three_dimensions_is_only_sampled_and_no_route_goes_over_it() -> (
    None
):
    atlas = explore(
        LoopClosure(Loop((1, 1.2, 0.9, 1.3, 1.1, 0.8), (0,) * 6, (0,) * 6)),
        settings=SearchSettings(starts=20),
    )
    with pytest.raises(
        RouteError, match=r"surface 1 \(dimension 3\): it is only sampled"
    ):
        find_route(atlas, "surface 1", "surface 1", problem=LoopClosure)
    with pytest.raises(
        RouteError,
        match=r"the atlas has no forms.*surface 1 \(dimension 3\): it is only sampled",
    ):
        find_route(
            atlas, atlas.surfaces[0].samples[0], "surface 1", problem=LoopClosure
        )


def test_forms_that_never_meet_a_torus_have_no_route_to_it(goldberg: Atlas) -> None:
    with pytest.raises(RouteError, match="only 'Form 1', 'Form 2' can be reached"):
        find_route(goldberg, "Form 1", on_torus(0.3, 0.5), problem=GOLDBERG)
