"""Eigenvalues of small complex matrices against exact ones and those of LAPACK."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from bifurc import _core

ROUNDING = np.finfo(float).eps


def distance(values, expected):
    """The largest distance (of the best pairing) of two lists of numbers."""
    gaps = np.abs(values[:, None] - expected)
    return gaps[linear_sum_assignment(gaps)].max(initial=0.0)


def random_matrix(rng, n):
    return rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))


def backward_error(matrix, values):
    """How singular matrix - value is at every value, over the norm of the matrix."""
    shifted = matrix - values[:, None, None] * np.eye(len(matrix))
    smallest = np.linalg.svd(shifted, compute_uv=False)[:, -1]
    return smallest.max() / np.linalg.norm(matrix)


@pytest.mark.parametrize("n", range(1, 9))
def test_random_matrices_have_the_eigenvalues_of_lapack(n):
    rng = np.random.default_rng(n)
    for matrix in [random_matrix(rng, n) for _ in range(50)]:
        values = _core.eigenvalues(matrix)
        assert distance(values, np.linalg.eigvals(matrix)) < 1e-11
        assert backward_error(matrix, values) < 10 * n * ROUNDING


def test_real_matrices_have_conjugate_pairs():
    rng = np.random.default_rng(0)
    for _ in range(50):
        values = _core.eigenvalues(rng.normal(size=(4, 4)).astype(complex))
        assert distance(values, values.conj()) < 1e-12


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_defective_matrix_has_its_eigenvalue_to_the_root_of_rounding(n):
    rng = np.random.default_rng(n)
    block = 0.7 * np.eye(n) + np.eye(n, k=1)
    turn = np.linalg.qr(random_matrix(rng, n))[0]
    matrix = turn @ block @ turn.conj().T
    values = _core.eigenvalues(matrix)
    assert distance(values, np.full(n, 0.7)) < 10 * ROUNDING ** (1 / n)
    assert backward_error(matrix, values) < 50 * ROUNDING


def test_repeated_eigenvalues_of_normal_matrices_are_exact_to_rounding():
    rng = np.random.default_rng(1)
    expected = np.array([2.0, 2.0, 2.0, -1j])
    for _ in range(20):
        turn = np.linalg.qr(random_matrix(rng, 4))[0]
        matrix = turn @ np.diag(expected) @ turn.conj().T
        assert distance(_core.eigenvalues(matrix), expected) < 50 * ROUNDING


def test_shifts_do_not_stand_still_at_a_cyclic_permutation():
    for n in range(2, 9):
        matrix = np.roll(np.eye(n, dtype=complex), 1, axis=0)
        roots = np.exp(2j * np.pi * np.arange(n) / n)
        assert distance(_core.eigenvalues(matrix), roots) < 1e-13


@pytest.mark.parametrize("scale", [1e-290, 1e-170, 1e170, 1e290])
def test_the_size_of_the_entries_does_not_matter(scale):
    matrix = random_matrix(np.random.default_rng(2), 4)
    expected = _core.eigenvalues(matrix)
    values = _core.eigenvalues(scale * matrix)
    assert distance(values / scale, expected) < 1e-13


def test_badly_scaled_matrices_have_eigenvalues_to_rounding_of_the_norm():
    rng = np.random.default_rng(3)
    for _ in range(50):
        scales = 10.0 ** rng.uniform(-8, 8, 4)
        matrix = random_matrix(rng, 4) * scales[:, None] / scales
        values = _core.eigenvalues(matrix)
        assert backward_error(matrix, values) < 50 * ROUNDING


def test_triangular_and_zero_matrices_have_their_diagonal():
    matrix = np.triu(random_matrix(np.random.default_rng(4), 5))
    assert distance(_core.eigenvalues(matrix), np.diag(matrix)) == 0.0
    np.testing.assert_array_equal(_core.eigenvalues(np.zeros((3, 3), complex)), 0.0)


def test_what_is_no_square_or_not_finite_is_refused():
    with pytest.raises(ValueError, match="square"):
        _core.eigenvalues(np.zeros((3, 4), complex))
    for value in (np.nan, np.inf):
        with pytest.raises(ValueError, match="finite"):
            _core.eigenvalues(np.full((3, 3), value, complex))
