"""How large the disk of a chart may be: as far as the surface stays close to its tangent
plane, on the sheet through the centre."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.numerics.binary_forms import unit_vectors
from bifurc.numerics.corrector import normal_corrections
from bifurc.numerics.null_spaces import cosines_between_planes, tangent_planes
from bifurc.problem import Problem
from bifurc.surfaces.sheet import follow_sheets
from bifurc.system import relative_jacobians

# Largest height of the surface above a disk, over its radius.
BEND = 0.12
# Smallest cosine between tangent planes of a disk and above its rim, and of charts that
# may be neighbours.
AGREE = 0.8
# Relative residual above which a point is no solution.
SOLVED = 1e-9
# How far from the centre, over the radius, other sheets are looked for. Where none is
# near, the second step of Newton's method from there, over the first, and the distance
# of where it ends from the centre, over that of where it begins, are smaller than these.
ASIDE, CONTRACTION, BACK = 0.2, 0.25, 0.3
# Change of F' across the plane up to the rim, over F', below which no sheet crosses in
# the disk, and singular values, over the largest, that are taken for zero there.
STEADY, NEGLIGIBLE = 0.5, 1e-12

RIM = unit_vectors(np.pi / 4 * np.arange(8))


class TangentPlane(NamedTuple):
    """The plane ``basis`` (n, 2) at a solution ``center`` (n,), and the unit vector
    ``normal`` (n,) across the surface along which F' is the weakest: another sheet may
    be near there. It is zero where no equation is left."""

    center: np.ndarray
    basis: np.ndarray
    normal: np.ndarray


class Disk(NamedTuple):
    """The ``radius`` of a chart, and whether other sheets are far from it."""

    radius: float
    is_clear: bool


def fitting_disk(
    problem: Problem, plane: TangentPlane, largest: float, smallest: float
) -> Disk | None:
    """The largest disk to which the surface stays close and where tangent planes agree,
    with a radius between these two; None if there is none."""
    planes = np.broadcast_to(plane.basis, (len(RIM), *plane.basis.shape))
    radius = largest
    while radius >= smallest:
        flat = plane.center + radius * RIM @ plane.basis.T
        points, is_clear = _straight_above(problem, plane, flat, radius)
        height = np.linalg.norm(points - flat, axis=1).max() / radius
        if not is_clear and height < BEND:
            centers = np.broadcast_to(plane.center, flat.shape)
            points, are_reached = follow_sheets(problem, centers, planes, radius * RIM)
            height = np.linalg.norm(points - flat, axis=1).max() / radius
            if not are_reached.all():
                height = np.inf
        if height < BEND:
            planes_there = tangent_planes(problem, points, plane.basis)
            cosines = cosines_between_planes(plane.basis, planes_there)
            if cosines[:, -1].min() > AGREE:
                return Disk(radius, is_clear)
        shrink = 0.5
        if np.isfinite(height):
            shrink = float(np.clip(0.9 * BEND / height, 0.5, 0.8))
        radius *= shrink
    return None


def _straight_above(
    problem: Problem, plane: TangentPlane, flat: np.ndarray, radius: float
) -> tuple[np.ndarray, bool]:
    """Solutions (k, n) straight above points ``flat`` (k, n) of a plane, and whether
    they are on the sheet through its centre.

    They are where Newton's method comes back to the centre, from beside it, and at
    once, as everywhere: then no other sheet is near.
    """
    aside = ASIDE * radius * plane.normal
    starts = np.concatenate([flat, [plane.center + aside, plane.center - aside]])
    planes = np.broadcast_to(plane.basis, (len(starts), *plane.basis.shape))
    corrected = normal_corrections(problem, starts, planes)
    distance = np.linalg.norm(corrected.points[-2:] - plane.center, axis=1)
    is_back = np.all(distance <= BACK * np.linalg.norm(aside))
    is_direct = np.all(corrected.contractions < CONTRACTION)
    is_solved = corrected.gaps[:-2].max() < SOLVED
    points = corrected.points[:-2]
    is_clear = (
        is_back and is_direct and is_solved and _is_steady(problem, plane, points)
    )
    return points, bool(is_clear)


def _is_steady(problem: Problem, plane: TangentPlane, points: np.ndarray) -> bool:
    """Whether F' across the plane is at all ``points`` (k, n) much what it is at the
    centre: where another sheet crosses it changes its sign."""
    about = relative_jacobians(problem, np.concatenate([plane.center[None], points]))
    across = about - about @ plane.basis @ plane.basis.T
    changes = np.linalg.pinv(across[0], rcond=NEGLIGIBLE) @ (across[1:] - across[0])
    return bool(np.linalg.norm(changes, ord=2, axis=(1, 2)).max() < STEADY)
