"""Components of dimension 2 and more: their dimension, and charts that cover
surfaces."""

from __future__ import annotations

import time
from collections.abc import Callable

import networkx as nx
import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import ProblemError
from bifurc.figures.form_graph import plot_form_graph
from bifurc.figures.surface_plot import plot_charts
from bifurc.files.dataset import load_atlas, save_atlas
from bifurc.function_problem import FunctionProblem, NumericalProblem
from bifurc.graphs import transition_graph
from bifurc.problem import Problem
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Seeds
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.point import Kind
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.geodesic import shortest_path
from linkages.closure.loop_closure import LoopClosure
from linkages.families.double_goldberg import double_subtractive_goldberg
from linkages.loop import Loop, loop_from_axes


def planar(*lengths: float) -> LoopClosure:
    return LoopClosure(Loop(lengths, (0,) * len(lengths), (0,) * len(lengths)))


def spherical(*twists: float) -> LoopClosure:
    return LoopClosure(Loop((0,) * len(twists), twists, (0,) * len(twists)))


def general(n: int) -> LoopClosure:
    rng = np.random.default_rng(n)
    return LoopClosure(
        Loop(
            *(
                tuple(rng.uniform(low, high, n))
                for low, high in ((0.5, 1.5), (0.4, 2.6), (-0.5, 0.5))
            )
        )
    )


def equal_double_goldberg() -> LoopClosure:
    """The double-subtractive-Goldberg loop whose links 23, 34, 56, 61 are alike (b =
    d)."""
    alpha, beta, gamma = np.radians([66, 50, 28])
    return LoopClosure(
        double_subtractive_goldberg(1.7 * np.sin(alpha), alpha, beta, gamma, beta)
    )


def sarrus() -> LoopClosure:
    """Two legs of three parallel joints each, with links that are alike in each leg."""
    points = [(0, 1, 0), (0, 1.5, 1), (0, 1, 2), (1, 0, 2), (1.7, 0, 1), (1, 0, 0)]
    return LoopClosure(loop_from_axes(points, [(1, 0, 0)] * 3 + [(0, 1, 0)] * 3)[0])


class Level(NumericalProblem):
    """The surface where a function of three unknowns is zero."""

    def __init__(self, function: Callable, gradient: Callable, size: float):
        self.names, self.units, self.periods = (
            ("x", "y", "z"),
            ("",) * 3,
            np.full(3, np.inf),
        )
        self.bounds = np.full((3, 2), [-size, size])
        self.function = function
        self.gradient = gradient

    def residuals(self, points):
        return self.function(*points.T)[:, None]

    def jacobians(self, points):
        return np.stack(self.gradient(*points.T), axis=1)[:, None]


SPHERE = Level(
    lambda x, y, z: (x * x + y * y + z * z - 1) / 2, lambda x, y, z: (x, y, z), 2.0
)


def torus(tube: float) -> Level:
    """The torus about the z-axis with radii 1 and ``tube``."""

    def gradient(x, y, z):
        r = np.hypot(x, y)
        return (r - 1) * x / r, (r - 1) * y / r, z

    return Level(
        lambda x, y, z: ((np.hypot(x, y) - 1) ** 2 + z * z - tube**2) / 2, gradient, 2.0
    )


def seeds(problem: Problem, count: int = 20) -> np.ndarray:
    return problem.seeds(np.random.default_rng(1), count).points


@pytest.fixture(scope="module")
def sphere() -> ChartAtlas:
    return cover_surface(SPHERE, seeds(SPHERE))


@pytest.fixture(scope="module")
def folded() -> Atlas:
    """What there is of the Sarrus loop with folded legs."""
    return explore(sarrus())


