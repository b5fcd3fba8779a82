"""The value of a near miss, and how far it may be off."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.precise_near_miss import precise_near_miss
from bifurc.numerics.null_spaces import TINY, Decomposition, decompose
from bifurc.problem import Problem

# Rounding of F and of the singular values of F', over the magnitude.
RESIDUAL_ROUNDING, VALUE_ROUNDING = 2e-15, 4e-15
# Step, over the scale, that is longer than anything rounding explains.
LONGEST_STEP = 1e-3
# A value that doubles know to no better than this share is found in many digits, but
# for those below the root of rounding: geometry in doubles makes redundant equations
# disagree by that, and with them such values.
PRECISE, SMALLEST = 1e-9, 2e-8


class NearMissValue(NamedTuple):
    """A singular value over the magnitude, which is off by ``error`` at most."""

    value: float
    error: float


def near_miss_value(
    problem: Problem, branch: Branch, rank: int, s: float
) -> NearMissValue:
    """Singular value number ``rank`` of F' at its minimum on a branch, at arclength
    ``s``.

    Rounding in F leaves the place open by as much, over the singular value of each
    direction, and the value changes by l^T F''(r, du) with its singular vectors l and r.
    Along the curve it does not change to first order.
    """
    point = branch(s)
    step = _visible_step(decompose(problem, point[None]), rank)
    if np.linalg.norm(step) < LONGEST_STEP * problem.scale:
        point = point + step
    decomposition = decompose(problem, point[None])
    sigma = decomposition.sigma[0, :rank]
    across = decomposition.right[0, :rank]
    left = decomposition.left[0, :, rank - 1]
    bend = np.tensordot(left, problem.hessian(point), axes=1) / problem.magnitude
    gradient = bend @ across[-1]
    shifts = np.abs(across @ gradient) * RESIDUAL_ROUNDING / np.maximum(sigma, TINY)
    error = VALUE_ROUNDING + float(shifts.sum())
    rough = NearMissValue(float(sigma[-1]), min(error, float(sigma[0])))
    if rank < problem.n - 1 or not _is_to_be_refined(rough):
        return rough
    return _refined(problem, branch, s, rough)


def _is_to_be_refined(rough: NearMissValue) -> bool:
    """Whether a value of doubles is worse than it can be made."""
    return rough.error > PRECISE * rough.value and rough.value > SMALLEST


def _refined(
    problem: Problem, branch: Branch, s: float, rough: NearMissValue
) -> NearMissValue:
    """The value in many digits, where it is within the error of that of doubles."""
    precise = precise_near_miss(problem, branch, problem.n - 1, s)
    if precise is None or abs(precise.value - rough.value) > rough.error:
        return rough
    return NearMissValue(precise.value, precise.error)


def _visible_step(decomposition: Decomposition, rank: int) -> np.ndarray:
    """The Gauss-Newton step (n,) of a ``rank`` at one point, along those directions in
    which the residual is more than rounding: a small singular value amplifies that."""
    components = decomposition.left[0, :, :rank].T @ decomposition.residuals[0]
    is_visible = np.abs(components) > RESIDUAL_ROUNDING
    sigma = np.maximum(decomposition.sigma[0, :rank][is_visible], TINY)
    shares = components[is_visible] / sigma
    step: np.ndarray = -shares @ decomposition.right[0, :rank][is_visible]
    return step
