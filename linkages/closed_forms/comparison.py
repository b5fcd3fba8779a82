"""The distance of a traced curve from the closed form, everywhere on it and across the
poles of the tangents."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import roots_along
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from linkages.closed_forms.closed_form import ClosedForm

# arclengths around a pole that are looked at
BESIDE = np.array([0.0, 1e-12, 1e-9, 1e-6, 1e-3])
REGULAR = 1e-3  # singular values above which rounding leaves eleven digits
LONGEST_STEP = 1e-3  # arclength that a foot may move in one step
FOOT = 1e-6  # arclength within which the foot counts as reached


def pole_samples(branch: Branch) -> np.ndarray:
    """Arclengths at which some joint is at 0 or pi, where its half tangent is 0 or
    infinite, and just beside."""
    roots = roots_along(branch, lambda s: np.sin(branch(s)))
    crossings = np.concatenate([*roots, [0.0]])
    shifts = np.concatenate([-BESIDE[1:], BESIDE])
    around = crossings[:, None] + shifts
    samples: np.ndarray = np.clip(around.ravel(), 0.0, branch.length)
    return samples


@dataclass(frozen=True)
class Comparison:
    """Largest distance (rad) of a traced curve from the closed form: ``everywhere``,
    and where the curve is certain.

    Rounding of 1e-14 in the closure moves a traced curve by that over the smallest
    regular singular value. It is ``certain`` where that is below 1e-11: at singular
    values above 1e-3.
    """

    everywhere: float
    certain: float


def compare(
    forms: Sequence[ClosedForm],
    parameters: Mapping[str, float],
    problem: Problem,
    branch: Branch,
    count: int = 1000,
) -> Comparison:
    """The distance of the curve from the nearest of the closed forms.

    The closed form is evaluated at the input angle of each of ``count`` samples, and of
    those at the poles. Where the input has a dead point its angle tells the place along
    the curve to half the digits only; the distance is therefore taken from the foot on
    the curve.
    """
    s = np.concatenate([branch.arclengths(count), pole_samples(branch)])
    theta = branch(s)
    best = np.full(len(s), np.inf)
    for form in forms:
        for root in form.roots:
            configurations = form.configurations(theta[:, 0], parameters, root)
            best = np.fmin(best, _distances(branch, s, configurations))
    smallest = singular_values(problem, theta)[:, problem.n - 2]
    certain = best[smallest > REGULAR]
    return Comparison(float(best.max()), float(certain.max(initial=0.0)))


def _distances(branch: Branch, s: np.ndarray, configurations: np.ndarray) -> np.ndarray:
    """Distances (k,) of configurations from the curve near arclengths ``s``; infinite
    where two steps do not reach the foot."""
    foot = s
    for _ in range(2):
        points = branch(foot)
        direction = branch(foot, 1)
        direction = direction / np.linalg.norm(direction, axis=1, keepdims=True)
        gap = np.remainder(configurations - points + np.pi, 2 * np.pi) - np.pi
        shift = np.nan_to_num(np.sum(gap * direction, axis=1))
        step = np.clip(shift, -LONGEST_STEP, LONGEST_STEP)
        foot = _on_branch(branch, foot + step)
    across = np.linalg.norm(gap - shift[:, None] * direction, axis=1)
    return np.where(np.abs(shift) < FOOT, across, np.inf)


def _on_branch(branch: Branch, s: np.ndarray) -> np.ndarray:
    """Arclengths (k,) brought onto the branch: round a closed one, to the ends of an
    open one."""
    if branch.closed:
        return np.asarray(np.remainder(s, branch.length))
    return np.asarray(np.clip(s, 0.0, branch.length))
