"""The branches at a singular point, from its germ, as far out as doubles lose them.

Where branches touch to a high order, or end in a sharp cusp, F' is singular to within
rounding over a long stretch, and a curve that is traced in doubles there goes over to
another branch, or turns back. The exact equations do not lose it: y(s) with x = +-s^q
is solved to many digits at Chebyshev nodes from the point to where F' is regular again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import mpmath
import numpy as np
from numpy.polynomial import chebyshev

from bifurc.decisions import is_lost_in_rounding
from bifurc.numerics.singular_values import singular_values
from bifurc.singular.puiseux import HalfBranch
from bifurc.system import System

# Places on the half-branches at which F' is looked at, in the unit of the germ and in
# scales: from the first on every next one twice as far away, up to the last.
FIRST, LAST = 1e-4, 0.6
STARTS = (1e-3, 1e-2)  # shares of the way to the end, from which nodes are reached
NODES = (32, 64, 128)  # on a branch, the first number that is enough
TAIL = 6  # coefficients of a series that has converged, which are
NEGLIGIBLE, HOPELESS = 1e-13, 1e-2  # beside its size; and those of one that will not
SLOW = 0.1  # of the tail that half as many nodes leave: a smooth branch leaves far less
NEWTON_STEPS, SETTLED = 40, 1e-40
STEP = 1e-45  # of the difference for a derivative
PREDICT_FROM = 4  # values before

Reduced: TypeAlias = Callable[[mpmath.mpf, mpmath.mpf], mpmath.mpf]


class LiftedEquation(NamedTuple):
    """The equation that is left on the null space, in coordinates x and y of the germ.

    ``value`` is f(x, y), ``offset`` (n,) how far the solution of the other equations
    above a place is from the singular point; ``unit`` is that of x, in scales.
    """

    value: Reduced
    offset: Callable[[mpmath.mpf, mpmath.mpf], np.ndarray]
    unit: mpmath.mpf


@dataclass(frozen=True, eq=False)
class LocalBranch:
    """One branch through a singular point.

    ``halves`` are the numbers of its half-branches. ``series`` (k, n) are Chebyshev
    coefficients of u(s) less the point, for s from -1, where the second half ends, by
    0, where the point is, to 1, where the first half ends. x goes with s to the power
    ``ramification``.
    """

    halves: tuple[int, int]
    ramification: int
    series: np.ndarray

    @property
    def returns(self) -> bool:
        """Whether it leaves the point on the side from which it came: at a cusp."""
        return self.ramification % 2 == 0

    def __call__(self, s: np.ndarray) -> np.ndarray:
        """Offsets (k, n) from the point at s (k,)."""
        offsets: np.ndarray = chebyshev.chebval(s, self.series).T
        return offsets

    def side(self, half: int) -> float:
        """The s at which the half-branch of a number ends."""
        return 1.0 if half == self.halves[0] else -1.0


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """The ``branches`` within a ``radius`` of a singular point, all of which end there
    or beyond, where doubles do not lose them any more; a radius of 0 where they are not
    known so far."""

    radius: float
    branches: tuple[LocalBranch, ...]

    def branch_of(self, half: int) -> LocalBranch:
        """The branch to which the half-branch of a number belongs."""
        return next(branch for branch in self.branches if half in branch.halves)

    def ends(self) -> np.ndarray:
        """Where each half-branch ends (h, n), less the point, in their order."""
        count = 2 * len(self.branches)
        n = self.branches[0].series.shape[1] if count else 0
        ends = np.empty((count, n))
        for branch in self.branches:
            ends[list(branch.halves)] = branch(np.array([1.0, -1.0]))
        return ends


UNKNOWN = Neighbourhood(0.0, ())


def neighbourhood_of(
    problem: System,
    point: np.ndarray,
    equation: LiftedEquation,
    halves: Sequence[HalfBranch],
    pairs: Sequence[tuple[int, int]],
) -> Neighbourhood:
    """The branches at a singular ``point`` (n,) that are made of ``pairs`` of
    ``halves``; `UNKNOWN` where F' is nowhere regular on them, or they are not smooth so
    far. Works at the digits that are set."""
    if not halves:
        return Neighbourhood(_radius_of_isolated(equation), ())
    width = _regular_width(problem, point, equation, halves)
    if width is None:
        return UNKNOWN
    branches: list[LocalBranch] = []
    for pair in pairs:
        branch = _local_branch(equation, halves, pair, width)
        if branch is None:
            return UNKNOWN
        branches.append(branch)
    ends = Neighbourhood(0.0, tuple(branches)).ends()
    radius = float(np.linalg.norm(ends, axis=1).min())
    return Neighbourhood(radius, tuple(branches))


# --- how far ---------------------------------------------------------------------------


def _regular_width(
    problem: System,
    point: np.ndarray,
    equation: LiftedEquation,
    halves: Sequence[HalfBranch],
) -> mpmath.mpf | None:
    """The least x, in the unit of the germ, at which F' is regular on all half-branches;
    None where there is none."""
    tracks = [_Track(equation, half) for half in halves]
    x = mpmath.mpf(FIRST)
    while x * equation.unit < LAST:
        offsets = [track.offset_at(x) for track in tracks]
        values = singular_values(problem, point + np.array(offsets))
        if not np.any(is_lost_in_rounding(values[:, problem.n - 2])):
            return x
        x *= 2
    return None


def _radius_of_isolated(equation: LiftedEquation) -> float:
    """How far from an isolated point the equation is solved but for rounding, at most;
    0 where that is too far.

    The coordinates are such that f is about smallest where y = 0.
    """
    x = mpmath.mpf(FIRST)
    while x * equation.unit < LAST:
        values = [abs(equation.value(side * x, mpmath.mpf(0))) for side in (1, -1)]
        # F grows with the square of what it is regular by
        if not is_lost_in_rounding(float(mpmath.sqrt(min(values)))):
            offset = equation.offset(x, mpmath.mpf(0))
            return float(np.linalg.norm(offset))
        x *= 2
    return 0.0


# --- along a branch --------------------------------------------------------------------


class _Track:
    """A half-branch while it is followed from the point outward."""

    def __init__(self, equation: LiftedEquation, half: HalfBranch):
        self._equation = equation
        self._half = half
        self._known: list[tuple[mpmath.mpf, mpmath.mpf]] = []

    def offset_at(self, x: mpmath.mpf) -> np.ndarray:
        """Where it is (n,), less the point, at the next ``x``, its size."""
        t = mpmath.root(x, self._half.ramification)
        y = self._solved(self._half.side * x, t)
        return self._equation.offset(self._half.side * x, y)

    def _solved(self, x: mpmath.mpf, t: mpmath.mpf) -> mpmath.mpf:
        """y at x = +-t^q, by Newton's method from what the values before predict of
        the terms that are not in the series."""
        terms = list(zip(self._half.exponents, self._half.coefficients, strict=True))
        start = mpmath.fsum(value * t**power for power, value in terms)
        last = terms[-1][0] if terms else 0
        y = start + t**last * self._predicted(t)
        for _ in range(NEWTON_STEPS):
            value = self._equation.value(x, y)
            rate = (self._equation.value(x, y + STEP) - value) / STEP
            step = value / rate
            y -= step
            if abs(step) < SETTLED:
                break
        self._known.append((t, (y - start) / t**last))
        return y

    def _predicted(self, t: mpmath.mpf) -> mpmath.mpf:
        """The value at ``t`` of the polynomial through 0 and the last known ones
        (Lagrange)."""
        knots = self._known[-PREDICT_FROM:]
        total = mpmath.mpf(0)
        for number, (at, value) in enumerate(knots):
            weight = t / at
            for other, (place, _) in enumerate(knots):
                if other != number:
                    weight *= (t - place) / (at - place)
            total += weight * value
        return total


def _local_branch(
    equation: LiftedEquation,
    halves: Sequence[HalfBranch],
    pair: tuple[int, int],
    width: mpmath.mpf,
) -> LocalBranch | None:
    """The branch of a ``pair`` of half-branches as far as x = ``width``; None where its
    series does not converge."""
    first, second = (halves[number] for number in pair)
    power = first.ramification
    before = np.inf
    for count in NODES:
        nodes = chebyshev.chebpts1(count)  # an even number: 0 is none of them
        ahead = _offsets(equation, first, nodes[nodes > 0], width)
        behind = _offsets(equation, second, -nodes[nodes < 0][::-1], width)
        values = np.concatenate([behind[::-1], ahead])
        series = _chebyshev_series(nodes, values)
        size = float(np.abs(series).max())
        tail = float(np.abs(series[-TAIL:]).max())
        if tail < NEGLIGIBLE * size:
            return LocalBranch(pair, power, series)
        if tail > HOPELESS * size or tail > SLOW * before:
            break  # it is not smooth so far, and more nodes are of no use
        before = tail
    return None


def _offsets(
    equation: LiftedEquation, half: HalfBranch, places: np.ndarray, width: mpmath.mpf
) -> np.ndarray:
    """Offsets (k, n) of a half-branch from the point at s = ``places`` (k,), in
    order."""
    track = _Track(equation, half)
    for share in STARTS:
        if share < places[0]:
            track.offset_at(width * mpmath.mpf(share) ** half.ramification)
    return np.array(
        [
            track.offset_at(width * mpmath.mpf(float(s)) ** half.ramification)
            for s in places
        ]
    )


def _chebyshev_series(nodes: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Coefficients (k, n) of the polynomials through ``values`` (k, n) at the roots of a
    Chebyshev polynomial (k,)."""
    count = len(nodes)
    waves = chebyshev.chebvander(nodes, count - 1)
    series: np.ndarray = 2.0 / count * waves.T @ values
    series[0] /= 2.0
    return series
