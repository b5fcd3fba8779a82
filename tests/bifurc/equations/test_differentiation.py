"""Derivatives of recorded equations are those of the compiled interpreter."""

import numpy as np

from bifurc import FunctionProblem
from bifurc.equations.differentiation import with_gradients

POINTS = np.array([[0.3, 0.7], [0.5, 0.2]])


def function(u):
    x, y = u
    return [
        np.sin(x) * y / (1 + x**2) + np.arctan2(y, x) + np.sqrt(2 + y) ** 3.5,
        np.log(3 + x) - y / 7 + 4 * np.exp(x - 1) + np.arcsin(x / 9) - np.tanh(x * y),
    ]


def test_the_further_equations_are_the_partial_derivatives():
    tape = FunctionProblem(function, [(0.1, 1.0)] * 2).recording.tape
    both = with_gradients(tape, [0, 1])
    values = both.compiled.residuals(POINTS)
    assert np.array_equal(values[:, :2], tape.compiled.residuals(POINTS))
    gradients = values[:, 2:].reshape(-1, 2, 2)
    expected = tape.compiled.jacobians(POINTS)
    np.testing.assert_allclose(gradients, expected, rtol=1e-14, atol=1e-14)


def test_second_derivatives_come_the_same_way():
    tape = FunctionProblem(function, [(0.1, 1.0)] * 2).recording.tape
    once = with_gradients(tape, [0])
    twice = with_gradients(once, [2])
    values = twice.compiled.residuals(POINTS)[:, 4:]
    expected = [tape.compiled.hessian(point)[0, 0] for point in POINTS]
    np.testing.assert_allclose(values, expected, rtol=1e-13, atol=1e-13)
