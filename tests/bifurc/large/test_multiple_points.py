"""Singular points of a large problem at which the rank drops by two and more at once,
against eigenvalues and directions known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, eye_array, kron

from bifurc import Kind, LargeProblem, LargeSettings, trace_large_branch

LOOKING = LargeSettings(values=3)
SIDE = 12  # inner points of a side of the square
STEP = np.pi / (SIDE + 1)


def square_laplacian(aspect=1.0):
    ones = np.ones(SIDE)
    second = diags_array([ones[1:], -2 * ones, ones[1:]], offsets=[-1, 0, 1]) / STEP**2
    one, other = kron(second, eye_array(SIDE)), kron(eye_array(SIDE), second)
    return csr_array(one + aspect * other)


def eigenvalue(wave, aspect=1.0):
    """Of minus the Laplacian, to sines of whole wave numbers, by differences."""
    first, second = 4 * np.sin(0.5 * STEP * np.array(wave)) ** 2 / STEP**2
    return first + aspect * second


def wave_on_square(first, second):
    x = STEP * np.arange(1, SIDE + 1)
    return np.outer(np.sin(first * x), np.sin(second * x)).ravel()


def trivial_branch(linear, low, high, settings=LOOKING, power=3):
    """Of linear u + p u - u^power = 0, along u = 0."""
    m = linear.shape[0]

    def residual(x):
        return linear @ x[:-1] + x[-1] * x[:-1] - x[:-1] ** power

    problem = LargeProblem(residual, m + 1, (low, high), pattern=linear + eye_array(m))
    start = np.append(np.zeros(m), low)
    return problem, trace_large_branch(problem, start, settings=settings)


def test_double_eigenvalues_of_a_square_are_double_crossings() -> None:
    # one of two equal values is enough to see both
    for values in (1, 3):
        looking = LargeSettings(values=values)
        _, branch = trivial_branch(square_laplacian(), 0.5, 7.0, looking)
        simple, double = branch.points
        assert [point.multiplicity for point in branch.crossings] == [1, 2]
        assert simple.parameter == pytest.approx(eigenvalue((1, 1)), abs=1e-10)
        assert double.parameter == pytest.approx(eigenvalue((1, 2)), abs=1e-10)
        assert np.abs(double.u[:-1]).max() < 1e-10


def test_the_null_vectors_are_the_waves_of_the_eigenvalue() -> None:
    _, branch = trivial_branch(square_laplacian(), 4.0, 6.0)
    (double,) = branch.crossings
    waves = np.stack([wave_on_square(1, 2), wave_on_square(2, 1)], axis=1)
    found = double.null_vectors[:, :-1].T
    _, cosines, _ = np.linalg.svd(np.linalg.qr(waves)[0].T @ np.linalg.qr(found)[0])
    assert cosines == pytest.approx([1.0, 1.0], abs=1e-9)
    assert np.abs(double.null_vectors[:, -1]).max() < 1e-9


def test_symmetry_makes_four_directions_of_third_order() -> None:
    problem, branch = trivial_branch(square_laplacian(), 4.0, 6.0)
    (double,) = branch.crossings
    assert double.order == 3 and len(double.directions) == 5
    assert np.linalg.norm(double.directions[0, :-1]) < 1e-9  # the branch u = 0 itself
    # of a sin x sin 2y + b sin 2x sin y the cubic allows a = 0, b = 0 and a = +-b
    waves = np.stack([wave_on_square(1, 2), wave_on_square(2, 1)], axis=1)
    shares, *_ = np.linalg.lstsq(waves, double.directions[1:, :-1].T, rcond=None)
    angles = np.sort(np.arctan2(shares[1], shares[0]) % np.pi * 4 / np.pi)
    apart = np.abs(angles - np.round(angles))
    assert apart == pytest.approx(np.zeros(4), abs=1e-4)
    assert set(np.round(angles).astype(int) % 4) == {0, 1, 2, 3}
    tracing = LargeSettings(tracing=LOOKING.tracing)
    for direction in double.directions[1:]:
        start = double.u + 0.1 * direction
        other = trace_large_branch(problem, start, direction, tracing)
        end = other(other.length)
        assert end[-1] == pytest.approx(6.0)
        assert np.abs(end[:-1]).max() > 0.5


def test_quadratic_terms_give_directions_of_second_order() -> None:
    # the symmetry of a triangle: besides x = y = 0, p x = x^2 - y^2 and p y = -2 x y
    # are three lines
    def triangle(x):
        first = x[2] * x[0] - (x[0] ** 2 - x[1] ** 2)
        return np.array([first, x[2] * x[1] + 2 * x[0] * x[1]])

    problem = LargeProblem(triangle, 3, (-1.0, 1.0))
    branch = trace_large_branch(problem, [0.0, 0.0, -0.8], settings=LOOKING)
    (double,) = branch.crossings
    assert double.multiplicity == 2 and double.order == 2
    assert np.abs(double.u).max() < 1e-12
    root = np.sqrt(3.0)
    lines = np.array([[0, 0, 1], [1, 0, 1], [1, root, -2], [1, -root, -2]])
    lines /= np.linalg.norm(lines, axis=1, keepdims=True)
    found = double.directions / np.linalg.norm(double.directions, axis=1, keepdims=True)
    cosines = np.abs(found @ lines.T)
    assert np.sort(cosines.max(axis=0)) == pytest.approx(np.ones(4), abs=1e-9)
    assert sorted(cosines.argmax(axis=0)) == [0, 1, 2, 3]


def test_a_circle_of_directions_is_said_to_be_not_computed() -> None:
    m = 30
    ring = diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(m, m)).tolil()
    ring[0, m - 1] = ring[m - 1, 0] = 1.0
    step = 2 * np.pi / m
    _, branch = trivial_branch(csr_array(ring) / step**2, -0.5, 2.0)
    first, second = branch.points
    assert first.kind is Kind.CROSSING and first.multiplicity == 1
    assert second.kind is Kind.MULTIPLE and second.multiplicity == 2
    assert second.parameter == pytest.approx(
        2 * (1 - np.cos(step)) / step**2, abs=1e-10
    )
    assert len(second.directions) == 1 and second.order == 0
    assert "not computed, multiplicity 2" in repr(second)


@pytest.mark.parametrize("count", [4, 60])
def test_all_values_may_vanish_at_once(count: int) -> None:
    _, branch = trivial_branch(csr_array((count, count)), -0.7, 1.0)
    (point,) = branch.points
    assert point.kind is Kind.MULTIPLE
    assert point.multiplicity == count
    assert np.abs(point.u).max() < 1e-12


@pytest.mark.parametrize("aspect", [1 + 1e-6, 1 + 1e-4, 1.01])
def test_eigenvalues_next_to_each_other_are_two_crossings(aspect: float) -> None:
    _, branch = trivial_branch(square_laplacian(aspect), 4.0, 6.0)
    expected = sorted(eigenvalue(wave, aspect) for wave in ((1, 2), (2, 1)))
    assert [point.multiplicity for point in branch.points] == [1, 1]
    found = sorted(point.parameter for point in branch.crossings)
    assert found == pytest.approx(expected, abs=1e-10)
