"""Taylor series of every operation against fifty digits, tapes as data."""

import copy
import pickle

import mpmath
import numpy as np
import pytest
from flint import arb, ctx

from bifurc import _core
from bifurc.equations.recording import record
from bifurc.equations.tape import FUNCTIONS, Operation, TapeWriter
from bifurc.function_problem import FunctionProblem
from bifurc.system import MarchSettings

ORDER = 12
# u(s) and v(s), by powers of s
CURVE = np.zeros((ORDER + 1, 2))
CURVE[:4] = [[0.4, 0.7], [0.5, -0.3], [-0.2, 0.25], [0.1, 0.05]]

NUMPY_NAMES = {
    "asin": "arcsin",
    "acos": "arccos",
    "atan": "arctan",
    "asinh": "arcsinh",
    "acosh": "arccosh",
    "atanh": "arctanh",
}


def taylor(function):
    """Taylor coefficients (order + 1,) of a function along the curve, from 50 digits."""
    with mpmath.workdps(50):
        powers = [[mpmath.mpf(x) for x in column] for column in CURVE.T]

        def along(s):
            u, v = (mpmath.polyval(column[::-1], s) for column in powers)
            return function(u, v)

        return [float(x) for x in mpmath.taylor(along, 0, ORDER)]


def series(function):
    points = np.random.default_rng(0).uniform(0.3, 0.8, (20, 2))
    tape = record(lambda u: [function(*u)], points).tape
    return tape.compiled.series(CURVE)[:, 0]


