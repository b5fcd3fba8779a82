"""Curves of many unknowns: folds, crossings and near misses against what is known of
them by other means."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.sparse import csr_array, eye_array
from scipy.sparse.linalg import LinearOperator, splu

import bifurc
from bifurc import Kind, LargeProblem, LargeSettings, trace_large_branch
from bifurc.branch import Outcome
from bifurc.settings import TraceSettings
from studies.methods.fields import (
    FOLD_IN_1D,
    SwiftHohenberg,
    bratu_field,
    fast_poisson,
)

AROUND_THE_FOLD = LargeSettings(
    tracing=TraceSettings(
        order=6, tolerance=1e-6, shortest=1e-7, longest=1.0, max_length=3.8
    )
)


def fold_of(case, **options):
    problem = LargeProblem(
        case.residual, case.n, (0.0, 8.0), jacobian=case.jacobian, **options
    )
    branch = trace_large_branch(problem, np.zeros(case.n), settings=AROUND_THE_FOLD)
    (fold,) = branch.folds
    return branch, fold


def fold_by_fsolve(case, fold):
    """Moore and Spence's system F = 0, F_u v = 0, |v| = 1 solved by MINPACK."""
    m = case.n - 1

    def extended(z):
        x, v = z[: m + 1], z[m + 1 :]
        square = case.jacobian(x)[:, :m]
        return np.concatenate([case.residual(x), square @ v, [v @ v - 1.0]])

    v = np.linalg.svd(case.jacobian(fold.u)[:, :m].toarray())[2][-1]
    solution = fsolve(extended, np.concatenate([1.001 * fold.u, v]), xtol=1e-13)
    return solution[m]


def test_the_fold_is_that_of_the_extended_system() -> None:
    case = bratu_field(25, 1)
    branch, fold = fold_of(case)
    assert fold.parameter == pytest.approx(fold_by_fsolve(case, fold), abs=1e-10)
    assert fold.gap < 1e-11
    assert fold.bend < 0.0
    assert branch.outcome is Outcome.STEP_LIMIT
    assert branch.parameters(np.array([fold.s])) == pytest.approx(fold.parameter)


def test_folds_go_to_that_of_the_equation_with_the_square_of_the_step() -> None:
    errors = [
        fold_of(bratu_field(k, 1))[1].parameter - FOLD_IN_1D for k in (19, 39, 79)
    ]
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.02)
    assert errors[1] / errors[2] == pytest.approx(4.0, abs=0.01)
    richardson = errors[2] + (errors[2] - errors[1]) / 3.0
    assert abs(richardson) < 1e-7


def test_a_solver_of_the_user_leads_to_the_same_fold() -> None:
    case = bratu_field(31, 2)
    _, direct = fold_of(case)
    poisson = fast_poisson(31)
    _, by_solver = fold_of(case, solver=lambda u: poisson)
    assert by_solver.parameter == pytest.approx(direct.parameter, abs=1e-9)
    assert np.allclose(by_solver.u, direct.u, atol=1e-5)


def test_an_exact_solver_may_be_singular_at_the_fold() -> None:
    case = bratu_field(40, 1)

    def solver(u):
        factors = splu(case.jacobian(u)[:, :-1].tocsc())
        shape = (case.n - 1, case.n - 1)
        return LinearOperator(
            shape,
            matvec=factors.solve,
            rmatvec=lambda x: factors.solve(x, trans="T"),
            dtype=float,
        )

    assert fold_of(case, solver=solver)[1].parameter == pytest.approx(
        fold_of(case)[1].parameter, abs=1e-10
    )


# --- Swift and Hohenberg's equation ---------------------------------------------------


def swift_hohenberg(points=60, constant=0.0):
    return SwiftHohenberg(points, 3 * np.pi, constant)


def problem_of(case):
    return LargeProblem(case.residual, case.n, (-0.5, 1.0), pattern=case.pattern)


def trivial(case):
    start = np.zeros(case.n)
    start[-1] = -0.4
    return start


LOOKING = LargeSettings(values=3)


