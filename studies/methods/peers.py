"""Continuation packages that are installed: pycont-lite from the package index."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np

from bifurc import Problem
from studies.methods.curve import Curve, MethodFailure, through_points
from studies.methods.linear import mixtures
from studies.methods.point_by_point import turn_per_step


def has_pycont() -> bool:
    """Whether pycont-lite can be imported."""
    return find_spec("pycont") is not None


def pycont_lite(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    length: float,
    tolerance: float,
) -> Curve:
    """pycont-lite: matrix-free pseudo-arclength continuation with a Newton-Krylov
    corrector, and a cubic spline.

    It takes square systems G(u, p) = 0 alone. Redundant equations are mixed into n - 1
    by a fixed random orthogonal matrix, which keeps the curve wherever the rank is n -
    1. Detection and stability are switched off.
    """
    import pycont

    rows = len(problem.residuals(start[None])[0])
    square = rows == problem.n - 1
    mix = mixtures(rows, problem.n - 1)

    def system(u: np.ndarray, p: float) -> np.ndarray:
        value = problem.residuals(np.append(u, p)[None])[0]
        return np.asarray(value if square else mix @ value)

    h = 0.5 * turn_per_step(tolerance)
    direction = "increase_p" if tangent[-1] > 0 else "decrease_p"
    options = {
        "tolerance": max(0.1 * tolerance, 1e-12),
        "analyze_stability": False,
        "bifurcation_detection": False,
        "initial_directions": direction,
        "hopf_detection": False,
    }
    try:
        result = pycont.arclengthContinuation(
            system,
            start[:-1].copy(),
            float(start[-1]),
            1e-3 * h,
            h,
            h,
            int(1.1 * length / h) + 6,
            options,
            "OFF",
        )
    except RecursionError as error:  # it tries a step again by calling itself
        raise MethodFailure("it recurses without end") from error
    if not result.branches:
        raise MethodFailure("it returns no branch")
    branch = result.branches[0]
    points = np.column_stack([branch.u_path, branch.p_path])
    if len(points) < 4:
        raise MethodFailure("it stops at once")
    return through_points(list(points), length)


def count_branch_points(
    problem: Problem, start: np.ndarray, length: float, step: float, increasing: bool
) -> int:
    """How many bifurcation points pycont-lite reports on the curve through ``start``,
    followed one way for ``length``.

    With its own detection, at equal steps; one that it reports again on another branch
    counts once. Redundant equations are mixed as in `pycont_lite`.
    """
    import pycont

    rows = len(problem.residuals(start[None])[0])
    mix = mixtures(rows, problem.n - 1)

    def system(u: np.ndarray, p: float) -> np.ndarray:
        value = problem.residuals(np.append(u, p)[None])[0]
        return np.asarray(value if rows == problem.n - 1 else mix @ value)

    options = {
        "tolerance": 1e-10,
        "analyze_stability": False,
        "hopf_detection": False,
        "initial_directions": "increase_p" if increasing else "decrease_p",
    }
    result = pycont.arclengthContinuation(
        system,
        start[:-1].copy(),
        float(start[-1]),
        1e-3 * step,
        step,
        step,
        int(length / step),
        options,
        "OFF",
    )
    distinct: list[np.ndarray] = []
    for event in result.events:
        point = np.append(event.u, event.p)
        if event.kind == "BP" and all(
            np.linalg.norm(point - other) > step for other in distinct
        ):
            distinct.append(point)
    return len(distinct)
