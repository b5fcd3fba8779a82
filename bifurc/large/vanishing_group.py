"""The singular values that go to zero together at one place of a curve."""

from __future__ import annotations

import numpy as np

from bifurc.branch import Branch
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.singular_profile import unit_tangent
from bifurc.large.smallest_singular_values import SingularTriple, smallest_triples_by

# Shares of the distance to the next place of a profile: how far beside a zero values are
# taken, so that no matrix is singular, and how near to each other zeros are one for a
# first try. What comes of the try decides.
BESIDE, TOGETHER = 0.05, 0.02
STRAYS = 3  # smaller values that vanish elsewhere, after which none is looked for


def zero_ahead(
    problem: ScaledProblem, branch: Branch, s: float, triple: SingularTriple
) -> float:
    """Where a singular value at arclength ``s`` would be zero by its slope along the
    curve, w^T F''(v, t)."""
    tangent = unit_tangent(branch, s)
    change = problem.second_derivative(branch(s), tangent, triple.right)
    slope = float(triple.left @ change)
    return s - triple.value / slope if slope else np.inf


def vanishing_group(
    problem: ScaledProblem, branch: Branch, zero: float, width: float
) -> list[SingularTriple]:
    """The singular values that vanish about arclength ``zero`` of a curve, as they are a
    little beside it; places are ``width`` apart.

    They come one by one, square to those before, so that each value is there as many
    times as it has vectors.
    """
    beside = zero + BESIDE * width
    if beside > branch.length:
        beside = zero - BESIDE * width
    group: list[SingularTriple] = []
    tangent = unit_tangent(branch, beside)
    strays = 0
    for triple in smallest_triples_by(problem, branch(beside), tangent):
        ahead = zero_ahead(problem, branch, beside, triple)
        if abs(ahead - zero) <= TOGETHER * width:
            group.append(triple)
            continue
        strays += 1
        if group or strays > STRAYS:
            break
    return group
