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
]

NODES, FINE = 16, 96


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
    """Arclengths (k,) and values (k,) of the local minima of the smallest regular
    singular value.

    Candidates are minima of two interpolants: of the square of that value, and of the
    product of the squares of all regular ones, which is smooth even where singular
    values meet (there only zeros count). Each is then refined on the exact values.
    Where the curve crosses a singular point the value found is small but not zero;
    `bifurc.singular.locate` decides.
    """
    _, fine, onto = _nodes()
    regular = profile.values[..., : profile.rank] ** 2
    grid = _on_pieces(branch, fine)
    s, reach = _grid_minima(grid, regular[..., -1] @ onto.T, branch.closed)
    product_s, product_reach = _grid_minima(
        grid, regular.prod(axis=-1) @ onto.T, branch.closed
    )
    of_product = np.repeat([False, True], [len(s), len(product_s)])
    s, reach = np.concatenate([s, product_s]), np.concatenate([reach, product_reach])
    value = np.empty_like(s)
    for _ in range(4):
        trial = s[:, None] + reach[:, None] * np.linspace(-1.0, 1.0, 9)
        if not branch.closed:
            trial = np.clip(trial, 0.0, branch.length)
        values = singular_values(problem, branch(trial))[..., profile.rank - 1]
        best = np.argmin(values, axis=1)
        rows = np.arange(len(s))
        s, value, reach = trial[rows, best], values[rows, best], reach / 4
    genuine = ~of_product | (value < 1e-3)
    return _without_repeats(s[genuine], value[genuine], branch)


def _grid_minima(
    grid: np.ndarray, quantity: np.ndarray, closed: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Arclengths and grid spacings of the local minima of ``quantity`` on the pieces'
    fine grids."""
    s, q = grid[:, :-1].ravel(), quantity[:, :-1].ravel()
    spacing = np.repeat(grid[:, 1] - grid[:, 0], grid.shape[1] - 1)
    if not closed:
        s, q = np.append(s, grid[-1, -1]), np.append(q, quantity[-1, -1])
        spacing = np.append(spacing, spacing[-1])
    left, right = np.roll(q, 1), np.roll(q, -1)
    if not closed:
        left[0], right[-1] = np.inf, np.inf
    found = (q <= left) & (q < right)
    return s[found], 2.0 * spacing[found]


def _without_repeats(
    s: np.ndarray, value: np.ndarray, branch: Branch
) -> tuple[np.ndarray, np.ndarray]:
    """Sorted by arclength, one of each group closer than 1e-4 of the curve's largest
    piece."""
    if branch.closed:
        s = s % branch.length
    order = np.argsort(s)
    s, value = s[order], value[order]
    apart = 1e-4 * np.diff(branch.breaks).max()
    keep: list[int] = []
    for i in range(len(s)):
        if keep and s[i] - s[keep[-1]] < apart:
            if value[i] < value[keep[-1]]:
                keep[-1] = i
            continue
        keep.append(i)
    if (
        branch.closed
        and len(keep) > 1
        and s[keep[0]] + branch.length - s[keep[-1]] < apart
    ):
        keep.pop(0 if value[keep[0]] > value[keep[-1]] else -1)
    return s[keep], value[keep]


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
