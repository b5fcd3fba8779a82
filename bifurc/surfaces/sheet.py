"""The sheet of a surface above a tangent plane: followed from the centre outwards, and
never by distance.

Along a straight ray in the plane the sheet is a curve. An arc of it is one curve where
the cubic through both ends, with the tangents there, is corrected onto it in places
between: Newton's method contracts at once, far from what other sheets there are, and
what the corrections leave is the smooth bump of the next order. An arc that goes over to
another sheet, however near, has a step in it, which no cubic comes near to.
"""

from __future__ import annotations

import numpy as np

from bifurc import _core
from bifurc.numerics.corrector import compiled_equations
from bifurc.problem import Problem

# Relative residual above which a point is no solution.
SOLVED = 1e-9
NOWHERE = np.empty(0)


def slopes_above(
    problem: Problem, points: np.ndarray, planes: np.ndarray
) -> np.ndarray:
    """Derivatives (k, n, 2) of sheets by the position in ``planes`` (k, n, 2), at their
    points (k, n): the smallest ones where F' has a lower rank."""
    return _core.slopes_above(
        compiled_equations(problem),
        np.ascontiguousarray(points),
        np.ascontiguousarray(planes),
    )


def follow_sheets(
    problem: Problem, centers: np.ndarray, planes: np.ndarray, positions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) above ``positions`` (k, 2) in tangent ``planes`` (k, n, 2) on the
    sheets through the solutions ``centers`` (k, n), and whether they are reached (k,).

    Each ray is followed in steps as long as they may be, at first all the way; what is
    not reached stays at the last place that was.
    """
    ends, reached, *_ = _follow(problem, centers, planes, positions, NOWHERE)
    return ends, reached >= 1.0


def follow_along(
    problem: Problem,
    centers: np.ndarray,
    planes: np.ndarray,
    positions: np.ndarray,
    shares: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, s, n) on the way to ``positions`` (k, 2), at ``shares`` (s,) of
    it, as by `follow_sheets`, and whether they are on the sheet (k, s): where the way is
    lost, and right beside another sheet, they may be on that."""
    _, _, passed, are_there = _follow(problem, centers, planes, positions, shares)
    return passed, are_there


def _follow(
    problem: Problem, *rays: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What compiled code makes of rays: from ``centers`` in ``planes`` to
    ``positions``, past ``shares``."""
    equations, scale = compiled_equations(problem), problem.domain.scale
    return _core.follow_rays(equations, scale, *map(np.ascontiguousarray, rays))
