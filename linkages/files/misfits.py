"""How far angles of a file may be from closed ones: as far as rounding takes them."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from bifurc.decisions import is_start_solved
from bifurc.problem import Problem
from linkages.decisions import keeps_angle
from linkages.values import GeometryError, require

log = logging.getLogger(__name__)

# Angles of a file are rounded. Near a singular configuration they move by the root of
# that, of two decimals of a degree by about one; angles that were never closed move by
# tens of degrees.
LARGEST_MOVE = 5.0  # degrees
MOST_SHOWN = 12  # angles in a message


def closed_near(
    problem: Problem, what: str, before: np.ndarray, names: Sequence[str], far: str
) -> np.ndarray:
    """The closed angles (n,), rad, of the joints of these ``names`` that are nearest to
    given ones (n,); warns of those that were moved.

    Raises `GeometryError` where none are near, as ``far`` says of the gap that is left,
    and where one of them went by more than `LARGEST_MOVE`: they were not closed.
    """
    points, gaps = problem.project(before[None])
    value, allowed = far.split("; ")
    is_near = is_start_solved(float(gaps[0]))
    require(is_near, what, value.format(gaps[0]), allowed)
    after: np.ndarray = points[0]
    gap = float(np.linalg.norm(problem.residuals(before[None])))
    changes = np.abs(np.remainder(after - before + np.pi, 2 * np.pi) - np.pi)
    largest = int(np.argmax(changes))
    change = float(np.degrees(changes[largest]))
    if change > LARGEST_MOVE:
        value = (
            f"not closed, by a gap of {gap:.3g} of the characteristic length; joint "
            f"{names[largest]} is {change:.4g} degrees off the closed configuration that "
            "is found from there, which"
        )
        allowed = f"closed to {LARGEST_MOVE:g} degrees, as rounded numbers are"
        if len(names) <= MOST_SHOWN:
            wrapped = np.remainder(after + np.pi, 2 * np.pi) - np.pi
            degrees = np.degrees(wrapped).round(6).tolist()
            allowed += f"; closed would be {degrees} degrees for {', '.join(names)}"
        raise GeometryError(what, value, allowed)
    if not keeps_angle(float(changes[largest])):
        log.warning("%s: moved by up to %.3g degrees to be closed", what, change)
    return after