def test_the_trivial_branch_is_crossed_at_the_eigenvalues_of_the_linear_part() -> None:
    case = swift_hohenberg()
    branch = trace_large_branch(problem_of(case), trivial(case), settings=LOOKING)
    eigenvalues = np.linalg.eigvalsh(case.linear.toarray())
    expected = eigenvalues[eigenvalues < 1.0]
    assert len(expected) == 4
    crossings = [point.parameter for point in branch.crossings]
    assert crossings == pytest.approx(sorted(expected), abs=1e-8)
    assert branch.points == branch.crossings


def test_a_matrix_that_is_exactly_singular_stops_nothing() -> None:
    def two_lines(x):
        return x[-1] * x[:-1]

    problem = LargeProblem(two_lines, 5, (-1.0, 1.0), pattern=eye_array(4))
    branch = trace_large_branch(problem, np.zeros(5))
    assert branch.outcome is Outcome.LEFT_REGION
    assert branch.parameters(np.array([branch.length])) == pytest.approx(1.0)


def test_a_direction_at_a_crossing_leads_onto_the_other_branch() -> None:
    case = swift_hohenberg()
    branch = trace_large_branch(problem_of(case), trivial(case), settings=LOOKING)
    first = branch.crossings[0]
    own, other = first.directions
    assert abs(own[-1]) > 0.1 and np.linalg.norm(own[:-1]) < 1e-6
    waves = trace_large_branch(problem_of(case), first.u + 0.1 * other, other)
    end = waves(waves.length)
    assert waves.outcome is Outcome.LEFT_REGION
    assert end[-1] == pytest.approx(1.0)
    assert np.abs(end[:-1]).max() > 0.5
    assert np.abs(case.residual(end)).max() < 1e-6


def test_an_imperfect_crossing_is_a_near_miss_with_its_gap() -> None:
    case = swift_hohenberg(constant=1e-3)
    branch = trace_large_branch(problem_of(case), trivial(case), settings=LOOKING)
    assert not branch.crossings
    assert branch.near_misses
    nearest = branch.near_misses[0]
    jacobian = problem_of(case).jacobian(nearest.u).toarray()
    assert nearest.gap > 1e-3
    assert np.linalg.svd(jacobian)[1][-1] > 0.0


def test_singular_values_are_those_of_the_dense_matrix() -> None:
    case = swift_hohenberg(40)
    problem = problem_of(case)
    branch = trace_large_branch(problem, trivial(case), settings=LOOKING)
    sizes = branch.units.sizes / np.sqrt(case.n - 1)
    ratios = []
    for s, values in zip(branch.places[::5], branch.values[::5], strict=True):
        dense = problem.jacobian(branch(s)).toarray() * sizes
        expected = np.linalg.svd(dense, compute_uv=False)[::-1][: len(values)]
        ratios.append(values / expected)
    assert np.ptp(ratios) < 1e-5 * np.max(ratios)


# --- what is refused ------------------------------------------------------------------


def test_what_a_solver_gives_is_checked() -> None:
    case = bratu_field(20, 1)

    def problem(solution):
        return LargeProblem(
            case.residual,
            case.n,
            (0.0, 8.0),
            jacobian=case.jacobian,
            solver=lambda u: lambda right: solution,
        )

    start = np.zeros(case.n)
    with pytest.raises(bifurc.ProblemError, match="solution by the solver: nan"):
        trace_large_branch(problem(np.full(20, np.nan)), start)
    with pytest.raises(bifurc.ProblemError, match="shape of a solution by the solver"):
        trace_large_branch(problem(np.ones(19)), start)


def test_a_solver_that_solves_something_else_is_named() -> None:
    case = bratu_field(200, 1)
    problem = LargeProblem(
        case.residual,
        case.n,
        (0.0, 8.0),
        jacobian=case.jacobian,
        solver=lambda u: lambda right: right,
    )
    with pytest.raises(bifurc.ProblemError, match="error of a linear system"):
        trace_large_branch(problem, np.zeros(case.n))


def test_a_linear_operator_of_another_size_is_refused() -> None:
    case = bratu_field(20, 1)
    problem = LargeProblem(
        case.residual,
        case.n,
        (0.0, 8.0),
        jacobian=case.jacobian,
        solver=lambda u: LinearOperator((19, 19), matvec=lambda x: x, dtype=float),
    )
    with pytest.raises(bifurc.ProblemError, match=r"shape of the solver: \(19, 19\)"):
        trace_large_branch(problem, np.zeros(case.n))


