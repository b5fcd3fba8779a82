"""What is known of a surface apart from charts: its area along lines, and its pieces and
Euler characteristic on a grid.

Lines along each unknown cross the surface f = 0 where f changes its sign. Over all lines
of a direction the sum of 1/|n|, n being the part of the unit normal along the line, is
the area (Cauchy and Crofton's formula for one direction); the three directions share it
by weights n_i^8 / sum n_j^8, which leave out what a line only touches. The lines form
lattices with random shifts: the mean has no bias, and the spread shows its error.

Where a grid is fine enough, the Euler characteristic of the region f < 0 is that of the
cubes, squares, edges and vertices in it. The surface has twice that of the region, less
that of the part of the bounds in it.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize.elementwise import find_root
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from studies.curve_bank import Curve

SHARPNESS = 8  # power of the normal in the weights
STEP = 1e-30  # of complex differences
OFF_ZEROS = 0.1234  # by which a grid of periods is shifted, over a cube
Function = Callable[[np.ndarray], list[Any]]


class Estimate(NamedTuple):
    """A ``value`` and its standard ``error``."""

    value: float
    error: float


def can_be_measured(system: Curve) -> bool:
    """Whether it is one equation in three unknowns, all of them angles or none."""
    are_angles = np.isfinite(system.periods)
    is_one = len(system.unknowns) == 3 and len(system.equations) == 1
    return is_one and bool(np.all(are_angles) or not np.any(are_angles))


# --- area -----------------------------------------------------------------------------


def area_along_lines(
    system: Curve, lines: int, shifts: int, rng: np.random.Generator
) -> Estimate:
    """The area of a surface, from so many ``lines`` each way in each direction, with so
    many random ``shifts``."""
    function = system.function()
    areas = []
    for _ in range(shifts):
        places = rng.random((3, 2))
        areas.append(
            sum(
                _area_along(function, system.bounds, axis, lines, places[axis])
                for axis in range(3)
            )
        )
    spread = np.std(areas, ddof=1) / np.sqrt(shifts)
    return Estimate(float(np.mean(areas)), float(spread))


def _area_along(
    function: Function, bounds: np.ndarray, axis: int, lines: int, shift: np.ndarray
) -> float:
    """The share of the area that lines along one unknown see."""
    low, high = bounds.T
    widths = high - low
    others = [k for k in range(3) if k != axis]
    starts = np.empty((3, lines, lines))
    for k, part in zip(others, shift, strict=True):
        places = low[k] + (np.arange(lines) + part) / lines * widths[k]
        is_first = k == others[0]
        starts[k] = places[:, None] if is_first else places
    rows = np.moveaxis(starts, 1, 0)
    brackets = [_brackets(function, row, axis, bounds[axis]) for row in rows]
    crossings = _crossings(function, np.concatenate(brackets, axis=1), axis)
    normals = np.abs(_gradients(function, crossings))
    normals /= np.linalg.norm(normals, axis=0)
    weights = normals[axis] ** (SHARPNESS - 1) / (normals**SHARPNESS).sum(axis=0)
    cell = float(np.prod(widths[others])) / lines**2
    return float(weights.sum()) * cell


def _brackets(
    function: Function, starts: np.ndarray, axis: int, ends: np.ndarray
) -> np.ndarray:
    """Pairs (2, k, 3) of points before and behind the surface, on lines from ``starts``
    (3, l) along one unknown, between its ``ends`` (2,)."""
    samples = starts.shape[1] + 1
    t = np.linspace(ends[0], ends[1], samples)
    points = np.repeat(starts[:, :, None], samples, axis=2)
    points[axis] = t
    signs = np.signbit(np.broadcast_to(function(points)[0], points.shape[1:]))
    line, begin = np.nonzero(signs[:, 1:] != signs[:, :-1])
    return np.array([points[:, line, begin].T, points[:, line, begin + 1].T])


def _crossings(function: Function, brackets: np.ndarray, axis: int) -> np.ndarray:
    """Points (3, k) of the surface between pairs (2, k, 3) along one unknown."""
    before, behind = brackets.transpose(0, 2, 1)
    indices = np.arange(before.shape[1])

    def points_at(t: np.ndarray, index: np.ndarray) -> np.ndarray:
        points: np.ndarray = before[:, index]
        points[axis] = t
        return points

    roots = find_root(
        lambda t, index: function(points_at(t, index))[0],
        (before[axis], behind[axis]),
        args=(indices,),
    )
    return points_at(roots.x, indices)


def _gradients(function: Function, points: np.ndarray) -> np.ndarray:
    """The gradients (3, k) at points (3, k), by complex differences."""
    slopes = []
    for unit in np.eye(3):
        value = function(points + 1j * STEP * unit[:, None])[0]
        slopes.append(np.broadcast_to(np.imag(value), points.shape[1:]) / STEP)
    return np.array(slopes)


# --- pieces and shape -----------------------------------------------------------------


class Shape(NamedTuple):
    """How many ``pieces`` a surface has, and the sum of their Euler characteristics."""

    pieces: int
    euler: int


def shape_on_grid(system: Curve, count: int) -> Shape:
    """The shape of a surface, on a grid of ``count`` cubes each way."""
    is_periodic = bool(np.all(np.isfinite(system.periods)))
    low, high = system.bounds.T
    # off the places at which sums of sines are zero but for rounding
    shares = (np.arange(count + 1) + OFF_ZEROS * is_periodic) / count
    places = low[:, None] + (high - low)[:, None] * shares
    grid = np.array(np.meshgrid(*places, indexing="ij"))
    is_below = np.broadcast_to(system.function()(grid)[0], grid[0].shape) < 0
    if is_periodic:
        is_below = np.pad(is_below[:-1, :-1, :-1], (0, 1), mode="wrap")
    pieces = _count_pieces(is_below, is_periodic)
    euler = 2 * _euler_of_region(is_below, is_periodic)
    if not is_periodic:
        euler -= _euler_on_bounds(is_below)
    return Shape(pieces, euler)


def _blocks(values: np.ndarray, extent: tuple[int, ...]) -> list[np.ndarray]:
    """The values at the corners of all blocks of the ``extent``, 0 or 1 each way."""
    size = [side - reach for side, reach in zip(values.shape, extent, strict=True)]
    corners = []
    for corner in product(*(range(reach + 1) for reach in extent)):
        part = tuple(slice(c, c + s) for c, s in zip(corner, size, strict=True))
        corners.append(values[part])
    return corners


def _euler_of_region(is_in: np.ndarray, is_periodic: bool) -> int:
    """Vertices - edges + squares - cubes of a region of vertices; those on the upper
    bounds are those on the lower ones where it ``is_periodic``."""
    total = 0
    for extent in product((0, 1), repeat=is_in.ndim):
        blocks = np.all(_blocks(is_in, extent), axis=0)
        if is_periodic:
            blocks = blocks[tuple(slice(0, side - 1) for side in is_in.shape)]
        total += (-1) ** sum(extent) * int(np.count_nonzero(blocks))
    return total


def _euler_on_bounds(is_in: np.ndarray) -> int:
    """The Euler characteristic of the part of the surface of a box in a region."""
    total = 0
    for extent in product((0, 1), repeat=3):
        blocks = np.all(_blocks(is_in, extent), axis=0)
        inside = tuple(slice(None) if reach else slice(1, -1) for reach in extent)
        on_bounds = np.count_nonzero(blocks) - np.count_nonzero(blocks[inside])
        total += (-1) ** sum(extent) * int(on_bounds)
    return total


def _count_pieces(is_below: np.ndarray, is_periodic: bool) -> int:
    """How many pieces the surface between a region and the rest has: cubes that it
    passes are joined by squares that it passes."""
    is_passed = _are_mixed(is_below, (1, 1, 1))
    size = int(np.count_nonzero(is_passed))
    number = np.full(is_passed.shape, -1)
    number[is_passed] = np.arange(size)
    pairs = []
    for axis in range(3):
        squares = _are_mixed(is_below, tuple(int(k != axis) for k in range(3)))
        is_crossed = np.moveaxis(squares, axis, 0)[:-1].copy()
        is_crossed[0] &= is_periodic
        after = np.moveaxis(number, axis, 0)
        before = np.roll(after, 1, axis=0)
        pairs.append(np.stack([before[is_crossed], after[is_crossed]]))
    i, j = np.concatenate(pairs, axis=1)
    graph = csr_array((np.ones(len(i)), (i, j)), shape=(size, size))
    return int(connected_components(graph, directed=False)[0])


def _are_mixed(is_in: np.ndarray, extent: tuple[int, ...]) -> np.ndarray:
    """Which blocks of an ``extent`` have corners in a region and outside it."""
    corners = np.array(_blocks(is_in, extent))
    return np.asarray(corners.any(axis=0) & ~corners.all(axis=0))
