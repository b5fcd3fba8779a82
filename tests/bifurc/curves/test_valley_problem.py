"""The valley of contradictory equations as a system of its own."""

import numpy as np
import pytest

from bifurc import _core
from bifurc.curves.valley_problem import ValleyProblem
from bifurc.function_problem import FunctionProblem
from bifurc.numerics.null_spaces import correct_to_valley
from bifurc.system import relative_gaps
from tests.bifurc.known_curves import contradictory


def test_the_jacobian_is_that_of_the_residuals():
    valley = ValleyProblem(contradictory(0.05))
    point = np.array([0.7, 0.6, 0.2])
    step = 1e-6
    columns = [
        (valley.residuals((point + d)[None]) - valley.residuals((point - d)[None]))[0]
        / (2 * step)
        for d in step * np.eye(3)
    ]
    # those of the problem within are differences, too
    jacobian = valley.jacobians(point[None])[0]
    assert jacobian == pytest.approx(np.array(columns).T, abs=1e-6)


def test_its_solutions_are_where_no_move_across_lowers_the_residual():
    problem = contradictory(1e-3)
    valley = ValleyProblem(problem)
    starts = np.array([[0.7, 0.6, 0.2], [-0.5, 0.8, -0.1]])
    points, gaps = correct_to_valley(problem, starts)
    assert np.all(relative_gaps(valley, points) < 1e-14)
    assert np.all(gaps > 1e-5)
    sigma = np.linalg.svd(valley.jacobians(points), compute_uv=False)
    assert np.all(sigma[:, 1] > 0.1)
    assert np.all(sigma[:, 2] < 1e-2)


def test_a_crossing_that_opened_has_a_valley_and_a_rank_drop_has_none():
    error = 1e-4
    crossing = FunctionProblem(
        lambda u: np.array([u[0] * u[1] + error, 2 * u[0] * u[1] + error]),
        [[-2, 2], [-2, 2]],
    )
    drop = FunctionProblem(
        lambda u: np.array([u[0] * u[1] + error, u[1] ** 2 - error]),
        [[-2, 2], [-2, 2]],
    )
    near = np.array([[0.008, -0.0075]])
    assert ValleyProblem(crossing).missed(near) == 0.0
    assert ValleyProblem(drop).missed(near) > 0.0
    assert ValleyProblem(drop).missed(np.array([[1.0, -error]])) == 0.0


@pytest.mark.parametrize("shape", [(6, 6), (6, 4), (3, 2), (5, 6), (2, 1)])
@pytest.mark.parametrize("weakest", [1e-3, 1e-12, 0.0])
def test_the_projection_is_that_of_an_svd_whatever_the_rank(shape, weakest):
    m, n = shape
    rng = np.random.default_rng(m * n)
    left, sigma, right = np.linalg.svd(rng.normal(size=shape))
    sigma[n - 1 :] *= weakest
    jacobian = (left[:, : len(sigma)] * sigma) @ right[: len(sigma)]
    residual = rng.normal(size=m)
    projected = _core.valley_residuals(residual[None], jacobian[None])[0]
    regular = left[:, : n - 1]
    assert projected == pytest.approx(regular @ (regular.T @ residual), abs=1e-13)


def test_arrays_that_do_not_fit_are_refused():
    one, jacobians = np.ones((1, 3)), np.ones((1, 3, 2))
    with pytest.raises(ValueError, match="residuals and jacobians"):
        _core.valley_residuals(one, np.ones((1, 4, 2)))
    with pytest.raises(ValueError, match="residuals, jacobians and hessians"):
        _core.valley_jacobians(one, jacobians, np.ones((1, 5, 2)))
