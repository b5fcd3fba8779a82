"""Callables become tapes, or say why not; what a tape computes is the callable."""

import math

import numpy as np
import pytest

from bifurc.equations.recording import record
from bifurc.tables import count_of
from tests.bifurc.known_curves import Bratu, double_watt
from tests.bifurc.search.test_explore import COPIES, KNOWN
from tests.bifurc.singular.test_degenerate_points import AT_THE_ORIGIN

BOX = (0.1, 0.9)


def points_in(n, box=BOX):
    return np.random.default_rng(0).uniform(*box, (20, n))


# --- what can be recorded -------------------------------------------------------------


def freudenstein_roth(u):
    x, y, a = u
    return np.array(
        [
            x - ((2 - y) * y + 5) * y + 13 * a - 14,
            x + ((1 + y) * y - 14) * y + 27 * a - 28,
        ]
    )


def aircraft(u):
    """Rheinboldt's aircraft, rudder and ailerons at rest."""
    roll, pitch, yaw, attack, slip, elevator = u
    a = np.array(
        [
            [-3.933, 0.107, 0.126, 0, -9.99],
            [0, -0.987, 0, -22.95, 0],
            [0.002, 0, -0.235, 0, 5.67],
            [0, 1.0, 0, -1.0, 0],
            [0, 0, -1.0, 0, -0.196],
        ]
    )
    quadratic = np.array(
        [
            -0.727 * pitch * yaw + 8.39 * yaw * attack - 684.4 * attack * slip,
            0.949 * roll * yaw + 0.173 * roll * slip,
            -0.716 * roll * pitch - 1.578 * roll * attack + 1.132 * pitch * attack,
            -roll * slip,
            roll * attack,
        ]
    )
    constant = np.array([0, -28.37, 0, -0.168, 0]) * elevator
    return a @ u[:5] + quadratic + constant


def four_bar(u):
    ends = [np.array([np.cos(x), np.sin(x)]) for x in u[:2]]
    return ends[0] * 1.5 - ends[1] + np.stack([np.cos(u[2]) - 1.0, np.sin(u[2])])


def filled(u):
    out = np.zeros_like(u)
    for i in range(len(u)):
        out[i] = u[i] ** (i + 1)
    out[1:] -= u[:-1] * 0.5
    return out


def rotation(u):
    c, s = np.cos(u[2]), np.sin(u[2])
    matrix = np.array([[c, -s], [s, c]])
    return matrix @ u[:2] - [0.5, 0.5]


def plane(polynomial):
    return lambda u: np.array([polynomial(*u)])


def double_watt_lengths():
    problem, _ = double_watt(1.0, 0.2, 2.0)
    return problem.equations.function


FUNCTIONS = {
    **{name: (plane(case[0]), 2) for name, case in KNOWN.items()},
    **{name: (plane(case[0]), 2) for name, case in AT_THE_ORIGIN.items()},
    **{
        f"pitchfork, {name}": (
            lambda u, f=copy: f(u[0] * u[1] - u[0] ** 3),
            2,
        )
        for name, copy in COPIES.items()
    },
    "a list": (lambda u: [u @ u - 1.0, u[0]], 2),
    "freudenstein and roth": (freudenstein_roth, 3),
    "aircraft": (aircraft, 6),
    "four-bar": (four_bar, 3),
    "double watt": (double_watt_lengths(), 8),
    "bratu": (Bratu(20).residual, 21),
    "filled array": (filled, 4),
    "rotation": (rotation, 3),
    "norms": (lambda u: [np.linalg.norm(u) - 1, np.linalg.norm([u[0], 2.0])], 3),
    "sums": (lambda u: [u.mean(), u.sum(), np.prod(u), np.cumsum(u)[1]], 3),
    "cross": (lambda u: np.cross(u, [1.0, 2.0, 3.0]), 3),
    "differences": (lambda u: np.diff(np.concatenate([[0.0], u])) * np.roll(u, 1), 4),
    "einsum": (lambda u: np.einsum("ij,i,j->i", np.ones((3, 3)), u, u), 3),
    "outer": (lambda u: np.outer(u, u)[0] - np.trace(np.outer(u, u)), 3),
    "polynomial": (lambda u: np.polyval([1.0, 2.0, 3.0], u), 2),
    "powers": (lambda u: [u[0] ** u[1], 2 ** u[0], u[0] ** -2, u[1] ** 1.5], 2),
    "angles": (lambda u: [np.arctan2(*u), np.hypot(2.0, u[0]), np.deg2rad(u[1])], 2),
    "scalars of numpy": (lambda u: [np.float64(2) * u[0] - np.float32(0.5) / u[1]], 2),
    "mixed array": (lambda u: np.cos(np.concatenate([[0.5], u])), 2),
    "loop": (lambda u: [sum(u[0] ** k / math.factorial(k) for k in range(9))], 1),
    "logarithms": (lambda u: np.log2(u) + np.log10(u) + np.log1p(u) - np.exp2(u), 2),
    "in place": (lambda u: np.add(u, 1.0, out=np.empty_like(u)), 2),
}


