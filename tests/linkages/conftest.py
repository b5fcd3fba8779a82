"""Reference cases, and a tracer that is kept plain so that tests of the catalogue rest
on nothing else."""

import json
from pathlib import Path

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.search.explore import explore
from tests.linkages.loops_with_surfaces import sarrus

CASES = json.loads(
    (Path(__file__).parents[2] / "data" / "reference_configurations.json").read_text()
)

ROUNDING = 1e-14  # rad; no correction after a smaller one changes more than last bits


@pytest.fixture(scope="session")
def reference_cases():
    """Linkage, parameters (rad), source and, per form, its name and one configuration
    (rad)."""
    return CASES


@pytest.fixture(scope="session")
def closure_gap():
    """Largest entry of T_1 ... T_n - I over all configurations (..., n)."""
    return lambda loop, theta: float(
        np.abs(loop.frames(np.asarray(theta))[..., -1, :, :] - np.eye(4)).max()
    )


@pytest.fixture(scope="session")
def closure_entries():
    """The entries of T_1 ... T_n - I of one configuration, computed with a library such
    as mpmath or sympy."""

    def entries(loop, theta, library):
        product = library.eye(4)
        for a, alpha, offset, angle in zip(
            loop.lengths, loop.twists, loop.offsets, theta, strict=True
        ):
            c, s, ca, sa = (
                f(x) for x in (angle, alpha) for f in (library.cos, library.sin)
            )
            step = [
                [c, -s * ca, s * sa, a * c],
                [s, c * ca, -c * sa, a * s],
                [0, sa, ca, offset],
                [0, 0, 0, 1],
            ]
            product = (
                product * library.Matrix(step)
                if library.__name__ == "sympy"
                else product * library.matrix(step)
            )
        return list(product - library.eye(4))

    return entries


def _traced(loop, start, step=0.12, limit=3000):
    scale = np.repeat([1.0, 1.0 / loop.characteristic_length], 3)[:, None]

    def tangent(theta, along):
        t = np.linalg.svd(scale * loop.joint_screws(theta))[2][-1]
        return t if t @ along >= 0 else -t

    def corrected(theta, t):
        for _ in range(6):
            gap = loop.frames(theta)[-1]
            twist = np.array([gap[2, 1], gap[0, 2], gap[1, 0], *gap[:3, 3]])
            rows = np.vstack([scale * loop.joint_screws(theta), t])
            right = np.append(scale[:, 0] * twist, 0.0)
            change = np.linalg.lstsq(rows, right, rcond=1e-5)[0]
            theta = theta - change
            if np.abs(change).max() < ROUNDING:
                break
        return theta

    points = [np.asarray(start, dtype=float)]
    first = t = tangent(points[0], np.ones(loop.n))
    while len(points) < limit:
        t = tangent(points[-1] + step / 2 * t, t)
        points.append(corrected(points[-1] + step * t, t))
        t = tangent(points[-1], t)
        away = points[-1] - points[0]
        if (
            len(points) > 10
            and t @ first > 0.9
            and np.linalg.norm(np.sin(away / 2)) < step / 2
        ):
            return np.array(points)
    raise AssertionError("the form did not close")


@pytest.fixture(scope="session")
def trace_form():
    """Samples (m, n) along the closed form through a configuration: midpoint steps,
    then Gauss-Newton."""
    cache = {}

    def traced(loop, start):
        key = (loop, tuple(start))
        if key not in cache:
            cache[key] = _traced(loop, start)
        return cache[key]

    return traced


@pytest.fixture(scope="session")
def folded_sarrus() -> Atlas:
    """What there is of the Sarrus loop with folded legs: two forms that meet a torus in
    four points."""
    return explore(sarrus())
