"""What every problem offers, and the records that it answers with."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from bifurc.system import March, MarchSettings, MarchStatus, Piece, relative_gaps

BOX = [(-2.0, 2.0), (-2.0, 2.0)]


def circle(u):
    return np.array([u[0] ** 2 + u[1] ** 2 - 1.0])


def wave(u):
    return np.array([np.sin(u[0]) - u[1]])


def test_differences_are_taken_modulo_the_periods_and_only_of_periodic_unknowns():
    problem = FunctionProblem(wave, BOX, periods=[2 * np.pi, np.inf])
    gap = problem.domain.difference(np.array([3.0, 3.0]), np.array([-3.0, -3.0]))
    assert gap == pytest.approx([6.0 - 2 * np.pi, 6.0])


@pytest.mark.parametrize("point", [np.zeros(3), np.zeros((1, 2)), 0.0])
def test_a_point_of_the_wrong_shape_is_refused(point):
    with pytest.raises(ProblemError, match=r"shape of start.*\(2,\)"):
        trace_branch(FunctionProblem(circle, BOX), point)


def test_a_point_that_is_not_finite_is_refused():
    with pytest.raises(ProblemError, match=r"start.*finite"):
        trace_branch(FunctionProblem(circle, BOX), [0.0, np.nan])


def test_gaps_are_residuals_over_the_magnitude():
    problem = FunctionProblem(lambda u: 1e3 * circle(u), BOX)
    gaps = relative_gaps(problem, np.array([[2.0, 0.0], [0.6, 0.8]]))
    assert gaps == pytest.approx([3e3 / problem.magnitude, 0.0], abs=1e-15)


def test_pieces_that_lie_end_to_end_make_a_march():
    pieces = [Piece(np.zeros((4, 2)), length, 1e-14) for length in (0.5, 1.0, 0.25)]
    march = March.of_pieces(MarchStatus.RAN, pieces, order=3, n=2)
    assert march.pieces.shape == (3, 4, 2)
    # from the start to the first centre, then from centre to centre
    assert march.steps.tolist() == [0.25, 0.75, 0.625]
    assert march.radii.tolist() == [0.25, 0.5, 0.125]


def test_a_march_without_a_solution_keeps_the_gap_at_its_start():
    march = March.without_solution(0.3, order=3, n=2)
    assert march.status is MarchStatus.OPEN
    assert march.pieces.shape == (0, 4, 2)
    assert march.steps.shape == march.radii.shape == (0,)
    assert march.residuals.tolist() == [0.3]


def test_a_march_is_shown_in_one_line():
    settings = MarchSettings(12, tolerance=1e-12, shortest=1e-9, longest=1.0, count=2)
    problem = FunctionProblem(circle, BOX)
    march = problem.march(np.array([1.0, 0.0]), np.array([0.0, 1.0]), settings)
    assert repr(march).startswith("<March RAN: 2 pieces of order 12 in 2 unknowns")
    assert "\n" not in repr(march)
