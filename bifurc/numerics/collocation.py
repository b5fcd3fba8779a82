"""Curve pieces for a problem that offers no series: corrected points at Chebyshev
nodes, interpolated.

A piece follows the curve over a stretch of the hyperplane coordinate t . (u - u_0),
corrects a point at every Chebyshev node of it, and is accepted when the last
coefficients of the interpolant have fallen to the tolerance: spectral accuracy between
the nodes from nothing but F and F'.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from bifurc.numerics.bordered import Bordered
from bifurc.numerics.corrector import correct_across
from bifurc.problem import March, MarchStatus, Problem

__all__ = ["bridge_by_collocation", "march_by_collocation", "reparametrised"]

PREDICT_FROM = 10  # nodes through which the next one is predicted


def march_by_collocation(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    order: int,
    tolerance: float,
    shortest: float,
    longest: float,
    count: int,
) -> March:
    """Up to ``count`` pieces of the curve from ``start`` (n,) along ``tangent``."""
    point, gap, _ = correct_across(problem, start, tangent, tolerance)
    pieces: list[np.ndarray] = []
    radii: list[float] = []
    residuals: list[float] = []
    status = MarchStatus.RAN
    if gap > 100 * tolerance + 1e-12:
        return March(
            MarchStatus.OPEN,
            np.empty((0, order + 1, problem.n)),
            np.empty(0),
            np.empty(0),
            np.array([gap]),
        )
    heading, width = (
        Bordered(problem.jacobian(point) / problem.magnitude, tangent).null_vector(),
        longest / 4,
    )
    low, high = problem.bounds.T
    while len(pieces) < count and (
        not pieces or np.all((low <= point) & (point <= high))
    ):
        piece, length, residual, width = _piece(
            problem, point, heading, order, tolerance, shortest, width
        )
        if piece is None:
            status = MarchStatus.STALLED
            break
        pieces.append(piece)
        radii.append(length / 2)
        residuals.append(residual)
        point = piece.sum(axis=0)  # the value at x = 1
        slope = np.arange(order + 1) @ piece
        heading = slope / np.linalg.norm(slope)
        width = min(width, 2 * longest)
    half = np.array(radii)
    steps = half + np.concatenate([[0.0], half[:-1]]) if len(half) else half
    return March(
        status,
        np.array(pieces).reshape(-1, order + 1, problem.n),
        steps,
        half,
        np.array(residuals),
    )


def bridge_by_collocation(
    problem: Problem,
    start: np.ndarray,
    heading: np.ndarray,
    order: int,
    tolerance: float,
    width: float,
) -> tuple[np.ndarray, float, float] | None:
    """One piece of about ``width`` from ``start``: (coefficients (order + 1, n),
    arclength, residual), or None.

    Over a point in the middle where no series can be made: no node lies there, and the
    nodes next to it need only be as good as ``tolerance``.
    """
    odd = order - 1 + order % 2  # an even number of nodes leaves the middle free
    made = _attempt(problem, start, heading, odd, tolerance, width)
    if isinstance(made, float):
        return None
    piece, length, residual, _ = made
    return np.vstack([piece, np.zeros((order - odd, problem.n))]), length, residual


def _piece(
    problem: Problem,
    start: np.ndarray,
    heading: np.ndarray,
    order: int,
    tolerance: float,
    shortest: float,
    width: float,
) -> tuple[np.ndarray | None, float, float, float]:
    """One accepted piece (or None), its arclength, its residual and the width to try
    next."""
    while width >= shortest:
        made = _attempt(problem, start, heading, order, tolerance, width)
        if not isinstance(made, float):
            return made
        width *= made
    return None, 0.0, 0.0, width


def _attempt(
    problem: Problem,
    start: np.ndarray,
    heading: np.ndarray,
    order: int,
    tolerance: float,
    width: float,
) -> tuple[np.ndarray, float, float, float] | float:
    """A piece of the given width with the next width to try, or the factor by which the
    width is to shrink."""
    basis = _basis(order)
    nodes = _follow(problem, start, heading, basis, width, tolerance)
    if nodes is None:
        return 0.4
    coefficients = basis.from_values @ nodes
    tail, enough = float(np.abs(coefficients[-2:]).max()), tolerance * problem.scale
    if tail <= enough:
        piece, length = _by_arclength(coefficients)
        inside = np.vander(
            np.cos(np.pi * (np.arange(order) + 0.5) / order), order + 1, increasing=True
        )
        misfit = problem.residuals(inside @ piece) / problem.magnitude
        residual = float(np.linalg.norm(misfit, axis=1).max())
        if residual <= 30 * tolerance:
            growth = (enough / max(tail, 1e-18)) ** (1.0 / order)
            return piece, length, residual, width * min(1.6, max(0.7, 0.95 * growth))
        tail = max(tail, residual)
    return min(0.75, max(0.3, 0.9 * (enough / tail) ** (1.0 / order)))


@dataclass(frozen=True)
class _Basis:
    """Chebyshev polynomials up to an order: ``nodes`` from -1 to 1, the matrices that
    make coefficients ``from_values`` at the nodes and monomials ``to_powers``, the
    matrices that differentiate and integrate, and the weights (k,) for each k by which
    the first k nodes predict the next."""

    nodes: np.ndarray
    from_values: np.ndarray
    to_powers: np.ndarray
    derivative: np.ndarray
    integral: np.ndarray
    predictors: tuple[np.ndarray, ...]


@lru_cache(maxsize=64)
def _basis(order: int) -> _Basis:
    nodes = -np.cos(np.pi * np.arange(order + 1) / order)
    unit = np.eye(order + 1)
    to_powers = np.zeros((order + 1, order + 1))
    for k in range(order + 1):
        powers = chebyshev.cheb2poly(unit[k])
        to_powers[: len(powers), k] = powers
    from_values = np.linalg.inv(chebyshev.chebvander(nodes, order))
    return _Basis(
        nodes,
        from_values,
        to_powers,
        chebyshev.chebder(unit, axis=0),
        chebyshev.chebint(unit, lbnd=-1, axis=0),
        tuple(_predictor(nodes, k) for k in range(order + 1)),
    )


def _follow(
    problem: Problem,
    start: np.ndarray,
    heading: np.ndarray,
    basis: _Basis,
    width: float,
    tolerance: float,
) -> np.ndarray | None:
    """Curve points (k, n) at the nodes of a piece, which lies along ``heading`` from
    ``start``; None where correction fails.

    Each is predicted by the polynomial through the last few points before it, and
    corrected with the factorisation that served the one before it.
    """
    offsets = 0.5 * width * (basis.nodes + 1.0)
    points = np.empty((len(offsets), len(start)))
    points[0] = start
    factored: Bordered | None = Bordered(
        problem.jacobian(start) / problem.magnitude, heading
    )
    for k in range(1, len(offsets)):
        reach = offsets[k] - offsets[k - 1]
        guess = basis.predictors[k] @ points[:k] if k > 1 else start
        guess = guess + (offsets[k] - (guess - start) @ heading) * heading
        points[k], gap, factored = correct_across(
            problem, guess, heading, tolerance, factored
        )
        if (
            gap > 100 * tolerance
            or np.linalg.norm(points[k] - points[k - 1]) > 4 * reach
        ):
            return None
    return points


def _predictor(nodes: np.ndarray, k: int) -> np.ndarray:
    """Weights (k,) by which the values at the first ``k`` nodes give that of the
    polynomial through the last `PREDICT_FROM` of them at node ``k`` (Lagrange)."""
    weights, first = np.zeros(k), max(0, k - PREDICT_FROM)
    for i in range(first, k):
        others = np.delete(nodes[first:k], i - first)
        weights[i] = np.prod((nodes[k] - others) / (nodes[i] - others))
    return weights


def reparametrised(piece: np.ndarray) -> tuple[np.ndarray, float]:
    """A piece (order + 1, n) of monomials on [-1, 1], in any parameter, with arclength
    as parameter; and its length."""
    return _by_arclength(np.linalg.solve(_basis(len(piece) - 1).to_powers, piece))


def _by_arclength(coefficients: np.ndarray) -> tuple[np.ndarray, float]:
    """A Chebyshev piece (order + 1, n) on any coordinate as monomials in arclength on
    [-1, 1], and its length."""
    order = len(coefficients) - 1
    basis, fine = _basis(order), _basis(3 * order)
    slope = _polynomials(fine.nodes, order - 1) @ (basis.derivative @ coefficients)
    speed = fine.from_values @ np.linalg.norm(slope, axis=1)
    arclength = fine.integral @ speed
    length = float(arclength.sum())  # every Chebyshev polynomial is 1 at 1
    target, x = 0.5 * length * (basis.nodes + 1.0), basis.nodes.copy()
    for _ in range(8):
        values = _polynomials(x, len(speed))
        step = (values @ arclength - target) / (values[:, :-1] @ speed)
        x = np.clip(x - step, -1.0, 1.0)
        if np.abs(step).max() < 1e-8:  # the next would be its square
            break
    return basis.to_powers @ (
        basis.from_values @ (_polynomials(x, order) @ coefficients)
    ), length


def _polynomials(x: np.ndarray, order: int) -> np.ndarray:
    """Chebyshev polynomials (k, order + 1) at x (k,) within [-1, 1]."""
    return np.cos(np.outer(np.arccos(x), np.arange(order + 1)))
