"""Atlases that are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


@pytest.fixture(scope="package")
def parallelogram() -> Atlas:
    """A parallelogram four-bar: x and y turn against each other in one form and
    together in the other, z is constant."""

    def closure(u: np.ndarray) -> np.ndarray:
        x, y, z = u
        turned = np.array(
            [np.cos(x) + 2 * np.cos(x + y), np.sin(x) + 2 * np.sin(x + y)]
        )
        # the far joint lies at distance 1 from (2, 0)
        return np.array(
            [(turned[0] - 2) ** 2 + turned[1] ** 2 - 1, np.sin((z - 0.3) / 2)]
        )

    names = ("theta1", "theta2", "theta3")
    problem = FunctionProblem(
        closure,
        [[-np.inf, np.inf]] * 3,
        names=names,
        units=("rad",) * 3,
        periods=(2 * np.pi,) * 3,
    )
    return explore(problem, settings=SearchSettings(starts=30))


@pytest.fixture(scope="package")
def circle() -> Atlas:
    """A circle and a line through it, in a plane without periods."""
    problem = FunctionProblem(
        lambda u: np.array([(u[0] ** 2 + u[1] ** 2 - 1) * u[1]]),
        [[-2, 2], [-2, 2]],
        names=("x", "y"),
        units=("", "m"),
    )
    return explore(problem, settings=SearchSettings(starts=30))


@pytest.fixture(scope="package")
def nothing() -> Atlas:
    """No solution at all."""
    return explore(
        FunctionProblem(lambda u: np.array([u @ u + 1]), [[-1, 1], [-1, 1]]),
        settings=SearchSettings(starts=5),
    )
