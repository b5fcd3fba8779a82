"""Components of three to five dimensions, covered by charts: each has known parts."""

import numpy as np
import pytest

import bifurc
from bifurc.errors import ProblemError
from bifurc.files.dataset import load_atlas, save_atlas
from bifurc.routes.route import find_route
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from bifurc.surfaces.chart_atlas import Covering
from bifurc.surfaces.covering import cover_component
from bifurc.system import relative_gaps


def problem_of(equations, count, half_width=3.0):
    names = "abcdefghi"[:count]
    bounds = dict.fromkeys(names, (-half_width, half_width))
    return bifurc.FunctionProblem(equations, bounds)


def starts(problem, count=30):
    rng = np.random.default_rng(0)
    points, gaps = problem.project(rng.normal(size=(count, problem.n)))
    return points[(gaps < 1e-12) & problem.domain.are_inside(points)]


def sphere(u):
    return [sum(x**2 for x in u) - 1]


def spheres_side_by_side(u):
    others = sum(x**2 for x in u[1:])
    return [((u[0] - 1.05) ** 2 + others - 1) * ((u[0] + 1.05) ** 2 + others - 1)]


def sphere_times_circle(u):
    """Bent, so that it is no product in these unknowns."""
    a, b, c, d, e = u
    return [a**2 + b**2 + c**2 - 1 + 0.1 * a * d, d**2 + e**2 - 1 + 0.1 * b]


def bent_torus(u):
    a, b, c, d, e, f = u
    return [
        a**2 + b**2 - 1 + 0.15 * a * c,
        c**2 + d**2 - 1 + 0.15 * c * e,
        e**2 + f**2 - 1 + 0.15 * a * e,
    ]


def orthogonal(u):
    """Matrices Q with Q^T Q = I: rotations, and these times a reflection."""
    columns = [[u[3 * i + j] for i in range(3)] for j in range(3)]
    pairs = [(i, j) for i in range(3) for j in range(i, 3)]
    return [
        sum(x * y for x, y in zip(columns[i], columns[j], strict=True)) - (i == j)
        for i, j in pairs
    ]


def hyperboloid(u):
    """Two sheets, each cut by the bounds."""
    return [u[0] ** 2 - u[1] ** 2 - u[2] ** 2 - u[3] ** 2 - 1]


def plane(u):
    return [u[0] + 0.7 * u[1] - 0.3 * u[2] + 0.2 * u[3] - 0.1 + 0.05 * u[0] * u[1]]


MANIFOLDS = {
    "sphere of dimension 3": (sphere, 4, 3, 1),
    "sphere of dimension 4": (sphere, 5, 4, 1),
    "two spheres, a twentieth of the diameter apart": (spheres_side_by_side, 4, 3, 2),
    "sphere times circle": (sphere_times_circle, 5, 3, 1),
    "torus of dimension 3": (bent_torus, 6, 3, 1),
    "orthogonal matrices": (orthogonal, 9, 3, 2),
    "two sheets between bounds": (hyperboloid, 4, 3, 2),
    "bent plane between bounds": (plane, 4, 3, 1),
}


@pytest.mark.parametrize("name", MANIFOLDS)
def test_a_manifold_is_covered_in_as_many_parts_as_it_has(name: str) -> None:
    equations, count, dimension, parts = MANIFOLDS[name]
    problem = problem_of(equations, count)
    points = starts(problem)
    charts = cover_component(problem, points, dimension, charts=4000)
    assert charts.outcome is Covering.COMPLETE
    assert len(charts.parts()) == parts
    assert np.all(charts.covers(points))
    assert relative_gaps(problem, charts.centers).max() < 1e-10
    assert charts.dimension == dimension and not charts.is_measured


def test_charts_close_around_the_periods_of_angles() -> None:
    # a + b + c + d is 0.3 sin a or half a turn more: two tori of dimension 3
    def closed(u):
        return [np.sin(u[0] + u[1] + u[2] + u[3] - 0.3 * np.sin(u[0]))]

    turn = (-np.pi, np.pi)
    bounds = dict.fromkeys("abcd", turn)
    problem = bifurc.FunctionProblem(closed, bounds, periods=[2 * np.pi] * 4)
    points, _ = problem.project(np.random.default_rng(1).uniform(-3, 3, (40, 4)))
    charts = cover_component(problem, points, 3, charts=4000)
    assert charts.outcome is Covering.COMPLETE
    assert len(charts.parts()) == 2


