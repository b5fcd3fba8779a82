"""Eigenvalues along a curve of a large problem, and the Hopf points at which a pair of
them passes the imaginary axis.

The equations are taken as u' = F(u, p), A is F' without the parameter's column, in the
user's units. Eigenvalues next to a shift are the largest of (A - shift)^-1, by Arnoldi's
method with sparse LU factors (Meerbergen, Spence and Roose 1994).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_hopf_of_many
from bifurc.domain import LARGE
from bifurc.large.large_branch import NO_EIGENVALUES, Eigenvalues, LargePoint
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.singular_triples import unit_tangent
from bifurc.numerics.bordered import factors_by_rounding
from bifurc.numerics.corrector import correct_across
from bifurc.singular.point import Kind

if TYPE_CHECKING:
    from scipy.sparse import csc_array

TOLERANCE = 1e-10  # of eigenvalues of the inverse, over the largest
CORRECTED = 1e-12  # last step of a correction onto the curve, over the scale
LOCATED = 1e-13  # arclength over that between places to which the axis is located
NEAREST = 0.9  # share of how far eigenvalues are known that is compared at two places
HALVINGS = 4  # of the distance between places where eigenvalues are not told apart


@dataclass(frozen=True, eq=False)
class HopfSearch:
    """Hopf ``points``, and stretches (low, high) of the arclength that are ``unsettled``:
    eigenvalues change sides there in a way that their places do not tell."""

    points: list[LargePoint]
    unsettled: tuple[tuple[float, float], ...]


def eigenvalues_along(
    problem: ScaledProblem, branch: Branch, places: int, count: int, shift: complex
) -> Eigenvalues:
    """The ``count`` eigenvalues next to a ``shift`` at so many ``places`` of each piece,
    and at both ends of the curve."""
    if not count or not len(branch.pieces):
        return NO_EIGENVALUES
    shares = (np.arange(places) + 0.5) / places
    inner = branch.places(shares).ravel()
    arclengths = np.concatenate([[0.0], inner, [branch.length]])
    values = [_at(problem, branch, s, count, shift) for s in arclengths.tolist()]
    return Eigenvalues(shift, arclengths, np.array(values))


def _at(
    problem: ScaledProblem, branch: Branch, s: float, count: int, shift: complex
) -> np.ndarray:
    """The eigenvalues (q,) next to a ``shift`` at an arclength, the nearest first."""
    tangent = unit_tangent(branch, s)
    point = correct_across(problem, branch(s), tangent, CORRECTED).point
    outwards = problem.own_units.outwards(point)
    square = problem.problem.jacobian(outwards)[:, :-1].tocsc()
    n = square.shape[0]
    if n <= LARGE or count >= n - 1:  # ARPACK wants room for more vectors
        values = np.linalg.eigvals(square.toarray())
    else:
        values = _by_shifted_inverse(square, count, shift)
    order = np.argsort(np.abs(values - shift), kind="stable")
    return np.asarray(values[order[:count]], dtype=complex)


def _by_shifted_inverse(square: csc_array, count: int, shift: complex) -> np.ndarray:
    """The ``count`` eigenvalues of a sparse matrix (n, n) next to a ``shift``."""
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import LinearOperator, eigs

    own = shift.real if shift.imag == 0.0 else shift
    shifted = (square - own * eye_array(square.shape[0])).tocsc()
    factors = factors_by_rounding(shifted, float(np.abs(square.data).max()))
    dtype = shifted.dtype
    operator = LinearOperator(square.shape, factors.solve, dtype=dtype)
    begin = np.random.default_rng(0).normal(size=square.shape[0]).astype(dtype)
    inverses = eigs(operator, count, tol=TOLERANCE, v0=begin, return_eigenvectors=False)
    return np.asarray(own + 1.0 / inverses)


# --- where they pass the axis ----------------------------------------------------------


def hopf_points_on(
    problem: ScaledProblem, branch: Branch, eigenvalues: Eigenvalues
) -> HopfSearch:
    """The Hopf points between places at which eigenvalues are known.

    A pair is the same at two places where each is the nearest to the other. Where more
    or fewer of those that are known at both are unstable than have changed sides, places
    between are looked at as well.
    """
    search = _Search(problem, branch, eigenvalues)
    upper = [_upper(row) for row in eigenvalues.values]
    rows = zip(eigenvalues.places.tolist(), upper, strict=True)
    for (low, before), (high, after) in pairwise(rows):
        search.between(low, before, high, after, HALVINGS)
    return HopfSearch(search.points, tuple(search.unsettled))


class _Search:
    """The search for Hopf ``points`` on one curve, between any two places of it."""

    def __init__(self, problem: ScaledProblem, branch: Branch, known: Eigenvalues):
        self.points: list[LargePoint] = []
        self.unsettled: list[tuple[float, float]] = []
        self._problem, self._branch, self._known = problem, branch, known
        self._count = known.values.shape[1]

    def between(
        self,
        low: float,
        before: np.ndarray,
        high: float,
        after: np.ndarray,
        halvings: int,
    ) -> None:
        """Look between arclengths with the eigenvalues ``before`` and ``after`` (q,)."""
        first, last = _partners(before, after)
        has_crossed = (before[first].real > 0.0) != (after[last].real > 0.0)
        change = np.sign(after[last][has_crossed].real).sum()
        if change == self._change(before, after):
            for k in np.flatnonzero(has_crossed & (before[first].imag > 0.0)):
                self._locate(low, before[first[k]], high, after[last[k]])
        elif halvings:
            middle = 0.5 * (low + high)
            values = _upper(self._at(middle, self._count, self._known.shift))
            self.between(low, before, middle, values, halvings - 1)
            self.between(middle, values, high, after, halvings - 1)
        else:
            self.unsettled.append((low, high))

    def _change(self, before: np.ndarray, after: np.ndarray) -> int:
        """By how much the number of unstable eigenvalues grows, of those that are as
        near to the shift as all are known at both places."""
        shift = self._known.shift
        reach = min(np.abs(row - shift).max(initial=0.0) for row in (before, after))
        counts = [
            np.count_nonzero((row.real > 0.0) & (np.abs(row - shift) < NEAREST * reach))
            for row in (before, after)
        ]
        return int(counts[1] - counts[0])

    def _locate(self, low: float, before: complex, high: float, after: complex) -> None:
        """Record the Hopf point at which an eigenvalue ``before`` is imaginary that is
        ``after`` at the other end."""
        from scipy.optimize import brentq

        def eigenvalue(s: float) -> complex:
            share = (s - low) / (high - low)
            expected = before + share * (after - before)
            return complex(self._at(s, 1, complex(expected))[0])

        ends = (eigenvalue(low).real, eigenvalue(high).real)
        if ends[0] * ends[1] > 0.0:
            self.unsettled.append((low, high))
            return
        width = LOCATED * (high - low)
        s = float(brentq(lambda s: eigenvalue(s).real, low, high, xtol=width))
        value = eigenvalue(s)
        gap = abs(value.real) / abs(value)
        if not is_hopf_of_many(gap):
            self.unsettled.append((low, high))
            return
        tangent = unit_tangent(self._branch, s)
        corrected = correct_across(
            self._problem, self._branch(s), tangent, CORRECTED
        ).point
        u = self._problem.own_units.outwards(corrected)
        frequency = abs(value.imag)
        self.points.append(LargePoint(Kind.HOPF, s, u, gap, frequency=frequency))

    def _at(self, s: float, count: int, shift: complex) -> np.ndarray:
        return _at(self._problem, self._branch, s, count, shift)


def _upper(values: np.ndarray) -> np.ndarray:
    """Those of the eigenvalues (q,) of a real matrix that are on the real axis or above
    it: the others mirror them."""
    return values[values.imag >= 0.0]


def _partners(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The numbers of eigenvalues ``before`` and ``after`` (q,) of which each is the
    nearest to the other."""
    if not len(before) or not len(after):
        nothing = np.empty(0, dtype=int)
        return nothing, nothing
    distances = np.abs(before[:, None] - after)
    nearest, back = distances.argmin(axis=1), distances.argmin(axis=0)
    first = np.flatnonzero(back[nearest] == np.arange(len(before)))
    return first, nearest[first]
