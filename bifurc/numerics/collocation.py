"""Curve pieces for a problem that offers no series: corrected points at Chebyshev
nodes, interpolated.

A piece follows the curve over a stretch of the hyperplane coordinate t . (u - u_0),
corrects a point at every Chebyshev node of it, and is accepted when the last
coefficients of the interpolant have fallen to the tolerance: spectral accuracy between
the nodes from nothing but F and F'.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from bifurc.branch import points_on_piece
from bifurc.numerics.blur import ROUNDING, known_to
from bifurc.numerics.bordered import Bordered, bordered_at
from bifurc.numerics.corrector import correct_across, last_step
from bifurc.system import (
    CurveNodes,
    March,
    MarchSettings,
    MarchStatus,
    NodeCorrector,
    Piece,
    System,
    relative_gaps,
    relative_residuals,
)

AT_ONCE = 14  # pieces in one march
PREDICT_FROM = 10  # nodes through which the next one is predicted
LOOSE = 30  # times the tolerance: the residual that a piece may have between its nodes
TAIL = 4.0  # times the distance to which points are known: last coefficients
# times the misclosure at the start of a piece: the same, where the system misses closure
MISSED = 4.0
# Times the distance to which points are known: the tolerance to which they are
# corrected. A hundredth of that is left, and more corrections are rounding.
SETTLED = 1.0
FAILED = 0.4  # factor of the width where no correction converges
FAR = 4.0  # times the distance of neighbouring nodes: so far apart no points may be
NEWTON_STEPS = 8  # from a share of the arclength to the parameter


@dataclass(frozen=True)
class PieceRules:
    """How pieces are made and judged: by the order ``norm`` of the norm of vectors; by a
    ``corrector`` of all points at the nodes of a piece in one call, or one by one; and
    whether a piece ``is_allowed``."""

    norm: float = np.inf
    corrector: NodeCorrector | None = None
    is_allowed: Callable[[Piece], bool] = lambda piece: True


PLAIN_RULES = PieceRules()


@dataclass(frozen=True)
class _Aim:
    """Where a piece begins, (n,), the unit vector along which it lies, (n,), how good
    it has to be, to which distance, over the scale, its points are known, the
    ``misclosure`` of the curve itself, and the ``rules`` for it."""

    start: np.ndarray
    heading: np.ndarray
    order: int
    tolerance: float
    known_to: float
    misclosure: float = 0.0
    rules: PieceRules = PLAIN_RULES


@dataclass(frozen=True)
class _Accepted:
    """A piece, and the width to try for the next one."""

    piece: Piece
    next_width: float


@dataclass(frozen=True)
class _Rejected:
    """The factor by which the width has to shrink."""

    factor: float


# --- marches and bridges --------------------------------------------------------------


def march_by_collocation(
    problem: System,
    start: np.ndarray,
    tangent: np.ndarray,
    settings: MarchSettings,
    rules: PieceRules = PLAIN_RULES,
) -> March:
    """Pieces of the curve from ``start`` (n,) along ``tangent`` (n,), up to the first
    that is not allowed by the ``rules``; no more than `AT_ONCE`, as they do not end where
    the curve does."""
    order, tolerance = settings.order, settings.tolerance
    corrected = correct_across(problem, start, tangent, tolerance)
    closing = 100 * tolerance + settings.closing
    if corrected.gap > closing:
        return March.without_solution(corrected.gap, order, problem.n)
    point = corrected.point
    heading = bordered_at(problem, point, tangent).null_vector()
    width = min(settings.longest / 4, max(settings.first, settings.shortest))
    pieces: list[Piece] = []
    # before a cusp a residual is left that is no misclosure
    may_miss = settings.closing > closing / 2
    misclosure = max(settings.misclosure, corrected.gap) if may_miss else 0.0
    count = min(settings.count, AT_ONCE)
    while len(pieces) < count:
        is_inside = problem.domain.are_inside(point[None])[0]
        covered = sum(piece.length for piece in pieces)
        if pieces and (not is_inside or covered > settings.length):
            break
        known_to = _known_to(problem, point, misclosure)
        aim = _Aim(point, heading, order, tolerance, known_to, misclosure, rules)
        accepted = _next_piece(problem, aim, width, settings.shortest)
        if accepted is None or misclosure > closing:
            return March.of_pieces(MarchStatus.STALLED, pieces, order, problem.n)
        if not rules.is_allowed(accepted.piece):
            return March.of_pieces(MarchStatus.STALLED, pieces, order, problem.n)
        pieces.append(accepted.piece)
        point, heading = _end(accepted.piece)
        if may_miss:
            misclosure = max(misclosure, float(relative_gaps(problem, point[None])[0]))
        width = min(accepted.next_width, 2 * settings.longest)
    return March.of_pieces(MarchStatus.RAN, pieces, order, problem.n)


def _end(piece: Piece) -> tuple[np.ndarray, np.ndarray]:
    """Point (n,) and unit tangent (n,) at x = 1, where every power of x is 1."""
    point = piece.coefficients.sum(axis=0)
    slope = np.arange(len(piece.coefficients)) @ piece.coefficients
    return point, slope / np.linalg.norm(slope)


def bridge_by_collocation(
    problem: System,
    start: np.ndarray,
    heading: np.ndarray,
    order: int,
    tolerance: float,
    width: float,
    misclosure: float = 0.0,
) -> Piece | None:
    """One piece of about ``width`` from ``start`` (n,) along ``heading`` (n,), or None.

    Over a point in the middle where no series can be made: no node lies there, and the
    nodes next to it need only be as good as ``tolerance``, beyond the ``misclosure`` of
    the curve.
    """
    odd = order - 1 + order % 2  # an even number of nodes leaves the middle free
    known_to = _known_to(problem, start, misclosure)
    aim = _Aim(start, heading, odd, tolerance, known_to, misclosure)
    attempt = _attempt(problem, aim, width)
    if isinstance(attempt, _Rejected):
        return None
    highest = np.zeros((order - odd, problem.n))
    coefficients = np.vstack([attempt.piece.coefficients, highest])
    return replace(attempt.piece, coefficients=coefficients)


# --- one piece ------------------------------------------------------------------------


def _next_piece(
    problem: System, aim: _Aim, width: float, shortest: float
) -> _Accepted | None:
    """A piece of ``width`` or less; None where even one of the ``shortest`` width
    fails."""
    while width >= shortest:
        attempt = _attempt(problem, aim, width)
        if isinstance(attempt, _Accepted):
            return attempt
        width *= attempt.factor
    return None


def _attempt(problem: System, aim: _Aim, width: float) -> _Accepted | _Rejected:
    """A piece of the given width, if its last coefficients and its residual are small
    enough."""
    basis = _basis(aim.order)
    nodes = _points_at_nodes(problem, aim, basis, width)
    if nodes is None:
        return _Rejected(FAILED)
    coefficients = basis.from_values @ nodes
    tail = float(np.linalg.norm(coefficients[-2:], aim.rules.norm, axis=1).max())
    # below the distance to which points are known, coefficients are rounding
    enough = max(aim.tolerance, TAIL * aim.known_to) * problem.domain.scale
    root = 1.0 / aim.order  # the tail goes with this power of the width, upside down
    if tail <= enough:
        powers, length = _by_arclength(coefficients)
        residual = _residual_between_nodes(problem, powers)
        if residual <= LOOSE * aim.tolerance + MISSED * aim.misclosure:
            piece = Piece(powers, length, residual)
            growth = (enough / max(tail, 1e-18)) ** root
            factor = min(1.6, max(0.7, 0.95 * growth))
            return _Accepted(piece, width * factor)
        tail = max(tail, residual)
    shrinkage = (enough / tail) ** root
    return _Rejected(min(0.75, max(0.3, 0.9 * shrinkage)))


def _known_to(problem: System, point: np.ndarray, misclosure: float) -> float:
    """The distance, over the scale, to which a point (n,) of a curve with a
    ``misclosure`` is known; 0 for a large problem, of which singular values are not
    taken."""
    if problem.domain.is_large:
        return 0.0
    by_rounding = float(known_to(problem, point[None])[0])
    return by_rounding * max(1.0, misclosure / ROUNDING)


def _residual_between_nodes(problem: System, piece: np.ndarray) -> float:
    """Largest relative residual of a piece (order + 1, n) at places between its
    nodes."""
    order = len(piece) - 1
    angles = np.pi * (np.arange(order) + 0.5) / order
    points = points_on_piece(piece, np.cos(angles))
    residuals = relative_residuals(problem, points)
    sizes = np.linalg.norm(residuals, axis=1)
    return float(sizes.max())


def _points_at_nodes(
    problem: System, aim: _Aim, basis: _Basis, width: float
) -> np.ndarray | None:
    """Curve points (k, n) at the nodes of a piece; None where correction fails.

    Each is predicted by the polynomial through the last few points before it, and
    corrected with the factorisation that served the one before it.
    """
    start, heading = aim.start, aim.heading
    offsets = 0.5 * width * (basis.nodes + 1.0)
    # Nearer than rounding lets a point be known no correction leads. Where curves cross
    # the corrections are to go on: what is left of them is what the certificate sees.
    enough = aim.tolerance
    if not problem.domain.has_crossings:
        enough = max(enough, SETTLED * aim.known_to)
    most = 100 * aim.tolerance + MISSED * aim.misclosure
    if aim.rules.corrector is not None:
        step = last_step(enough, problem.domain.scale)
        nodes = CurveNodes(start, heading, offsets, basis.all_predictors, step, most)
        return aim.rules.corrector(nodes)
    points = np.empty((len(offsets), len(start)))
    points[0] = start
    factored: Bordered | None = bordered_at(problem, start, heading)
    for k in range(1, len(offsets)):
        guess = basis.predictors[k] @ points[:k] if k > 1 else start
        covered = (guess - start) @ heading
        guess = guess + (offsets[k] - covered) * heading
        corrected = correct_across(problem, guess, heading, enough, factored)
        points[k] = corrected.point
        factored = corrected.factored
        step = points[k] - points[k - 1]
        expected = offsets[k] - offsets[k - 1]
        is_far = np.linalg.norm(step) > FAR * expected
        if is_far or corrected.gap > most:
            return None
    return points


# --- Chebyshev polynomials ------------------------------------------------------------


@dataclass(frozen=True)
class _Basis:
    """Chebyshev polynomials up to an order: ``nodes`` from -1 to 1, the matrices that
    make coefficients ``from_values`` at the nodes and monomials ``to_powers``, the
    matrices that differentiate and integrate, and the weights (k,) for each k by which
    the first k nodes predict the next, also as rows of one matrix."""

    nodes: np.ndarray
    from_values: np.ndarray
    to_powers: np.ndarray
    derivative: np.ndarray
    integral: np.ndarray
    predictors: tuple[np.ndarray, ...]
    all_predictors: np.ndarray


@lru_cache(maxsize=64)
def _basis(order: int) -> _Basis:
    angles = np.pi * np.arange(order + 1) / order
    nodes = -np.cos(angles)
    unit = np.eye(order + 1)
    to_powers = np.zeros((order + 1, order + 1))
    for k in range(order + 1):
        powers = chebyshev.cheb2poly(unit[k])
        to_powers[: len(powers), k] = powers
    predictors = [_predictor(nodes, k) for k in range(order + 1)]
    all_predictors = np.zeros((order + 1, order + 1))
    for k, weights in enumerate(predictors):
        all_predictors[k, :k] = weights
    return _Basis(
        nodes=nodes,
        from_values=np.linalg.inv(chebyshev.chebvander(nodes, order)),
        to_powers=to_powers,
        derivative=chebyshev.chebder(unit, axis=0),
        integral=chebyshev.chebint(unit, lbnd=-1, axis=0),
        predictors=tuple(predictors),
        all_predictors=all_predictors,
    )


def _predictor(nodes: np.ndarray, k: int) -> np.ndarray:
    """Weights (k,) by which the values at the first ``k`` nodes give that of the
    polynomial through the last `PREDICT_FROM` of them at node ``k`` (Lagrange)."""
    first = max(0, k - PREDICT_FROM)
    weights = np.zeros(k)
    for i in range(first, k):
        others = np.delete(nodes[first:k], i - first)
        ratios = (nodes[k] - others) / (nodes[i] - others)
        weights[i] = np.prod(ratios)
    return weights


def _polynomials(x: np.ndarray, order: int) -> np.ndarray:
    """Chebyshev polynomials (k, order + 1) at x (k,) within [-1, 1]."""
    angles = np.outer(np.arccos(x), np.arange(order + 1))
    return np.cos(angles)


# --- arclength as parameter -----------------------------------------------------------


def reparametrised(piece: np.ndarray) -> tuple[np.ndarray, float]:
    """A piece (order + 1, n) of monomials on [-1, 1], in any parameter, with arclength
    as parameter; and its length."""
    to_powers = _basis(len(piece) - 1).to_powers
    return _by_arclength(np.linalg.solve(to_powers, piece))


def piece_through(curve: Callable[[np.ndarray], np.ndarray], order: int) -> Piece:
    """The piece of an ``order`` with arclength as parameter along a ``curve`` that gives
    points (k, n) at places (k,) in [-1, 1]; its residual is not known."""
    basis = _basis(order)
    coefficients, length = _by_arclength(basis.from_values @ curve(basis.nodes))
    return Piece(coefficients, length, np.nan)


def _by_arclength(coefficients: np.ndarray) -> tuple[np.ndarray, float]:
    """A Chebyshev piece (order + 1, n) on any coordinate as monomials in arclength on
    [-1, 1], and its length."""
    order = len(coefficients) - 1
    basis = _basis(order)
    fine = _basis(3 * order)
    derivative = basis.derivative @ coefficients
    slopes = _polynomials(fine.nodes, order - 1) @ derivative
    speed = fine.from_values @ np.linalg.norm(slopes, axis=1)
    arclength = fine.integral @ speed
    length = float(arclength.sum())  # every Chebyshev polynomial is 1 at 1
    x = _places_at_shares(speed, arclength, basis.nodes)
    values = basis.from_values @ (_polynomials(x, order) @ coefficients)
    return basis.to_powers @ values, length


def _places_at_shares(
    speed: np.ndarray, arclength: np.ndarray, nodes: np.ndarray
) -> np.ndarray:
    """Coordinates (k,) at which the share of the arclength covered is that of ``nodes``
    (k,) in [-1, 1], by Newton's method.

    ``speed`` and ``arclength`` are Chebyshev coefficients.
    """
    targets = 0.5 * float(arclength.sum()) * (nodes + 1.0)
    x = nodes.copy()
    for _ in range(NEWTON_STEPS):
        values = _polynomials(x, len(speed))
        errors = values @ arclength - targets
        steps = errors / (values[:, :-1] @ speed)
        x = np.clip(x - steps, -1.0, 1.0)
        if np.abs(steps).max() < 1e-8:  # the next would be its square
            break
    return x
