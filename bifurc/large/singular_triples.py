"""The few smallest singular values of F', by Lanczos' method on an inverse: at a point,
along a curve, and those that go to zero together at one place of it.

M is F' with the tangent t of the curve under it. Its singular values are those of F'
and the 1 of t, as t is across the rows of F'. The largest eigenvalues of M^-1 M^-T are
the inverse squares of the smallest of them; none of these products is formed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.domain import LARGE
from bifurc.large.bordered_system import BorderedSystem
from bifurc.large.scaled_problem import ScaledProblem

# of singular values, over the largest of their inverse squares: minima are located from
# them, and singular points by Newton's method
TOLERANCE = 1e-6
# Shares of the distance to the next place of a profile: how far beside a zero values are
# taken, so that no matrix is singular, and how near to each other zeros are one for a
# first try. What comes of the try decides.
BESIDE, TOGETHER = 0.05, 0.02
STRAYS = 3  # smaller values that vanish elsewhere, after which none is looked for
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
    if n <= LARGE or count + len(excluded) >= n:  # ARPACK wants room for more vectors
        values, vectors = np.linalg.eigh(operator @ np.eye(n))
        values, vectors = values[-count:], vectors[:, -count:]
    else:
        begin = np.random.default_rng(0).normal(size=n)
        values, vectors = eigsh(operator, count, tol=TOLERANCE, v0=begin)
    return list(zip(values.tolist(), vectors.T, strict=True))


# --- along a curve ---------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class SingularProfile:
    """The smallest singular ``triples``, in increasing order, at each of the ``places``
    (k,) of a curve, by arclength."""

    places: np.ndarray
    triples: list[list[SingularTriple]]

    @property
    def values(self) -> np.ndarray:
        """The singular values (k, q), over the magnitude, nan where fewer are known."""
        count = max((len(row) for row in self.triples), default=0)
        values = np.full((len(self.triples), count), np.nan)
        for row, triples in zip(values, self.triples, strict=True):
            row[: len(triples)] = [triple.value for triple in triples]
        return values

    @property
    def smallest(self) -> np.ndarray:
        """The smallest singular value (k,) at each place."""
        return np.array([row[0].value if row else np.inf for row in self.triples])


def singular_profile(
    problem: ScaledProblem, branch: Branch, places: int, count: int
) -> SingularProfile:
    """The ``count`` smallest singular values at so many ``places`` of each piece."""
    if not count or not len(branch.pieces):
        return SingularProfile(np.empty(0), [])
    shares = (np.arange(places) + 0.5) / places
    arclengths = branch.places(shares).ravel()
    triples = [triples_at(problem, branch, s, count) for s in arclengths.tolist()]
    return SingularProfile(arclengths, triples)


def triples_at(
    problem: ScaledProblem, branch: Branch, s: float, count: int
) -> list[SingularTriple]:
    """The ``count`` smallest singular values at an arclength."""
    tangent = unit_tangent(branch, s)
    return smallest_singular_triples(problem, branch(s), tangent, count)


def unit_tangent(branch: Branch, s: float) -> np.ndarray:
    """The unit tangent (n,) of a curve at an arclength."""
    tangent = branch(s, 1)
    unit: np.ndarray = tangent / np.linalg.norm(tangent)
    return unit


# --- that vanish together --------------------------------------------------------------


def zero_ahead(
    problem: ScaledProblem, branch: Branch, s: float, triple: SingularTriple
) -> float:
    """Where a singular value at arclength ``s`` would be zero by its slope along the
    curve, w^T F''(v, t)."""
    tangent = unit_tangent(branch, s)
    change = problem.second_derivative(branch(s), tangent, triple.right)
    slope = float(triple.left @ change)
    return s - triple.value / slope if slope else np.inf


def vanishing_group(
    problem: ScaledProblem, branch: Branch, zero: float, width: float
) -> list[SingularTriple]:
    """The singular values that vanish about arclength ``zero`` of a curve, as they are a
    little beside it; places are ``width`` apart.

    They come one by one, square to those before, so that each value is there as many
    times as it has vectors.
    """
    beside = zero + BESIDE * width
    if beside > branch.length:
        beside = zero - BESIDE * width
    group: list[SingularTriple] = []
    tangent = unit_tangent(branch, beside)
    strays = 0
    for triple in smallest_triples_by(problem, branch(beside), tangent):
        ahead = zero_ahead(problem, branch, beside, triple)
        if abs(ahead - zero) <= TOGETHER * width:
            group.append(triple)
            continue
        strays += 1
        if group or strays > STRAYS:
            break
    return group
