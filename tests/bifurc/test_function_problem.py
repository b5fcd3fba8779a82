"""Problems from plain functions: derivatives, checks, magnitudes."""

import copy
import math
import pickle

import mpmath
import numpy as np
import pytest

from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.system import hessian_at

BOX = [(-2.0, 2.0), (-2.0, 2.0)]


def circle(u):
    return np.array([u[0] ** 2 + u[1] ** 2 - 1.0])


def only_real(u):
    """The circle by a function that refuses complex numbers."""
    return np.array([np.hypot(float(u[0]), float(u[1])) - 1.0])


def silently_wrong(u):
    """The circle by a function that drops imaginary parts without a word."""
    return np.array([np.abs(u[0]) ** 2 + np.abs(u[1]) ** 2 - 1.0])


def test_derivatives_are_exact_by_complex_step_where_complex_numbers_pass():
    problem = FunctionProblem(circle, BOX, is_recorded=False)
    assert problem.accuracy.derivatives == "complex step"
    assert problem.jacobians(np.array([[0.3, 0.7]]))[0] == pytest.approx(
        np.array([[0.6, 1.4]]), abs=1e-15
    )


@pytest.mark.parametrize("function", [only_real, silently_wrong])
def test_derivatives_are_central_differences_where_complex_numbers_do_not_pass(
    function,
):
    problem = FunctionProblem(function, BOX)
    assert problem.accuracy.derivatives == "central differences"
    u = np.array([0.6, 0.8])
    expected = u if function is only_real else 2 * u
    # central differences with a step of 1e-5: 1e-10 from the third derivative, 1e-11
    # from rounding
    assert problem.jacobians(u[None])[0, 0] == pytest.approx(expected, abs=1e-9)


def test_a_given_jacobian_is_used():
    problem = FunctionProblem(only_real, BOX, jacobian=lambda u: u[None] / np.hypot(*u))
    assert problem.accuracy.derivatives == "given"
    assert problem.jacobians(np.array([[0.6, 0.8]]))[0, 0] == pytest.approx(
        [0.6, 0.8], abs=1e-15
    )


@pytest.mark.parametrize(("is_recorded", "error"), [(True, 1e-15), (False, 1e-9)])
def test_the_hessian_is_symmetric_and_right(is_recorded, error):
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 3 * u[1], np.sin(u[0] * u[1])]),
        BOX,
        is_recorded=is_recorded,
    )
    x, y = u = np.array([0.7, -0.4])
    s, c = np.sin(x * y), np.cos(x * y)
    expected = np.array(
        [
            [[6 * x * y, 3 * x**2], [3 * x**2, 0.0]],
            [[-y * y * s, c - x * y * s], [c - x * y * s, -x * x * s]],
        ]
    )
    # exact, or central differences of an exact Jacobian with steps of 1e-5: 1e-10
    assert hessian_at(problem, u) == pytest.approx(expected, abs=error)


def test_residuals_relative_to_the_magnitude_do_not_depend_on_the_scale_of_the_equations():
    one, thousand = (
        FunctionProblem(circle, BOX),
        FunctionProblem(lambda u: 1e3 * circle(u), BOX),
    )
    assert thousand.magnitude == pytest.approx(1e3 * one.magnitude)
    u = np.array([[0.2, 0.5]])
    assert thousand.residuals(u) / thousand.magnitude == pytest.approx(
        one.residuals(u) / one.magnitude
    )


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"bounds": [(1.0, -1.0), (0.0, 1.0)]}, "bounds"),
        ({"bounds": [(0.0, 0.0), (0.0, 1.0)]}, "bounds"),
        ({"bounds": [0.0, 1.0]}, "bounds"),
        ({"bounds": [(0.0, 1.0, 2.0), (0.0, 1.0, 2.0)]}, "bounds"),
        ({"bounds": [(np.nan, 1.0), (0.0, 1.0)]}, "bounds"),
        ({"bounds": BOX, "names": ["x"]}, "number of names"),
        ({"bounds": BOX, "units": ["m", "m", "m"]}, "number of units"),
        ({"bounds": BOX, "periods": [1.0]}, "number of periods"),
        ({"bounds": BOX, "periods": [0.0, 1.0]}, "periods"),
        ({"bounds": BOX, "periods": [-1.0, 1.0]}, "periods"),
    ],
)
def test_a_bad_argument_is_named_with_its_value_and_what_is_allowed(arguments, name):
    with pytest.raises(ProblemError) as caught:
        FunctionProblem(circle, **arguments)
    assert caught.value.name == name
    assert str(caught.value.value) in str(caught.value)
    assert caught.value.allowed in str(caught.value)


