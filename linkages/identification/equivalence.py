"""When two Denavit-Hartenberg tables are one linkage.

A table is an array (3, n): lengths, twists (rad), offsets. NaN stands for a number that
is left out, which is as far off as nothing. The same linkage, or its
mirror image, has many: it can be read from another joint or the other way round
(`Reading`), every joint axis and every link can be reversed (`Signs`), and a half turn
about x turns the sign of all offsets, which is the reversal of all axes:

    axis i reversed   R_i -> -R_i, alpha_{i-1,i} -> alpha_{i-1,i} + pi,
                      alpha_{i,i+1} -> alpha_{i,i+1} + pi
    link i reversed   a_{i,i+1} -> -a_{i,i+1}, alpha_{i,i+1} -> -alpha_{i,i+1}
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from linkages.loop import Loop


def table(loop: Loop) -> np.ndarray:
    """The table (3, n) of a loop: lengths, twists (rad), offsets."""
    return np.array([loop.lengths, loop.twists, loop.offsets], dtype=float)


def as_loop(values: np.ndarray, name: str = "", rounding: float = 0.0) -> Loop:
    """The loop of a table (3, n) with lengths that are known to ``rounding``."""
    lengths, twists, offsets = (tuple(row.tolist()) for row in values)
    return Loop(lengths, twists, offsets, name, rounding)


@dataclass(frozen=True)
class Reading:
    """A way to read a table: mirrored or not, forwards or backwards, from joint 1 +
    ``shift``."""

    shift: int
    is_reversed: bool
    is_mirrored: bool

    def of(self, values: np.ndarray) -> np.ndarray:
        """The table (3, n) as it reads this way."""
        out = _reversed(values) if self.is_reversed else values
        out = np.roll(out, -self.shift, axis=1)
        return _mirrored(out) if self.is_mirrored else out

    def undone(self, values: np.ndarray) -> np.ndarray:
        """The table whose reading is ``values`` (3, n)."""
        out = _mirrored(values) if self.is_mirrored else values
        out = np.roll(out, self.shift, axis=1)
        return _reversed(out) if self.is_reversed else out

    def __str__(self) -> str:
        start = f"from joint {self.shift + 1}"
        if self.is_reversed:
            start = f"backwards, shift {self.shift}"
        return start + (", mirrored" if self.is_mirrored else "")


def _mirrored(values: np.ndarray) -> np.ndarray:
    return values * [[1.0], [-1.0], [-1.0]]


def _reversed(values: np.ndarray) -> np.ndarray:
    out = values[:, ::-1].copy()
    out[:2] = np.roll(out[:2], -1, axis=1)  # the last link stays the last one
    return out


def readings(n: int) -> tuple[Reading, ...]:
    """The 4 n ways to read a table of n joints."""
    return tuple(
        Reading(k, back, mirror)
        for mirror in (False, True)
        for back in (False, True)
        for k in range(n)
    )


def normal_form(values: np.ndarray) -> np.ndarray:
    """The tables (..., 3, n) with no negative length and every twist in [0, pi), axes
    and links being reversed as needed.

    Offsets keep their size only. The parity of the axis reversals is lost: use it to
    read off parameters.
    """
    lengths, twists, offsets = np.moveaxis(values, -2, 0)
    turned = np.mod(np.where(lengths < 0, -twists, twists), np.pi)
    turned = np.where(np.pi - turned < 1e-12, 0.0, turned)
    return np.stack([np.abs(lengths), turned, offsets], axis=-2)


@dataclass(frozen=True)
class Signs:
    """Which links and axes are reversed: ``links`` and ``axes`` (n,) are +1 or -1."""

    links: np.ndarray
    axes: np.ndarray

    def of(self, values: np.ndarray) -> np.ndarray:
        """The table (3, n) with these links and axes reversed."""
        turns = np.where(_opposite_to_next(self.axes), np.pi, 0.0)
        lengths, twists, offsets = values
        rows = [self.links * lengths, self.links * twists + turns, self.axes * offsets]
        return np.array(rows)


def _opposite_to_next(signs: np.ndarray) -> np.ndarray:
    """Whether each of the ``signs`` (n,) is another than the next, the last than the
    first (n,)."""
    opposite: np.ndarray = signs != np.concatenate((signs[1:], signs[:1]))
    return opposite


@dataclass(frozen=True)
class Comparison:
    """Distances of candidates from a target, each the root of a sum of squares, lengths
    in its unit, angles in rad.

    ``exact`` (k,) allows reversed links and axes; ``blind`` (k,), never larger, takes
    every twist modulo pi and every offset without its sign as well. ``axes`` (k,) is
    the number of the best pattern of reversed axes.
    """

    blind: np.ndarray
    exact: np.ndarray
    axes: np.ndarray


@dataclass(frozen=True)
class _AxisChoices:
    """All 2^n patterns of reversed axes: their ``signs`` (2^n, n), and one-hot matrices
    (2 n, 2^n) that choose from the costs of twists and of offsets."""

    signs: np.ndarray
    of_twists: np.ndarray
    of_offsets: np.ndarray


@cache
def _axis_choices(n: int) -> _AxisChoices:
    numbers = np.arange(2**n)
    flips = (numbers[:, None] >> np.arange(n)) & 1
    turns = flips ^ np.roll(flips, -1, axis=1)
    return _AxisChoices(1.0 - 2.0 * flips, _one_hot(turns), _one_hot(flips))


def _one_hot(choices: np.ndarray) -> np.ndarray:
    """The matrix (2 n, k) that takes the first or the second of n pairs, by the
    ``choices`` (k, n) of 0 or 1."""
    k, n = choices.shape
    pairs = np.stack([1 - choices, choices], axis=-1)
    return pairs.reshape(k, 2 * n).T.astype(float)


def compare(target: np.ndarray, candidates: np.ndarray, unit: float) -> Comparison:
    """How far ``candidates`` (k, 3, n) are from ``target`` (3, n) or (k, 3, n), up to
    reversed links and axes.

    Lengths and offsets are measured in ``unit``.
    """
    plain, other = _link_costs(target, candidates, unit)
    joints = _joint_costs(target, candidates, unit)
    return _compare_costs(np.minimum(plain, other), joints)


def _compare_costs(links: np.ndarray, joints: np.ndarray) -> Comparison:
    """Distances (k,) from the costs (k, n, 2) of links and of joints."""
    k, n, _ = links.shape
    choices = _axis_choices(n)
    by_twists = links.reshape(k, 2 * n) @ choices.of_twists
    by_offsets = joints.reshape(k, 2 * n) @ choices.of_offsets
    total = by_twists + by_offsets  # (k, 2^n)
    best = total.argmin(axis=1)
    exact = total[np.arange(k), best]
    blind_links = links.min(axis=2).sum(axis=1)
    blind_joints = joints.min(axis=2).sum(axis=1)
    return Comparison(np.sqrt(blind_links + blind_joints), np.sqrt(exact), best)


def find_signs(target: np.ndarray, candidate: np.ndarray, unit: float) -> Signs:
    """The reversals that bring ``candidate`` (3, n) as near to ``target`` (3, n) as
    they can."""
    n = candidate.shape[1]
    plain, other = _link_costs(target, candidate[None], unit)
    joints = _joint_costs(target, candidate[None], unit)
    best = _compare_costs(np.minimum(plain, other), joints).axes[0]
    axes = _axis_choices(n).signs[best]
    turns = _opposite_to_next(axes).astype(int)
    reverse = (other < plain)[0][np.arange(n), turns]
    return Signs(np.where(reverse, -1.0, 1.0), axes)


def _link_costs(
    target: np.ndarray, candidates: np.ndarray, unit: float
) -> list[np.ndarray]:
    """Squared distances (k, n, 2) of links without and with pi added to the twist, of
    links as they are and reversed."""
    costs = []
    for sign in (1.0, -1.0):
        length = (target[..., 0, :] - sign * candidates[:, 0]) / unit
        half = (target[..., 1, :] - sign * candidates[:, 1]) / 2
        square = _without_gaps(length**2)
        without = square + _without_gaps(4 * np.sin(half) ** 2)
        turned = square + _without_gaps(4 * np.cos(half) ** 2)
        costs.append(np.stack([without, turned], axis=-1))
    return costs


def _joint_costs(target: np.ndarray, candidates: np.ndarray, unit: float) -> np.ndarray:
    """Squared distances (k, n, 2) of offsets as they are and with the other sign."""
    given = np.atleast_2d(target[..., 2, :])
    offsets = candidates[:, 2]
    squares = [(given - offsets) ** 2, (given + offsets) ** 2]
    return _without_gaps(np.stack(squares, axis=-1) / unit**2)


def _without_gaps(costs: np.ndarray) -> np.ndarray:
    """Costs, those of numbers that are left out being 0."""
    known: np.ndarray = np.nan_to_num(costs, nan=0.0)
    return known