def is_right(function, exact):
    expected = np.array(taylor(exact))
    # rounding of some hundred operations on numbers of the size of the coefficients
    assert series(function) == pytest.approx(expected, rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_series_of_a_function_is_right_to_order_twelve(name):
    in_numpy = getattr(np, NUMPY_NAMES.get(name, name))
    exact = getattr(mpmath, name)
    shift = 2.0 if name == "acosh" else 0.0  # defined from 1 on
    is_right(lambda u, v: in_numpy(shift + u * v), lambda u, v: exact(shift + u * v))


@pytest.mark.parametrize(
    ("function", "exact"),
    [
        (lambda u, v: u + v - 2.0 * u / 3.0,) * 2,
        (lambda u, v: u * v * u,) * 2,
        (lambda u, v: u / v + 1.0 / (u + v),) * 2,
        (lambda u, v: u**7 - v**-3,) * 2,
        (lambda u, v: u**1.7 * v**-0.3,) * 2,
        (lambda u, v: u**v,) * 2,
        (lambda u, v: 3.0**u,) * 2,
        (lambda u, v: (2.0 - u) ** 2 / 7.0,) * 2,
        (lambda u, v: np.arctan2(u, v), mpmath.atan2),
        (lambda u, v: np.arctan2(u, -v), lambda u, v: mpmath.atan2(u, -v)),
        (lambda u, v: np.hypot(u, v), mpmath.hypot),
        (
            lambda u, v: np.sin(np.exp(u) * np.log(v)) / np.sqrt(u + np.cosh(v)),
            lambda u, v: (
                mpmath.sin(mpmath.exp(u) * mpmath.log(v))
                / mpmath.sqrt(u + mpmath.cosh(v))
            ),
        ),
    ],
)
def test_the_series_of_an_expression_is_right_to_order_twelve(function, exact):
    is_right(function, exact)


def test_the_series_of_a_curve_is_exact():
    # the unit circle from (1, 0): cosine and sine
    problem = FunctionProblem(lambda u: [u @ u - 1.0], [(-2.0, 2.0)] * 2)
    settings = MarchSettings(ORDER, 1e-13, 1e-9, 2.0, 1)
    march = problem.march(np.array([1.0, 0.0]), np.array([0.0, 1.0]), settings)
    powers = march.radii[0] ** np.arange(ORDER + 1)
    expected = np.array([taylor_of_circle(k) for k in range(ORDER + 1)])
    assert march.pieces[0] / powers[:, None] == pytest.approx(expected, abs=1e-14)


def taylor_of_circle(k):
    sign = (-1.0) ** (k // 2) / float(mpmath.factorial(k))
    return (0.0, sign) if k % 2 else (sign, 0.0)


# where each function is looked at, by the least and the largest logarithm of |x|
REACHES = {
    **dict.fromkeys(("log", "sqrt", "cbrt", "asinh", "atan"), (-600.0, 600.0)),
    **dict.fromkeys(("asin", "acos", "atanh"), (-30.0, 0.0)),
    **dict.fromkeys(("sin", "cos", "tan"), (-30.0, 14.0)),
    "acosh": (0.0, 600.0),
    "tanh": (-30.0, 3.0),
}


def in_many_digits(name, x):
    """A function as a ball of 200 bits."""
    is_root = name == "cbrt"  # of what is negative a ball has none
    return arb(abs(x)).root(3) * np.sign(x) if is_root else getattr(arb(x), name)()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_bounds_of_a_function_hold_what_it_is_in_many_digits(name, monkeypatch):
    rng = np.random.default_rng(0)
    x = np.exp(rng.uniform(*REACHES.get(name, (-30.0, 6.0)), 400))
    x[::2] *= -1.0 if name not in ("log", "sqrt", "acosh", "log1p") else 1.0
    writer = TapeWriter(1)
    tape = writer.tape([writer.apply(FUNCTIONS[name], writer.unknown(0))])
    monkeypatch.setattr(ctx, "prec", 200)
    low, high = tape.compiled.value_bounds(x[:, None], x[:, None])
    for argument, least, most in zip(x, low[:, 0], high[:, 0], strict=True):
        assert arb(least) <= in_many_digits(name, argument) <= arb(most)


def test_a_tape_is_copied_and_pickled():
    tape = record(lambda u: np.sin(u) * u[0], np.full((1, 3), 0.5)).tape
    point = np.array([[0.1, 0.2, 0.3]])
    for twin in (pickle.loads(pickle.dumps(tape)), copy.deepcopy(tape)):
        assert np.array_equal(
            twin.compiled.residuals(point), tape.compiled.residuals(point)
        )
    assert repr(tape) == "<Tape: 3 equations in 3 unknowns, 6 operations>"


def test_a_tape_over_numbers_of_fifty_digits():
    tape = record(lambda u: [np.exp(u[0]) / u[1] ** 2], np.full((1, 2), 0.5)).tape
    with mpmath.workdps(50):
        third = mpmath.mpf(1) / 3
        (value,) = tape.over([third, mpmath.mpf(2)], mpmath)
        assert abs(value - mpmath.exp(third) / 4) < mpmath.mpf(10) ** -49


def test_operations_have_the_numbers_of_the_interpreter():
    writer = TapeWriter(1)
    outputs = [writer.apply(op, writer.unknown(0)) for op in FUNCTIONS.values()]
    point = 0.6
    values = writer.tape(outputs).compiled.residuals(np.array([[point]]))[0]
    for name, value in zip(FUNCTIONS, values, strict=True):
        if name != "acosh":
            assert value == pytest.approx(
                float(getattr(mpmath, name)(point)), abs=1e-15
            )
    assert np.isnan(values[list(FUNCTIONS).index("acosh")])


@pytest.mark.parametrize(
    ("operation", "operands", "message"),
    [
        (Operation.ADD, (0, 1, 0), "operand 1 is not allowed; it must be from 0 to 0"),
        (Operation.SIN, (-1, 0, 0), "operand -1"),
        (99, (0, 0, 0), "no such operation"),
    ],
)
def test_a_tape_that_makes_no_sense_is_refused(operation, operands, message):
    rows = np.array([(0, 0, 0), operands])
    operations = np.array([Operation.UNKNOWN, operation])
    with pytest.raises(ValueError, match=message):
        _core.Tape(1, operations, rows, np.zeros(2), np.array([1]))


def test_entries_of_a_sparse_jacobian_are_those_of_the_dense_one():
    def chain(u):
        return u[1:-1] ** 2 - np.sin(u[:-2]) * u[2:]

    tape = record(chain, np.full((1, 9), 0.5)).tape.compiled
    point = np.linspace(0.1, 0.9, 9)
    starts, columns = tape.pattern()
    entries = tape.entries(point)
    dense = np.zeros((7, 9))
    for row in range(7):
        part = slice(starts[row], starts[row + 1])
        dense[row, columns[part]] = entries[part]
    assert len(columns) == 21
    assert np.array_equal(dense, tape.jacobians(point[None])[0])


@pytest.mark.parametrize("base", [0.0, -2.0])
def test_a_number_that_is_not_positive_has_no_power_that_is_an_unknown(base):
    writer = TapeWriter(1)
    tape = writer.tape([writer.power(writer.constant(base), writer.unknown(0))])
    assert np.isnan(tape.compiled.residuals(np.array([[1.5]]))).all()


def test_many_points_at_once_have_the_bits_of_each_alone():
    # of some the numbers on the way, or all derivatives, are not finite
    def function(u):
        x, y, z = u
        grown = 1.0 / (1.0 + np.exp(x))
        return [grown + y**3 / z, np.sin(x) * np.sqrt(y) - z, np.arctan2(y, z) * x]

    problem = FunctionProblem(function, [(-2, 2)] * 3)
    points = np.random.default_rng(0).uniform(-2, 2, (23, 3))
    points[5, 0], points[9, 2], points[13, 1] = 1000.0, 0.0, 0.0
    for values in (problem.residuals, problem.jacobians):
        alone = np.concatenate([values(point[None]) for point in points])
        assert np.array_equal(values(points), alone, equal_nan=True)
