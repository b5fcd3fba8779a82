"""Germs of curves at points that doubles know to a few digits."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.singular.germ import germ_at, placed_at
from bifurc.singular.locate import LocatedPoint

BOX = [[-1.1, 1.0], [-1.05, 1.2]]
CENTER = np.array([0.3, -0.2])
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(2, 2)))[0]
CURVES = {  # polynomial at the origin, number of half-branches, passes of one branch
    "cusp of order 9": (lambda x, y: y**2 - x**9, 2, False),
    "x^3 = y^4": (lambda x, y: x**3 - y**4, 2, True),
    "x^3 = y^4, stretched": (lambda x, y: x**3 - (10 * y) ** 4, 2, True),
    "contact of order 4": (lambda x, y: y * (y - x**4), 4, None),
    "isolated point": (lambda x, y: y**2 + x**6, 0, None),
    "three parabolas": (lambda x, y: y * (y**2 - x**4), 6, None),
    "not a polynomial": (
        lambda x, y: np.sin(y) ** 2 - x**2 * (np.exp(x) - 1),
        2,
        False,
    ),
}


@pytest.mark.parametrize("name", CURVES)
def test_the_germ_has_the_exact_point_and_its_branches(name):
    polynomial, count, is_through = CURVES[name]
    problem = FunctionProblem(
        lambda u: np.array([polynomial(*(TURN @ (u - CENTER)))]), BOX
    )
    beside = CENTER + np.array([2e-6, -1e-6])
    located = LocatedPoint(beside, np.eye(2), 1e-5)
    germ = germ_at(problem, located)
    assert (len(germ.directions), germ.is_through) == (count, is_through)
    assert np.array_equal(germ.u, CENTER)
    error = placed_at(located, germ).error
    assert error >= np.linalg.norm(beside - CENTER)


def test_a_germ_in_space_is_that_of_the_equation_that_is_left():
    problem = FunctionProblem(
        lambda u: np.array([u[1] ** 2 - u[0] ** 5 + u[2] ** 3, u[2] - u[0] ** 2]),
        [[-1, 1]] * 3,
    )
    place = np.array([1e-6, 2e-6, 0.0])
    germ = germ_at(problem, LocatedPoint(place, np.eye(3)[:, :2], 1e-5))
    assert germ.is_through is False
    assert np.allclose(germ.directions, [[1, 0, 0]] * 2)


def test_an_equation_without_a_singular_point_has_no_germ():
    problem = FunctionProblem(lambda u: np.array([u[1] ** 2 - u[0] ** 3 + 1e-12]), BOX)
    assert germ_at(problem, LocatedPoint(np.zeros(2), np.eye(2), 1e-5)) is None


def test_nothing_is_said_of_more_than_one_equation_on_the_null_space():
    problem = FunctionProblem(lambda u: np.array([u[0] * u[1]] * 2), BOX)
    assert germ_at(problem, LocatedPoint(np.zeros(2), np.eye(2), 1e-5)) is None


def test_a_germ_is_found_from_a_place_that_is_far_off_beside_another_curve():
    problem = FunctionProblem(
        lambda u: np.array([(u[1] ** 2 - u[0] ** 8) * (u[1] - 0.05)]), [[-1, 1]] * 2
    )
    located = LocatedPoint(np.array([2.3e-3, 0.0]), np.eye(2), 0.025)
    germ = germ_at(problem, located)
    assert len(germ.directions) == 4
    assert np.abs(germ.u).max() < 1e-30
    assert germ.invariants.contacts == (4,)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.57, 1.1])
def test_a_germ_does_not_hang_on_the_axes_of_the_null_space(angle):
    problem = FunctionProblem(lambda u: np.array([u[0] ** 3 - u[1] ** 4]), BOX)
    axes = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    germ = germ_at(problem, LocatedPoint(np.array([1e-6, -1e-6]), axes, 1e-5))
    assert germ.is_through
    assert np.abs(germ.directions[:, 0]).max() < 1e-12
    assert germ.radius > 0.01  # so that its branches are known beside it


@pytest.mark.parametrize("gap", [0.0, 1e-9])
def test_a_germ_knows_where_its_two_branches_meet_again(gap):
    def function(u):
        x, y = u
        return np.array([y * (y - x * ((x - 0.001) ** 2 * (x + 0.002) + gap * x))])

    problem = FunctionProblem(function, [(-1, 1)] * 2)
    germ = germ_at(problem, LocatedPoint(np.zeros(2), np.eye(2), 1e-4))
    assert germ is not None
    others = germ.others[np.argsort(germ.others[:, 0])]
    roots = np.roots([1.0, 0.0, gap - 3e-6, 2e-9])
    expected = np.sort(roots[np.abs(roots.imag) < 1e-12].real)
    assert np.abs(others[:, 1]).max() < 1e-14
    assert np.abs(others[0] - [expected[0], 0.0]).max() < 1e-9
    assert len(others) == (2 if gap == 0.0 else 1)
