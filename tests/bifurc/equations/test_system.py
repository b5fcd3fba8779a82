"""The compiled methods on recorded equations: scales, domains, sparse matrices."""

import numpy as np
import pytest
from scipy.sparse import issparse

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.function_problem import FunctionProblem
from bifurc.settings import TraceSettings
from bifurc.system import Anchor, MarchSettings, MarchStatus, jacobian_at, relative_gaps
from tests.bifurc.known_curves import Bratu


def circle(size, weight):
    return FunctionProblem(
        lambda u: [weight * (u @ u - size**2)], [(-2 * size, 2 * size)] * 2
    )


@pytest.mark.parametrize("size", [1e-6, 0.3, 1.0, 1e5])
@pytest.mark.parametrize("weight", [1e-8, 1.0, 1e8])
def test_a_march_does_not_depend_on_the_units(size, weight):
    problem = circle(size, weight)
    settings = MarchSettings(16, 1e-13, 1e-9 * size, 2 * size, 20, closing=1e-3)
    start, tangent = np.array([size, 0.0]), np.array([0.0, 1.0])
    march = problem.march(start, tangent, settings)
    assert march.status is MarchStatus.RAN
    # pieces are known to 1e-13 of the size
    for piece in march.pieces:
        points = np.vander(np.linspace(-1, 1, 21), 17, increasing=True) @ piece
        assert np.linalg.norm(points, axis=1) == pytest.approx(size, rel=3e-13)
    assert len(march.pieces) == len(
        circle(1.0, 1.0)
        .march(
            start / size,
            tangent,
            MarchSettings(16, 1e-13, 1e-9, 2.0, 20, closing=1e-3),
        )
        .pieces
    )


def test_projections_reach_solutions_and_state_what_is_left():
    problem = circle(3.0, 50.0)
    starts = np.random.default_rng(0).uniform(-6, 6, (40, 2))
    points, gaps = problem.project(starts)
    assert np.linalg.norm(points, axis=1) == pytest.approx(3.0, abs=1e-13)
    assert gaps == pytest.approx(relative_gaps(problem, points), abs=1e-15)
    center = np.array([3.0, 0.0])
    on_sphere = problem.project_to_sphere(center + 0.1 * starts, center, 0.5)
    distances = np.linalg.norm(on_sphere.points - center, axis=1)
    assert distances == pytest.approx(0.5, abs=1e-12)
    assert np.linalg.norm(on_sphere.points, axis=1) == pytest.approx(3.0, abs=1e-12)


def test_where_the_equations_are_not_defined_there_is_no_solution():
    problem = FunctionProblem(lambda u: [np.log(u[0]) - u[1]], [(-1.0, 3.0)] * 2)
    points, gaps = problem.project(np.array([[-0.5, 0.0], [0.5, 0.0]]))
    assert gaps[0] == np.inf
    assert gaps[1] < 1e-15
    branch = trace_branch(problem, points[1])
    assert branch.outcome is Outcome.LEFT_REGION
    assert branch.residuals.max() < 1e-12
    assert (
        problem.march(
            np.array([-0.5, 0.0]),
            np.array([1.0, 0.0]),
            MarchSettings(16, 1e-13, 1e-9, 1, 5),
        ).status
        is MarchStatus.OPEN
    )


def test_a_march_with_an_anchor_ends_where_the_bounds_are_left():
    problem = FunctionProblem(
        lambda u: [u[1] - np.exp(u[0])], [(-1.0, 1.0), (0.0, 5.0)]
    )
    start, tangent = np.array([0.0, 1.0]), np.array([1.0, 1.0]) / np.sqrt(2.0)
    anchor = Anchor(start, tangent, 1e-9)
    settings = MarchSettings(16, 1e-13, 1e-9, 2.0, 50, anchor=anchor)
    march = problem.march(start, tangent, settings)
    assert march.status is MarchStatus.RAN
    assert len(march.pieces) < 20
    inside = march.pieces[:-1].sum(axis=1)
    assert np.all(inside[:, 0] <= 1.0)


def test_many_unknowns_have_a_sparse_jacobian():
    problem = Bratu(150)
    jacobian = jacobian_at(problem, problem.start)
    assert problem.accuracy.derivatives == "recorded"
    assert issparse(jacobian)
    assert jacobian.nnz == 150 + 2 * 149 + 150
    branch = trace_branch(
        problem, problem.start, problem.tangent, TraceSettings(tolerance=1e-8)
    )
    assert branch.outcome is Outcome.LEFT_REGION
    assert branch.residuals.max() < 1e-8


@pytest.mark.parametrize("tolerance", [1e-8, 1e-13])
def test_a_curve_is_exact_where_the_equations_are_far_larger_elsewhere(tolerance):
    # exp(20) within the bounds, 1 and less along the curve
    problem = Bratu(30)
    branch = trace_branch(
        problem, problem.start, problem.tangent, TraceSettings(tolerance=tolerance)
    )
    points = branch.sample(300)
    # rounding over the magnitude, which is 1e5, would be 1e-10
    assert np.abs(problem.residuals(points)).max() < 2 * tolerance + 5e-12


def test_a_curve_starts_where_rounding_is_far_more_than_at_most_solutions():
    flat = FunctionProblem(
        lambda u: [(u[1] ** 2 - u[0] ** 8) * (u[1] - 0.05)], [(-1, 1)] * 2
    )
    places = np.linspace(0.85, 0.999, 400)
    tangent = np.array([1.0, 4.0]) / np.sqrt(17.0)
    settings = MarchSettings(16, 1e-13, 1e-9, 2.0, 1, closing=1e-12)
    for x in places:
        march = flat.march(np.array([x, x**4]), tangent, settings)
        assert len(march.pieces) == 1