def test_there_are_forty_functions():
    assert len(FUNCTIONS) >= 40


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_recording_is_equal_to_its_function_to_rounding(name):
    function, n = FUNCTIONS[name]
    points = points_in(n)
    recording = record(function, points)
    assert recording.tape is not None, recording.reason
    operations = count_of(recording.tape.size, "operation")
    assert str(recording) == f"recorded ({operations})"
    recorded = recording.tape.compiled.residuals(points)
    expected = np.array([function(point) for point in points], dtype=float)
    # a few units in the last place of the largest term
    size = np.abs(expected).max(initial=1.0)
    assert np.abs(recorded - expected).max() < 2e-14 * size


@pytest.mark.parametrize("name", FUNCTIONS)
def test_derivatives_of_a_recording_are_those_by_differences(name):
    function, n = FUNCTIONS[name]
    tape = record(function, points_in(n)).tape.compiled
    point, step = points_in(n)[0], 1e-5
    shifted = np.concatenate([point + step * np.eye(n), point - step * np.eye(n)])
    values, jacobians = tape.residuals(shifted), tape.jacobians(shifted)
    jacobian = tape.jacobians(point[None])[0]
    hessian = tape.hessian(point)
    scale = 1.0 + np.abs(hessian).max()
    slopes = (values[:n] - values[n:]).T / (2 * step)
    bends = np.moveaxis(jacobians[:n] - jacobians[n:], 0, -1) / (2 * step)
    # third derivatives times 1e-10, and rounding over the step
    assert jacobian == pytest.approx(slopes, abs=1e-7 * scale)
    assert hessian == pytest.approx(bends, abs=1e-6 * scale)
    assert np.array_equal(hessian, np.swapaxes(hessian, 1, 2))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_complex_numbers_and_intervals_give_the_same(name):
    function, n = FUNCTIONS[name]
    tape = record(function, points_in(n)).tape.compiled
    points = points_in(n)
    values, jacobians = tape.residuals(points), tape.jacobians(points)
    size = 1e-13 * (1.0 + np.abs(values).max() + np.abs(jacobians).max())
    shifted = points + 1e-100j * np.eye(n)[0]
    complex_values = tape.complex_residuals(shifted)
    assert complex_values.real == pytest.approx(values, abs=size)
    # the imaginary part over the step is the derivative
    assert complex_values.imag / 1e-100 == pytest.approx(jacobians[:, :, 0], abs=size)
    assert tape.complex_jacobians(shifted).real == pytest.approx(jacobians, abs=size)
    low, high = tape.value_bounds(points, points)
    assert np.all((low <= values) & (values <= high))
    assert np.all(high - low < size)


def test_intervals_hold_all_values_in_a_box():
    rng = np.random.default_rng(1)
    for function, n in FUNCTIONS.values():
        tape = record(function, points_in(n)).tape.compiled
        low = rng.uniform(0.1, 0.5, n)
        high = low + rng.uniform(0.0, 0.4, n)
        inside = rng.uniform(low, high, (50, n))
        values, jacobians = tape.residuals(inside), tape.jacobians(inside)
        lowest, highest = tape.value_bounds(low[None], high[None])
        assert np.all((lowest <= values) & (values <= highest))
        lowest, highest = tape.jacobian_bounds(low[None], high[None])
        assert np.all((lowest <= jacobians) & (jacobians <= highest))