@pytest.mark.parametrize(
    "function",
    [
        lambda u: np.array([np.nan]),
        lambda u: 1.0,
        lambda u: np.ones((2, 2)),
        lambda u: np.array([np.inf]),
    ],
)
def test_a_function_without_a_finite_vector_is_refused(function):
    with pytest.raises(ProblemError, match="value of the function"):
        FunctionProblem(function, BOX)


# --- recorded equations ---------------------------------------------------------------


def test_a_problem_says_whether_its_equations_are_recorded_and_why_not():
    recorded = FunctionProblem(circle, BOX)
    assert recorded.accuracy.derivatives == "recorded"
    assert recorded.accuracy.equations == "recorded (4 operations)"
    refused = FunctionProblem(silently_wrong, BOX)
    assert refused.accuracy.derivatives == "central differences"
    assert refused.accuracy.equations.startswith(
        "not recorded: it takes an absolute value"
    )
    without = FunctionProblem(circle, BOX, is_recorded=False)
    assert without.accuracy.equations == "not recorded: not asked for"
    atlas = explore(recorded, settings=SearchSettings(starts=5))
    assert atlas.provenance.derivatives == "recorded"
    assert atlas.provenance.equations == recorded.accuracy.equations


def test_a_given_jacobian_is_compared_with_the_recorded_one():
    def right(u):
        return np.array([[2 * u[0], 2 * u[1]]])

    def wrong(u):
        return np.array([[2 * u[0], 3 * u[1]]])

    assert (
        FunctionProblem(circle, BOX, jacobian=right).accuracy.derivatives == "recorded"
    )
    with pytest.raises(ProblemError, match=r"jacobian\[0, 1\].* as recorded at"):
        FunctionProblem(circle, BOX, jacobian=wrong)


def test_a_recorded_function_is_not_called_again():
    calls = []

    def counted(u):
        calls.append(u)
        return circle(u)

    problem = FunctionProblem(counted, BOX)
    count = len(calls)
    explore(problem, settings=SearchSettings(starts=5))
    assert len(calls) == count


def test_a_recorded_problem_is_known_at_fifty_digits_and_others_are_not():
    residual = FunctionProblem(circle, BOX).precise_residual()
    with mpmath.workdps(50):
        (value,) = residual([mpmath.mpf(1) / 3, mpmath.mpf(0)])
        assert abs(value + mpmath.mpf(8) / 9) < mpmath.mpf(10) ** -49
    assert FunctionProblem(silently_wrong, BOX).precise_residual() is None


@pytest.mark.parametrize("is_recorded", [True, False])
def test_a_problem_is_copied_and_pickled(is_recorded):
    problem = FunctionProblem(circle, BOX, is_recorded=is_recorded)
    points = np.array([[0.2, 0.5]])
    for twin in (pickle.loads(pickle.dumps(problem)), copy.deepcopy(problem)):
        assert np.array_equal(twin.residuals(points), problem.residuals(points))
        assert np.array_equal(twin.project(points)[0], problem.project(points)[0])


@pytest.mark.parametrize("is_recorded", [True, False])
def test_nothing_is_made_of_no_points(is_recorded):
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - 1.0]),
        [[-2.0, 2.0], [-2.0, 2.0]],
        is_recorded=is_recorded,
    )
    assert problem.residuals(np.empty((0, 2))).shape == (0, 1)
    assert problem.jacobians(np.empty((0, 2))).shape == (0, 1, 2)


def test_an_error_of_the_function_is_one_line_that_says_where():
    def logarithm(u):
        return [math.log(float(u[0]) + 1.5) - u[1]]

    with pytest.raises(ProblemError, match=r"ValueError \(math domain error\) at \(-1"):
        explore(FunctionProblem(logarithm, BOX))


