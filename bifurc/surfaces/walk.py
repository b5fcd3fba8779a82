"""Which solutions beside the charts of a surface are joined to them: each walks over
the surface to a chart."""

from __future__ import annotations

import numpy as np

from bifurc.limits import Deadline
from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import null_spaces, tangent_planes
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas

__all__ = ["reached_charts"]

WALKS, STEPS = 6, 100
LONGEST, SHORTEST = 0.5, 1e-3  # of a step, over the radius of a chart
CHUNK = 256  # walkers between two looks at the clock


def reached_charts(
    problem: Problem, charts: ChartAtlas, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Numbers (k,) of the charts that regular solutions (k, n) come to on the surface;
    -1 where no walk arrives.

    The first walk goes towards the nearest chart, the others each towards one drawn at
    random. That none arrives is no proof that there is no way: a walk ends before an
    obstacle.
    """
    out, rng = np.full(len(points), -1), np.random.default_rng(0)
    for attempt in range(WALKS):
        left = np.flatnonzero(out < 0)
        goals = rng.integers(len(charts), size=len(left)) if attempt else None
        for begin in range(0, len(left), CHUNK):
            if not deadline.passed:
                part = slice(begin, begin + CHUNK)
                out[left[part]] = _walk(
                    problem,
                    charts,
                    points[left[part]],
                    None if goals is None else goals[part],
                )
    return out


def _walk(
    problem: Problem, charts: ChartAtlas, points: np.ndarray, goals: np.ndarray | None
) -> np.ndarray:
    """Where walks towards the charts numbered ``goals`` (k,), or to the nearest,
    arrive; -1 where they do not."""
    out = np.full(len(points), -1)
    at, planes = (
        points.copy(),
        np.swapaxes(null_spaces(problem, points)[1][:, -2:], 1, 2),
    )
    length = np.full(len(points), LONGEST * charts.radii.max())
    walking = np.arange(len(points))
    for _ in range(STEPS):
        out[walking] = charts.chart_at(at[walking])
        walking = walking[
            (out[walking] < 0) & (length[walking] > SHORTEST * charts.radii.max())
        ]
        if not len(walking):
            break
        here, plane = at[walking], planes[walking]
        nearest = charts.nearest(here)
        goal = nearest if goals is None else goals[walking]
        step = np.einsum(
            "kij,klj,kl->ki", plane, plane, charts.apart(charts.centers[goal], here)
        )
        size = np.linalg.norm(step, axis=1)
        longest = np.minimum(
            length[walking], LONGEST * charts.radii[nearest]
        )  # small where singular points are near
        step *= np.minimum(1.0, longest / (size + 1e-300))[:, None]
        found, gaps = correct_normal(problem, here + step, plane)
        turned = tangent_planes(problem, found, plane)
        flat = (
            np.linalg.svd(np.swapaxes(plane, 1, 2) @ turned, compute_uv=False)[:, -1]
            > 0.8
        )
        near = np.linalg.norm(found - here - step, axis=1) < 0.3 * np.linalg.norm(
            step, axis=1
        )
        low, high = problem.bounds.T
        good = (
            flat
            & near
            & (gaps < 1e-10)
            & np.all((found >= low) & (found <= high), axis=1)
        )
        at[walking[good]], planes[walking[good]] = found[good], turned[good]
        length[walking] = np.where(
            good,
            np.minimum(1.3 * length[walking], LONGEST * charts.radii.max()),
            0.5 * longest,
        )
        length[walking[size < 0.3 * charts.radii[goal]]] = (
            0.0  # above or below the goal, on another sheet
        )
    return out
