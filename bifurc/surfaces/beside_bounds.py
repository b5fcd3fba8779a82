"""Disks of charts where bounds cut the surface: a polygon is cut along straight lines.

A chart next to bounds goes in; out come a radius at which they cut it in nearly straight
lines, and whether the surface above it comes up to a bound and turns back.
"""

from __future__ import annotations

import numpy as np

from bifurc._core import rim_of
from bifurc.numerics.corrector import correct_normal
from bifurc.problem import Problem
from bifurc.surfaces.disk import Disk, TangentPlane
from bifurc.surfaces.sheet import slopes_above

# Rise of the surface towards a bound above the tangent plane, over that in the plane, at
# which the bound is too bent, and the radius over what it was then.
BENT, SMALLER = 0.18, 0.7
# Distance, over the radius, of a place where the surface turns back, at most, by how
# many steps it is looked for, and the last of them, over the radius.
FARTHEST, STEPS, LAST = 2.5, 20, 1e-7


def disk_beside_bounds(
    problem: Problem, plane: TangentPlane, disk: Disk, smallest: float
) -> Disk:
    """The disk, or a smaller one, but none below ``smallest``, where bounds bend into
    it, as about a corner of the surface that is smaller than the disk."""
    radius = disk.radius
    while radius > smallest and _are_bent(problem, plane, radius):
        radius = max(SMALLER * radius, smallest)
    return disk._replace(radius=radius)


def _are_bent(problem: Problem, plane: TangentPlane, radius: float) -> bool:
    """Whether the surface rises to a bound by its bend: what is outside surrounds what
    is inside."""
    domain = problem.domain
    slopes = radius * np.linalg.norm(plane.basis, axis=1)
    rooms = np.abs(domain.bounds - plane.center[:, None])
    # a surface as flat as charts are comes no nearer
    if np.all(rooms.min(axis=1) > 2.0 * radius):
        return False
    rises = _rises(problem, plane, radius)
    for side, sign in enumerate((-1.0, 1.0)):
        most = (sign * rises).max(axis=0)
        is_reached = rooms[:, side] + domain.slack < slopes + most
        if np.any(is_reached & (most > BENT * slopes)):
            return True
    return False


def turns_back(
    problem: Problem, plane: TangentPlane, radius: float, unknown: int, sign: float
) -> bool:
    """Whether ``unknown`` times ``sign`` has its largest value on the surface next to
    a disk, and none outside the bound there: the surface comes up to it and turns
    back."""
    rises = _rises(problem, plane, radius)[:, unknown]
    bend = sign * _bend(rises, radius, plane.basis.shape[1])
    if np.linalg.eigvalsh(bend).max() >= 0.0:
        return False
    y, step = np.zeros(len(bend)), -np.linalg.solve(bend, sign * plane.basis[unknown])
    for _ in range(STEPS):
        y += step
        if np.linalg.norm(y) > FARTHEST * radius:
            return False
        flat = plane.center + plane.basis @ y
        tops, _ = correct_normal(problem, flat[None], plane.basis[None])
        slopes = slopes_above(problem, tops, plane.basis[None])[0, unknown]
        step = -np.linalg.solve(bend, sign * slopes)
        if np.linalg.norm(step) < LAST * radius:
            return bool(problem.domain.are_inside(tops)[0])
    return False


def _rises(problem: Problem, plane: TangentPlane, radius: float) -> np.ndarray:
    """How far solutions (r, n) lie above the places on the rim of a disk."""
    flat = plane.center + radius * rim_of(plane.basis.shape[1]) @ plane.basis.T
    points, _ = correct_normal(problem, flat, plane.basis)
    rises: np.ndarray = points - flat
    return rises


def _bend(rises: np.ndarray, radius: float, dimension: int) -> np.ndarray:
    """The second derivatives (d, d) at the centre that ``rises`` (r,) on the rim
    show."""
    one, other = np.triu_indices(dimension)
    places = radius * rim_of(dimension)
    terms = places[:, one] * places[:, other] / np.where(one == other, 2.0, 1.0)
    bend = np.empty((dimension, dimension))
    bend[one, other] = np.linalg.lstsq(terms, rises, rcond=None)[0]
    bend[other, one] = bend[one, other]
    return bend
