"""How well a point of a curve is known, and how far a singular point is from it.

F is known to rounding. Across a curve it grows in proportion to the distance, most
slowly along the weakest regular direction: rounding over the smallest regular singular
value is the distance to which a point of the curve is known. Beside a surface that is
no solution but nearly one, that value is small all along the curve; beside a singular
point it is small because it vanishes there.
"""

from __future__ import annotations

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_without_equation, may_be_scaled_down
from bifurc.numerics.null_spaces import decompose, null_vector
from bifurc.numerics.singular_values import factors_of, singular_values
from bifurc.system import System, hessian_at, relative_jacobians, relative_residuals

ROUNDING = 1e-15  # of F, over the magnitude, where F is evaluated with care
# Step, over the scale, after which F differs by its slope and rounding, and how far from
# a point that is seen.
PROBE, BESIDE = 1e-12, 1e-4
MANY = 300  # unknowns beyond which singular values take minutes
PROBES = 8  # such steps: rounding is the largest difference
SAFETY = 2.0  # times that
# Times the blur: two points of one curve are no farther apart.
ALIKE = 20.0
# Times the blur: what an unknown changes by along a curve of the length of the scale for
# rounding alone is no more.
MADE = 100.0
# Shares of the length of a curve at which it is seen how well it is known.
PLACES = (np.arange(15) + 0.5) / 15
TINY = 1e-300  # keeps a rate of zero from being divided by


def known_to(
    problem: System, points: np.ndarray, values: np.ndarray | None = None
) -> np.ndarray:
    """The distance, over the scale, to which points (k, n) of curves are known: what
    rounding leaves of the weakest regular equation, over its singular value.

    ``values`` (k, n) are the singular values there, where they are known. That equation
    may be small because somebody scaled it, and its rounding with it: the rounding is
    measured. 0 where F says nothing of a direction, and where F' is not finite: at the
    rim of where F is defined.
    """
    distances = np.zeros(len(points))
    if problem.n < 2 or not len(points):
        return distances
    if values is None and problem.n > MANY and problem.shortcuts.smallest_value:
        return ROUNDING / _weakest_of_many(problem, points)
    if values is None:
        values = singular_values(problem, points)
    sigma = values[:, problem.n - 2]
    is_clear = np.isfinite(sigma) & ~may_be_scaled_down(sigma)
    if is_clear.all():
        return np.asarray(ROUNDING / sigma)
    distances[is_clear] = ROUNDING / sigma[is_clear]
    weak = np.flatnonzero(~is_clear & ~is_without_equation(sigma))
    if len(weak):
        rounding = _rounding_of_weakest(problem, points[weak])
        distances[weak] = SAFETY * rounding / sigma[weak]
    return distances


def _weakest_of_many(problem: System, points: np.ndarray) -> np.ndarray:
    """The smallest regular singular value (k,) at points (k, n) of curves of many
    unknowns, about, by sparse factors."""
    smallest_value = problem.shortcuts.smallest_value
    assert smallest_value is not None
    values = [smallest_value(point, null_vector(problem, point)) for point in points]
    return np.maximum(values, TINY)


def _rounding_of_weakest(problem: System, points: np.ndarray) -> np.ndarray:
    """The rounding (k,) of the weakest regular equation at points (k, n)."""
    left, _, _ = factors_of(relative_jacobians(problem, points))
    weakest = left[:, :, problem.n - 2]
    parts = np.einsum("pkm,km->pk", _rounding(problem, points), weakest)
    # beyond the rim of where F is defined there is none to measure
    rounding: np.ndarray = np.fmax.reduce(np.abs(parts), axis=0, initial=0.0)
    return rounding


def same_reach(
    problem: System, points: np.ndarray, values: np.ndarray | None = None
) -> np.ndarray:
    """How far, over the scale, from where a curve was found its points (k, n) may be
    found for rounding alone; ``values`` as in `known_to`."""
    return ALIKE * known_to(problem, points, values)


def blur_along(problem: System, branch: Branch) -> float:
    """The distance, over the scale, to which the points of a curve are known, as a
    rule."""
    distances = known_to(problem, branch(branch.length * PLACES))
    return float(np.sort(distances)[len(PLACES) // 2])


def change_by_blur(blur: float) -> float:
    """The largest change of an unknown along a curve, over the scale, that rounding may
    make where its points are known to a distance ``blur``, over the scale; the largest
    rate as well."""
    return MADE * blur


def rounding_unit(problem: System, points: np.ndarray) -> float:
    """How many times larger than `ROUNDING` the rounding of F is at points (k, n), 1 at
    least."""
    if not len(points):
        return 1.0
    sizes = np.linalg.norm(_rounding(problem, points), axis=2)
    return max(1.0, float(sizes.max()) / ROUNDING)


def _rounding(problem: System, points: np.ndarray) -> np.ndarray:
    """Samples (p, k, m) of the rounding of F, over the magnitude, about points (k, n).

    F is evaluated twice, a little apart: what its slope does not explain is rounding.
    That is done beside the points, for at some of them rounding happens to be nothing.
    """
    rng = np.random.default_rng(0)
    shape = (PROBES, *points.shape)
    places = (points + BESIDE * problem.domain.scale * rng.normal(size=shape)).reshape(
        -1, problem.n
    )
    steps = PROBE * problem.domain.scale * rng.normal(size=places.shape)
    moved = relative_residuals(problem, places + steps)
    change = moved - relative_residuals(problem, places)
    slopes = relative_jacobians(problem, places)
    rounding: np.ndarray = change - np.einsum("kmn,kn->km", slopes, steps)
    return rounding.reshape(PROBES, len(points), -1)


def distance_to_singular(problem: System, point: np.ndarray, nullity: int = 2) -> float:
    """The distance, over the scale, at which a singular point of a ``nullity`` would
    lie from a solution (n,), to first order.

    V are as many weakest directions and W what the other ones leave of the equations:
    on V the largest of those singular values changes at the rate |W^T F''(V, V)|. On a
    surface both vanish, and beside one both are small: it is their quotient that tells.
    Infinite where there are fewer unknowns than the nullity.
    """
    weakest = problem.n - nullity
    if weakest < 0:
        return np.inf
    decomposition = decompose(problem, point[None])
    if decomposition.sigma.shape[1] <= weakest:
        return 0.0
    sigma = float(decomposition.sigma[0, weakest])
    left = decomposition.left[0, :, weakest:]
    right = decomposition.right[0, weakest:]
    hessian = hessian_at(problem, point) / problem.magnitude
    reduced = np.tensordot(left.T, right @ (hessian @ right.T), axes=1)
    rate = float(np.linalg.norm(reduced)) * problem.domain.scale
    return sigma / (rate + TINY)
