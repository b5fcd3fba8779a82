"""Charts that cover surfaces of known area and Euler characteristic."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.covering import cover_surface
from tests.bifurc.known_surfaces import (
    CONE,
    SPHERE,
    level,
    seeds,
    spheres,
    torus,
    two_spheres,
)
from tests.samples import one_in


@pytest.mark.parametrize(
    ("problem", "area", "euler"),
    [(SPHERE, 4 * np.pi, 2), (torus(0.6), 2.4 * np.pi**2, 0)],
    ids=["sphere", "torus"],
)
def test_area_and_euler_characteristic_of_a_closed_surface_are_found(
    problem: Problem, area: float, euler: int
) -> None:
    charts = cover_surface(problem, seeds(problem))
    assert charts.complete
    assert charts.euler_characteristic == euler
    assert charts.border == 0
    assert charts.area == pytest.approx(area, rel=1e-10)
    assert abs(charts.area - area) < charts.area_error < 1e-8 * area
    assert np.linalg.norm(problem.residuals(charts.vertices), axis=1).max() < 1e-10


@pytest.mark.parametrize("neck", [0.03])
def test_a_neck_joins_two_halves_to_one_surface(neck: float) -> None:
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - u[2] ** 2 - neck**2]),
        [[-2, 2], [-2, 2], [-1, 1]],
    )
    charts = cover_surface(problem, np.array([[0.5, 0.0, np.sqrt(0.25 - neck**2)]]))
    assert charts.complete
    assert charts.euler_characteristic == 0
    # of a surface of revolution: the integral of 2 pi sqrt(2 z^2 + neck^2)
    end = np.sqrt(2 + neck**2)
    area = 2 * np.pi * (end + neck**2 / np.sqrt(2) * np.arcsinh(np.sqrt(2) / neck))
    assert charts.area == pytest.approx(area, rel=1e-9)


def test_charts_are_solutions_with_tangent_planes(sphere_charts: ChartAtlas) -> None:
    centers, bases = sphere_charts.centers, sphere_charts.bases
    assert np.abs(np.linalg.norm(centers, axis=1) - 1).max() < 1e-12
    assert np.abs(np.einsum("ki,kij->kj", centers, bases)).max() < 1e-9
    products = np.swapaxes(bases, 1, 2) @ bases
    assert np.abs(products - np.eye(2)).max() < 1e-12


@pytest.mark.parametrize("start", [0.0, 1e-13, -1e-14])
def test_a_surface_that_runs_in_a_bound_is_whole(start: float) -> None:
    def square(u: np.ndarray) -> np.ndarray:
        x, y, z = u
        return np.array([z * (1.3 + np.sin(x + 0.3) + y * y)])

    problem = FunctionProblem(square, [[-1, 1], [-1, 1], [0, 1]])
    charts = cover_surface(problem, np.array([[0.1, 0.2, start]]))
    assert charts.complete
    assert charts.euler_characteristic == 1
    assert charts.area == pytest.approx(4.0, rel=1e-9)


def sphere_between(low: float, high: float) -> Problem:
    """The part of the unit sphere with z from ``low`` to ``high``."""
    bounds = [(-1.5, 1.5), (-1.5, 1.6), (low, high)]
    return FunctionProblem(lambda u: np.array([u @ u - 1.0]), bounds)


@pytest.mark.parametrize("height", [1e-2, 1e-4])
def test_a_corner_of_a_surface_much_smaller_than_charts_is_whole(height: float) -> None:
    problem = sphere_between(1.0 - height, 2.0)
    start = np.array([np.sqrt(1.0 - (1.0 - height) ** 2), 0.0, 1.0 - height])
    charts = cover_surface(problem, start[None])
    assert charts.euler_characteristic == 1
    assert charts.area == pytest.approx(2 * np.pi * height, rel=1e-6)


def test_a_surface_that_touches_a_bound_is_not_cut_there() -> None:
    start = np.array([[0.3, 0.4, np.sqrt(0.75)]])
    charts = cover_surface(sphere_between(-1.5, 1.0), start)
    assert charts.euler_characteristic == 2
    assert charts.area == pytest.approx(4 * np.pi, rel=1e-7)


def test_a_surface_that_leaves_the_bounds_has_a_border_and_its_area_inside() -> None:
    problem = level(lambda x, y, z: z - 0.5 * x, 1.0)
    charts = cover_surface(problem, seeds(problem, 1))
    assert charts.complete
    assert charts.border > 0
    assert charts.euler_characteristic == 1
    assert charts.area == pytest.approx(4 * np.hypot(1, 0.5), rel=1e-6)


def test_two_spheres_are_two_surfaces() -> None:
    starts = np.array([[-0.5, 0, 0], [0.4, 0, 0]])
    parts = cover_surface(two_spheres(1.0), starts, radius=0.4).parts()
    assert [part.euler_characteristic for part in parts] == [2, 2]
    areas = sorted(part.area for part in parts)
    assert areas == pytest.approx([np.pi, 1.44 * np.pi], rel=1e-9)


@pytest.mark.parametrize("angle", one_in(2, [0.4, 1.1]))
def test_a_sheet_that_crosses_is_found_or_said_to_be_missed(angle: float) -> None:
    # sphere of radius 0.5 about (-0.4, 0, 0), 0.6 about (0.4, 0, 0)
    direction = np.array([np.cos(angle), np.sin(angle), 0])
    start = np.array([-0.4, 0, 0]) - 0.5 * direction
    charts = cover_surface(two_spheres(0.4), start[None], radius=0.4)
    for part in charts.parts():
        left = np.linalg.norm(part.centers - [-0.4, 0, 0], axis=1) - 0.5
        right = np.linalg.norm(part.centers - [0.4, 0, 0], axis=1) - 0.6
        off = min(np.abs(left).max(), np.abs(right).max())
        assert off < 1e-9  # no chart went over to the other sphere
    if charts.complete:
        assert charts.area == pytest.approx(2.44 * np.pi, rel=1e-6)
    else:
        assert charts.outcome is Covering.UNFIT


NEARER = [pytest.param(gap, marks=pytest.mark.exhaustive) for gap in (0.05, 1e-3, 1e-5)]


# caps of spheres, and whole ones
@pytest.mark.parametrize("floor", one_in(2, [0.9, -1.5]))
@pytest.mark.parametrize("gap", [0.2, 1e-2, *NEARER])
def test_concentric_spheres_are_two_surfaces_however_near(
    gap: float, floor: float
) -> None:
    problem = spheres(np.zeros(3), 1.0, np.zeros(3), 1.0 + gap)
    problem.domain = replace(
        problem.domain, bounds=np.array([[-1.5, 1.5], [-1.5, 1.5], [floor, 1.5]])
    )
    # the inner one has no seed: it is seen from the charts of the outer one
    start = np.array([[0.0, 0.0, 1.0 + gap]])
    parts = cover_surface(problem, start, radius=0.7).parts()
    euler = 1 if floor > 0 else 2
    assert [part.euler_characteristic for part in parts] == [euler] * 2
    areas = sorted(part.area for part in parts)
    truth = [2 * np.pi * r * (r - max(floor, -r)) for r in (1.0, 1.0 + gap)]
    assert areas == pytest.approx(truth, rel=1e-6)


@pytest.mark.parametrize("gap", one_in(2, [1e-4, 0.025]))
def test_spheres_side_by_side_are_two_surfaces(gap: float) -> None:
    shift = np.array([0.5 + gap / 2, 0.0, 0.0])
    problem = spheres(-shift, 0.5, shift, 0.5)
    start = np.array([[-0.5 - gap / 2, 0.5, 0.0]])
    parts = cover_surface(problem, start, radius=0.3).parts()
    assert [part.euler_characteristic for part in parts] == [2, 2]
    assert [part.area for part in parts] == pytest.approx([np.pi] * 2, rel=1e-6)


@pytest.mark.parametrize("gap", [1e-3, 1e-5])
def test_parallel_planes_are_two_surfaces_however_near(gap: float) -> None:
    problem = FunctionProblem(lambda u: np.array([u[2] * (u[2] - gap)]), [(-1, 1)] * 3)
    parts = cover_surface(problem, np.array([[0.1, 0.2, 0.0]])).parts()
    assert [part.euler_characteristic for part in parts] == [1, 1]
    assert [part.area for part in parts] == pytest.approx([4, 4], rel=1e-9)


def test_a_surface_with_one_side_has_an_euler_characteristic() -> None:
    def moebius_band(u: np.ndarray) -> np.ndarray:
        x, y, z, w = u
        return np.array([x**2 + y**2 - 1, z * (1 - x) - w * y, z * y - w * (1 + x)])

    bounds = [(-1.5, 1.5), (-1.5, 1.5), (-1, 1), (-1, 1)]
    problem = FunctionProblem(moebius_band, bounds)
    charts = cover_surface(problem, np.array([[1.0, 0, 0.5, 0]]))
    assert charts.outcome is Covering.COMPLETE
    assert charts.euler_characteristic == 0
    assert charts.area == pytest.approx(14.832242382922185, rel=1e-6)


def test_an_area_is_refined_without_smaller_charts() -> None:
    def ellipsoid(u: np.ndarray) -> np.ndarray:
        return np.array([u[0] ** 2 + u[1] ** 2 / 4 + u[2] ** 2 / 9 - 1])

    problem = FunctionProblem(ellipsoid, [(-3.5, 3.5)] * 3)
    charts = cover_surface(problem, np.array([[1.0, 0, 0]]), radius=0.9)
    assert charts.euler_characteristic == 2
    assert abs(charts.area - 48.88214630258206) < charts.area_error < 1e-7 * charts.area


def test_a_bridge_between_two_bounds_is_in_one_piece_or_said_to_be_open() -> None:
    # its width is 1e-3, and planes cut it off
    problem = FunctionProblem(lambda u: np.array([u @ u - 1]), [(-0.7075, 0.7075)] * 3)
    charts = cover_surface(problem, np.full((1, 3), np.sqrt(1 / 3)))
    assert charts.outcome is not Covering.COMPLETE or len(charts.parts()) == 1


def test_where_both_sheets_that_cross_are_covered_nothing_is_missed() -> None:
    starts = np.array([[-0.9, 0, 0], [1.0, 0, 0]])
    charts = cover_surface(two_spheres(0.4), starts, radius=0.4)
    assert charts.outcome is Covering.COMPLETE
    assert charts.area == pytest.approx(2.44 * np.pi, rel=1e-6)


def test_two_planes_that_cross_are_two_surfaces() -> None:
    problem = FunctionProblem(lambda u: np.array([u[1] * u[2]]), [(-1, 1)] * 3)
    starts = np.array([[0.3, 0.4, 0.0], [-0.2, 0.0, 0.7]])
    parts = cover_surface(problem, starts).parts()
    assert [part.euler_characteristic for part in parts] == [1, 1]
    assert [part.area for part in parts] == pytest.approx([4, 4], rel=1e-9)


def test_a_cone_is_covered_but_for_its_tip_and_says_so() -> None:
    charts = cover_surface(CONE, np.array([[0.3, 0.4, 0.5]]))
    assert charts.outcome is Covering.SINGULAR
    assert charts.euler_characteristic is None
    assert np.linalg.norm(charts.centers, axis=1).min() < 0.05


def test_a_covering_stops_at_its_limits_and_is_continued_from_there() -> None:
    start = seeds(SPHERE, 1)
    few = cover_surface(SPHERE, start, charts=30)
    assert few.outcome is Covering.CHART_LIMIT
    assert len(few) == 30
    assert few.euler_characteristic is None
    none = cover_surface(SPHERE, start, seconds=1e-9)
    assert none.outcome is Covering.OUT_OF_TIME
    assert "continue" in none.outcome.value
    whole = cover_surface(SPHERE, start, atlas=few)
    assert whole.complete
    assert np.array_equal(whole.centers[:30], few.centers)
    assert whole.euler_characteristic == 2


def test_wrong_seeds_and_limits_are_refused() -> None:
    with pytest.raises(ProblemError, match="shape of the seeds"):
        cover_surface(SPHERE, np.zeros(3))
    with pytest.raises(ProblemError, match="radius"):
        cover_surface(SPHERE, np.zeros((1, 3)), radius=0.0)


@pytest.mark.parametrize("edge", [1e-2, 1e-3, 1e-5])
def test_a_corner_of_the_bounds_that_is_cut_off_is_no_vertex(edge: float) -> None:
    def plane(u: np.ndarray) -> np.ndarray:
        return np.array([u.sum() - 1.0 + edge])

    problem = FunctionProblem(plane, [(-1, 1)] * 3)
    charts = cover_surface(problem, np.full((1, 3), (1.0 - edge) / 3))
    # a triangle without its three corners
    area = np.sqrt(3) / 2 * ((4.0 - edge) ** 2 - 3 * (2.0 - edge) ** 2)
    assert charts.area == pytest.approx(area, rel=1e-12)
    assert charts.euler_characteristic == 1


def test_there_is_no_chart_where_the_derivatives_are_no_numbers() -> None:
    # F is zero for |x| <= pi / 2, and F' has no limit on the rim
    problem = FunctionProblem(
        lambda u: [np.arcsin(np.sin(u[0])) - u[0]], [(-10, 10)] * 2, names=["x", "y"]
    )
    inside, rim = np.array([1.0, 0.3]), np.array([np.pi / 2, 0.3])
    assert len(cover_surface(problem, inside[None], charts=1)) == 1
    assert len(cover_surface(problem, rim[None], charts=1)) == 0


@pytest.mark.parametrize("gap", [1e-8, 1e-9])
def test_planes_too_near_to_be_told_apart_are_said_to_be(gap: float) -> None:
    problem = FunctionProblem(lambda u: np.array([u[2] * (u[2] - gap)]), [(-1, 1)] * 3)
    charts = cover_surface(problem, np.array([[0.1, 0.2, 0.0]]))
    assert charts.outcome is Covering.UNDECIDED
