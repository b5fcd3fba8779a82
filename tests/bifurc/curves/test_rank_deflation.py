"""Curves and surfaces along which F' has a lower rank are as regular as others, once
that is one of the equations."""

import numpy as np
import pytest

from bifurc import explore
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import RankDeflated
from bifurc.curves.misclosure import largest_misclosure
from bifurc.function_problem import FunctionProblem
from bifurc.numerics.singular_values import singular_values
from bifurc.settings import SearchSettings

BOX = [(-2.0, 2.0)] * 4


def double_sphere(u):
    """The unit sphere in the first three unknowns, and the square of the last one."""
    x, y, z, w = u
    return [x * x + y * y + z * z - 1.0 + w, w * w]


def triple_null_circle(u):
    """A circle, on which the squares of two more unknowns vanish."""
    x, y, z, w = u
    return [x * x + y * y - 1.0, z * z + w * w, z * w]


def problem_of(function):
    names = ("x", "y", "z", "w")
    return FunctionProblem(function, names=names, bounds=BOX)


def test_the_derivative_is_that_of_the_singular_values():
    problem = problem_of(triple_null_circle)
    deflated = RankDeflated(problem, 1)
    point = np.array([0.6, 0.8, 0.1, -0.2])
    step = 1e-6 * np.array([0.3, 0.2, -0.5, 0.7])
    places = np.array([point - step, point + step])
    sizes = 0.5 * np.sum(deflated.residuals(places) ** 2, axis=1)
    residual = deflated.residuals(point[None])[0]
    slope = residual @ deflated.jacobians(point[None])[0] @ (2 * step)
    assert sizes[1] - sizes[0] == pytest.approx(slope, rel=1e-6)


def test_solutions_known_to_half_the_digits_become_exact():
    problem = problem_of(triple_null_circle)
    deflated = RankDeflated(problem, 1)
    near = np.array([[0.6, 0.8, 3e-8, -2e-8]])
    points, are_solved = deflated.next_to(near)
    assert are_solved[0]
    assert np.abs(points[0, 2:]).max() < 1e-15
    assert singular_values(deflated, points)[0, 2] > 0.1


def test_a_curve_of_lower_rank_is_traced_as_any_other():
    problem = problem_of(triple_null_circle)
    deflated = RankDeflated(problem, 1)
    branch = trace_branch(deflated, np.array([0.6, 0.8, 0.0, 0.0]))
    assert branch.closed
    assert branch.length == pytest.approx(2 * np.pi, rel=1e-10)
    assert largest_misclosure(problem, branch) < 1e-13


def test_a_double_sphere_is_covered():
    settings = SearchSettings(starts=30)
    atlas = explore(problem_of(double_sphere), settings=settings)
    assert [surface.dimension for surface in atlas.surfaces] == [2]
    assert atlas.surfaces[0].complete
