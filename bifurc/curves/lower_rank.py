"""What a curve is along which F' has rank n - 2, and where others meet it.

F' says neither: it has that rank where nothing meets the curve and where something
does. The matrix of the deflated system (`bifurc.curves.deflation`) is regular where
the curve is a double one, as z = 0 = (z - y)^2 is, and singular where others meet it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.deflation import deflated_singular_values
from bifurc.curves.monitor import Profile
from bifurc.decisions import is_zero_along, may_be_crossed
from bifurc.problem import Problem

DIP = 0.5  # of the typical value, below which a minimum at the nodes is looked at
NARROWER, ROUNDS = 4.0, 16  # by which the places about a minimum close in on it
STEPS = (
    1e-3,
    1e-5,
    1e-7,
)  # over the scale, to both sides of where two slopes are to meet
UNKNOWN = 0
TINY = 1e-300  # keeps what vanishes on both sides from being divided by


class LowerRank(NamedTuple):
    """The ``multiplicity`` of a curve, of one of lower rank 2 or, not known, 0, and
    the arclengths ``crossings`` (k,) at which the deflated system is singular."""

    multiplicity: int
    crossings: np.ndarray


ORDINARY = LowerRank(1, np.empty(0))  # that of a curve of full rank


def lower_rank_along(problem: Problem, branch: Branch, profile: Profile) -> LowerRank:
    """What deflation says of a branch on which F' has a ``profile`` of rank n - 2 or
    less; of less it says nothing."""
    unknown = LowerRank(UNKNOWN, np.empty(0))
    if profile.rank < problem.n - 2:
        return unknown
    nodes = profile.arclength.ravel()
    values = deflated_singular_values(problem, branch, nodes)
    typical = float(np.median(values))
    if is_zero_along(typical):
        return unknown
    are_low = _are_dips(values, branch.closed) & (values < DIP * typical)
    dips = np.flatnonzero(are_low).tolist()
    places = np.array([_bottom(problem, branch, nodes, k) for k in dips])
    depths = deflated_singular_values(problem, branch, places)
    return LowerRank(2, places[may_be_crossed(depths, typical)])


def _are_dips(values: np.ndarray, is_closed: bool) -> np.ndarray:
    """Which of a row of values (k,) are not above their neighbours; the ends of an open
    row are none."""
    is_dip: np.ndarray = (values <= np.roll(values, 1)) & (values < np.roll(values, -1))
    if not is_closed:
        is_dip[[0, -1]] = False
    return is_dip


def _bottom(problem: Problem, branch: Branch, nodes: np.ndarray, k: int) -> float:
    """The arclength of the minimum about node ``k``; where it is a zero, to rounding."""
    reach = float(np.max(np.diff(nodes[max(k - 1, 0) : k + 2])))
    middle = float(nodes[k])
    for _ in range(ROUNDS):
        trial = middle + reach * np.linspace(-1.0, 1.0, 9)
        values = deflated_singular_values(problem, branch, _within(branch, trial))
        middle = float(trial[np.argmin(values)])
        reach /= NARROWER
    for step in STEPS:  # about a zero the two slopes are as steep as each other
        sides = middle + step * problem.scale * np.array([-1.0, 1.0])
        left, right = deflated_singular_values(problem, branch, _within(branch, sides))
        middle += step * problem.scale * float((left - right) / (left + right + TINY))
    return float(_within(branch, np.array([middle]))[0])


def _within(branch: Branch, s: np.ndarray) -> np.ndarray:
    """Arclengths on the branch: modulo its length, or none beyond its ends."""
    if branch.closed:
        return np.asarray(s % branch.length)
    return np.asarray(np.clip(s, 0.0, branch.length))
