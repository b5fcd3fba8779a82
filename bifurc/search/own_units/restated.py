"""An atlas that was found in units of the search, stated in the user's units.

Points and tangents are restated one by one. A curve is a polynomial of its arclength,
which is another one where the unknowns change by different factors: its pieces are made
again, short enough for the new arclength.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.isometry import Course, Unknowns, atlas_in
from bifurc.problem import Problem
from bifurc.units import Units

ORDER, FINE = 16, 48  # of a piece, and of its speed
EXACT = (
    1e-12  # error of a piece, over the length of the curve, in the units of the search
)
DEPTH = 60  # halvings of a piece
NEWTON_STEPS, LAST_STEP = 60, 1e-14
TINY = 1e-300  # keeps a length of zero from being divided by
# Chebyshev points and terms there, and the powers that the terms are made of.
NODES, FINE_NODES = chebyshev.chebpts1(ORDER + 1), chebyshev.chebpts1(FINE)
BETWEEN = np.linspace(-1.0, 1.0, 2 * ORDER)
POWERS = np.array(
    [
        np.pad(chebyshev.cheb2poly(row[: k + 1]), (0, ORDER - k))
        for k, row in enumerate(np.eye(ORDER + 1))
    ]
)


def restated(atlas: Atlas, problem: Problem, units: Units) -> Atlas:
    """An atlas in ``units`` as one of the ``problem``, which is the user's."""
    unknowns = Unknowns(
        names=problem.domain.names,
        units=problem.domain.units,
        periods=problem.domain.periods,
        points=units.outwards,
        directions=units.directions,
        bases=lambda bases: _restated_bases(bases, units),
        course=lambda branch: restated_branch(branch, units, problem.domain.periods),
        index=lambda index: index,
        size=float(units.sizes.max()),
    )
    return atlas_in(atlas, unknowns)


def _restated_bases(bases: np.ndarray, units: Units) -> np.ndarray:
    """Orthonormal bases (..., n, k) in ``units`` as those of the user's unknowns."""
    if units.is_uniform:
        return bases
    return np.linalg.qr(units.sizes[:, None] * bases)[0]


# --- curves ---------------------------------------------------------------------------


def restated_branch(branch: Branch, units: Units, periods: np.ndarray) -> Course:
    """A branch in ``units`` as one of the user's unknowns with ``periods`` (n,)."""
    if units.is_uniform or not len(branch.pieces):
        return _scaled_course(branch, units, periods)
    pieces: list[_Piece] = []
    numbers: list[int] = []  # of the pieces that they are parts of
    for number in np.flatnonzero(np.diff(branch.breaks) > 0.0):  # some have no length
        low, high = branch.breaks[number : number + 2]
        parts = _pieces_between(branch, units, float(low), float(high))
        pieces += parts
        numbers += [int(number)] * len(parts)
    lengths = np.array([piece.length for piece in pieces])
    ends = np.cumsum(lengths)
    starts = ends - lengths
    restated_pieces = Branch(
        pieces=np.array([piece.coefficients for piece in pieces]),
        centers=starts + 0.5 * lengths,
        radii=0.5 * lengths,
        breaks=np.concatenate([[0.0], ends]),
        residuals=branch.residuals[numbers],
        periods=periods,
        outcome=branch.outcome,
        gap=branch.gap,
    )
    former = np.array([piece.low for piece in pieces] + [branch.length])
    gains = np.array([piece.gains for piece in pieces])

    def arclengths(s: np.ndarray) -> np.ndarray:
        flat = np.ravel(s)
        of_piece = np.searchsorted(former, flat, side="right") - 1
        of_piece = np.clip(of_piece, 0, len(starts) - 1)
        low, high = former[of_piece], former[of_piece + 1]
        x = (2 * flat - low - high) / (high - low)
        terms = chebyshev.chebvander(x, gains.shape[1] - 1)
        gained = np.einsum("ik,ik->i", terms, gains[of_piece])
        return np.asarray(starts[of_piece] + gained).reshape(np.shape(s))

    return Course(restated_pieces, arclengths)