# --- dimension ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("problem", "dimension"),
    [
        (planar(1, 1.2, 0.9, 1.3, 1.1), 2),
        (planar(1, 1.2, 0.9, 1.3, 1.1, 0.8), 3),
        (planar(1, 2, 1, 2, 1, 2, 1, 2), 5),
        (spherical(0.9, 1.1, 1.3, 1.0, 1.2), 2),
        (general(7), 1),
        (general(8), 2),
        (general(9), 3),
        (general(12), 6),
        (
            LoopClosure(Loop((0, 1, 0, 1), (0, 0.7, 0, 0.7), (0, 0, 0, 0))),
            2,
        ),  # two pairs of coincident axes
    ],
    ids=[
        "planar 5R",
        "planar 6R",
        "planar 8R",
        "spherical 5R",
        "7R",
        "8R",
        "9R",
        "12R",
        "coincident axes",
    ],
)
def test_every_seed_of_a_loop_lies_on_a_component_of_the_right_dimension(
    problem: Problem, dimension: int
) -> None:
    found = local_dimensions(problem, seeds(problem, 60)[-200:])
    assert (
        len(found.dimension) > 20
        and np.all(found.dimension == dimension)
        and np.all(found.regular)
    )


def test_a_plane_and_the_line_through_it_have_their_own_dimensions() -> None:
    problem = FunctionProblem(
        lambda u: np.array([u[2] * u[0], u[2] * u[1]]), [(-1, 1)] * 3
    )
    found = local_dimensions(
        problem, np.array([[0.3, 0.2, 0.0], [0.0, 0.0, 0.4], [0.0, 0.0, 0.0]])
    )
    assert found.dimension.tolist() == [2, 1, 2]
    assert found.regular.tolist() == [True, True, False]


def test_the_dimension_of_a_shaky_plane_is_not_its_corank() -> None:
    problem = FunctionProblem(lambda u: np.array([u[2] ** 2]), [(-1, 1)] * 3)
    found = local_dimensions(problem, np.array([[0.3, 0.2, 0.0]]))
    assert (found.dimension[0], found.nullity[0], found.regular[0]) == (2, 3, False)


def test_a_curve_at_a_bifurcation_keeps_dimension_one() -> None:
    problem = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [(-1, 1)] * 2)
    found = local_dimensions(problem, np.array([[0.0, 0.0], [0.5, 0.0]]))
    assert found.dimension.tolist() == [1, 1] and found.nullity.tolist() == [2, 1]


# --- charts -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("problem", "area", "euler"),
    [(SPHERE, 4 * np.pi, 2), (torus(0.6), 2.4 * np.pi**2, 0)],
    ids=["sphere", "torus"],
)
def test_area_and_euler_characteristic_of_a_closed_surface_are_found(
    problem: Problem, area: float, euler: int
) -> None:
    charts = cover_surface(problem, seeds(problem))
    assert (
        charts.complete and charts.euler_characteristic == euler and charts.border == 0
    )
    assert charts.area == pytest.approx(
        area, rel=0.01
    )  # flat triangles: (radius x curvature)^2 / 8 with 0.24 at most
    assert np.linalg.norm(problem.residuals(charts.vertices), axis=1).max() < 1e-10


def test_smaller_charts_give_the_area_to_second_order() -> None:
    errors = [
        4 * np.pi - cover_surface(SPHERE, seeds(SPHERE, 1), radius=r).area
        for r in (0.2, 0.1)
    ]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15)


def test_charts_are_solutions_with_tangent_planes(sphere: ChartAtlas) -> None:
    assert np.abs(np.linalg.norm(sphere.centers, axis=1) - 1).max() < 1e-12
    assert np.abs(np.einsum("ki,kij->kj", sphere.centers, sphere.bases)).max() < 1e-9
    assert (
        np.abs(np.swapaxes(sphere.bases, 1, 2) @ sphere.bases - np.eye(2)).max() < 1e-12
    )


