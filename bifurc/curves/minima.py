"""Local minima of the smallest regular singular value along a traced curve.

They are converged: the slope of the exact singular value changes from falling to rising
there. Where two singular values cross, the smaller one has its kink upwards, so that a
minimum with a kink is a zero, and the square is smooth there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.branch import Branch
from bifurc.curves.monitor import NODES, Profile
from bifurc.decisions import is_level, may_be_crossed, stands_out
from bifurc.numerics.roots import bracketed_roots
from bifurc.numerics.singular_values import singular_values
from bifurc.system import System, relative_jacobians

FINE = 96  # intervals of a piece on which the interpolants are compared
DIFFERENCE = 1e-5  # step, over the scale, of the central difference of F'
# Rise of a singular value, relative and not, that is none.
ROUNDING, ZERO = 1e-8, 1e-10
WITHIN = 17  # places beside a singular point between which others are looked for
LOCATED = 1e-12  # error of the place of a minimum, over the scale
# Share by which a near miss must be below half of the largest value.
TIE = 1e-6
# Where the largest value is converged: the nodes near the top, the rounds, and by how
# much each narrows the row of points.
NEAR_THE_TOP, ROUNDS, NARROWER = 0.9, 14, 3.0


class Minima(NamedTuple):
    """Local minima along a curve: arclengths (k,), in order, and values (k,)."""

    arclengths: np.ndarray
    values: np.ndarray


def singular_value_minima(problem: System, branch: Branch, profile: Profile) -> Minima:
    """The local minima of the smallest regular singular value.

    Where a value rises to no side by more than rounding there is no minimum, and the
    ends of an open curve are none; nor is there one where F' vanishes all along.
    Where the curve crosses a singular point the value
    is small but not zero; `bifurc.singular.locate` decides.
    """
    rank = profile.rank
    if not rank:
        return Minima(np.empty(0), np.empty(0))
    places = _places_to_look(branch, profile)
    here = _values_and_slopes(problem, branch, rank, places)
    valleys = _look_into(problem, branch, rank, places, here)
    is_crossed = may_be_crossed(
        singular_values(problem, branch(valleys.bottoms))[..., rank - 1]
    )
    if np.any(is_crossed):
        # next to one singular point there may be another one
        low, high = valleys.low[is_crossed], valleys.high[is_crossed]
        more = np.setdiff1d(_about(branch, places, low, high), places)
        there = _values_and_slopes(problem, branch, rank, more)
        both = np.concatenate([places, more])
        order = np.argsort(both)
        places, here = both[order], here.and_more(there, order)
        valleys = _look_into(problem, branch, rank, places, here)
    bottoms = valleys.bottoms
    if not len(bottoms):
        return Minima(np.empty(0), np.empty(0))
    samples = np.concatenate([profile.arclength.ravel(), places])
    heights = np.concatenate([profile.smallest.ravel(), here.values])
    cut = 0.0
    if branch.closed:  # cut open at the top: every valley then has a wall to both sides
        cut = samples[np.argmax(heights)]
        bottoms = (bottoms - cut) % branch.length
        samples = np.append((samples - cut) % branch.length, branch.length)
        heights = np.append(heights, heights.max())
    bottoms = np.sort(bottoms)
    values = singular_values(problem, branch(cut + bottoms))[..., rank - 1]
    lowest = _with_walls(values, _highest_between(samples, heights, bottoms))
    arclengths, values = cut + bottoms[lowest], values[lowest]
    if branch.closed:
        arclengths %= branch.length
    order = np.argsort(arclengths)
    return Minima(arclengths[order], values[order])


def _about(
    branch: Branch, places: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Arclengths (i,) from ``low`` (k,) to ``high`` (k,), two of the ``places``, and on to
    the next ones on either side."""
    row = places
    if branch.closed:
        row = np.concatenate([places - branch.length, places, places + branch.length])
    first = row[np.maximum(np.searchsorted(row, low) - 1, 0)]
    last = row[np.minimum(np.searchsorted(row, high) + 1, len(row) - 1)]
    corners = np.array([first, low, high, last])
    looks = np.linspace(corners[:-1], corners[1:], WITHIN).ravel()
    return looks % branch.length if branch.closed else looks


class _Look(NamedTuple):
    """Between which places along a curve the slope turns to rising: from ``low`` (k,) to
    ``high`` (k,), about ``bottoms`` (k,)."""

    low: np.ndarray
    high: np.ndarray
    bottoms: np.ndarray


