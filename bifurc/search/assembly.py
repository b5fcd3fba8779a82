"""An isolated solution, as exact as doubles make it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.decisions import closes_to_rounding, is_blurred
from bifurc.numerics.null_spaces import decompose
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem

__all__ = ["IsolatedSolution", "polished"]

STEPS = 6  # of Newton's method
NEARBY = 1e-2  # of the scale: how far a solution may lie from where it was found


class IsolatedSolution(NamedTuple):
    """A ``point`` (n,) with its ``stiffness``, the smallest of all n singular values
    there. It ``is_isolated`` where rounding moves it by less than what tells points
    apart."""

    point: np.ndarray
    stiffness: float
    is_isolated: bool


def polished(problem: Problem, start: np.ndarray) -> IsolatedSolution:
    """The solution next to ``start`` (n,), by Newton's method of full rank."""
    best = start
    gap = float(problem.gaps(start[None])[0])
    point = start
    for _ in range(STEPS):
        point = point + decompose(problem, point[None]).newton_steps(problem.n)[0]
        new_gap = float(problem.gaps(point[None])[0])
        distance = np.linalg.norm(point - start)
        if not distance < NEARBY * problem.scale or not new_gap < gap:
            break
        best, gap = point, new_gap
    stiffness = float(singular_values(problem, best)[problem.n - 1])
    is_isolated = closes_to_rounding(gap) and not is_blurred(stiffness)
    return IsolatedSolution(best, stiffness, is_isolated)
