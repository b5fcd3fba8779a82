"""Components of dimension 2 and more in a search: surfaces with their charts, and the
singular points at which forms meet them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.graphs import transition_graph
from bifurc.problem import Problem
from bifurc.search.explore import explore
from bifurc.seeds import Seeds
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.covering import cover_surface
from tests.bifurc.known_surfaces import (
    CONE,
    SPHERE,
)


def seeds_at(points: np.ndarray) -> Seeds:
    """These solutions (k, n) alone as seeds."""
    count, n = points.shape
    return Seeds(points, np.ones(count, dtype=bool), np.empty(0), np.empty((0, n)))


@pytest.mark.parametrize("bend", [0.0, 0.4], ids=["line", "parabola"])
def test_a_curve_through_a_plane_is_found_with_both_of_its_halves(bend: float) -> None:
    def plane_and_curve(u: np.ndarray) -> np.ndarray:
        x, y, z = u
        return np.array([z * x, z * (y - bend * z**2)])

    problem = FunctionProblem(plane_and_curve, [(-1, 1)] * 3)
    atlas = explore(problem, settings=SearchSettings(starts=100))
    (point,) = atlas.points
    assert point.kind is Kind.DIMENSION_CHANGE
    assert np.abs(point.point.u).max() < 1e-10
    assert len(point.point.half_branches) == 2
    assert len(point.passes) == 1
    assert point.surfaces == (0,)
    assert len(atlas.forms) == 1
    assert atlas.surfaces[0].complete
    edges = list(transition_graph(atlas).edges(keys=True))
    assert edges == [("Form 1", "surface 1", point.name)]


def test_curves_that_meet_a_plane_are_found_from_the_plane_alone() -> None:
    # the plane z = 0 and the lines x = y = 0 and x = y, z = x - 0.5
    def plane_and_lines(u: np.ndarray) -> np.ndarray:
        x, y, z = u
        return z * np.outer([x, y], [x - y, z - x + 0.5]).ravel()

    problem = FunctionProblem(plane_and_lines, [(-1, 1)] * 3)
    atlas = explore(problem, seeds=seeds_at(np.array([[0.3, -0.5, 0.0]])))
    assert len(atlas.forms) == 2
    assert len(atlas.bifurcations) == 1  # the lines cross at z = -0.5
    meeting = [p.point.u for p in atlas.points if p.kind is Kind.DIMENSION_CHANGE]
    expected = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0]]
    assert np.abs(np.sort(meeting, axis=0) - expected).max() < 1e-9


# --- what is not finished is said -----------------------------------------------------


def test_seeds_outside_unfinished_charts_belong_to_the_surface_they_can_walk_to() -> (
    None
):
    (surface,) = explore(SPHERE, settings=SearchSettings(starts=60, charts=40)).surfaces
    assert surface.charts is not None
    assert surface.charts.outcome is Covering.CHART_LIMIT
    assert len(surface.samples) == 60
    assert np.count_nonzero(~surface.charts.covers(surface.samples)) > 10


def test_the_halves_of_a_cone_are_two_surfaces_and_nothing_is_left_over_at_the_tip() -> (
    None
):
    above = np.array([[0.3, 0.4, 0.5], [0.006, 0.008, 0.01]])
    below = above * [1, 1, -1]
    atlas = explore(CONE, seeds=seeds_at(np.concatenate([above, below])))
    signs = [np.sign(surface.samples[:, 2]).tolist() for surface in atlas.surfaces]
    assert sorted(signs) == [[-1, -1], [1, 1]]
    assert [point.surfaces for point in atlas.points] == [(0, 1)]
    assert [surface.note for surface in atlas.surfaces] == ["", ""]


def cylinder_and_plane() -> Problem:
    def function(u: np.ndarray) -> np.ndarray:
        return np.array([(u[0] ** 2 + u[1] ** 2 - 1.0) * (u[2] - 1 / 3)])

    return FunctionProblem(function, [(-2, 2)] * 3)


def test_seeds_between_the_charts_of_complete_surfaces_belong_to_these() -> None:
    # a disk of the plane is inside the cylinder; charts leave out slivers at its rim
    for seed in (0, 3):
        atlas = explore(cylinder_and_plane(), seed=seed)
        assert len(atlas.surfaces) == 2
        samples = sum(len(surface.samples) for surface in atlas.surfaces)
        assert samples == atlas.provenance.settings.starts
        assert "no charted surface" not in atlas.completeness.statement


def test_a_corner_of_a_surface_that_random_starts_miss_is_a_surface() -> None:
    bounds = [(-1.5, 1.5), (-1.5, 1.6), (0.999, 2.0)]
    cap = FunctionProblem(lambda u: np.array([u @ u - 1.0]), bounds)
    (surface,) = explore(cap, settings=SearchSettings(starts=20)).surfaces
    assert surface.charts is not None
    assert surface.charts.euler_characteristic == 1
    assert surface.charts.area == pytest.approx(2e-3 * np.pi, rel=1e-6)


def test_a_plane_that_cuts_off_a_corner_of_the_bounds_is_a_surface() -> None:
    # starts end outside, also those in a single bound
    plane = FunctionProblem(lambda u: [u.sum() - 2.999], [(-1, 1)] * 3)
    (surface,) = explore(plane, settings=SearchSettings(starts=20)).surfaces
    assert surface.charts is not None
    assert surface.charts.euler_characteristic == 1
    assert surface.charts.area == pytest.approx(np.sqrt(3) / 2 * 1e-6, rel=1e-9)


def test_a_small_circle_in_which_surfaces_cross_is_no_isolated_point() -> None:
    def sphere_and_plane(u: np.ndarray) -> np.ndarray:
        return np.array([(u @ u - 1) * (u[2] - (1 - 5e-7))])  # its radius is 1e-3

    problem = FunctionProblem(sphere_and_plane, [(-1.5, 1.5)] * 3)
    atlas = explore(problem, settings=SearchSettings(starts=30))
    assert atlas.points
    assert all(point.kind is Kind.CURVE_SAMPLE for point in atlas.points)


def test_lines_in_which_surfaces_cross_and_that_meet_themselves_are_a_doubt() -> None:
    def two_saddles(u: np.ndarray) -> list[float]:
        x, y, z = u
        return [(x - y * z) * (x + y * z)]

    atlas = explore(FunctionProblem(two_saddles, [(-1, 1)] * 3))
    assert len(atlas.surfaces) == 2
    assert atlas.completeness.is_in_doubt


def test_charts_that_do_not_fit_together_are_a_doubt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def ill_fitting(*args: Any, **options: Any) -> ChartAtlas:
        charts = cover_surface(*args, **options)
        return replace(charts, outcome=Covering.MISFIT)

    plane = FunctionProblem(lambda u: u[2:], [(-1.0, 1.0)] * 3)
    settings = SearchSettings(starts=5)
    assert not explore(plane, settings=settings).completeness.is_in_doubt
    monkeypatch.setattr("bifurc.surfaces.covering.cover_surface", ill_fitting)
    atlas = explore(plane, settings=settings)
    assert "do not fit together everywhere" in atlas.completeness.statement


def test_seeds_that_come_to_no_chart_are_no_surface_but_a_doubt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def nothing(*_: object) -> None:
        """No product is recognised."""

    def but_for_two(charts: ChartAtlas, points: np.ndarray) -> np.ndarray:
        chart = chart_at(charts, points)
        chart[:2] = -1
        return chart

    chart_at = ChartAtlas.chart_at
    monkeypatch.setattr("bifurc.search.search.recognise_products", nothing)
    monkeypatch.setattr("bifurc.surfaces.walk.WALKS", 0)
    monkeypatch.setattr(ChartAtlas, "chart_at", but_for_two)
    atlas = explore(cylinder_and_plane(), seed=0)
    assert all(surface.complete for surface in atlas.surfaces)
    on_charts = sum(len(surface.samples) for surface in atlas.surfaces)
    left = atlas.provenance.settings.starts - on_charts
    assert left > 0
    assert f"no charted surface is known to hold {left} start" in (
        atlas.completeness.statement
    )


def test_the_line_in_which_planes_cross_is_a_curve_and_no_heap_of_points() -> None:
    for seed in range(3):
        settings = SearchSettings(starts=40)
        atlas = explore(crossing_planes(), settings=settings, seed=seed)
        (point,) = atlas.points  # by which a route changes from one to the other
        assert point.kind is Kind.CURVE_SAMPLE
        assert np.abs(point.point.u[1:]).max() < 1e-9
        assert point.surfaces == (0, 1)
        notes = {surface.note for surface in atlas.surfaces}
        assert notes == {"singular points of rank 0 form 1 open curve"}
        assert not atlas.completeness.is_in_doubt


def test_each_of_three_planes_holds_the_two_lines_in_which_it_is_crossed() -> None:
    planes = FunctionProblem(lambda u: np.array([u[0] * u[1] * u[2]]), [(-1, 1)] * 3)
    atlas = explore(planes, settings=SearchSettings(starts=60))
    met = sorted(point.surfaces for point in atlas.points)
    assert met == [(0, 1), (0, 2), (1, 2)]
    notes = [surface.note for surface in atlas.surfaces]
    assert notes == ["singular points of rank 0 form 2 open curves"] * 3


def test_spheres_that_cross_at_a_small_angle_are_whole_and_meet_in_a_circle() -> None:
    def spheres(u: np.ndarray) -> np.ndarray:
        aside = u - np.array([0.1, 0.0, 0.0])
        return np.array([(u @ u - 1.0) * (aside @ aside - 1.0)])

    atlas = explore(FunctionProblem(spheres, [(-2, 2)] * 3))
    assert [surface.complete for surface in atlas.surfaces] == [True, True]
    notes = {surface.note for surface in atlas.surfaces}
    assert notes == {"singular points of rank 0 form 1 closed curve"}


@pytest.mark.parametrize("gap", [1e-16, 1e-13])
def test_sheets_that_nearly_cross_are_in_doubt(gap: float) -> None:
    def sheets(u: np.ndarray) -> np.ndarray:
        x, y, z = u
        return np.array([(y - 0.3 * x + 0.1) * (z + 0.2 * x - 0.05) - gap])

    problem = FunctionProblem(sheets, [(-1, 1)] * 3)
    atlas = explore(problem, settings=SearchSettings(starts=40))
    assert atlas.completeness.is_in_doubt


def test_a_curve_of_singular_points_that_is_not_followed_is_a_doubt() -> None:
    def planes(u: np.ndarray) -> np.ndarray:
        return np.array([u[1] * u[2] * (u[1] - u[2])])

    problem = FunctionProblem(planes, [(-1, 1)] * 3)
    atlas = explore(problem, settings=SearchSettings(starts=40))
    assert {point.kind for point in atlas.points} == {Kind.CURVE_SAMPLE}
    samples = f"{len(atlas.points)} of its singular points are samples of curves"
    assert all(surface.note.startswith(samples) for surface in atlas.surfaces)
    assert "form curves that could not be followed" in atlas.completeness.statement


def test_a_surface_says_at_how_many_places_singular_points_were_not_looked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("bifurc.search.components.MOST_POINTS", 1)
    atlas = explore(crossing_planes(), settings=SearchSettings(starts=40))
    notes = " ".join(surface.note for surface in atlas.surfaces)
    assert "places singular points were not looked for" in notes


def crossing_planes() -> Problem:
    """Two planes that meet in the x-axis."""
    return FunctionProblem(lambda u: np.array([u[1] * u[2]]), [(-1, 1)] * 3)


def test_a_surface_with_a_lower_rank_everywhere_is_one_and_no_heap_of_points():
    """A sphere on which F has a minimum, and the plane that cuts it."""

    def function(u):
        x, y, z = u
        return np.array([(1.0 - np.cos(x * x + y * y + z * z - 1.0)) * (z - 0.3)])

    problem = FunctionProblem(function, [(-1.5, 1.5)] * 3)
    settings = SearchSettings(starts=60, charts=0)
    for seed in range(2):
        atlas = explore(problem, settings=settings, seed=seed)
        assert not atlas.points
        notes = [surface.note for surface in atlas.surfaces]
        assert sorted(notes) == ["", "F' has a lower rank all over it"]


@pytest.mark.parametrize(("gap", "is_in_doubt"), [(1e-7, True), (0.0, False)])
def test_sheets_nearer_than_doubles_tell_apart_are_in_doubt_and_double_ones_are_not(
    gap: float, is_in_doubt: bool
) -> None:
    def two(u: np.ndarray) -> np.ndarray:
        return np.array([(u[2] - 0.3 * u[0] ** 2) * (u[2] - 0.3 * u[0] ** 2 - gap)])

    problem = FunctionProblem(two, [(-1, 1)] * 3)
    atlas = explore(problem, settings=SearchSettings(starts=20))
    assert len(atlas.surfaces) == 1
    assert atlas.completeness.is_in_doubt is is_in_doubt


def test_surfaces_that_share_a_point_alone_meet_there():
    # complex lines z = w and z = -w
    def squares(u):
        x, y, a, b = u
        return [x * x - y * y - a * a + b * b, x * y - a * b]

    atlas = explore(FunctionProblem(squares, [(-1, 1)] * 4))
    (point,) = atlas.points
    assert point.surfaces == (0, 1)
    assert np.abs(point.point.u).max() < 1e-9