def _look_into(
    problem: System,
    branch: Branch,
    rank: int,
    places: np.ndarray,
    here: _ValuesAndSlopes,
) -> _Look:
    """The minima between ``places`` (k,), arclengths in order, at which so much is
    known."""
    before, after = _valleys(branch, here.slopes * problem.domain.scale)
    low, high = places[before], places[after]
    high[after < before] += branch.length  # once round a closed curve

    def slope_of_square(s: np.ndarray) -> np.ndarray:
        there = _values_and_slopes(problem, branch, rank, s)
        return there.slopes_of_squares

    bottoms = low
    if len(low):
        at_ends = here.slopes_of_squares[before], here.slopes_of_squares[after]
        tolerance = LOCATED * problem.domain.scale
        bottoms = bracketed_roots(slope_of_square, low, high, tolerance, at_ends)
    return _Look(low, high, bottoms)


def stand_out(
    problem: System, branch: Branch, profile: Profile, values: np.ndarray
) -> np.ndarray:
    """Which of the minima ``values`` (k,) are below half the largest value on the
    curve.

    The largest at the nodes is a little too small. Where that might decide, the largest
    is converged, and a value at half of it, but for rounding, does not stand out.
    """
    half = 0.5 * profile.smallest.max()
    doubtful = (values > (1.0 - 2 * TIE) * half) & (values < 1.1 * half)
    if np.any(doubtful):
        half = 0.5 * _largest_value(problem, branch, profile)
    return stands_out(values, half)


def _largest_value(problem: System, branch: Branch, profile: Profile) -> float:
    """The largest of the smallest regular singular values on the curve, to about 1e-8.

    From every node near the top a row of points closes in on the highest one.
    """
    nodes = profile.arclength.ravel()
    heights = profile.smallest.ravel()
    tops = _minima_in_row(-heights, branch.closed)
    tops = tops[heights[tops] > NEAR_THE_TOP * heights.max()]
    middles = nodes[tops]
    reach = _spacing(nodes, tops)
    rows = np.arange(len(tops))
    largest = float(heights.max())
    for _ in range(ROUNDS):
        trial = middles[:, None] + reach[:, None] * np.linspace(-1.0, 1.0, 9)
        if not branch.closed:
            trial = np.clip(trial, 0.0, branch.length)
        values = singular_values(problem, branch(trial))[..., profile.rank - 1]
        highest = np.argmax(values, axis=1)
        middles = trial[rows, highest]
        reach = reach / NARROWER
        largest = max(largest, float(values.max(initial=0.0)))
    return largest


# --- where the slope is looked at -----------------------------------------------------


@dataclass(frozen=True)
class _FineGrid:
    """A fine grid on a piece: ``fractions`` (FINE + 1,) from 0 to 1, and the matrix
    (FINE + 1, k) that interpolates values at the nodes."""

    fractions: np.ndarray
    from_nodes: np.ndarray


@cache
def _fine_grid() -> _FineGrid:
    fractions = np.linspace(0.0, 1.0, FINE + 1)
    degree = len(NODES) - 1
    at_nodes = np.polynomial.chebyshev.chebvander(2 * NODES - 1, degree)
    at_fine = np.polynomial.chebyshev.chebvander(2 * fractions - 1, degree)
    return _FineGrid(fractions, at_fine @ np.linalg.inv(at_nodes))


def _places_to_look(branch: Branch, profile: Profile) -> np.ndarray:
    """Arclengths (k,), sorted, between which the slope is to be compared.

    Every minimum of the values at the nodes is between two of them, and on both sides
    of every minimum of two interpolants there is one: of the square of the value, and
    of the product of the squares of all regular ones, which is smooth even where they
    meet.
    """
    squares = profile.values[..., : profile.rank] ** 2
    places = np.concatenate(
        [
            _around_lowest_nodes(branch, profile),
            _around_interpolated_minima(branch, profile, squares[..., -1]),
            _around_interpolated_minima(branch, profile, squares.prod(axis=-1)),
        ]
    )
    if branch.closed:
        return np.unique(places % branch.length)
    return np.unique(np.clip(places, 0.0, branch.length))


def _around_lowest_nodes(branch: Branch, profile: Profile) -> np.ndarray:
    """Arclengths (3 k,) of the nodes with the lowest values and of their neighbours."""
    nodes = profile.arclength.ravel()
    lowest = _minima_in_row(profile.smallest.ravel(), branch.closed)
    after = (lowest + 1) % len(nodes)
    return np.concatenate([nodes[lowest], nodes[lowest - 1], nodes[after]])


