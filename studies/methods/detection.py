"""How bifurcations are found by the usual ways: on the points of a curve, while or
after it is followed."""

from __future__ import annotations

import numpy as np

from bifurc.problem import Problem
from studies.methods.linear import mixtures

__all__ = ["by_determinant", "by_singular_value"]

SMALL = 0.02  # of the median: a singular value below this is read as zero


def by_determinant(problem: Problem, points: np.ndarray) -> int:
    """Sign changes of det [G'; t] along points (k, n): the test function of square
    continuation packages.

    Where there are more than n - 1 equations, G is n - 1 random combinations of them,
    the usual way to make a system square.
    """
    m = len(problem.residuals(points[:1])[0])
    n = points.shape[1]
    mix = np.eye(m) if m == n - 1 else mixtures(m, n - 1)
    chords = np.gradient(points, axis=0)
    frames = np.concatenate(
        [mix @ problem.jacobians(points), chords[:, None, :]], axis=1
    )
    sign = np.sign(np.linalg.det(frames))
    sign = sign[sign != 0.0]  # a point that hits the singular point exactly
    return int(np.count_nonzero(sign[1:] * sign[:-1] < 0))


def by_singular_value(problem: Problem, points: np.ndarray) -> int:
    """Local minima of singular value n - 1 that come close to zero: how the source
    papers read their curves."""
    sigma = np.linalg.svd(problem.jacobians(points), compute_uv=False)[:, problem.n - 2]
    low = (
        (sigma[1:-1] < sigma[:-2])
        & (sigma[1:-1] <= sigma[2:])
        & (sigma[1:-1] < SMALL * np.median(sigma))
    )
    return int(np.count_nonzero(low))