@pytest.mark.parametrize("is_recorded", [True, False])
def test_a_function_may_change_its_argument(is_recorded):
    def spoiled(u):
        x, y = u[0] * 1.0, u[1] * 1.0
        u[0] = 7.0
        return np.array([x**2 + y**2 - 1.0])

    def gradient(u):
        row = 2.0 * u[None].copy()
        u[:] = 0.0
        return row

    given = None if is_recorded else gradient
    problem = FunctionProblem(spoiled, BOX, jacobian=given, is_recorded=is_recorded)
    (form,) = explore(problem).forms
    assert form.branch.length == pytest.approx(2 * math.pi)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_a_wrong_jacobian_is_refused_in_any_units(size):
    box = [(-2.0 * size, 2.0 * size)] * 2

    def values(u):
        x, y = float(u[0]) / size, float(u[1]) / size
        return [np.sin(x) - y, 1e-3 * (x * y - 0.1)]

    def right(u):
        x, y = u / size
        return np.array(
            [[np.cos(x) / size, -1.0 / size], [1e-3 * y / size, 1e-3 * x / size]]
        )

    FunctionProblem(values, box, jacobian=right)
    for row in range(2):
        factors = np.where(np.arange(2) == row, 2.0, 1.0)

        def wrong(u, factors=factors):
            return factors[:, None] * right(u)

        with pytest.raises(ProblemError, match=rf"jacobian\[{row}, "):
            FunctionProblem(values, box, jacobian=wrong)


@pytest.mark.parametrize("size", [1e-8, 1.0, 1e8])
def test_imaginary_parts_that_are_dropped_are_noticed_in_any_units(size):
    def values(u):
        x, y = np.real(u).tolist()
        return [size * (x**2 + y**2 - 1.0)]

    problem = FunctionProblem(values, BOX, is_recorded=False)
    assert problem.accuracy.derivatives == "central differences"
    analytic = FunctionProblem(
        lambda u: [size * (u[0] ** 2 + u[1] ** 2 - 1.0)], BOX, is_recorded=False
    )
    assert analytic.accuracy.derivatives == "complex step"


def test_a_derivative_that_is_finite_nowhere_is_said():
    with pytest.raises(ProblemError, match=r"derivative of the function: nan"):
        FunctionProblem(lambda u: [u[1] + np.arcsin(u[0] / u[0])], BOX)


def test_a_function_of_unknowns_and_parameters_is_that_of_all_of_them():
    def rates(u, p, k):
        return [p * (1 - u[0]) * np.exp(u[1]) - u[0], p + k * u[1]]

    def jacobian(u, p, k):
        rate = (1 - u[0]) * np.exp(u[1])
        return np.array(
            [[-p * np.exp(u[1]) - 1, p * rate, rate, 0], [0, k, 1, u[1]]], dtype=float
        )

    parameters = {"p": (0, 0.16), "k": (1, 2)}
    for given in (None, jacobian):
        problem = FunctionProblem(
            rates, {"x": (0, 1), "y": (0, 8)}, parameters=parameters, jacobian=given
        )
        assert problem.domain.names == ("x", "y", "p", "k")
        assert problem.domain.bounds.tolist() == [[0, 1], [0, 8], [0, 0.16], [1, 2]]
        point = np.array([[0.3, 2.0, 0.1, 1.5]])
        assert problem.residuals(point)[0] == pytest.approx(
            rates(point[0, :2], 0.1, 1.5), abs=1e-15
        )
        assert problem.jacobians(point)[0] == pytest.approx(
            jacobian(point[0, :2], 0.1, 1.5), abs=1e-14
        )


@pytest.mark.parametrize(
    "arguments, words",
    [
        ({"bounds": {"x": (0, 1), "z": (0, 1)}, "names": "xy"}, "bounds: 'z' is not"),
        ({"bounds": {"x": (0, 1)}, "names": ["x", "y"]}, r"bounds\['y'\]: missing"),
        ({"periods": {"y": 1}}, "periods: 'y' is not allowed; it must be one of .* u1"),
        ({"parameters": {"u1": (0, 1)}}, "names: .* must be all different"),
        ({"parameters": {"p": (1, 0)}}, "bounds of the parameters"),
        ({"parameters": [(0, 1)]}, "parameters: .* must be a dict"),
    ],
)
def test_names_of_unknowns_and_parameters_that_do_not_fit_are_refused(arguments, words):
    arguments = {"bounds": BOX, **arguments}
    if arguments.get("names") == "xy":
        arguments["names"] = ["x", "y"]
    with pytest.raises(ProblemError, match=words):
        FunctionProblem(lambda u, *p: circle(u), **arguments)