def test_a_start_and_a_direction_are_checked() -> None:
    case = bratu_field(10, 1)
    problem = LargeProblem(case.residual, case.n, (0.0, 8.0), jacobian=case.jacobian)
    with pytest.raises(bifurc.ProblemError, match="shape of the start"):
        trace_large_branch(problem, np.zeros(10))
    with pytest.raises(bifurc.ProblemError, match="start: nan"):
        trace_large_branch(problem, np.full(11, np.nan))
    with pytest.raises(bifurc.ProblemError, match="direction"):
        trace_large_branch(problem, np.zeros(11), np.zeros(11))
    outside = np.append(np.zeros(10), -0.5)
    with pytest.raises(
        bifurc.ProblemError, match=r"parameter of the start: -0\.5 .* 0"
    ):
        trace_large_branch(problem, outside)
    with pytest.raises(bifurc.ProblemError, match="values: -1"):
        LargeSettings(values=-1)


def test_a_start_far_from_all_solutions_is_refused_with_how_far_it_is() -> None:
    case = bratu_field(10, 1)
    problem = LargeProblem(
        lambda x: case.residual(x) + 1e3 * (1.0 + x[:-1] ** 2),
        case.n,
        (0.0, 8.0),
        pattern=case.jacobian(np.zeros(11)),
    )
    with pytest.raises(bifurc.ProblemError, match=r"residual of the start: \d.* 1e-12"):
        trace_large_branch(problem, np.zeros(11))


def test_a_start_at_which_the_derivative_vanishes_is_refused() -> None:
    n = 300
    no_solution = LargeProblem(
        lambda x: x[:-1] ** 2 + 1 + x[-1] ** 2, n, (0.0, 1.0), pattern=eye_array(n - 1)
    )
    with pytest.raises(bifurc.ProblemError, match="residual of the start"):
        trace_large_branch(no_solution, np.zeros(n))


def test_singular_values_that_vanish_to_the_last_bit_are_no_overflow(capfd) -> None:
    n = 60
    zeros = np.arange(1, n) * 1.0
    touching = LargeProblem(
        lambda x: (x[-1] - zeros) ** 2 * x[:-1] - x[:-1] ** 3,
        n,
        (0.0, 4.5),
        pattern=eye_array(n - 1),
    )
    start = np.zeros(n)
    start[-1] = 0.5
    branch = trace_large_branch(touching, start, settings=LargeSettings(values=4))
    assert branch.outcome is Outcome.LEFT_REGION
    places = sorted(point.u[-1] for point in branch.points)
    assert places == pytest.approx([1.0, 2.0, 3.0, 4.0], abs=1e-3)
    assert not any(capfd.readouterr())


# --- units ----------------------------------------------------------------------------


@pytest.mark.parametrize("size, weight", [(1e-6, 1.0), (1e6, 1e9), (1.0, 1e-9)])
def test_neither_the_size_of_the_field_nor_of_the_equations_counts(
    size: float, weight: float
) -> None:
    case = bratu_field(20, 1)

    def restated(x):
        return weight * case.residual(np.append(x[:-1] / size, x[-1]))

    problem = LargeProblem(
        restated, case.n, (0.0, 8.0), pattern=case.laplacian, size=size
    )
    branch = trace_large_branch(problem, np.zeros(case.n), settings=AROUND_THE_FOLD)
    expected, fold = fold_of(case)
    assert len(branch.branch.pieces) == len(expected.branch.pieces)
    assert branch.folds[0].parameter == pytest.approx(fold.parameter, abs=1e-11)
    assert branch.folds[0].bend == pytest.approx(fold.bend, rel=1e-5)


@pytest.mark.parametrize("size", [1e3, 1e6])
def test_a_size_that_is_far_too_large_does_not_count(size: float) -> None:
    case = bratu_field(15, 1)
    branch, fold = fold_of(case, size=size)
    assert branch.outcome is Outcome.STEP_LIMIT
    assert fold.parameter == pytest.approx(fold_of(case)[1].parameter, abs=1e-10)


