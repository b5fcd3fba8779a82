"""What happens along a traced curve: singular values, user test functions, dead points.

Everything is evaluated on the dense curve after tracing, in batches, at Chebyshev nodes
of each piece, and read off the interpolants; detection never disturbs the tracing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bifurc.branch import Branch
from bifurc.numerics.roots import bracketed_roots
from bifurc.problem import Problem

__all__ = [
    "Profile",
    "dead_points",
    "profile_branch",
    "roots_along",
    "singular_value_minima",
    "stand_out",
]

NODES, FINE = 16, 96
DIFFERENCE = 1e-5  # step, over the scale, of the central difference of F'
LEVEL = (
    1e-8  # slope of a singular value, over magnitude and scale: below it is rounding
)
ROUNDING, ZERO = 1e-8, 1e-10  # rise of a singular value, relative and not, that is none
TIE = 1e-6  # share by which a near miss must be below half of the largest value


@dataclass(frozen=True)
class Profile:
    """Singular values of F', over the problem's magnitude, at Chebyshev nodes of every
    piece of a curve.

    ``arclength`` (p, NODES), ``values`` (p, NODES, n) in decreasing order, ``rank``:
    the rank that F' has along the curve but for single points, n - 1 as a rule. Number
    ``rank`` is the one to watch.
    """

    arclength: np.ndarray
    values: np.ndarray
    rank: int

    @property
    def smallest(self) -> np.ndarray:
        """The smallest regular singular value (p, NODES)."""
        return self.values[..., self.rank - 1]


@lru_cache(maxsize=1)
def _nodes() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Chebyshev nodes on (0, 1), a fine grid, and the matrix that interpolates from the
    first to the second."""
    nodes = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)[::-1]
    fine = np.linspace(-1.0, 1.0, FINE + 1)
    onto = np.polynomial.chebyshev.chebvander(fine, NODES - 1)
    from_values = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, NODES - 1))
    return 0.5 * (nodes + 1), 0.5 * (fine + 1), onto @ from_values


def _on_pieces(branch: Branch, fractions: np.ndarray) -> np.ndarray:
    """Arclengths (p, k) at ``fractions`` of every piece."""
    return branch.breaks[:-1, None] + np.diff(branch.breaks)[:, None] * fractions