def _around_interpolated_minima(
    branch: Branch, profile: Profile, quantity: np.ndarray
) -> np.ndarray:
    """Arclengths (4 k,) on both sides of the minima of the interpolant of a quantity
    (p, nodes), near and a little farther away: as far as the nodes are apart there."""
    fine = _fine_grid()
    grid = branch.places(fine.fractions)  # (p, FINE + 1)
    interpolated = quantity @ fine.from_nodes.T
    arclengths = grid[:, :-1].ravel()
    sizes = interpolated[:, :-1].ravel()
    steps = np.repeat(grid[:, 1] - grid[:, 0], FINE)
    if not branch.closed:
        arclengths = np.append(arclengths, grid[-1, -1])
        sizes = np.append(sizes, interpolated[-1, -1])
        steps = np.append(steps, steps[-1])
    lowest = _minima_in_row(sizes, branch.closed)
    middles, near = arclengths[lowest], 2 * steps[lowest]
    nodes = profile.arclength.ravel()
    node = np.minimum(np.searchsorted(nodes, middles), len(nodes) - 1)
    far = _spacing(nodes, node)
    return np.concatenate(
        [middles - far, middles - near, middles + near, middles + far]
    )


def _spacing(nodes: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """How far apart the ``nodes`` are about those of these ``numbers`` (k,)."""
    before, after = np.maximum(numbers - 1, 0), np.minimum(numbers + 1, len(nodes) - 1)
    spacing: np.ndarray = (nodes[after] - nodes[before]) / (after - before)
    return spacing


def _minima_in_row(values: np.ndarray, closed: bool) -> np.ndarray:
    """Numbers (k,) of the local minima in a row of values, whose ends meet if
    closed."""
    before, after = (values[-1], values[0]) if closed else (np.inf, np.inf)
    left = np.concatenate([[before], values[:-1]])
    right = np.concatenate([values[1:], [after]])
    return np.flatnonzero((values <= left) & (values < right))


# --- values and slopes ----------------------------------------------------------------


class _ValuesAndSlopes(NamedTuple):
    """A singular value along a curve, and its derivative by the arclength (k,)."""

    values: np.ndarray
    slopes: np.ndarray

    @property
    def slopes_of_squares(self) -> np.ndarray:
        """Half the derivatives of their squares (k,)."""
        slopes: np.ndarray = self.values * self.slopes
        return slopes

    def and_more(self, others: _ValuesAndSlopes, order: np.ndarray) -> _ValuesAndSlopes:
        """These and ``others`` in an ``order`` (k,)."""
        values = np.concatenate([self.values, others.values])[order]
        slopes = np.concatenate([self.slopes, others.slopes])[order]
        return _ValuesAndSlopes(values, slopes)


def _values_and_slopes(
    problem: System, branch: Branch, rank: int, s: np.ndarray
) -> _ValuesAndSlopes:
    """Singular value number ``rank`` at arclengths (k,), and its derivative there.

    With l and r the singular vectors d sigma/ds = l^T F''(r, du/ds): F'' along the
    tangent is a central difference of F'.
    """
    points, count = branch(s), len(s)
    step = DIFFERENCE * problem.domain.scale
    along = step * branch(s, 1)
    rows = np.concatenate([points, points + along, points - along])
    jacobians = relative_jacobians(problem, rows)
    change = (jacobians[count : 2 * count] - jacobians[2 * count :]) / (2 * step)
    values, slopes = _core.singular_value_rates(jacobians[:count], change, rank - 1)
    return _ValuesAndSlopes(values, slopes)


# --- valleys and the walls beside them ------------------------------------------------


def _valleys(branch: Branch, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the places before and after which the ``slopes`` (k,), in order along
    the curve, turn to rising."""
    steep = np.flatnonzero(~is_level(np.abs(slopes)))
    after = np.roll(steep, -1) if branch.closed else steep[1:]
    before = steep[: len(after)]
    turns = (slopes[before] < 0) & (slopes[after] > 0)
    return before[turns], after[turns]


def _highest_between(
    samples: np.ndarray, heights: np.ndarray, stops: np.ndarray
) -> np.ndarray:
    """Largest of the ``heights`` of ``samples`` before, between and after ``stops``
    (k,).

    That makes k + 1 numbers, -inf where there is no sample.
    """
    stretch = np.searchsorted(stops, samples)
    walls = np.full(len(stops) + 1, -np.inf)
    np.maximum.at(walls, stretch, heights)
    return walls


def _with_walls(values: np.ndarray, walls: np.ndarray) -> np.ndarray:
    """Numbers of the minima ``values`` (k,) that ``walls`` (k + 1,) on both sides stand
    above.

    Of two minima without a wall between them, as rounding makes them, the lower one.
    """

    def is_wall(wall: float, value: float) -> bool:
        return bool(wall > (1.0 + ROUNDING) * value + ZERO)

    numbers: list[int] = []
    wall = walls[0]
    for i, value in enumerate(values):
        higher = max(value, values[numbers[-1]]) if numbers else value
        if is_wall(wall, higher):
            numbers.append(i)
            wall = walls[i + 1]
            continue
        if numbers and value < values[numbers[-1]]:
            numbers[-1] = i
        wall = max(wall, walls[i + 1])
    if numbers and not is_wall(wall, values[numbers[-1]]):
        numbers.pop()
    return np.array(numbers, dtype=int)