def _scaled_course(branch: Branch, units: Units, periods: np.ndarray) -> Course:
    """The same where all unknowns change by one factor, and arclengths with them."""
    size = float(units.sizes[0])
    pieces = size * branch.pieces
    if len(pieces):
        pieces[:, 0] += units.origin
    scaled = replace(
        branch,
        pieces=pieces,
        centers=size * branch.centers,
        radii=size * branch.radii,
        breaks=size * branch.breaks,
        periods=periods,
    )
    return Course(scaled, lambda s: size * s)


class _Piece(NamedTuple):
    """A piece from the former arclength ``low`` on: monomial ``coefficients`` (order +
    1, n) in the new arclength on [-1, 1], its ``length``, and the Chebyshev series of
    the ``gains`` in arclength."""

    low: float
    coefficients: np.ndarray
    length: float
    gains: np.ndarray


def _pieces_between(
    branch: Branch, units: Units, low: float, high: float, depth: int = 0
) -> list[_Piece]:
    """Pieces of a branch between two of its arclengths, halved until they are exact."""
    piece, error = _piece_between(branch, units, low, high)
    if error <= EXACT * branch.length or depth >= DEPTH:
        return [piece]
    middle = 0.5 * (low + high)
    return [
        *_pieces_between(branch, units, low, middle, depth + 1),
        *_pieces_between(branch, units, middle, high, depth + 1),
    ]


def _piece_between(
    branch: Branch, units: Units, low: float, high: float
) -> tuple[_Piece, float]:
    """One piece between two arclengths of a branch, and its error in the units of the
    search."""
    half = 0.5 * (high - low)
    velocity = units.sizes * branch(low + half * (1.0 + FINE_NODES), 1)
    speed = half * _series(np.linalg.norm(velocity, axis=1))
    gains = chebyshev.chebint(speed, lbnd=-1)
    length = float(gains.sum())
    targets = 0.5 * length * (1.0 + np.append(NODES, BETWEEN))
    places = _places(speed, gains, targets)
    points = branch(np.clip(low + half * (1.0 + places), low, high))
    series = _series(points[: ORDER + 1])
    missed = _terms(BETWEEN, ORDER + 1) @ series - points[ORDER + 1 :]
    monomials = (POWERS.T @ series) * units.sizes
    monomials[0] += units.origin
    return _Piece(low, monomials, length, gains), float(np.abs(missed).max())


def _terms(x: np.ndarray, count: int) -> np.ndarray:
    """The first Chebyshev polynomials (k, count) at x (k,) in [-1, 1]."""
    terms: np.ndarray = np.cos(
        np.arccos(np.clip(x, -1.0, 1.0))[:, None] * np.arange(count)
    )
    return terms


def _series(values: np.ndarray) -> np.ndarray:
    """Chebyshev coefficients (k, ...) of values (k, ...) at the Chebyshev points."""
    count = len(values)
    terms = _terms(FINE_NODES if count == FINE else NODES, count)
    weights = np.full(count, 2.0 / count)
    weights[0] = 1.0 / count
    series: np.ndarray = (terms * weights).T @ values
    return series


def _places(speed: np.ndarray, gains: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Where on [-1, 1] the arclength is that of the targets (k,), by Newton's method
    kept within a bracket."""
    low, high = np.full(len(targets), -1.0), np.full(len(targets), 1.0)
    x = np.clip(2 * targets / max(float(gains.sum()), TINY) - 1.0, -1.0, 1.0)
    for _ in range(NEWTON_STEPS):
        terms = _terms(x, len(gains))
        error = terms @ gains - targets
        low = np.where(error < 0, x, low)
        high = np.where(error > 0, x, high)
        newton = x - error / np.maximum(terms[:, :-1] @ speed, TINY)
        is_inside = (newton > low) & (newton < high)
        following = np.where(is_inside, newton, 0.5 * (low + high))
        following = np.where(np.abs(newton - x) < LAST_STEP, x, following)
        if np.array_equal(following, x):
            break
        x = following
    return x
