"""Recorded equations of many unknowns, factored as the sparse matrices that they are."""

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.equations.system import ScaledTape
from bifurc.function_problem import FunctionProblem
from bifurc.system import jacobian_at

ROWS, COLUMNS = 6, 8  # of a lattice


def lattice(weight=1.0):
    """Unknowns on a lattice: along every row sine and cosine of neighbours are those of
    a shifted angle, and so they are along every column, which is redundant.

    All of a row and of a column is known from its first one: the curve of one freedom
    is u(i, j) = u(0, 0) + 0.1 (i + j).
    """

    def equations(u):
        values = []
        for i in range(ROWS):
            for j in range(COLUMNS):
                here = u[i * COLUMNS + j]
                for beside in _neighbours(i, j):
                    values.append(weight * (np.sin(u[beside]) - np.sin(here + 0.1)))
                    values.append(weight * (np.cos(u[beside]) - np.cos(here + 0.1)))
        return values

    bounds = [(-np.pi, np.pi)] * (ROWS * COLUMNS)
    return FunctionProblem(equations, bounds, periods=[2 * np.pi] * len(bounds))


def _neighbours(i, j):
    if i + 1 < ROWS:
        yield (i + 1) * COLUMNS + j
    if j + 1 < COLUMNS:
        yield i * COLUMNS + j + 1


def on_curve(angle):
    steps = np.add.outer(np.arange(ROWS), np.arange(COLUMNS))
    return angle + 0.1 * steps.ravel()


def scaled_tape(problem):
    return ScaledTape(
        problem.recording.tape,
        problem.magnitude,
        problem.domain.scale,
        problem.domain.bounds,
        problem.domain.periods,
    )


def test_redundant_equations_are_solved_in_the_least_squares_sense():
    problem = lattice()
    scaled = scaled_tape(problem)
    assert scaled.is_factored_sparse
    rng = np.random.default_rng(3)
    point = on_curve(0.4)
    jacobian = jacobian_at(problem, point) / problem.magnitude
    tangent = rng.normal(size=problem.n)
    tangent /= np.linalg.norm(tangent)
    solve = scaled.bordered_solver(point, tangent)
    # one that the equations allow, and one that they do not
    for residual in (
        jacobian @ rng.normal(size=problem.n),
        rng.normal(size=len(jacobian)),
    ):
        expected, *_ = np.linalg.lstsq(jacobian, residual)
        solution = solve(np.append(residual, 0.7))
        left = np.linalg.norm(jacobian @ solution - residual)
        least = np.linalg.norm(jacobian @ expected - residual)
        assert left <= least * (1 + 1e-12) + 1e-12
        assert tangent @ solution == pytest.approx(0.7, abs=1e-12)


def test_the_factors_hold_whatever_entry_of_the_tangent_is_the_largest():
    problem = lattice()
    scaled = scaled_tape(problem)
    point = on_curve(-1.0)
    right = np.zeros(len(jacobian_at(problem, point)) + 1)
    right[-1] = 1.0
    null_vector = np.ones(problem.n) / np.sqrt(problem.n)
    for largest in range(0, problem.n, 7):
        tangent = null_vector.copy()
        tangent[largest] *= 3.0
        tangent /= np.linalg.norm(tangent)
        solution = scaled.bordered_solver(point, tangent)(right)
        expected = null_vector / (tangent @ null_vector)
        assert solution == pytest.approx(expected, abs=1e-13)


def test_where_a_second_singular_value_vanishes_the_matrix_is_left_to_pivoting():
    # two curves cross, of which the lattice is no part
    rest = 60

    def equations(u):
        chain = [u[k + 1] - np.sin(u[k]) for k in range(rest)]
        return [*chain, u[rest + 1] * (u[rest + 1] - u[0])]

    problem = FunctionProblem(equations, [(-1.0, 1.0)] * (rest + 2))
    tangent = np.ones(problem.n) / np.sqrt(problem.n)
    assert scaled_tape(problem).bordered_solver(np.zeros(problem.n), tangent) is None
    # a little way off it is not
    point = np.zeros(problem.n)
    point[-1] = 0.1
    assert scaled_tape(problem).bordered_solver(point, tangent) is not None


@pytest.mark.parametrize("weight", [1.0, 1e-6])
def test_a_curve_of_redundant_sparse_equations_closes_and_is_exact(weight):
    problem = lattice(weight)
    start = on_curve(0.2)
    branch = trace_branch(problem, start)
    assert branch.outcome is Outcome.CLOSED
    assert branch.length == pytest.approx(2 * np.pi * np.sqrt(problem.n), rel=1e-12)
    points = branch.sample(200)
    offsets = points - on_curve(0.0)
    spread = np.ptp(offsets, axis=1)
    assert spread.max() < 1e-11


def test_random_starts_reach_solutions_of_sparse_equations():
    problem = lattice()
    rng = np.random.default_rng(0)
    starts = on_curve(1.0) + 0.3 * rng.normal(size=(5, problem.n))
    points, gaps = problem.project(starts)
    assert gaps.max() < 1e-13
    assert np.ptp(points - on_curve(0.0), axis=1).max() < 1e-11


def test_a_curve_crosses_another_one_in_many_unknowns():
    # x_0 is free, the others follow by a chain; the last one is on one of two curves
    length = 60

    def equations(u):
        chain = [u[k + 1] - np.sin(u[k]) for k in range(length)]
        first, last = u[0], u[length + 1]
        crossing = (last - 0.3 * first) * (last + u[length] + first**2)
        return [*chain, crossing, 2 * crossing + chain[3]]

    problem = FunctionProblem(equations, [(-1.0, 1.0)] * (length + 2))
    chain = [0.5]
    for _ in range(length):
        chain.append(np.sin(chain[-1]))
    for last in (0.15, -chain[-1] - 0.25):
        branch = trace_branch(problem, np.array([*chain, last]))
        assert branch.outcome is Outcome.LEFT_REGION
        points = branch.sample(300)
        first = points[:, 0]
        assert np.ptp(first) > 1.2  # through the crossing at 0
        on_line = np.abs(points[:, -1] - 0.3 * first).max()
        on_curve_beside = np.abs(points[:, -1] + points[:, length] + first**2).max()
        is_on_line = last > 0
        assert (on_line if is_on_line else on_curve_beside) < 1e-12
