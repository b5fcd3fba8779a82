"""A factorised bordered matrix solves its system, whichever way it is factorised."""

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array, eye_array, hstack, vstack
from scipy.sparse.linalg import splu

from bifurc.numerics.bordered import Bordered, SparseBordered


def chain(n):
    """Second differences with a border column, (n, n + 1), sparse."""
    ones = np.ones(n)
    band = diags_array([ones[1:], -1.9 * ones, ones[1:]], offsets=[-1, 0, 1])
    return csc_array(hstack([band, 1e-3 * ones[:, None]]))


@pytest.mark.parametrize("magnitude", [1.0, 1e-6, 1e6])
def test_sparse_and_dense_factorisations_agree_whatever_the_size_of_the_equations(
    magnitude,
):
    rng = np.random.default_rng(0)
    matrix, tangent, residual = (
        chain(60) * magnitude,
        rng.normal(size=61),
        magnitude * rng.normal(size=60),
    )
    dense = Bordered.factored(matrix.toarray(), tangent)
    for factored in (
        Bordered.factored(matrix, tangent),
        Bordered.factored(np.vstack([matrix.toarray()] * 2), tangent),
    ):
        right = residual if factored._rows == 60 else np.tile(residual, 2)
        assert np.allclose(
            factored.solve(right, 0.3), dense.solve(residual, 0.3), rtol=1e-9
        )
        assert np.allclose(factored.null_vector(), dense.null_vector(), atol=1e-12)


def test_the_border_does_not_fill_a_sparse_factorisation(monkeypatch):
    made = []

    def factorise(*arguments, **options):
        made.append(splu(*arguments, **options))
        return made[-1]

    monkeypatch.setattr("scipy.sparse.linalg.splu", factorise)
    matrix = chain(500)
    right = np.ones((501, 2))
    solved = SparseBordered(matrix, np.linspace(0.1, 1.0, 501)[None]).solve(right)
    assert np.allclose(matrix @ solved, 1.0, atol=1e-9)
    assert made[0].L.nnz + made[0].U.nnz < 4 * matrix.nnz


def test_a_border_fills_no_long_chain_with_a_fold(monkeypatch) -> None:
    # about singular without the border: pivots fall along the chain, and the border grows
    made = []

    def factorise(*arguments, **options):
        made.append(splu(*arguments, **options))
        return made[-1]

    monkeypatch.setattr("scipy.sparse.linalg.splu", factorise)
    n = 20_000
    second = diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(n, n))
    lowest = 4 * np.sin(0.5 * np.pi / (n + 1)) ** 2
    wave = np.sin(np.pi * np.arange(1, n + 1) / (n + 1))
    matrix = csc_array(
        hstack([second + lowest * eye_array(n), csc_array(wave[:, None])])
    )
    tangent = np.append(wave, 0.5)
    right = np.append(np.zeros(n), 1.0)
    solution = SparseBordered(matrix, tangent[None], may_be_singular=True).solve(right)
    expected = np.append(wave, 0.0) / (wave @ wave)
    assert np.allclose(solution, expected, atol=1e-6 * expected.max())
    assert made[0].L.nnz + made[0].U.nnz < 4 * matrix.nnz


def test_small_pivots_along_a_chain_cost_no_digits() -> None:
    # of v_k = v_{k-1} / 2 + ... the entry 1/2 would do as a pivot: 2^120 is lost then
    n = 120
    chain = diags_array([1.0, -0.5, 0.3], offsets=[2, 1, 0], shape=(n - 2, n))
    circle = csc_array(([1.6, 1.2], ([0, 0], [0, 1])), shape=(1, n))
    matrix = csc_array(vstack([circle, chain]))
    tangent = np.linalg.svd(matrix.toarray())[2][-1]
    right = np.random.default_rng(0).normal(size=n)
    expected = np.linalg.solve(np.vstack([matrix.toarray(), tangent]), right)
    assert np.allclose(
        SparseBordered(matrix, tangent[None]).solve(right), expected, atol=1e-11
    )
