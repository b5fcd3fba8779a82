"""The valley of contradictory equations as a system of its own."""

import numpy as np
import pytest

from bifurc import _core
from bifurc.curves.valley import correct_to_valley
from bifurc.curves.valley_problem import ValleyProblem
from bifurc.function_problem import FunctionProblem
from bifurc.noisy_problem import with_rounding_noise
from bifurc.numerics.collocation import march_by_collocation
from bifurc.numerics.null_spaces import null_vector
from bifurc.pieces import points_on_piece
from bifurc.problem import CurveNodes, MarchSettings
from linkages.closure.loop_closure import LoopClosure
from linkages.linkage import load
from linkages.loop import Loop


def contradictory(error):
    """Four equations in three unknowns that agree but for an error."""

    def function(u):
        x, y, z = u
        sphere = x * x + y * y + z * z - 1.0
        plane = z - 0.3 * x * y
        return np.array(
            [sphere, plane, sphere + 2 * plane + error * x, plane + error * np.sin(y)]
        )

    return FunctionProblem(function, [[-2, 2]] * 3)


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
    assert np.all(valley.gaps(points) < 1e-14)
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


# --- compiled, against slower ways to the same ----------------------------------------


class OneByOne(ValleyProblem):
    """A valley of which the points at nodes are corrected one by one."""

    def node_corrector(self):
        return None


def nearly_bennett():
    """A loop of four joints that misses the condition of its motion by 1e-4."""
    lengths, twists, offsets = load("bennett").loop.arrays
    twists = twists + np.array([1e-4, 0, 0, 0])
    return LoopClosure(Loop(lengths, twists, offsets))


def on_the_valley(problem, start):
    """A point (n,) of the valley, and its tangent there."""
    (point,), _ = correct_to_valley(problem, np.array([start]))
    return point, null_vector(ValleyProblem(problem), point)


PROBLEMS = {
    "recorded": lambda: (contradictory(1e-3), [0.7, 0.6, 0.2]),
    "loop": lambda: (nearly_bennett(), [0.4, 2.4, -0.4, -2.4]),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_points_corrected_in_one_call_are_those_corrected_one_by_one(name):
    problem, start = PROBLEMS[name]()
    point, tangent = on_the_valley(problem, start)
    settings = MarchSettings(16, 1e-12, 1e-9, 1.0, 1, closing=1e-2)
    marches = [
        march_by_collocation(valley, point, tangent, settings)
        for valley in (ValleyProblem(problem), OneByOne(problem))
    ]
    assert ValleyProblem(problem).node_corrector() is not None
    assert len(marches[0].pieces) == len(marches[1].pieces) == 1
    # points are known to rounding over the smallest regular singular value, about 0.1
    assert marches[0].radii == pytest.approx(marches[1].radii, abs=1e-13)
    x = np.linspace(-1.0, 1.0, 7)
    places = [points_on_piece(march.pieces[0], x) for march in marches]
    assert places[0] == pytest.approx(places[1], abs=1e-13)


def nodes_from(point, heading, width, most=1e-6):
    """Nodes of a piece of which each point is predicted by the one before it."""
    predictors = np.eye(5, k=-1)
    return CurveNodes(point, heading, np.linspace(0, width, 5), predictors, 1e-15, most)


def test_where_a_point_cannot_be_corrected_there_are_none():
    problem = nearly_bennett()
    point, tangent = on_the_valley(problem, [0.4, 2.4, -0.4, -2.4])
    correct = problem.valley_corrector()
    assert correct(nodes_from(point, tangent, 0.1)).shape == (5, 4)
    assert correct(nodes_from(point, tangent, 0.1, most=0.0)) is None
    assert correct(nodes_from(point * np.nan, tangent, 0.1)) is None
    with pytest.raises(ValueError, match="do not fit each other"):
        correct(nodes_from(point[:3], tangent, 0.1))


def test_points_of_a_noisy_problem_have_errors_too():
    problem = nearly_bennett()
    point, tangent = on_the_valley(problem, [0.4, 2.4, -0.4, -2.4])
    nodes = nodes_from(point, tangent, 0.1)
    exact = problem.valley_corrector()(nodes)
    noisy = with_rounding_noise(problem, 1).valley_corrector()(nodes)
    assert 0.0 < np.abs(noisy - exact).max() < 1e-14


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
