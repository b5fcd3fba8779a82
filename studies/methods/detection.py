"""How bifurcations are found by the usual ways: on the points of a curve, while or
after it is followed."""

from __future__ import annotations

import numpy as np

from bifurc import Problem
from studies.methods.linear import mixtures

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
    jacobians = mix @ problem.jacobians(points)
    chords = np.gradient(points, axis=0)
    frames = np.concatenate([jacobians, chords[:, None, :]], axis=1)
    signs = np.sign(np.linalg.det(frames))
    signs = signs[signs != 0.0]  # a point that hits the singular point exactly
    changes = signs[1:] * signs[:-1] < 0
    return int(np.count_nonzero(changes))


def by_singular_value(problem: Problem, points: np.ndarray) -> int:
    """Local minima of singular value n - 1 that come close to zero: how the source
    papers read their curves."""
    values = np.linalg.svd(problem.jacobians(points), compute_uv=False)
    smallest = values[:, problem.n - 2]
    before, here, after = smallest[:-2], smallest[1:-1], smallest[2:]
    is_minimum = (here < before) & (here <= after)
    is_small = here < SMALL * np.median(smallest)
    return int(np.count_nonzero(is_minimum & is_small))
