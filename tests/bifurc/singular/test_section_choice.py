"""Which of the sections of a point are taken."""

import numpy as np

import bifurc
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import LocatedPoint
from bifurc.singular.point import Kind


def test_what_fills_a_smaller_sphere_only_is_rounding():
    # 1e-4 x^2 y^2 is below rounding on the smallest sphere, which looks like a surface
    def double_lines(u):
        return [u[2], u[2] - 1e-4 * (u[0] * u[1]) ** 2]

    problem = bifurc.FunctionProblem(double_lines, [[-1.0, 1.0]] * 3)
    located = LocatedPoint(np.zeros(3), np.eye(3)[:, :2], 1e-10)
    point = classify_singular_point(problem, located)
    assert point.kind is Kind.BIFURCATION
    assert len(point.half_branches) == 4


def test_no_solution_on_a_sphere_leaves_a_point_undecided():
    # the equation across the null space is of rank 1 by 1e-9 only
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] * u[1], 1e-9 * u[2] + u[2] ** 3 + u[0] ** 2],
        [[-1.0, 1.0]] * 3,
    )
    located = LocatedPoint(np.zeros(3), np.eye(3)[:, :2], 1e-10)
    assert classify_singular_point(problem, located).kind is not Kind.DIMENSION_CHANGE
