"""The study of many unknowns: its fold against an independent one, its limits."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.sparse import csc_array, vstack
from scipy.sparse.linalg import splu

from studies.many_unknowns import cost_of_fold, crossing_errors, richardson
from studies.methods.fields import FOLD_IN_1D, FOLD_IN_2D, bratu_field


def largest_parameter(side):
    """The largest p over the height in the middle, each solved by Newton's method."""
    field = bratu_field(side, 2)
    row = np.zeros(field.n)
    row[side * side // 2] = 1.0
    solution = np.zeros(field.n)

    def parameter(height):
        for _ in range(12):
            left = np.append(field.residual(solution), row @ solution - height)
            matrix = vstack([field.jacobian(solution), csc_array(row[None])])
            solution[:] -= splu(matrix.tocsc()).solve(left)
        return -solution[-1]

    options = {"xatol": 1e-6}
    found = minimize_scalar(
        parameter, bounds=(1.0, 1.8), method="bounded", options=options
    )
    return -found.fun


def test_the_fold_in_two_dimensions_is_the_largest_parameter() -> None:
    expected = largest_parameter(15)
    for solver in ("sparse LU", "fast Poisson"):
        cost = cost_of_fold(15, 2, solver)
        assert cost.parameter == pytest.approx(expected, abs=1e-9)
        assert cost.gap < 1e-12


def test_extrapolated_folds_are_those_of_the_equations() -> None:
    line = [cost_of_fold(side, 1, "sparse LU") for side in (19, 39, 79)]
    assert richardson(line)[-1] == pytest.approx(FOLD_IN_1D, abs=1e-7)
    square = [cost_of_fold(side, 2, "fast Poisson") for side in (15, 31)]
    assert richardson(square)[-1] == pytest.approx(FOLD_IN_2D, abs=3e-5)


def test_crossings_of_swift_and_hohenberg_are_the_known_ones() -> None:
    errors, _ = crossing_errors(100)
    assert len(errors) == 6
    assert np.abs(errors).max() < 1e-9
