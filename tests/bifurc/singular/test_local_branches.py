"""Branches at singular points of high order, known from the exact equations."""

import numpy as np
import pytest

from bifurc.decisions import is_lost_in_rounding
from bifurc.function_problem import FunctionProblem
from bifurc.singular.germ import germ_at
from bifurc.singular.locate import LocatedPoint
from bifurc.system import relative_gaps, relative_jacobians

BOX = [[-1.1, 1.0], [-1.05, 1.2]]
CENTER = np.array([0.3, -0.2])
S = np.linspace(-1.0, 1.0, 401)
ROUNDING = 1e-16  # of places, which are less than 0.2 from the point


def germ_of(polynomial):
    """The germ at `CENTER` of a polynomial about it."""
    problem = FunctionProblem(
        lambda u: np.array([polynomial(*(u - CENTER))]), bounds=BOX
    )
    beside = CENTER + np.array([2e-6, -1e-6])
    return germ_at(problem, LocatedPoint(beside, np.eye(2), 1e-5))


def test_the_branches_of_a_contact_stay_what_they_are():
    around = germ_of(lambda x, y: (y - x**2) * (y - x**2 - x**4)).neighbourhood
    heights = []
    for branch in around.branches:
        x, y = branch(S).T
        assert branch.ramification == 1
        assert not branch.returns
        # doubles see no difference of the two next to the point: not on which it is
        on_first = np.abs(y - x**2).max()
        on_second = np.abs(y - x**2 - x**4).max()
        assert min(on_first, on_second) < 3 * ROUNDING
        heights.append(max(on_first, on_second))
    assert len(heights) == 2
    assert min(heights) > 1e-5
    assert around.radius == pytest.approx(np.linalg.norm(around.ends(), axis=1).min())


@pytest.mark.parametrize("power", [4, 5, 7])
def test_x_cubed_is_passed_by_one_branch(power):
    (branch,) = germ_of(lambda x, y: x**3 - y**power).neighbourhood.branches
    x, y = branch(S).T
    root = np.abs(y) ** (power / 3)
    signed = root if power % 2 == 0 else np.sign(y) * root
    assert np.abs(x - signed).max() < 1e-14
    assert not branch.returns
    assert branch.ramification == 3


def test_the_halves_of_a_cusp_leave_to_one_side():
    around = germ_of(lambda x, y: y**2 - x**9).neighbourhood
    (branch,) = around.branches
    x, y = branch(S).T
    assert branch.returns
    assert np.all(x > -ROUNDING)
    assert np.abs(np.abs(y) - np.maximum(x, 0.0) ** 4.5).max() < ROUNDING
    one, other = around.ends()
    assert one[1] * other[1] < 0


def test_doubles_do_not_lose_the_branches_at_their_ends():
    def contact(x, y):
        return y**2 - x**8

    problem = FunctionProblem(lambda u: np.array([contact(*(u - CENTER))]), bounds=BOX)
    for branch in germ_of(contact).neighbourhood.branches:
        places = CENTER + branch(np.array([-1.0, -0.4, 0.4, 1.0]))
        sizes = np.linalg.norm(relative_jacobians(problem, places), axis=(1, 2))
        is_lost = sizes < is_lost_in_rounding.threshold
        assert is_lost.tolist() == [False, True, True, False]


def test_about_an_isolated_point_nothing_is_solved_beyond_the_radius():
    around = germ_of(lambda x, y: y**2 + x**6).neighbourhood
    assert around.branches == ()
    assert 1e-3 < around.radius < 0.1
    assert around.radius**6 > 1e-10


def test_branches_in_space_solve_all_equations():
    problem = FunctionProblem(
        lambda u: np.array([u[1] ** 2 - u[0] ** 5 + u[2] ** 3, u[2] - u[0] ** 2]),
        [[-1, 1]] * 3,
    )
    place = np.array([1e-6, 2e-6, 0.0])
    germ = germ_at(problem, LocatedPoint(place, np.eye(3)[:, :2], 1e-5))
    (branch,) = germ.neighbourhood.branches
    x, _, z = branch(S).T
    assert relative_gaps(problem, germ.u + branch(S)).max() < 1e-16
    assert np.abs(z - x**2).max() < ROUNDING
