"""Many unknowns in small blocks of one freedom each: what the tree over these solves."""

import numpy as np
import pytest

from bifurc.equations.system import ScaledTape
from bifurc.function_problem import FunctionProblem
from bifurc.system import jacobian_at

SIDE = 16  # columns and rows of a lattice with 2 * SIDE * (SIDE + 1) unknowns


def lattice():
    """At every vertex of a lattice four unknowns meet, with three equations that leave
    one freedom: sines of the others are multiples of that of the first, which are the
    same along every row and every column, so that the equations agree."""

    def equations(u):
        values = []
        for i in range(SIDE):
            for j in range(SIDE):
                west, east, south, north = (u[k] for k in _unknowns(i, j))
                ratio = 0.5 + 0.01 * j
                values.append(np.sin(east) - np.sin(west))
                values.append(
                    np.sin(north) - np.sin(south) + np.sin(east) - np.sin(west)
                )
                values.append(np.sin(south) - (ratio / (1 + 0.02 * i)) * np.sin(west))
        return values

    count = 2 * SIDE * (SIDE + 1)
    return FunctionProblem(equations, [(-1.5, 1.5)] * count)


def _unknowns(i, j):
    along, up = j * (SIDE + 1) + i, SIDE * (SIDE + 1) + i * (SIDE + 1) + j
    return along, along + 1, up, up + 1


def on_curve(t):
    point = np.zeros(2 * SIDE * (SIDE + 1))
    for i in range(SIDE):
        for j in range(SIDE):
            west, east, south, north = _unknowns(i, j)
            # along: t / ratio(j); up: t / (1 + 0.02 i)
            point[[west, east]] = np.arcsin(t / (0.5 + 0.01 * j))
            point[[south, north]] = np.arcsin(t / (1 + 0.02 * i))
    return point


@pytest.fixture(scope="module")
def problem():
    return lattice()


def scaled_tape(problem):
    return ScaledTape(problem.recording.tape, problem.magnitude, problem.domain)


def test_what_agrees_is_solved_as_by_dense_least_squares(problem):
    point = on_curve(0.3)
    assert np.abs(problem.residuals(point[None])).max() < 1e-15
    jacobian = jacobian_at(problem, point).toarray() / problem.magnitude
    rng = np.random.default_rng(2)
    tangent = rng.normal(size=problem.n)
    tangent /= np.linalg.norm(tangent)
    wanted = rng.normal(size=problem.n)
    solve = scaled_tape(problem).bordered_solver(point, tangent)
    solution = solve(np.append(jacobian @ wanted, tangent @ wanted))
    # the matrix has full rank with the tangent: the solution is what it was made of
    assert solution == pytest.approx(wanted, abs=1e-11)


def test_its_smallest_singular_value_is_that_of_the_matrix_about(problem):
    for t in (0.1, 0.45):
        point = on_curve(t)
        jacobian = jacobian_at(problem, point).toarray() / problem.magnitude
        exact = np.linalg.svd(jacobian, compute_uv=False)[-2]
        tangent = (on_curve(t + 1e-6) - on_curve(t - 1e-6)) / 2e-6
        tangent /= np.linalg.norm(tangent)
        value = scaled_tape(problem).smallest_value(point, tangent)
        # the tree is no pseudo-inverse: a solution with it is longer, never shorter
        assert 0.02 * exact < value < 1.1 * exact
