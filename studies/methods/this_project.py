"""The method of this project: pieces of high order, through the public interface."""

from __future__ import annotations

import numpy as np

from bifurc import Branch, Problem, TraceSettings, trace_branch
from bifurc.settings import lowest_order
from studies.methods.curve import Curve, MethodFailure


def trace(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    length: float,
    order: int,
    tolerance: float,
) -> Curve:
    """`bifurc.curves.continuation.trace_branch` at one order and tolerance.

    An open curve is followed both ways, from bound to bound: more than the other
    methods are asked for.
    """
    if order < lowest_order(tolerance):
        raise MethodFailure("the steps of this order are too short")
    settings = TraceSettings(
        order=order, tolerance=tolerance, max_length=10 * length / problem.domain.scale
    )
    branch: Branch = trace_branch(problem, start, tangent, settings)
    if branch.length < 0.999 * length:
        raise MethodFailure(branch.outcome.value)
    return Curve(branch, branch.length, len(branch.pieces))
