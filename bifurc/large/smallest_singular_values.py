"""The few smallest singular values of F', by Lanczos' method on an inverse.

M is F' with the tangent t of the curve under it. Its singular values are those of F'
and the 1 of t, as t is across the rows of F'. The largest eigenvalues of M^-1 M^-T are
the inverse squares of the smallest of them; none of these products is formed.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bifurc.large.bordered_system import BorderedSystem
from bifurc.large.scaled_problem import ScaledProblem

# of singular values, over the largest of their inverse squares: minima are located from
# them, and singular points by Newton's method
TOLERANCE = 1e-6
FEW = 50  # unknowns up to which all of them are taken from a dense matrix
TINY = 1e-300  # keeps the inverse of a singular value of zero from being divided by


class SingularTriple(NamedTuple):
    """A singular ``value`` of F', over the magnitude, with its vectors ``left`` (n - 1,)
    and ``right`` (n,)."""

    value: float
    left: np.ndarray
    right: np.ndarray


def smallest_singular_triples(
    problem: ScaledProblem, point: np.ndarray, tangent: np.ndarray, count: int
) -> list[SingularTriple]:
    """The ``count`` smallest singular values of F' at a point (n,) of a curve with a
    unit ``tangent`` (n,), in increasing order; fewer where there are no more.

    Of a value that is there several times some may be left out, as Lanczos' method
    starts from one vector: `smallest_triples_by` has them all.
    """
    system = problem.bordered(point, tangent[None])
    return _triples(system, tangent[None], min(count, problem.n - 1))


def smallest_triples_by(
    problem: ScaledProblem, point: np.ndarray, tangent: np.ndarray
) -> Iterator[SingularTriple]:
    """The singular values of F' at a point (n,) of a curve with a unit ``tangent``
    (n,), the smallest first, each as many times as it has vectors: one after the other,
    square to those before."""
    system = problem.bordered(point, tangent[None])
    excluded = tangent[None]
    for _ in range(problem.n - 1):
        (triple,) = _triples(system, excluded, 1)
        yield triple
        part = triple.right - (excluded @ triple.right) @ excluded
        excluded = np.concatenate([excluded, part[None] / np.linalg.norm(part)])


def _triples(
    system: BorderedSystem, excluded: np.ndarray, count: int
) -> list[SingularTriple]:
    """The ``count`` smallest singular values with right vectors square to the
    ``excluded`` ones (k, n), in increasing order."""
    triples = []
    for inverse_square, right in _largest_of_inverse(system, excluded, count):
        value = 1.0 / np.sqrt(max(inverse_square, TINY))
        left = value * system.solve_transposed(right)[:-1]
        left /= np.linalg.norm(left)
        triples.append(SingularTriple(float(value), left, right))
    triples.sort(key=lambda triple: triple.value)
    return triples


def _largest_of_inverse(
    system: BorderedSystem, excluded: np.ndarray, count: int
) -> list[tuple[float, np.ndarray]]:
    """The largest eigenvalues of M^-1 M^-T, with unit eigenvectors (n,) square to the
    ``excluded`` ones (k, n). One of these is the tangent, the row of M under F': it is
    an eigenvector of 1 itself, which must not be mixed with those of F' that are 1 or
    more."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    def across(vector: np.ndarray) -> np.ndarray:
        flat = np.ravel(vector)
        part: np.ndarray = flat - (excluded @ flat) @ excluded
        return part

    n = excluded.shape[1]
    operator = LinearOperator(
        (n, n),
        lambda x: across(system.solve(system.solve_transposed(across(x)))),
        dtype=float,
    )
    if n <= FEW or count + len(excluded) >= n:  # ARPACK wants room for more vectors
        values, vectors = np.linalg.eigh(operator @ np.eye(n))
        values, vectors = values[-count:], vectors[:, -count:]
    else:
        begin = np.random.default_rng(0).normal(size=n)
        values, vectors = eigsh(operator, count, tol=TOLERANCE, v0=begin)
    return list(zip(values.tolist(), vectors.T, strict=True))
