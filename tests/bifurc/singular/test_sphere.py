"""Sections of known curves and surfaces with small spheres."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.singular.sphere import Sections, is_on_surface, section


def plane(function) -> FunctionProblem:
    return FunctionProblem(lambda u: np.array([function(*u)]), [(-1, 1)] * 2)


def space(function) -> FunctionProblem:
    return FunctionProblem(lambda u: np.atleast_1d(function(*u)), [(-1, 1)] * 3)


PLANE_AND_LINE = space(lambda x, y, z: np.array([z * x, z * y]))
THREE_AXES = space(lambda x, y, z: np.array([x * y, y * z, z * x]))


def test_a_circle_meets_two_lines_in_four_points():
    cut = section(plane(lambda x, y: x * (x - y)), np.zeros(2), np.eye(2), 0.1)
    assert cut.dimension == 1
    assert not cut.doubtful
    assert np.linalg.norm(cut.points, axis=1) == pytest.approx(0.1)
    x, y = cut.points.T
    assert len(cut.points) == 4
    assert np.abs(x * (x - y)).max() < 1e-12


def test_a_circle_about_an_isolated_point_meets_nothing():
    cut = section(plane(lambda x, y: x * x + y * y), np.zeros(2), np.eye(2), 0.1)
    assert (len(cut.points), cut.dimension) == (0, 0)


def test_a_double_line_is_a_zero_but_for_rounding():
    cut = section(plane(lambda x, y: (y - x) ** 2), np.zeros(2), np.eye(2), 0.1)
    assert len(cut.points) == 2
    assert cut.doubtful


def test_equations_that_vanish_are_a_surface():
    cut = section(plane(lambda x, y: 0.0 * x), np.zeros(2), np.eye(2), 0.1)
    assert (len(cut.points), cut.dimension) == (0, 2)


def test_a_sphere_meets_three_axes_in_six_points():
    cut = section(THREE_AXES, np.zeros(3), np.eye(3), 0.1)
    assert cut.dimension == 1
    assert len(cut.points) == 6
    assert np.sort(np.abs(cut.points), axis=1)[:, 2] == pytest.approx(0.1)


def test_of_a_plane_and_a_line_the_points_are_those_of_the_line():
    cut = section(PLANE_AND_LINE, np.zeros(3), np.eye(3), 0.1)
    assert cut.dimension == 2
    assert np.sort(cut.points[:, 2]) == pytest.approx([-0.1, 0.1])


def beside_a_plane(of_the_others):
    """A plane in (x, y) and what equations of (z, w) say, in four unknowns."""

    def equations(u):
        x, y, z, w = u
        return [x * z, y * z, x * w, y * w, of_the_others(z, w)]

    return FunctionProblem(equations, [(-1.0, 1.0)] * 4)


@pytest.mark.parametrize(
    ("of_the_others", "half_branches", "alone"),
    [
        pytest.param(lambda z, w: z * w, 4, 4, id="lines that second order tells"),
        pytest.param(lambda z, w: w * (w - z**2), 4, 0, id="curves that touch"),
        pytest.param(lambda z, w: w**2 - z**3, 2, 0, id="a cusp"),
    ],
)
def test_half_branches_beside_a_surface(of_the_others, half_branches, alone):
    problem = beside_a_plane(of_the_others)
    sections = Sections(problem, np.zeros(4), np.eye(4))
    assert len(sections.cone.lone) == alone
    for radius in (0.04, 0.02, 0.01):
        cut = sections.of_radius(radius)
        assert (len(cut.points), cut.dimension) == (half_branches, 2)


def test_regular_points_of_a_plane_are_on_a_surface_and_those_of_a_line_are_not():
    def is_there(*point, null_space):
        return is_on_surface(Sections(PLANE_AND_LINE, np.array(point), null_space))

    assert is_there(0.3, 0.2, 0.0, null_space=np.eye(3)[:, :2])
    assert not is_there(0.0, 0.0, 0.4, null_space=np.eye(3)[:, 2:])
    assert not is_there(0.0, 0.0, 0.0, null_space=np.eye(3))
    assert not is_there(0.0, 0.0, 0.0, null_space=np.eye(3)[:, :2])


def test_two_lines_that_cross_are_no_surface():
    crossing = plane(lambda x, y: x * (x - y))
    assert not is_on_surface(Sections(crossing, np.zeros(2), np.eye(2)))


def test_a_section_is_made_once():
    sections = Sections(THREE_AXES, np.zeros(3), np.eye(3))
    assert sections.of_radius(0.1) is sections.of_radius(0.1)
    assert sections.of_radius(0.1) is not sections.of_radius(0.05)


def test_small_curves_that_come_back_within_the_sphere_leave_it_in_doubt():
    """Two figures of eight, of size 0.01, that cross in a point."""

    def equations(u):
        x, y, z = u
        return [1e4 * (x**2 + y**2) ** 2 - x**2 + y**2, z * (z - x)]

    problem = FunctionProblem(equations, [(-1.0, 1.0)] * 3)
    sections = Sections(problem, np.zeros(3), np.eye(3))
    outside, inside = sections.of_radius(0.04), sections.of_radius(0.005)
    assert (len(outside.points), outside.doubtful) == (0, True)
    assert (len(inside.points), inside.doubtful) == (8, False)
