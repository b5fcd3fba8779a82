"""The valley of a system that contradicts itself a little, as a system of its own.

With F' = U diag(sigma) V^T let P be the projection on the first n - 1 columns of U, the
directions in which a move across a curve changes F. A point lies on the valley where

    G(u) = P(u) F(u) = 0:

no move across it makes |F| smaller; see `bifurc.curves.valley`. Unlike F = 0 these
equations agree with each other, whatever errors F has. So the valley is a curve like any
other: known to rounding, closed or not, the same from every start. P changes along w by

    P' = sum_{i < n <= j} b_ij (u_i u_j^T + u_j u_i^T),
    b_ij = (sigma_j u_i . F''(w, v_j) + sigma_i u_j . F''(w, v_i))
           / (sigma_i^2 - sigma_j^2)

(first-order perturbation of F' F'^T; compiled, in `bifurc/core/valley.hpp`). On the
valley all that is left of F is misclosure.

Where forms crossed, the valley is smooth and turns: the crossing has opened. Where the
rank of F' dropped on a single form there are two equations of second order on the null
space, x y + e = 0 and y^2 + e' = 0 say, e and e' of the order of the misclosure. Within
its root of the place the valley is not single: it may split in two that lead away from
the form, while straight on the system is solved as nearly as before. `bridge` goes
straight on there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.polynomial import chebyshev

from bifurc import _core
from bifurc.branch import points_on_piece
from bifurc.curves.track import SplitCurve
from bifurc.decisions import has_one_form, has_valley, is_beside_drop, nearly_closes
from bifurc.function_problem import NumericalProblem
from bifurc.numerics.collocation import (
    PieceRules,
    reparametrised,
)
from bifurc.numerics.corrector import correct_across
from bifurc.numerics.null_spaces import Decomposition, decompose
from bifurc.problem import Problem
from bifurc.system import (
    Piece,
    hessian_at,
    relative_gaps,
    relative_jacobians,
    relative_residuals,
)

TINY = 1e-30  # keeps a difference of squared singular values from being zero
# Places on a piece, from -1 to 1, at which it is seen whether there is a valley.
LOOKS = np.linspace(-1.0, 1.0, 9)
BRIDGE_NODES = 40  # of a bridge, but for those in its middle
LEAST_NODES = 6  # on either side of that
BRIDGE_DEGREE = 9
PREDICTOR = 5  # degree of the polynomial by which the next node is predicted
BRIDGE_ERROR = 0.5  # of the root of the misclosure, over the scale: at the nodes


class ValleyProblem(NumericalProblem, SplitCurve):
    """G = P F of the problem ``of``: its solutions are the curves along which that is
    nearly solved.

    They are followed as far as it nearly closes.
    """

    def __init__(self, of: Problem):
        self.of = of
        self.rank = of.n - 1
        # crossings have opened, and the valley turns
        self.domain = replace(of.domain, rim=self._beyond, has_crossings=False)
        self.magnitude = of.magnitude
        self.rules = PieceRules(
            corrector=of.shortcuts.valley_corrector, is_allowed=self._is_single_on
        )

    # --- G and G' ---------------------------------------------------------------------

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """G (k, m) at points (k, n)."""
        residuals = relative_residuals(self.of, points)
        jacobians = relative_jacobians(self.of, points)
        projected: np.ndarray = _core.valley_residuals(residuals, jacobians)
        return projected * self.magnitude

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """G' (k, m, n) at points (k, n): P F' + P' F."""
        residuals = relative_residuals(self.of, points)
        jacobians = relative_jacobians(self.of, points)
        hessians = self.of.hessians(points) / self.magnitude
        count, m, n = jacobians.shape
        rows = hessians.reshape(count, m * n, n)
        derivatives: np.ndarray = _core.valley_jacobians(residuals, jacobians, rows)
        return derivatives * self.magnitude

    # --- the region -------------------------------------------------------------------

    def _beyond(self, points: np.ndarray) -> np.ndarray:
        """How far points (k, n) lie outside the region (k,): outside that of F = 0, or by
        how much more than a near motion may they miss F = 0, over that."""
        outer = self.of.domain
        missed = relative_gaps(self.of, points) / nearly_closes.threshold - 1.0
        beyond: np.ndarray = np.maximum(outer.excess(points), missed * outer.scale)
        return beyond

    def missed(self, points: np.ndarray) -> np.ndarray:
        """What points (k, n) miss where the valley is not single (k,), else 0.

        A single unknown is its own valley: there is nothing across it.
        """
        if self.rank == 0:
            return np.zeros(len(points))
        at = decompose(self.of, points)
        gaps = np.linalg.norm(at.residuals, axis=1)
        squares = np.maximum(at.sigma[:, self.rank - 1], TINY) ** 2
        is_blurred = ~has_valley(gaps, squares)
        beside = is_beside_drop(squares, gaps) & ~is_blurred
        for i in np.flatnonzero(beside).tolist():
            is_blurred[i] = not has_one_form(self._second_form(points[i], at, i))
        return np.where(is_blurred, gaps, 0.0)

    def clearness(self, point: np.ndarray) -> float:
        """How far a point (n,) is from where the valley may split, negative within."""
        if self.rank == 0:
            return np.inf
        at = decompose(self.of, point[None])
        gap = max(float(np.linalg.norm(at.residuals[0])), TINY)
        square = float(at.sigma[0, self.rank - 1]) ** 2
        return square / gap - is_beside_drop.threshold

    def _second_form(self, point: np.ndarray, at: Decomposition, i: int) -> float:
        """The second singular value over the first of the quadratic forms that F'' has
        on the two weakest directions: where forms cross they are one form."""
        rank = self.rank
        hessian = hessian_at(self.of, point) / self.magnitude
        weakest = at.right[i, rank - 1 :]
        others = at.left[i, :, rank - 1 :]
        on_weakest = weakest @ hessian @ weakest.T  # (m, 2, 2)
        forms = np.tensordot(others.T, on_weakest, axes=1)
        rows = [forms[:, 0, 0], np.sqrt(2.0) * forms[:, 0, 1], forms[:, 1, 1]]
        sizes = np.linalg.svd(np.array(rows), compute_uv=False)
        if len(sizes) < 2:
            return 0.0
        return float(sizes[1] / max(sizes[0], TINY))

    # --- pieces -----------------------------------------------------------------------

    def _is_single_on(self, piece: Piece) -> bool:
        """Whether the valley is single all along a piece."""
        points = points_on_piece(piece.coefficients, LOOKS)
        return not np.any(self.missed(points) > 0)

    def bridge(
        self, start: np.ndarray, heading: np.ndarray, width: float, order: int
    ) -> Piece | None:
        """One piece of about ``width`` from ``start`` (n,) along ``heading`` (n,), None
        where there is none: through points of the valley on both sides of where that is
        not single."""
        shares = 0.5 - 0.5 * np.cos(
            np.pi * np.arange(BRIDGE_NODES) / (BRIDGE_NODES - 1)
        )
        offsets = width * shares
        points, is_single = self._points_across(start, heading, offsets)
        middle = BRIDGE_NODES // 2
        before, after = is_single[:middle], is_single[middle:]
        if min(before.sum(), after.sum()) < LEAST_NODES or not is_single[-1]:
            return None
        x = 2.0 * shares - 1.0
        degree = min(BRIDGE_DEGREE, order)
        basis = chebyshev.chebvander(x[is_single], degree)
        fit, *_ = np.linalg.lstsq(basis, points[is_single], rcond=None)
        off = basis @ fit - points[is_single]
        missed = float(relative_gaps(self.of, points[is_single]).max())
        allowed = BRIDGE_ERROR * np.sqrt(missed * self.domain.scale)
        if np.abs(off).max() > allowed:
            return None
        powers = np.zeros((order + 1, self.n))
        for k in range(self.n):
            coefficients = chebyshev.cheb2poly(fit[:, k])
            powers[: len(coefficients), k] = coefficients
        piece, length = reparametrised(powers)
        return Piece(piece, length, missed)

    def _points_across(
        self, start: np.ndarray, heading: np.ndarray, offsets: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Points (k, n) of the valley at ``offsets`` (k,) along a ``heading`` (n,), and
        whether it is single there (k,); where it is not they are only predicted."""
        points = np.empty((len(offsets), self.n))
        is_single = np.ones(len(offsets), dtype=bool)
        points[0] = start
        for k in range(1, len(offsets)):
            known = np.flatnonzero(is_single[:k])
            guess = start + offsets[k] * heading
            if len(known) > 2:
                degree = min(PREDICTOR, len(known) - 1)
                at = offsets[known] - offsets[k]
                guess = np.polynomial.polynomial.polyfit(at, points[known], degree)[0]
            corrected = correct_across(self, guess, heading, 1e-12)
            points[k] = corrected.point
            step = np.linalg.norm(corrected.point - guess)
            reach = max(offsets[k] - offsets[known[-1]], offsets[-1] / BRIDGE_NODES)
            is_near = step < 0.2 * reach
            is_single[k] = is_near and self.missed(points[k][None])[0] == 0.0
            if not is_single[k]:
                points[k] = guess
        return points, is_single