def singular_values(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Singular values (..., n) of F' at points (..., n), over the problem's magnitude,
    padded with zeros."""
    flat = points.reshape(-1, points.shape[-1])
    values = np.linalg.svd(
        problem.jacobians(flat) / problem.magnitude, compute_uv=False
    )
    out = np.zeros((len(flat), problem.n))
    out[:, : values.shape[1]] = values[:, : problem.n]
    return out.reshape(points.shape)


def profile_branch(
    problem: Problem, branch: Branch, tolerance: float = 1e-9
) -> Profile:
    """The singular values along a curve; ``tolerance``: what counts as zero, over the
    problem's magnitude."""
    arclength = _on_pieces(branch, _nodes()[0])
    values = singular_values(problem, branch(arclength))
    typical = np.median(values.reshape(-1, problem.n), axis=0)
    rank = int(np.count_nonzero(typical > tolerance))
    return Profile(arclength, values, max(min(rank, problem.n - 1), 1))


def singular_value_minima(
    problem: Problem, branch: Branch, profile: Profile
) -> tuple[np.ndarray, np.ndarray]:
    """Arclengths (k,) and values (k,) of the local minima of the smallest regular one.

    They are converged: the slope of the exact singular value changes from falling to
    rising there. Where two singular values cross the smaller one has its kink upwards,
    so that a minimum with a kink is a zero, and the square is smooth there. Where a
    value rises to no side by more than rounding there is no minimum, and the ends of an
    open curve are none. Where the curve crosses a singular point the value found is
    small but not zero; `bifurc.singular.locate` decides.
    """
    rank = profile.rank
    s = _places_to_look(branch, profile)
    value, slope = _value_and_slope(problem, branch, rank, s)
    low, high = _valleys(branch, s, slope * problem.scale)
    if not len(low):
        return np.empty(0), np.empty(0)

    def rate_of_square(at: np.ndarray) -> np.ndarray:
        value, slope = _value_and_slope(problem, branch, rank, at)
        return value * slope

    at = bracketed_roots(rate_of_square, low, high, 1e-12 * problem.scale)
    samples = np.concatenate([profile.arclength.ravel(), s])
    heights = np.concatenate([profile.smallest.ravel(), value])
    top = 0.0
    if branch.closed:  # cut open at the top: every valley then has a wall to both sides
        top = samples[np.argmax(heights)]
        at = (at - top) % branch.length
        samples = np.append((samples - top) % branch.length, branch.length)
        heights = np.append(heights, heights.max())
    at = np.sort(at)
    least = singular_values(problem, branch(top + at))[..., rank - 1]
    kept = _with_walls(least, _highest_between(samples, heights, at))
    at, least = at[kept], least[kept]
    if branch.closed:
        at = (top + at) % branch.length
    order = np.argsort(at)
    return at[order], least[order]


def stand_out(
    problem: Problem, branch: Branch, profile: Profile, values: np.ndarray
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
    return values < (1.0 - TIE) * half


def _largest_value(problem: Problem, branch: Branch, profile: Profile) -> float:
    """The largest of the smallest regular singular values on the curve, to about 1e-8.

    From every node near the top a row of points closes in on the highest one.
    """
    nodes, heights = profile.arclength.ravel(), profile.smallest.ravel()
    tops = _minima_in_row(-heights, branch.closed)
    tops = tops[heights[tops] > 0.9 * heights.max()]
    at, reach = nodes[tops], np.gradient(nodes)[tops]
    rows = np.arange(len(at))
    largest = float(heights.max())
    for _ in range(14):
        trial = at[:, None] + reach[:, None] * np.linspace(-1.0, 1.0, 9)
        if not branch.closed:
            trial = np.clip(trial, 0.0, branch.length)
        values = singular_values(problem, branch(trial))[..., profile.rank - 1]
        highest = np.argmax(values, axis=1)
        at, reach = trial[rows, highest], reach / 3
        largest = max(largest, float(values.max(initial=0.0)))
    return largest


def _places_to_look(branch: Branch, profile: Profile) -> np.ndarray:
    """Arclengths (k,), sorted, between which the slope is to be compared.

    Every minimum of the values at the nodes is between two of them, and on both sides
    of every minimum of two interpolants there is one: of the square of the value, and
    of the product of the squares of all regular ones, which is smooth even where they
    meet.
    """
    _, fine, onto = _nodes()
    nodes = profile.arclength.ravel()
    spacing = np.gradient(nodes)
    squares = profile.values[..., : profile.rank] ** 2
    grid = _on_pieces(branch, fine)
    lowest = _minima_in_row(profile.smallest.ravel(), branch.closed)
    around = [nodes[lowest], nodes[lowest - 1], nodes[(lowest + 1) % len(nodes)]]
    step = (grid[:, 1] - grid[:, 0])[:, None]
    for quantity in (squares[..., -1], squares.prod(axis=-1)):
        interpolated = quantity @ onto.T
        s, sizes = grid[:, :-1].ravel(), interpolated[:, :-1].ravel()
        steps = np.broadcast_to(step, (len(grid), FINE)).ravel()
        if not branch.closed:
            s, sizes = (
                np.append(s, grid[-1, -1]),
                np.append(sizes, interpolated[-1, -1]),
            )
            steps = np.append(steps, step[-1])
        lowest = _minima_in_row(sizes, branch.closed)
        s, steps = s[lowest], steps[lowest]
        wide = spacing[np.minimum(np.searchsorted(nodes, s), len(nodes) - 1)]
        around += [s - wide, s - 2 * steps, s + 2 * steps, s + wide]
    places = np.concatenate(around)
    if branch.closed:
        return np.unique(places % branch.length)
    return np.unique(np.clip(places, 0.0, branch.length))


def _minima_in_row(values: np.ndarray, closed: bool) -> np.ndarray:
    """Numbers (k,) of the local minima in a row of values, whose ends meet if
    closed."""
    before, after = (values[-1], values[0]) if closed else (np.inf, np.inf)
    left = np.concatenate([[before], values[:-1]])
    right = np.concatenate([values[1:], [after]])
    return np.flatnonzero((values <= left) & (values < right))


def _value_and_slope(
    problem: Problem, branch: Branch, rank: int, s: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Singular value number ``rank`` at arclengths (k,), and its derivative there (k,).

    With l and r the singular vectors d sigma/ds = l^T F''(r, du/ds): F'' along the
    tangent is a central difference of F'.
    """
    points = branch(s)
    step = DIFFERENCE * problem.scale
    along = step * branch(s, 1)
    jacobians = problem.jacobians(
        np.concatenate([points, points + along, points - along])
    )
    here, after, before = np.split(jacobians / problem.magnitude, 3)
    left, values, right = np.linalg.svd(here, full_matrices=False)
    change = (after - before) / (2 * step)
    vectors = left[:, None, :, rank - 1] @ change @ right[:, rank - 1, :, None]
    return values[:, rank - 1], vectors[:, 0, 0]


def _valleys(
    branch: Branch, s: np.ndarray, slope: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Brackets (low, high) between which the ``slope`` (k,) at ``s`` (k,) turns to
    rising."""
    steep = np.abs(slope) > LEVEL
    s, slope = s[steep], slope[steep]
    if branch.closed and len(s):
        s, slope = np.append(s, s[0] + branch.length), np.append(slope, slope[0])
    turns = np.flatnonzero((slope[:-1] < 0) & (slope[1:] > 0))
    return s[turns], s[turns + 1]


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
    """Numbers of the minima ``values`` (k,) that ``walls`` (k + 1,) beside them stand
    above.

    Of two minima without a wall between them, as rounding makes them, the lower one.
    """

    def is_wall(wall: float, value: float) -> bool:
        return bool(wall > (1.0 + ROUNDING) * value + ZERO)

    kept: list[int] = []
    wall = walls[0]
    for i, value in enumerate(values):
        higher = max(value, values[kept[-1]]) if kept else value
        if is_wall(wall, higher):
            kept.append(i)
            wall = walls[i + 1]
            continue
        if kept and value < values[kept[-1]]:
            kept[-1] = i
        wall = max(wall, walls[i + 1])
    if kept and not is_wall(wall, values[kept[-1]]):
        kept.pop()
    return np.array(kept, dtype=int)


def roots_along(
    branch: Branch, function: Callable[[np.ndarray], np.ndarray]
) -> list[np.ndarray]:
    """Arclengths of the sign changes along a curve of test functions.

    ``function`` maps arclengths (k,) to values (k, q); one array of roots is returned
    for each of the q functions. Sign changes are bracketed on the Chebyshev nodes of
    every piece and refined all together.
    """
    s = np.concatenate(
        [[0.0], _on_pieces(branch, _nodes()[0]).ravel(), [branch.length]]
    )
    values = function(s)
    index, which = np.nonzero(values[:-1] * values[1:] < 0)
    if not len(index):
        return [np.empty(0)] * values.shape[1]

    def of_interest(x: np.ndarray) -> np.ndarray:
        return np.take_along_axis(function(x), which[:, None], axis=1)[:, 0]

    roots = bracketed_roots(of_interest, s[index], s[index + 1])
    return [roots[which == q] for q in range(values.shape[1])]


def dead_points(branch: Branch) -> list[np.ndarray]:
    """For each unknown the arclengths of its dead points: du_i/ds changes sign. None
    for one that stays constant."""
    slopes = np.abs(branch(branch.arclengths(64), 1)).max(axis=0)
    moving = np.flatnonzero(slopes > 1e-8)
    roots = iter(roots_along(branch, lambda s: branch(s, 1)[:, moving]))
    return [next(roots) if i in moving else np.empty(0) for i in range(branch.n)]
