"""The distance of a traced curve from the closed form, everywhere on it and across the
poles of the tangents."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import roots_along, singular_values
from bifurc.problem import Problem
from linkages.closed_forms.closed_form import ClosedForm

__all__ = ["Comparison", "compare", "pole_samples"]

BESIDE = np.array(
    [0.0, 1e-12, 1e-9, 1e-6, 1e-3]
)  # arclengths around a pole that are looked at


def pole_samples(branch: Branch) -> np.ndarray:
    """Arclengths at which some joint is at 0 or pi, where its half tangent is 0 or
    infinite, and just beside."""
    crossings = np.concatenate(
        [*roots_along(branch, lambda s: np.sin(branch(s))), [0.0]]
    )
    around = crossings[:, None] + np.concatenate([-BESIDE[1:], BESIDE])
    return np.clip(around.ravel(), 0.0, branch.length)


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
    theta_1 = branch(s)[:, 0]
    best = np.full(len(s), np.inf)
    for form in forms:
        for root in form.roots:
            best = np.fmin(
                best, _across(branch, s, form.configurations(theta_1, parameters, root))
            )
    regular = singular_values(problem, branch(s))[:, problem.n - 2] > 1e-3
    return Comparison(float(best.max()), float(best[regular].max(initial=0.0)))


def _across(branch: Branch, s: np.ndarray, configurations: np.ndarray) -> np.ndarray:
    """Distances (k,) of configurations from the curve near arclengths ``s``: the feet
    are found by one step."""
    foot = s
    for _ in range(2):
        points, along = branch(foot), branch(foot, 1)
        along = along / np.linalg.norm(along, axis=1, keepdims=True)
        away = np.remainder(configurations - points + np.pi, 2 * np.pi) - np.pi
        shift = np.nan_to_num(np.sum(away * along, axis=1))
        foot = foot + np.clip(shift, -1e-3, 1e-3)
        foot = (
            np.remainder(foot, branch.length)
            if branch.closed
            else np.clip(foot, 0.0, branch.length)
        )
    across = np.linalg.norm(away - shift[:, None] * along, axis=1)
    return np.where(np.abs(shift) < 1e-6, across, np.inf)
