"""Noise of values is measured, and is the floor of what solved means."""

import numpy as np
import pytest

from bifurc import FunctionProblem, ProblemError, explore
from bifurc.equations.evaluation import noise_of

BOUNDS = [(-2.0, 2.0), (-2.0, 2.1)]


def circle(u):
    x, y = np.real(u).tolist()  # plain numbers, of which nothing is recorded
    return np.array([x * x + y * y - 1.0])


def noisy(function, noise, seed=5):
    rng = np.random.default_rng(seed)
    return lambda u: function(u) + noise * rng.normal(size=1)


def measured(function, scale=1.0):
    rng = np.random.default_rng(0)
    points = rng.uniform(-scale, scale, (5, 2))
    return noise_of(function, points, np.full(2, scale), rng)[0]


@pytest.mark.parametrize("noise", [1e-13, 1e-10, 1e-6, 1e-2])
@pytest.mark.parametrize("scale", [1.0, 1e-4, 1e4])
def test_random_noise_is_measured_in_any_units(noise, scale):
    # the least of the estimates from few differences is low by a factor of 2 or so
    value = measured(
        noisy(lambda u: np.sin(u[:1] / scale) + u[1:] / scale, noise), scale
    )
    assert 0.2 * noise < value < 2.0 * noise


@pytest.mark.parametrize(
    ("function", "size"),
    [
        (lambda u: np.array(u, dtype=np.float32)[:1] ** 2 + 1, 1e-7),
        (lambda u: np.round(np.sin(u[:1]) * u[1:], 8), 1e-8),
        (lambda u: np.round(np.sin(u[:1]) * u[1:], 3), 1e-3),
        (lambda u: np.round(u[1:] - np.sin(u[:1]), 3), 1e-3),
    ],
)
def test_rounded_values_are_noisy_to_what_is_rounded(function, size):
    assert 0.03 * size < measured(function) < size


@pytest.mark.parametrize("rate", [1, 3, 30, 100])
def test_smooth_values_are_noisy_to_rounding(rate):
    assert measured(lambda u: np.exp(np.sin(rate * u[:1])) * u[1:]) < 1e-14


def test_unknowns_of_very_different_sizes_make_no_noise():
    def function(u):
        x, y = 1e4 * u[0], 1e-4 * u[1]
        return circle((x, y)) * (2.0 + x**2) ** 4

    bounds = [(-2e-4, 2e-4), (-2e4, 2.1e4)]
    problem = FunctionProblem(function, bounds, is_recorded=False)
    assert problem.accuracy.noise == 0.0
    (form,) = explore(problem).forms
    assert form.branch.closed


@pytest.mark.parametrize("noise", [1e-12, 1e-9])
def test_a_noisy_curve_is_found_and_the_noise_is_said(noise):
    atlas = explore(FunctionProblem(noisy(circle, noise), BOUNDS))
    (form,) = atlas.forms
    assert form.branch.closed and not len(atlas.rigid)
    assert form.branch.length == pytest.approx(2 * np.pi, rel=100 * noise + 1e-9)
    assert "noise" in {doubt.kind for doubt in atlas.completeness.doubts}
    assert "noisy to" in atlas.provenance.equations


def crossing(u):
    x, y = np.real(u).tolist()
    return np.array([x * y])


def wave(u):
    x, y = np.real(u).tolist()
    return np.array([y - np.sin(x)])


NOISES = {
    "1e-8": lambda f: noisy(f, 1e-8),
    "1e-7": lambda f: noisy(f, 1e-7),
    "1e-5": lambda f: noisy(f, 1e-5),
    "single precision": lambda f: lambda u: np.float32(f(np.float32(u))),
    "six digits": lambda f: lambda u: np.round(f(u), 6),
    "three digits": lambda f: lambda u: np.round(f(u), 3),
}


@pytest.mark.parametrize("noise", NOISES)
@pytest.mark.parametrize(
    ("function", "length"), [(circle, 2 * np.pi), (crossing, 4.05), (wave, 4.6895)]
)
def test_curves_in_more_noise_are_those_of_polynomials(noise, function, length):
    atlas = explore(FunctionProblem(NOISES[noise](function), BOUNDS))
    assert len(atlas.forms) == (2 if function is crossing else 1)
    for form in atlas.forms:
        assert form.branch.length == pytest.approx(length, abs=0.1)
    assert "noise" in {doubt.kind for doubt in atlas.completeness.doubts}
    assert "a polynomial next to its values" in atlas.provenance.equations


def test_noise_without_a_polynomial_is_refused_with_what_was_measured():
    def steep(u):
        return np.tanh(30 * circle(u))

    with pytest.raises(ProblemError, match=r"e-08 is not allowed.*at most 1e-09"):
        FunctionProblem(noisy(steep, 1e-7), BOUNDS)


def test_the_drift_of_a_function_from_call_to_call_is_noise():
    calls = []

    def drifting(u):
        calls.append(u)
        return circle(u) + 1e-6 * len(calls)

    atlas = explore(FunctionProblem(drifting, BOUNDS))
    assert len(atlas.forms) == 1
    assert "noise" in {doubt.kind for doubt in atlas.completeness.doubts}


def test_too_much_noise_is_refused_with_what_was_measured():
    with pytest.raises(
        ProblemError, match=r"noise of the values.*e-0[23] is not allowed"
    ):
        FunctionProblem(noisy(circle, 3e-2), BOUNDS)


def test_a_function_may_change_its_argument():
    def changing(u):
        u *= 2.0
        return circle(u / 2.0)

    problem = FunctionProblem(changing, BOUNDS, is_recorded=False)
    points = np.array([[1.0, 0.0], [0.0, 2.0]])
    assert np.allclose(problem.residuals(points), [[0.0], [3.0]])
    assert np.array_equal(points, [[1.0, 0.0], [0.0, 2.0]])