def test_equal_operations_are_one():
    recording = record(
        lambda u: [np.sin(u[0]) ** 2, 1 + np.sin(u[0]) ** 2], points_in(1)
    )
    assert recording.tape.size == 3  # sin, square, shift


def test_what_doubles_make_of_constants_is_a_constant():
    recording = record(lambda u: u * (np.sqrt(2.0) * 3.0 + 1.0), points_in(2))
    assert recording.tape.size == 2


# --- what cannot ----------------------------------------------------------------------


def writes_into_floats(u):
    out = np.zeros(2)
    out[0] = u[0]
    return out


def adds_to_floats(u):
    out = np.zeros(2)
    out += u
    return out


def swallows(u):
    try:
        return np.array([math.sin(u[0])])
    except Exception:
        return np.array([u[0] * 0.5])


class Counting:
    calls = 0

    def __call__(self, u):
        self.calls += 1
        return self.calls * u


REFUSED = {
    "branch": (lambda u: [u[0] if u[0] > 0.5 else u[1]], "branches on the value"),
    "where": (lambda u: np.where(u > 0.5, u, 1.0), "branches on the value"),
    "maximum": (lambda u: np.maximum(u, 0.5), "branches on the value"),
    "absolute": (lambda u: [abs(u[0])], "absolute value"),
    "math": (lambda u: [math.sin(u[0])], "a function of math"),
    "float": (lambda u: [float(u[0])], "plain number"),
    "array of floats": (writes_into_floats, "plain number"),
    "sum of floats": (adds_to_floats, "plain number"),
    "as floats": (lambda u: np.asarray(u, dtype=float), "plain number"),
    "swallowed": (swallows, "plain number"),
    "rounded": (lambda u: np.floor(u), "rounds an unknown"),
    "remainder": (lambda u: [u[0] % 1], "remainder"),
    "complex": (lambda u: [(1j * u[0]) * u[1]], "complex numbers"),
    "index": (lambda u: [[1.0, 2.0][u[0]]], "index"),
    "linear algebra": (
        lambda u: np.linalg.solve(np.eye(2) + np.outer(u, u), u),
        "plain numbers only",
    ),
    "mixed": (lambda u: np.cos(np.array([u[0], 1.0])), "np.stack or np.concatenate"),
    "negative base": (lambda u: [(-2.0) ** u[0]], "not positive"),
    "other kind": (
        lambda u: [u[0] if isinstance(u[0], float) else u[1]],
        "not equal to the function at",
    ),
    "another every time": (Counting(), "not equal to the function at"),
    "endless": (lambda u: [sum(u[0] ** k for k in range(10**6))], "more than 200000"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_recorded_says_so_in_a_sentence(name):
    function, reason = REFUSED[name]
    recording = record(function, points_in(2))
    assert recording.tape is None
    assert reason in recording.reason
    assert str(recording) == f"not recorded: {recording.reason}"


@pytest.mark.parametrize(
    "function",
    [
        lambda u: np.array([0 * np.log(u[0]) + u[0] - u[1]]),
        lambda u: np.array([u[0] - u[1], u[1] + np.sqrt(u[0]) * 0]),
        lambda u: np.array([[0.0, 1.0]]) @ np.stack([1.0 / (u[0] + 1.0), u[1]]),
    ],
)
def test_zero_times_what_is_not_defined_is_not_zero(function):
    points = np.array([[-1.0, 0.5], [1.0, 1.0]])
    with np.errstate(all="ignore"):
        tape = record(function, points).tape
    values = tape.compiled.residuals(points)
    assert not np.isfinite(values[0]).all()
    np.testing.assert_array_equal(values[1], function(points[1]))


def test_zero_times_what_an_equation_holds_leaves_no_operation():
    def equations(u):
        roots = np.sqrt(u)
        return np.eye(2) @ roots

    assert record(equations, np.ones((1, 2))).tape.size == 2
