"""Curves up to where F or F' is not finite: nothing is claimed there, and no search ends
in an error of linear algebra."""

import warnings

import numpy as np
import pytest

from bifurc import FunctionProblem, explore
from bifurc.errors import ProblemError
from bifurc.numerics.singular_values import factors_of, singular_values
from bifurc.system import hessian_at
from tests.samples import one_in

# name: equations, bounds, number of forms
CURVES = {
    "Hill's function times x": (
        lambda u: [u[0] ** 2.5 / (1 + u[0] ** 2.5) - u[1] * u[0]],
        [(0, 5), (0, 2)],
        2,
    ),
    "x^1.5": (lambda u: [u[1] - u[0] ** 1.5], [(0, 1)] * 2, 1),
    "x sqrt(x)": (lambda u: [u[1] - u[0] * np.sqrt(u[0])], [(-1, 1)] * 2, 1),
    "a kink": (lambda u: [u[1] - np.sqrt(u[0] ** 2)], [(-1, 1)] * 2, 2),
    "a cone": (
        lambda u: [np.hypot(u[0], u[1]) - u[2], u[0] - 2 * u[1]],
        [(-1, 1)] * 3,
        2,
    ),
    "sqrt(x) + sqrt(y)": (
        lambda u: [np.sqrt(u[0]) + np.sqrt(u[1]) - 1],
        [(-1, 2)] * 2,
        1,
    ),
    "a quotient of overflows": (
        lambda u: [np.exp(u[0]) / (1 + np.exp(u[0])) - u[1]],
        [(-1000, 1000), (-1, 2)],
        1,
    ),
    "two forms that meet at a rim": (
        lambda u: [u[0] * np.sqrt(u[0]) - u[1] * u[0]],
        [(0, 1)] * 2,
        2,
    ),
}


@pytest.mark.parametrize("seed", one_in(3, range(3)))
@pytest.mark.parametrize("name", CURVES)
def test_a_curve_is_followed_up_to_a_rim(name: str, seed: int) -> None:
    function, bounds, forms = CURVES[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        atlas = explore(FunctionProblem(function, bounds), seed=seed)
    assert len(atlas.forms) == forms


@pytest.mark.parametrize("is_recorded", [True, False])
def test_the_statement_says_that_the_derivative_is_not_finite(is_recorded) -> None:
    root = FunctionProblem(
        lambda u: [np.sqrt(u[0]) * (1.0 + u[0]) - u[1]],
        [(-1, 4), (-3, 3)],
        is_recorded=is_recorded,
    )
    statement = explore(root).completeness.statement
    assert "F' is not finite beside 1 of them" in statement


@pytest.mark.parametrize("seed", one_in(3, range(3)))
@pytest.mark.parametrize("width", [1.0, 1e-3])
def test_a_sigmoid_is_smooth_where_exp_overflows(width: float, seed: int) -> None:
    bound = 1000 * width
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        problem = FunctionProblem(
            lambda u: [1 / (1 + np.exp(-u[0] / width)) - u[1]],
            [(-bound, bound), (-1, 2)],
        )
        [form] = explore(problem, seed=seed).forms
    ends = form.branch(np.array([0.0, form.branch.length]))
    assert np.sort(ends[:, 0]) == pytest.approx([-bound, bound], rel=1e-12)


def test_what_overflows_has_no_derivatives_left() -> None:
    def sigmoids(u):
        (x,) = u
        growth = np.exp(-x)
        return [
            1 / (1 + growth),
            1 / (growth * growth),
            np.arctan(np.sinh(x)),
            np.tanh(np.cosh(x) ** 3),
        ]

    problem = FunctionProblem(sigmoids, [(-1, 1)])
    far = np.array([-1000.0])
    assert np.all(problem.jacobians(far) == 0.0)
    assert np.all(hessian_at(problem, far) == 0.0)


def test_a_pole_is_no_overflow() -> None:
    parallel = FunctionProblem(lambda u: [1 / (1 / u[0] + 1 / u[1])], [(-1, 1)] * 2)
    assert not np.isfinite(parallel.jacobians(np.array([0.0, 0.5]))).all()


def test_a_function_that_is_defined_on_little_of_its_bounds_is_taken() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        problem = FunctionProblem(
            lambda u: [np.log(1 - u[0] ** 2 - u[1] ** 2) + u[0]], [(-2, 2)] * 2
        )
        [form] = explore(problem).forms
    assert form.branch.closed


def test_a_function_that_is_nowhere_defined_is_refused() -> None:
    with pytest.raises(ProblemError, match="at none of 2000 random points"):
        FunctionProblem(lambda u: [np.log(-1 - u[0] ** 2) + u[1]], [(-2, 2)] * 2)


def test_a_matrix_that_is_not_finite_has_infinite_singular_values() -> None:
    matrices = np.array([[[3.0, 0.0], [0.0, 4.0]], [[np.nan, 0.0], [0.0, 1.0]]])
    factors = factors_of(matrices)
    assert factors.sigma.tolist() == [[4.0, 3.0], [np.inf, np.inf]]
    root = FunctionProblem(lambda u: [np.sqrt(u[0]) - u[1]], [(-1, 4), (-3, 3)])
    values = singular_values(root, np.array([[0.0, 1.0], [1.0, 1.0]]))
    assert np.isinf(values[0]).all()
    assert np.isfinite(values[1]).all()
