"""The value of a near miss, and how far it may be off.

Beside a crossing that forms miss by little, doubles know a place on the curve to
rounding over the singular value, and that value no better than by its square. With F in
many digits the curve is as well known as one likes. With l and r the singular vectors,
the singular value is l . F'(r), its slope along the unit tangent t is l . F''(r, t), both
differences of F. Errors of l and r enter by their squares, so that those of doubles do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.misclosure import as_floats
from bifurc.errors import NOT_DEFINED
from bifurc.limits import is_time_over
from bifurc.numerics.null_spaces import TINY, Decomposition, decompose
from bifurc.system import PreciseResidual, System

if TYPE_CHECKING:
    import mpmath

# Rounding of F and of the singular values of F', over the magnitude.
RESIDUAL_ROUNDING, VALUE_ROUNDING = 2e-15, 4e-15
# Step, over the scale, that is longer than anything rounding explains.
LONGEST_STEP = 1e-3
# A value that doubles know to no better than this share is found in many digits, but
# for those below the root of rounding: geometry in doubles makes redundant equations
# disagree by that, and with them such values.
PRECISE, SMALLEST = 1e-9, 2e-8
DIGITS = 40
STEP = "1e-10"  # of differences, over the scale: they are exact to its square
CORRECTIONS = 40  # Gauss-Newton steps, at most, onto the curve,
# until the last one is so short, over the scale, or, below the second number, shrinks no
# more: the geometry itself is rounded, and its redundant equations disagree by that.
ON_CURVE, STAGNANT = 1e-24, 1e-14
ASIDE = 3e-8  # scales beside the minimum: from there on secants lead,
SHORT = 0.6  # of the singular value, in scales: none of them longer than that,
ROUNDS = 60  # of them at most,
ENOUGH = 1e-12  # until the value changes by so little, as a share
# Rounding of the value; of F' in doubles, which turns its singular vectors by that over
# the singular value.
ROUNDING, TURNED = 4e-16, 1e-15
FARTHEST = 1e-2  # scales from where it was found at which the minimum may lie


class NearMissValue(NamedTuple):
    """A singular value over the magnitude, which is off by ``error`` at most."""

    value: float
    error: float


def near_miss_values(
    problem: System, branch: Branch, rank: int, arclengths: np.ndarray
) -> list[NearMissValue]:
    """Singular value number ``rank`` of F' at its minima on a branch, at ``arclengths``
    (k,).

    Rounding in F leaves the place open by as much, over the singular value of each
    direction, and the value changes by l^T F''(r, du) with its singular vectors l and r.
    Along the curve it does not change to first order. Past the end of the time values
    are those of doubles.
    """
    points = branch(arclengths)
    steps = _visible_steps(decompose(problem, points), rank)
    is_short = np.linalg.norm(steps, axis=1) < LONGEST_STEP * problem.domain.scale
    points[is_short] += steps[is_short]
    values = _values_of_doubles(problem, points, rank)
    if rank < problem.n - 1:
        return values
    return [
        _refined(problem, branch, float(s), value)
        if _is_to_be_refined(value)
        else value
        for s, value in zip(arclengths, values, strict=True)
    ]


def _values_of_doubles(
    problem: System, points: np.ndarray, rank: int
) -> list[NearMissValue]:
    """The singular values of a number ``rank`` at points (k, n), with their errors."""
    decomposition = decompose(problem, points)
    sigma = decomposition.sigma[:, :rank]
    across = decomposition.right[:, :rank]
    left = decomposition.left[:, :, rank - 1]
    hessians = problem.hessians(points) / problem.magnitude
    gradients = np.einsum("km,kmij,kj->ki", left, hessians, across[:, -1])
    shifts = np.abs(np.einsum("kri,ki->kr", across, gradients)) * RESIDUAL_ROUNDING
    errors = VALUE_ROUNDING + (shifts / np.maximum(sigma, TINY)).sum(axis=1)
    pairs = zip(sigma[:, -1], np.minimum(errors, sigma[:, 0]), strict=True)
    return [NearMissValue(float(value), float(error)) for value, error in pairs]


def _is_to_be_refined(rough: NearMissValue) -> bool:
    """Whether a value of doubles is worse than it can be made in the time."""
    is_open = rough.error > PRECISE * rough.value and rough.value > SMALLEST
    return is_open and not is_time_over()


def _refined(
    problem: System, branch: Branch, s: float, rough: NearMissValue
) -> NearMissValue:
    """The value in many digits, where it is within the error of that of doubles."""
    try:
        precise = _precise_near_miss(problem, branch, problem.n - 1, s)
    except NOT_DEFINED:
        return rough  # it is beside a rim of where the function is defined
    if precise is None or abs(precise.value - rough.value) > rough.error:
        return rough
    return precise


def _visible_steps(decomposition: Decomposition, rank: int) -> np.ndarray:
    """The Gauss-Newton steps (k, n) of a ``rank``, along those directions in which the
    residual is more than rounding: a small singular value amplifies that."""
    left = decomposition.left[:, :, :rank]
    components = np.einsum("kmr,km->kr", left, decomposition.residuals)
    is_visible = np.abs(components) > RESIDUAL_ROUNDING
    shares = components / np.maximum(decomposition.sigma[:, :rank], TINY)
    shares[~is_visible] = 0.0
    steps: np.ndarray = -np.einsum("kr,kri->ki", shares, decomposition.right[:, :rank])
    return steps


# --- in many digits -------------------------------------------------------------------


class _Station(NamedTuple):
    """A point (n,) of a curve in many digits, the unit tangent (n,) there, the singular
    value, half the slope of its square along the tangent, and how far the point may be
    off, over the scale."""

    point: list[mpmath.mpf]
    tangent: np.ndarray
    value: float
    half_slope: float
    error: float


def _precise_near_miss(
    problem: System, branch: Branch, rank: int, s: float
) -> NearMissValue | None:
    """Singular value number ``rank`` of F' at its minimum on a branch next to
    arclength ``s``; None where F is known in doubles only, or no minimum is reached.

    It begins a little aside, where the curve is known to less than its distance from
    the next one, and goes to the minimum by steps that are short beside that distance.
    """
    residual = problem.precise_residual()
    if residual is None:
        return None
    import mpmath

    with mpmath.workdps(DIGITS):
        start = branch(s + ASIDE * problem.domain.scale)
        place = [mpmath.mpf(float(x)) for x in start]
        before = _station(problem, residual, place, rank)
        if before is None:
            return None
        step = SHORT * before.value * problem.domain.scale
        if branch(s + ASIDE * problem.domain.scale, 1) @ before.tangent > 0:
            step = -step
        for _ in range(ROUNDS):
            here = _station(problem, residual, _moved(before, step), rank)
            if here is None or not _is_near(problem, here, start):
                return None
            change = abs(here.value - before.value) + here.error
            if change <= max(ENOUGH * here.value, 10 * here.error):
                turned = (TURNED / here.value) ** 2
                error = change + (ROUNDING + turned) * here.value
                return NearMissValue(here.value, error)
            longest = SHORT * here.value * problem.domain.scale
            step = float(np.clip(_secant(before, here), -longest, longest))
            before = here
    return None


def _station(
    problem: System, residual: PreciseResidual, place: list[mpmath.mpf], rank: int
) -> _Station | None:
    """The point of the curve next to a place (n,), and the singular value there; None
    where no correction leads to one."""
    import mpmath

    point = list(place)
    last = np.inf
    for _ in range(CORRECTIONS):
        at = decompose(problem, np.array([[float(x) for x in point]]))
        inverse = (at.right[0, :rank].T / at.sigma[0, :rank]) @ at.left[0, :, :rank].T
        missed = as_floats(residual(point), problem.magnitude)
        step = inverse @ missed
        point = [x - mpmath.mpf(float(d)) for x, d in zip(point, step, strict=True)]
        size = float(np.linalg.norm(step)) / problem.domain.scale
        if size < ON_CURVE or (size < STAGNANT and size > 0.5 * last):
            break
        last = size
    else:
        return None
    at = decompose(problem, np.array([[float(x) for x in point]]))
    left, right = at.left[0, :, rank - 1], at.right[0, rank - 1]
    tangent = at.right[0, rank]
    h = mpmath.mpf(STEP) * mpmath.mpf(problem.domain.scale)

    def seen(along_right: int, along_tangent: int) -> mpmath.mpf:
        """l . F a step or none beside the point."""
        beside = [
            x
            + h
            * (
                along_right * mpmath.mpf(float(r))
                + along_tangent * mpmath.mpf(float(t))
            )
            for x, r, t in zip(point, right, tangent, strict=True)
        ]
        return mpmath.fdot([mpmath.mpf(float(x)) for x in left], residual(beside))

    value = (seen(1, 0) - seen(-1, 0)) / (2 * h * problem.magnitude)
    mixed = seen(1, 1) - seen(1, -1) - seen(-1, 1) + seen(-1, -1)
    slope = mixed / (4 * h * h * problem.magnitude)
    return _Station(point, tangent, float(value), float(value * slope), size)


def _moved(here: _Station, step: float) -> list[mpmath.mpf]:
    """The place (n,) a ``step`` along the tangent of a station."""
    import mpmath

    return [
        x + mpmath.mpf(step * float(t))
        for x, t in zip(here.point, here.tangent, strict=True)
    ]


def _secant(before: _Station, here: _Station) -> float:
    """The step from ``here`` along its tangent to where the slope would be zero if it
    changed at one rate."""
    covered = [float(x - y) for x, y in zip(here.point, before.point, strict=True)]
    width = float(np.array(covered) @ here.tangent)
    aligned = 1.0 if here.tangent @ before.tangent > 0 else -1.0
    change = here.half_slope - aligned * before.half_slope
    return -here.half_slope * width / change if change else 0.0


def _is_near(problem: System, here: _Station, start: np.ndarray) -> bool:
    """Whether a station is next to where the near miss was found."""
    offset = np.array([float(x) for x in here.point]) - start
    return bool(np.linalg.norm(offset) < FARTHEST * problem.domain.scale)
