"""All places at which curves cross the zeros of a function, by intervals.

A curve is cut into stretches until bounds on the function along each of them show that
it has no zero there, or, by bounds on its rate, that it has one at most. What is left
are places at which the function vanishes with its rate, or very nearly so.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.equations.tape import Tape
from bifurc.numerics.roots import bracketed_roots

NARROWEST = 1e-8  # reach of a stretch, over the sizes, that is not cut any more
BLUR = 1e-11  # over the sizes: how well a curve is known
OVERLAP = 1e-6  # share of a stretch by which it is looked at beyond its ends
SAME = 1e-9  # of the length of a curve: zeros no farther apart are one
MOST_STRETCHES = 20_000  # at a time; where there are more, curves run along the zeros


class Crossing(NamedTuple):
    """A zero on a curve, by its number, at the arclength ``s``."""

    curve: int
    s: float


class Crossings(NamedTuple):
    """The zeros on curves, and the curves, by their numbers, on which some are not told
    from others, or from none."""

    zeros: tuple[Crossing, ...]
    unclear: frozenset[int]


class _Stretches(NamedTuple):
    """Stretches from ``low`` to ``high`` (k,) of pieces with ``coefficients`` (k,
    order + 1, n) of the powers of t in [-1, 1]; piece by piece the ``curve`` (k,) it
    belongs to, its ``center`` and ``radius`` (k,) in arclengths."""

    coefficients: np.ndarray
    low: np.ndarray
    high: np.ndarray
    curve: np.ndarray
    center: np.ndarray
    radius: np.ndarray

    @staticmethod
    def of(branches: Sequence[Branch]) -> _Stretches:
        """The pieces of branches, which have at least one."""
        order = max(branch.pieces.shape[1] for branch in branches)
        parts: list[list[np.ndarray]] = []
        for number, branch in enumerate(branches):
            missing = order - branch.pieces.shape[1]
            parts.append(
                [
                    np.pad(branch.pieces, ((0, 0), (0, missing), (0, 0))),
                    (branch.breaks[:-1] - branch.centers) / branch.radii,
                    (branch.breaks[1:] - branch.centers) / branch.radii,
                    np.full(len(branch.pieces), number),
                    branch.centers,
                    branch.radii,
                ]
            )
        return _Stretches(*map(np.concatenate, zip(*parts, strict=True)))

    def at(self, chosen: np.ndarray) -> _Stretches:
        """Those that are chosen by a mask or by numbers."""
        return _Stretches(*(column[chosen] for column in self))

    def halves(self) -> _Stretches:
        """Both halves of each."""
        middle = 0.5 * (self.low + self.high)
        twice = self.at(np.tile(np.arange(len(middle)), 2))
        low = np.concatenate([self.low, middle])
        high = np.concatenate([middle, self.high])
        return twice._replace(low=low, high=high)

    def points(self, t: np.ndarray, derivative: int = 0) -> np.ndarray:
        """Where each is at its t (k,), or its derivative (k, n) in t there."""
        values = np.zeros(self.coefficients[:, 0].shape)
        for coefficient in self._derived(derivative)[::-1]:
            values = values * t[:, None] + coefficient
        return values

    def largest(self, derivative: int) -> np.ndarray:
        """Bounds (k, n) on a derivative of each in t."""
        farthest = np.maximum(np.abs(self.low), np.abs(self.high))[:, None]
        values = np.zeros(self.coefficients[:, 0].shape)
        for coefficient in self._derived(derivative)[::-1]:
            values = values * farthest + np.abs(coefficient)
        return values

    def _derived(self, derivative: int) -> np.ndarray:
        """The coefficients (order + 1 - derivative, k, n) of a derivative."""
        rows = np.moveaxis(self.coefficients, 1, 0)
        for _ in range(derivative):
            rows = np.arange(1, len(rows))[:, None, None] * rows[1:]
        return rows


class _Bounds(NamedTuple):
    """What is known of a function on stretches (k,): whether it ``is_empty`` of zeros,
    or ``is_monotone``; and how far each reaches, over the sizes."""

    is_empty: np.ndarray
    is_monotone: np.ndarray
    reach: np.ndarray


def crossings_with(
    tape: Tape, branches: Sequence[Branch], sizes: np.ndarray
) -> Crossings:
    """The zeros on ``branches`` of the one equation of a ``tape``; ``sizes`` (n,) are
    those of the unknowns."""
    if not branches:
        return Crossings((), frozenset())
    stretches = _Stretches.of(branches)
    zeros: list[Crossing] = []
    unclear: set[int] = set()
    while len(stretches.low):
        bounds = _bounds_of(tape, stretches, sizes)
        zeros += _zeros_on(tape, stretches.at(bounds.is_monotone & ~bounds.is_empty))
        is_open = ~bounds.is_empty & ~bounds.is_monotone
        is_left = is_open & (bounds.reach < NARROWEST)
        if np.count_nonzero(is_open) > MOST_STRETCHES:
            is_left = is_open
        unclear.update(stretches.curve[is_left].tolist())
        is_settled = np.isin(stretches.curve, list(unclear))
        stretches = stretches.at(is_open & ~is_settled).halves()
    return Crossings(_different(zeros, branches), frozenset(unclear))


def _bounds_of(tape: Tape, stretches: _Stretches, sizes: np.ndarray) -> _Bounds:
    """What bounds on the equation of a tape, and on its rate, show on stretches."""
    half = 0.5 * (stretches.high - stretches.low)
    middle = 0.5 * (stretches.high + stretches.low)
    blur = BLUR * sizes
    points = stretches.points(middle)
    reach = half[:, None] * stretches.largest(1) + blur
    velocity = stretches.points(middle, 1)
    change = half[:, None] * stretches.largest(2)
    slopes = tape.compiled.jacobian_bounds(points - reach, points + reach)
    least, most = _products(slopes, (velocity - change, velocity + change))
    steepest = half * np.maximum(np.abs(least), np.abs(most))
    values = tape.compiled.value_bounds(points - reach, points + reach)
    at_middle = tape.compiled.value_bounds(points - blur, points + blur)
    return _Bounds(
        is_empty=leave_out_zero(values, at_middle, steepest[:, None])[:, 0],
        is_monotone=(least > 0.0) | (most < 0.0),
        reach=(reach / sizes).max(axis=1),
    )


def leave_out_zero(
    values: tuple[np.ndarray, np.ndarray],
    at_middle: tuple[np.ndarray, np.ndarray],
    reach: np.ndarray,
) -> np.ndarray:
    """Whether bounds on functions, or those in the middle and what they change by from
    there at most, leave out zero; all (k, m)."""
    lowest = np.fmax(values[0], at_middle[0] - reach)
    highest = np.fmin(values[1], at_middle[1] + reach)
    return np.asarray((lowest > 0.0) | (highest < 0.0))


def _products(
    slopes: tuple[np.ndarray, np.ndarray], rates: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (k,) on the sum of the products of F' (k, 1, n) and rates (k, n), each
    between two bounds."""
    ends = [slope[:, 0] * rate for slope in slopes for rate in rates]
    least: np.ndarray = np.min(ends, axis=0).sum(axis=1)
    most: np.ndarray = np.max(ends, axis=0).sum(axis=1)
    return least, most