def test_a_covering_ends_with_its_charts_and_with_its_time() -> None:
    problem = problem_of(sphere, 4)
    few = cover_component(problem, starts(problem), 3, charts=50)
    assert few.outcome is Covering.CHART_LIMIT and 40 < len(few) <= 50
    none = cover_component(problem, starts(problem), 3, seconds=1e-9)
    assert none.outcome is Covering.OUT_OF_TIME
    with pytest.raises(ProblemError, match="dimension"):
        cover_component(problem, starts(problem), 6)


@pytest.mark.parametrize("seed", range(2))
def test_a_search_counts_components_that_walks_between_starts_do_not_tell_apart(
    seed: int,
) -> None:
    problem = problem_of(spheres_side_by_side, 4)
    atlas = bifurc.explore(problem, seed=seed)
    assert len(atlas.surfaces) == 2
    assert all(surface.complete for surface in atlas.surfaces)
    assert sum(len(surface.samples) for surface in atlas.surfaces) == 200
    assert not atlas.completeness.is_in_doubt


def test_halves_of_a_cone_are_two_components_that_meet_in_its_tip() -> None:
    def cone(u):
        return [u[0] ** 2 + u[1] ** 2 + u[2] ** 2 - u[3] ** 2]

    atlas = bifurc.explore(problem_of(cone, 4))
    assert [one.charts.outcome for one in atlas.surfaces] == [Covering.SINGULAR] * 2
    (tip,) = atlas.points
    assert tip.kind is Kind.SURFACE and tip.surfaces == (0, 1)
    assert np.linalg.norm(tip.point.u) < 1e-8


def test_a_form_that_runs_through_a_component_meets_it_in_two_points() -> None:
    def sphere_and_curve(u):
        off = sum(x**2 for x in u) - 1
        return [off * (u[1] - 0.1 * u[0] ** 2), off * (u[2] + 0.1 * u[0]), off * u[3]]

    atlas = bifurc.explore(problem_of(sphere_and_curve, 4))
    assert len(atlas.forms) == len(atlas.surfaces) == 1
    assert [point.kind for point in atlas.points] == [Kind.DIMENSION_CHANGE] * 2
    assert {point.surfaces for point in atlas.points} == {(0,)}


def test_what_two_components_share_is_seen_from_both() -> None:
    def sphere_and_sheet(u):
        return [sphere(u)[0] * (u[0] - 0.1 * u[1] ** 2 - 0.05)]

    atlas = bifurc.explore(problem_of(sphere_and_sheet, 4))
    assert len(atlas.surfaces) == 2
    assert atlas.points
    for point in atlas.points:
        assert point.kind is Kind.CURVE_SAMPLE and point.surfaces == (0, 1)


def test_where_charts_run_out_the_answer_is_in_doubt() -> None:
    settings = SearchSettings(charts=10)
    atlas = bifurc.explore(problem_of(bent_torus, 6), settings=settings)
    assert not any(surface.complete for surface in atlas.surfaces)
    assert atlas.surfaces[0].is_short_of_charts
    assert atlas.completeness.is_in_doubt


def test_a_file_keeps_the_charts_and_a_route_leads_over_them(tmp_path) -> None:
    problem = problem_of(sphere, 4)
    save_atlas(bifurc.explore(problem), tmp_path / "sphere.nc")
    atlas = load_atlas(tmp_path / "sphere.nc")
    charts = atlas.surfaces[0].charts
    assert charts is not None and charts.dimension == 3 and charts.complete
    start, goal = np.eye(4)[:2]
    route = find_route(atlas, start, goal, problem=problem)
    # the chords of a great circle are a little shorter
    assert route.length == pytest.approx(np.pi / 2, rel=1e-5)


def test_one_equation_of_four_unknowns_has_its_singular_points_looked_for():
    """Whitney's umbrella times a line: F' has a null space of dimension 3 at least. They
    are looked for first, and the rest takes long."""
    umbrella = problem_of(lambda u: [u[0] ** 2 - u[1] ** 2 * u[2] + 0.0 * u[3]], 4, 1.0)
    atlas = bifurc.explore(umbrella, settings=SearchSettings(starts=200, budget=2.0))
    assert atlas.points or atlas.provenance.out_of_time


@pytest.mark.parametrize("half_width", [0.59, 0.6])
def test_charts_that_end_in_narrow_corners_of_bounds_are_in_doubt(half_width):
    """A 3-sphere in a cube is one by its necks from corner to corner."""
    atlas = bifurc.explore(problem_of(sphere, 4, half_width))
    assert {doubt.kind for doubt in atlas.completeness.doubts} == {"holes"}
    assert not any(surface.charts.complete for surface in atlas.surfaces)