def test_singular_values_by_a_solver_are_those_of_the_factors() -> None:
    case = bratu_field(15, 2)
    tracing = replace(AROUND_THE_FOLD.tracing, longest=0.4, max_length=0.5)
    settings = LargeSettings(tracing=tracing, values=2, places=1)
    poisson = fast_poisson(15)
    values = []
    operator = LinearOperator((225, 225), matvec=poisson, dtype=float)
    for solver in (None, lambda u: poisson, lambda u: operator):
        problem = LargeProblem(
            case.residual, case.n, (0.0, 8.0), jacobian=case.jacobian, solver=solver
        )
        start = np.zeros(case.n)
        values.append(trace_large_branch(problem, start, settings=settings).values)
    assert values[0].shape[1] == 2
    assert np.allclose(values[0], values[1], rtol=1e-5)
    assert np.allclose(values[0], values[2], rtol=1e-5)


# --- starts of every kind -------------------------------------------------------------


def pitchfork(x):
    return np.array([x[1] * x[0] - x[0] ** 3])


def cubic(x):
    return np.array([x[0] ** 3 - x[0] - x[1]])


WHOLE = LargeSettings(
    tracing=replace(AROUND_THE_FOLD.tracing, max_length=20.0), values=2, both_ways=True
)


@pytest.mark.parametrize("parameter", [-1.0, 0.0, 1e-9, 1e-3, 0.1])
def test_a_crossing_is_seen_from_any_start_itself_among_them(parameter: float) -> None:
    problem = LargeProblem(pitchfork, 2, (-1.0, 1.5))
    branch = trace_large_branch(problem, [0.0, parameter], settings=WHOLE)
    assert [point.kind for point in branch.points] == [Kind.CROSSING]
    assert np.abs(branch.crossings[0].u).max() < 1e-12
    assert np.all(np.isfinite(branch.values))


@pytest.mark.parametrize("angle", [0.0, 1.0, np.pi / 2])
def test_a_circle_closes_from_any_start_folds_among_them(angle: float) -> None:
    problem = LargeProblem(lambda x: np.array([x @ x - 1.0]), 2, (-3.0, 3.0))
    start = [np.cos(angle), np.sin(angle)]
    branch = trace_large_branch(problem, start, settings=WHOLE)
    assert branch.outcome is Outcome.CLOSED
    assert sorted(fold.parameter for fold in branch.folds) == pytest.approx([-1.0, 1.0])
    assert len(branch.branch.pieces) < 50


@pytest.mark.parametrize("guess", [0.8, 0.9, 1.2])
def test_a_guess_on_the_bounds_is_corrected_within_them(guess: float) -> None:
    problem = LargeProblem(cubic, 2, (-0.2, 1.0))
    branch = trace_large_branch(problem, [guess, -0.2])
    assert branch.outcome is Outcome.LEFT_REGION
    assert branch.parameters(np.array([branch.length])) == pytest.approx([1.0])
    assert branch.length > 3.9


@pytest.mark.parametrize("shift", [1e4, -1e6, 1e6])
def test_a_parameter_far_from_0_within_narrow_bounds_counts_as_any(
    shift: float,
) -> None:
    def shifted(x):
        return cubic([x[0], x[1] - shift])

    bounds = (shift - 2.0, shift + 2.0)
    square = LargeProblem(
        shifted, 2, bounds, jacobian=lambda x: csr_array([[3 * x[0] ** 2 - 1]])
    )
    for problem in (LargeProblem(shifted, 2, bounds), square):
        branch = trace_large_branch(problem, [-1.5, shift - 1.8], settings=WHOLE)
        folds = [fold.parameter - shift for fold in branch.folds]
        assert folds == pytest.approx([2 / 27**0.5, -2 / 27**0.5], abs=1e-9)


def test_a_jacobian_that_is_wrong_only_beyond_the_start_is_named() -> None:
    case = bratu_field(100, 1)

    def without_growth(x):
        # right at u = 0 alone
        return case.jacobian(np.append(np.zeros(case.n - 1), x[-1]))

    problem = LargeProblem(case.residual, case.n, (0.0, 8.0), jacobian=without_growth)
    with pytest.raises(bifurc.ProblemError, match=r"row \d+ of the jacobian with the"):
        trace_large_branch(problem, np.zeros(case.n), settings=AROUND_THE_FOLD)
