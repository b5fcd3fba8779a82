"""What a user says of a large problem: derivatives, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, eye_array

from bifurc import LargeProblem, ProblemError
from bifurc.large.large_problem import column_groups
from studies.methods.fields import bratu_field


def sliced_bratu(x):
    """Bratu's problem in one dimension without a matrix, so that it can be recorded."""
    u = x[:-1]
    inner = np.concatenate([[0.0], u, [0.0]])
    second = (inner[2:] - 2.0 * inner[1:-1] + inner[:-2]) * (len(u) + 1) ** 2
    return second + x[-1] * np.exp(u)


def test_derivatives_are_the_same_however_they_are_made() -> None:
    case = bratu_field(30, 1)
    point = np.linspace(0.1, 1.3, 31)
    expected = case.jacobian(point).toarray()
    square = case.laplacian
    ways = {
        "given": {"jacobian": case.jacobian},
        "recorded": {},
        "complex step in 4 groups of columns": {"pattern": square},
    }
    for derivatives, options in ways.items():
        function = case.residual if options else sliced_bratu
        problem = LargeProblem(function, 31, (0.0, 8.0), **options)
        assert problem.derivatives == derivatives
        made = problem.jacobian(point).toarray()
        assert np.allclose(made, expected, rtol=1e-14, atol=1e-12)


def test_the_column_of_the_parameter_may_be_left_out() -> None:
    case = bratu_field(30, 1)
    problem = LargeProblem(
        case.residual, 31, (0.0, 8.0), jacobian=lambda x: case.jacobian(x)[:, :-1]
    )
    point = np.linspace(0.1, 1.3, 31)
    expected = case.jacobian(point).toarray()
    assert np.allclose(problem.jacobian(point).toarray(), expected, rtol=1e-8)


def test_a_function_that_drops_imaginary_parts_is_differenced() -> None:
    case = bratu_field(30, 1)
    problem = LargeProblem(
        lambda x: case.residual(np.real(x)), 31, (0.0, 8.0), pattern=case.laplacian
    )
    assert problem.derivatives == "central differences in 4 groups of columns"
    point = np.linspace(0.1, 1.3, 31)
    made = problem.jacobian(point).toarray()
    assert np.allclose(made, case.jacobian(point).toarray(), atol=1e-4)


@pytest.mark.parametrize("dimensions", [1, 2])
def test_columns_of_a_group_share_no_row(dimensions: int) -> None:
    pattern = bratu_field(12, dimensions).jacobian(np.zeros(12**dimensions + 1))
    groups = column_groups(pattern)
    incidence = np.zeros((len(groups), groups.max() + 1))
    incidence[np.arange(len(groups)), groups] = 1.0
    assert ((abs(pattern) > 0.0).astype(float) @ incidence).max() == 1.0
    assert groups.max() + 1 <= 10


def test_unknowns_of_very_different_sizes_are_differenced_each_by_its_own() -> None:
    def real(x):
        values = x[0] ** 3 - x[2], x[1] / 1e6 - x[0] ** 2
        return np.array([float(np.real(value)) for value in values])

    pattern = csr_array(np.array([[1, 0, 1], [1, 1, 0]]))
    problem = LargeProblem(real, 3, (-2.0, 2.0), pattern=pattern)
    assert problem.derivatives == "central differences in 2 groups of columns"
    point = np.array([1.5, 2e6, 0.3])
    expected = [[3 * 1.5**2, 0.0, -1.0], [-3.0, 1e-6, 0.0]]
    np.testing.assert_allclose(problem.jacobian(point).toarray(), expected, rtol=1e-8)


def test_entries_that_a_pattern_leaves_out_are_named() -> None:
    def function(x):
        return np.array([x[0] ** 3 - x[0] - x[2] + x[1], x[1] - x[0] ** 2])

    pattern = csr_array(np.array([[1, 0, 1], [1, 1, 0]]))
    problem = LargeProblem(function, 3, (-2.0, 2.0), pattern=pattern)
    with pytest.raises(ProblemError, match="product of row 0"):
        problem.check_start([-1.0, 1.0, 1.0])


def test_matrices_of_another_size_or_kind_are_named() -> None:
    case = bratu_field(10, 1)

    def start_of(**options):
        return LargeProblem(case.residual, 11, (0.0, 8.0), **options).check_start(
            np.zeros(11)
        )

    with pytest.raises(ProblemError, match=r"shape of the pattern: \(9, 9\)"):
        start_of(pattern=eye_array(9))
    with pytest.raises(ProblemError, match=r"shape of the jacobian: \(11, 11\)"):
        start_of(jacobian=lambda x: eye_array(11))
    with pytest.raises(ProblemError, match="type of the jacobian"):
        start_of(jacobian=lambda x: np.eye(10))
    with pytest.raises(ProblemError, match="jacobian: nan"):
        start_of(jacobian=lambda x: np.nan * case.jacobian(x))
    with pytest.raises(ProblemError, match="product of row"):
        start_of(jacobian=lambda x: 2.0 * case.jacobian(x))


def test_arguments_of_another_kind_are_named() -> None:
    case = bratu_field(10, 1)
    with pytest.raises(ProblemError, match="bounds"):
        LargeProblem(case.residual, 11, (3.0, 1.0), jacobian=case.jacobian)
    with pytest.raises(ProblemError, match="bounds"):
        LargeProblem(case.residual, 11, (0.0, np.inf), jacobian=case.jacobian)
    with pytest.raises(ProblemError, match="size: 0"):
        LargeProblem(case.residual, 11, (0.0, 8.0), pattern=case.laplacian, size=0)
    with pytest.raises(ProblemError, match=r"n: 1\.5"):
        LargeProblem(case.residual, 1.5, (0.0, 8.0))  # type: ignore[arg-type]
    problem = LargeProblem(
        lambda x: x[:9], 11, (0.0, 8.0), jacobian=lambda x: csr_array((10, 11))
    )
    with pytest.raises(ProblemError, match="number of equations: 9"):
        problem.check_start(np.zeros(11))


def test_what_is_neither_given_nor_recorded_says_why() -> None:
    case = bratu_field(10, 1)
    with pytest.raises(ProblemError, match="the equations are not recorded, as"):
        LargeProblem(case.residual, 11, (0.0, 8.0))
