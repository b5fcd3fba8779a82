"""Derivatives of recorded equations are those of the compiled interpreter."""

import numpy as np

from bifurc import FunctionProblem
from bifurc.equations.differentiation import with_gradients, with_null_vectors

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


def test_null_vectors_are_multiplied_by_the_derivatives_and_stay_orthonormal():
    tape = FunctionProblem(function, [(0.1, 1.0)] * 2).recording.tape
    rng = np.random.default_rng(0)
    basis = np.linalg.qr(rng.normal(size=(2, 2)))[0]
    both = with_null_vectors(tape, 2, basis)
    vectors = rng.normal(size=(2, 2))
    rows = np.array([[*point, *vectors.T.ravel()] for point in POINTS])
    values = both.compiled.residuals(rows)
    slopes = tape.compiled.jacobians(POINTS) @ vectors
    gram = vectors.T @ vectors
    turned = basis.T @ vectors
    expected = np.column_stack(
        [
            tape.compiled.residuals(POINTS),
            slopes[:, :, 0],
            slopes[:, :, 1],
            np.tile(
                [
                    gram[0, 0] - 1.0,
                    gram[1, 0],
                    turned[1, 0] - turned[0, 1],
                    gram[1, 1] - 1.0,
                ],
                (2, 1),
            ),
        ]
    )
    np.testing.assert_allclose(values, expected, rtol=1e-12, atol=1e-12)


def test_with_one_null_vector_and_a_parameter_the_parameter_is_no_direction():
    tape = FunctionProblem(function, [(0.1, 1.0)] * 2).recording.tape
    both = with_null_vectors(tape, 1, np.ones((1, 1)))
    values = both.compiled.residuals(np.column_stack([POINTS, [0.5, -2.0]]))
    slopes = tape.compiled.jacobians(POINTS)[:, :, 0]
    expected = slopes * np.array([[0.5], [-2.0]])
    np.testing.assert_allclose(values[:, 2:4], expected, rtol=1e-13)
    np.testing.assert_allclose(values[:, 4], [0.25 - 1.0, 3.0], rtol=1e-14)