def _zeros_on(tape: Tape, stretches: _Stretches) -> list[Crossing]:
    """The zeros on stretches along which the equation of a tape is monotone."""
    beyond = OVERLAP * (stretches.high - stretches.low)
    low, high = stretches.low - beyond, stretches.high + beyond

    def values(t: np.ndarray, of: _Stretches = stretches) -> np.ndarray:
        points = np.ascontiguousarray(of.points(t))
        residuals: np.ndarray = tape.compiled.residuals(points)[:, 0]
        return residuals

    if not len(low):
        return []
    changes = values(low) * values(high) <= 0.0
    if not np.any(changes):
        return []
    changing = stretches.at(changes)
    places = bracketed_roots(lambda t: values(t, changing), low[changes], high[changes])
    arclengths = changing.center + changing.radius * places
    pairs = zip(changing.curve.tolist(), arclengths.tolist(), strict=True)
    return [Crossing(curve, s) for curve, s in pairs]


def _different(
    zeros: Sequence[Crossing], branches: Sequence[Branch]
) -> tuple[Crossing, ...]:
    """The zeros within their curves, each once: next to the end of a stretch one is seen
    from both."""
    different: list[Crossing] = []
    for curve, branch in enumerate(branches):
        ends = [zero.s for zero in zeros if zero.curve == curve]
        length, closed = branch.length, branch.closed
        within = SAME * length
        places = sorted(
            s % length if closed else min(max(s, 0.0), length) for s in ends
        )
        kept: list[float] = []
        for s in places:
            if not kept or s - kept[-1] > within:
                kept.append(s)
        if closed and len(kept) > 1 and kept[0] + length - kept[-1] <= within:
            kept.pop()
        different += [Crossing(curve, s) for s in kept]
    return tuple(different)