def test_every_point_of_a_covered_surface_lies_in_a_chart_and_none_beside_it(
    sphere: ChartAtlas,
) -> None:
    points = np.random.default_rng(2).normal(size=(500, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    at = sphere.chart_at(points)
    assert np.all(at >= 0) and np.all(
        np.linalg.norm(sphere.centers[at] - points, axis=1) < 1.2 * sphere.radii[at]
    )
    assert not np.any(sphere.holds(1.3 * points)) and np.all(sphere.part == 0)
    assert all(
        i in sphere.holding(point) for i, point in zip(at[:20], points, strict=False)
    )


def test_a_surface_that_leaves_the_bounds_has_a_border_and_its_area_inside() -> None:
    problem = Level(
        lambda x, y, z: z - 0.5 * x,
        lambda x, y, z: (-0.5 + 0 * x, 0 * y, 1 + 0 * z),
        1.0,
    )
    charts = cover_surface(problem, seeds(problem, 1))
    assert charts.complete and charts.border > 0 and charts.euler_characteristic == 1
    assert charts.area == pytest.approx(4 * np.hypot(1, 0.5), rel=1e-6)


def spheres(apart: float) -> Level:
    """A sphere of radius 0.5 about (-apart, 0, 0) and one of radius 0.6 about (apart,
    0, 0)."""

    def factors(x, y, z):
        return (x + apart) ** 2 + y * y + z * z - 0.25, (
            x - apart
        ) ** 2 + y * y + z * z - 0.36

    def gradient(x, y, z):
        a, b = factors(x, y, z)
        return (
            2 * (x + apart) * b + 2 * (x - apart) * a,
            2 * y * (a + b),
            2 * z * (a + b),
        )

    return Level(lambda *u: np.prod(factors(*u), axis=0), gradient, 2.0)


def test_two_spheres_are_two_surfaces() -> None:
    starts = np.array([[-0.5, 0, 0], [0.4, 0, 0]])
    parts = cover_surface(spheres(1.0), starts, radius=0.4).parts()
    assert [part.euler_characteristic for part in parts] == [2, 2]
    assert sorted(part.area for part in parts) == pytest.approx(
        [np.pi, 1.44 * np.pi], rel=0.01
    )


def test_the_charts_of_a_sphere_do_not_go_over_to_one_that_it_crosses() -> None:
    charts = cover_surface(spheres(0.4), np.array([[-0.9, 0, 0]]), radius=0.4)
    assert charts.outcome is Covering.SINGULAR and len(charts.parts()) == 1
    assert (
        np.abs(
            np.linalg.norm(charts.centers - np.array([-0.4, 0, 0]), axis=1) - 0.5
        ).max()
        < 1e-9
    )
    assert (
        charts.area == pytest.approx(np.pi, rel=0.02) and charts.polygon_sizes.min() > 2
    )


@pytest.mark.parametrize("angle", [0.4, 1.1, 2.0])
def test_a_sheet_that_crosses_is_missed_wherever_the_charts_begin(angle: float) -> None:
    problem = spheres(0.4)
    on_first = np.array([-0.4, 0, 0]) - 0.5 * np.array(
        [np.cos(angle), np.sin(angle), 0]
    )
    charts = cover_surface(problem, on_first[None], radius=0.4)
    assert charts.outcome is Covering.SINGULAR
    assert charts.area == pytest.approx(np.pi, rel=0.02)


def test_where_both_sheets_that_cross_are_covered_nothing_is_missed() -> None:
    seeds_of_both = np.array([[-0.9, 0, 0], [1.0, 0, 0]])
    charts = cover_surface(spheres(0.4), seeds_of_both, radius=0.4)
    assert charts.outcome is Covering.COMPLETE
    assert charts.area == pytest.approx(2.44 * np.pi, rel=0.02)


def test_two_planes_that_cross_are_told_apart() -> None:
    problem = FunctionProblem(lambda u: np.array([u[1] * u[2]]), [(-1, 1)] * 3)
    parts = cover_surface(
        problem, np.array([[0.3, 0.4, 0.0], [-0.2, 0.0, 0.7]])
    ).parts()
    assert [part.euler_characteristic for part in parts] == [1, 1]
    assert [part.area for part in parts] == pytest.approx([4, 4], rel=0.01)


def test_a_cone_is_covered_but_for_its_tip_and_says_so() -> None:
    problem = Level(
        lambda x, y, z: z * z - x * x - y * y,
        lambda x, y, z: (-2 * x, -2 * y, 2 * z),
        1.0,
    )
    charts = cover_surface(problem, np.array([[0.3, 0.4, 0.5]]))
    assert charts.outcome is Covering.SINGULAR and charts.euler_characteristic is None
    assert np.linalg.norm(charts.centers, axis=1).min() < 0.05


def test_the_charts_of_a_planar_5r_loop_form_a_surface_of_genus_four() -> None:
    # Havel 1991, Some examples of the use of distances as coordinates for Euclidean
    # geometry: the equilateral pentagon
    problem = planar(1, 1, 1, 1, 1)
    charts = cover_surface(problem, seeds(problem)[:1], radius=0.7)
    assert (
        charts.complete
        and charts.euler_characteristic == -6
        and len(charts.parts()) == 1
    )


def test_the_trivial_component_of_the_double_goldberg_loop_is_a_flat_torus() -> None:
    problem = equal_double_goldberg()
    charts = cover_surface(
        problem, np.array([[0.3, 0.5, np.pi, -0.5, -0.3, np.pi]]), radius=1.0
    )
    assert charts.complete and charts.euler_characteristic == 0
    assert charts.area == pytest.approx(
        8 * np.pi**2, rel=1e-6
    )  # theta1 and theta2 turn freely, each with another joint


def test_a_covering_stops_at_its_limits_and_is_continued_from_there() -> None:
    start = seeds(SPHERE, 1)
    few = cover_surface(SPHERE, start, charts=30)
    assert (
        few.outcome is Covering.CHART_LIMIT
        and len(few) == 30
        and few.euler_characteristic is None
    )
    none = cover_surface(SPHERE, start, seconds=1e-9)
    assert none.outcome is Covering.OUT_OF_TIME and "continue" in none.outcome.value
    whole = cover_surface(SPHERE, start, known=few)
    assert (
        whole.complete
        and np.array_equal(whole.centers[:30], few.centers)
        and whole.euler_characteristic == 2
    )


def test_a_path_on_the_sphere_is_a_great_circle(sphere: ChartAtlas) -> None:
    start, goal = np.array([0.0, 0.0, 1.0]), np.array([0.6, 0.8, 0.0])
    path = shortest_path(SPHERE, sphere, start, goal, 0.05)
    assert np.array_equal(path[0], start) and np.allclose(path[-1], goal)
    assert np.abs(np.linalg.norm(path, axis=1) - 1).max() < 1e-12
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert (
        steps.sum() == pytest.approx(np.pi / 2, rel=1e-3) and steps.max() < 0.06
    )  # chords
    assert (
        np.abs(path @ np.cross(start, goal)).max() < 1e-3
    )  # in the plane of the circle


def test_a_path_on_a_torus_of_angles_has_no_jump_where_a_period_ends() -> None:
    problem = equal_double_goldberg()
    start, goal = (
        np.array([a, b, np.pi, -b, -a, np.pi]) for a, b in ((3.0, 0.2), (-3.0, 0.4))
    )
    charts = cover_surface(problem, start[None], radius=1.0)
    path = shortest_path(problem, charts, start, goal, 0.1)
    assert np.abs(np.diff(path, axis=0)).max() < 0.2 and path[-1, 0] == pytest.approx(
        2 * np.pi - 3
    )
    with pytest.raises(ValueError, match="goal lies in no chart"):
        shortest_path(problem, charts, start, np.zeros(6), 0.1)


def test_wrong_seeds_and_limits_are_refused() -> None:
    with pytest.raises(ProblemError, match="shape of the seeds"):
        cover_surface(SPHERE, np.zeros(3))
    with pytest.raises(ProblemError, match="radius"):
        cover_surface(SPHERE, np.zeros((1, 3)), radius=0.0)


# --- in a search --------------------------------------------------------------------------------------


def test_the_double_goldberg_loop_with_equal_links_has_forms_and_a_torus_that_they_never_meet() -> (
    None
):
    problem = equal_double_goldberg()
    atlas = explore(problem)
    assert (
        len(atlas.forms) == 2
        and len(atlas.bifurcations) == 2
        and len(atlas.points) == 2
    )
    (surface,) = atlas.surfaces
    assert (
        surface.dimension == 2
        and surface.complete
        and surface.charts.euler_characteristic == 0
    )
    # theta3 = theta6 = pi, theta4 = -theta2, theta5 = -theta1
    halves = (
        np.stack(
            [
                surface.samples[:, 2] - np.pi,
                surface.samples[:, 1] + surface.samples[:, 3],
            ]
        )
        / 2
    )
    assert np.abs(np.sin(halves)).max() < 1e-9
    regular = np.linalg.svd(
        problem.jacobians(surface.charts.centers), compute_uv=False
    )[:, 3]
    assert regular.min() > 0.1  # rank 4 all over: no singular point, and so no way out
    assert not nx.has_path(transition_graph(atlas), atlas.forms[0].name, surface.name)


def test_a_sarrus_loop_with_folded_legs_changes_mobility_where_its_forms_meet_the_torus(
    folded: Atlas,
) -> None:
    atlas = folded
    assert len(atlas.forms) == 2 and [s.dimension for s in atlas.surfaces] == [2]
    assert [p.kind for p in atlas.points] == [Kind.DIMENSION_CHANGE] * 4
    for point in atlas.points:
        assert len(point.point.half_branches) == 2 and len(point.passes) == 1
        assert point.surfaces == (0,) and point.note == ""
    assert (
        nx.is_connected(transition_graph(atlas))
        and len({form.component for form in atlas.forms}) == 1
    )


@pytest.mark.parametrize("bend", [0.0, 0.4], ids=["line", "parabola"])
def test_a_curve_through_a_plane_is_found_with_both_of_its_halves(bend: float) -> None:
    problem = FunctionProblem(
        lambda u: np.array([u[2] * u[0], u[2] * (u[1] - bend * u[2] ** 2)]),
        [(-1, 1)] * 3,
    )
    atlas = explore(problem, settings=SearchSettings(starts=100))
    (point,) = atlas.points
    assert point.kind is Kind.DIMENSION_CHANGE and np.abs(point.point.u).max() < 1e-10
    assert (
        len(point.point.half_branches) == 2
        and len(point.passes) == 1
        and point.surfaces == (0,)
    )
    assert len(atlas.forms) == 1 and atlas.surfaces[0].complete
    assert list(transition_graph(atlas).edges(keys=True)) == [
        ("Form 1", "surface 1", point.name)
    ]


def test_curves_that_meet_a_plane_are_found_from_the_plane_alone() -> None:
    def cross(
        u: np.ndarray,
    ) -> np.ndarray:  # the plane z = 0 and the lines x = y = 0 and x = y, z = x - 0.5
        one, other = np.array([u[0], u[1]]), np.array([u[0] - u[1], u[2] - u[0] + 0.5])
        return u[2] * np.outer(one, other).ravel()

    problem = FunctionProblem(cross, [(-1, 1)] * 3)
    on_plane = np.array([[0.3, -0.5, 0.0]])
    given = Seeds(on_plane, np.ones(1, dtype=bool), np.empty(0), np.empty((0, 3)))
    atlas = explore(problem, seeds=given)
    assert (
        len(atlas.forms) == 2 and len(atlas.bifurcations) == 1
    )  # the lines cross at z = -0.5
    meeting = [p.point.u for p in atlas.points if p.kind is Kind.DIMENSION_CHANGE]
    assert (
        np.abs(np.sort(meeting, axis=0) - [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0]]).max()
        < 1e-9
    )


@pytest.mark.parametrize(
    ("problem", "dimension"),
    [
        (planar(1, 1.2, 0.9, 1.3, 1.1, 0.8), 3),
        (planar(1, 2, 1, 2, 1, 2, 1, 2), 5),
        (general(9), 3),
        (general(12), 6),
    ],
    ids=["planar 6R", "planar 8R", "9R", "12R"],
)
def test_components_of_higher_dimension_are_reported_with_it_and_nothing_else(
    problem, dimension: int
) -> None:
    atlas = explore(problem)
    assert [surface.dimension for surface in atlas.surfaces] == [dimension]
    assert not atlas.forms and not atlas.points and not len(atlas.rigid)


def test_a_search_ends_when_its_budget_is_used_up_and_says_so() -> None:
    began = time.perf_counter()
    atlas = explore(general(8), settings=SearchSettings(budget=1.0))
    assert time.perf_counter() - began < 5.0
    assert atlas.provenance.out_of_time and atlas.completeness.level == "out of time"
    assert (
        atlas.surfaces[0].dimension == 2
        and atlas.surfaces[0].charts.outcome is Covering.OUT_OF_TIME
    )
    assert not explore(
        planar(1, 2, 1.4, 2.2), settings=SearchSettings(budget=60.0)
    ).provenance.out_of_time
    with pytest.raises(ProblemError, match="budget"):
        explore(general(8), settings=SearchSettings(budget=0.0))


def test_charts_and_meeting_points_survive_a_dataset(folded: Atlas, tmp_path) -> None:
    atlas = folded
    again = load_atlas(save_atlas(atlas, tmp_path / "sarrus.nc"))
    old, new = atlas.surfaces[0], again.surfaces[0]
    assert (new.name, new.dimension, new.complete) == (old.name, 2, True)
    for name in (
        "centers",
        "bases",
        "radii",
        "neighbours",
        "vertices",
        "polygons",
        "polygon_sizes",
    ):
        assert np.array_equal(getattr(old.charts, name), getattr(new.charts, name))
    assert new.charts.area == old.charts.area and new.charts.euler_characteristic == 0
    assert [p.surfaces for p in again.points] == [(0,)] * 4
    assert nx.utils.graphs_equal(transition_graph(atlas), transition_graph(again))


def test_the_picture_of_a_surface_has_all_its_triangles_and_the_graph_of_forms_still_draws(
    sphere: ChartAtlas,
) -> None:
    axes = plot_charts(sphere, np.eye(3)[:2]).axes[0]
    assert len(axes.collections[0].get_paths()) == len(sphere.triangles)
    assert np.abs(axes.dataLim.get_points()).max() == pytest.approx(1.0, abs=0.03)
    problem = FunctionProblem(
        lambda u: np.array([u[2] * u[0], u[2] * u[1]]), [(-1, 1)] * 3
    )
    texts = [
        text.get_text()
        for text in plot_form_graph(
            explore(problem, settings=SearchSettings(starts=20))
        )
        .axes[0]
        .texts
    ]
    assert sorted(texts) == ["D1", "Form 1", "surface 1"]


# --- what is not finished is said ---------------------------------------------------------------------


def test_seeds_beside_unfinished_charts_belong_to_the_surface_to_which_they_can_walk() -> (
    None
):
    (surface,) = explore(SPHERE, settings=SearchSettings(starts=60, charts=40)).surfaces
    assert surface.charts.outcome is Covering.CHART_LIMIT and len(surface.samples) == 60
    assert np.count_nonzero(~surface.charts.holds(surface.samples)) > 10


def test_the_halves_of_a_cone_are_two_surfaces_and_nothing_is_left_over_at_the_tip() -> (
    None
):
    problem = Level(
        lambda x, y, z: z * z - x * x - y * y,
        lambda x, y, z: (-2 * x, -2 * y, 2 * z),
        1.0,
    )
    near_tip = np.array([[0.006, 0.008, 0.01], [0.006, 0.008, -0.01]])
    points = np.concatenate([[[0.3, 0.4, 0.5], [0.3, 0.4, -0.5]], near_tip])
    atlas = explore(
        problem,
        seeds=Seeds(points, np.ones(4, dtype=bool), np.empty(0), np.empty((0, 3))),
    )
    assert sorted(
        np.sign(surface.samples[:, 2]).tolist() for surface in atlas.surfaces
    ) == [[-1, -1], [1, 1]]
    assert [point.surfaces for point in atlas.points] == [(0, 1)] and [
        s.note for s in atlas.surfaces
    ] == ["", ""]


def test_a_surface_says_which_singular_points_are_samples_of_curves_and_how_many_places_were_left_out(
    monkeypatch,
) -> None:
    problem = FunctionProblem(
        lambda u: np.array([u[1] * u[2]]), [(-1, 1)] * 3
    )  # two planes that meet in the x-axis
    atlas = explore(problem, settings=SearchSettings(starts=40))
    assert len(atlas.points) > 1 and all(
        np.abs(p.point.u[1:]).max() < 1e-9 for p in atlas.points
    )
    assert all(p.surfaces == (0, 1) and p.point.error < 1e-4 for p in atlas.points)
    assert sum(int(s.note.split()[0]) for s in atlas.surfaces if s.note) == len(
        atlas.points
    )
    assert all(
        "samples of curves of such points" in s.note for s in atlas.surfaces if s.note
    )
    monkeypatch.setattr("bifurc.search.components.MOST_POINTS", 1)
    cut = explore(problem, settings=SearchSettings(starts=40))
    assert len(cut.points) == 1
    assert any(
        "places singular points were not looked for" in surface.note
        for surface in cut.surfaces
    )
