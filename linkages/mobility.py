"""Does a loop move at all: a survey of its configurations, for verification and for
negative controls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Atlas
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.closure.closure import Closure
from linkages.loop import Loop

STEPS = 60  # of damped Gauss-Newton
LONGEST_STEP = 1.0  # rad, of one joint
# damping, over the squared residual, while that is large, and at the end
DAMPING = 0.1
LEAST_DAMPING = 1e-14


@dataclass(frozen=True)
class Survey:
    """What exploring found: an ``atlas`` of motion forms and of surfaces of mobility 2
    or more, and the number of ``rigid`` assemblies.

    ``stiffness`` is the smallest singular value number n at the rigid assemblies,
    ``gap`` the smallest closure residual at which a start got stuck, relative to the
    characteristic length; nan where there is none.
    """

    atlas: Atlas
    rigid: int
    stiffness: float
    gap: float

    @property
    def mobility(self) -> int:
        """The largest dimension of a component; 0 for a rigid loop and for one without
        real configurations."""
        return self.atlas.mobility


def survey(loop: Loop, starts: int = 40, seed: int = 0) -> Survey:
    """What exploring ``loop`` from complete slices and from ``starts`` random starts
    finds."""
    problem = Closure(loop)
    seeds = problem.seeds(np.random.default_rng(seed), starts)
    # neither whether a motion is missing is asked, nor what nearly moves
    settings = SearchSettings(count=False, near_motions=False)
    atlas = explore(problem, settings=settings, seeds=seeds, seed=seed)
    gaps = seeds.gaps  # those of the starts that did not close
    return Survey(
        atlas=atlas,
        rigid=len(atlas.rigid),
        stiffness=_stiffness(problem, atlas.rigid),
        gap=float(gaps.min()) if len(gaps) else float("nan"),
    )


def _stiffness(problem: Closure, assemblies: np.ndarray) -> float:
    """The smallest singular value number n at configurations (k, n), nan for none."""
    if not len(assemblies):
        return float("nan")
    jacobians = problem.jacobians(np.array(assemblies))
    singular_values = np.linalg.svd(jacobians, compute_uv=False)
    return float(singular_values[:, problem.n - 1].min())


def held_gap(loop: Loop, angle: float = 1.0, starts: int = 60, seed: int = 0) -> float:
    """The smallest closure residual with joint 1 held at ``angle`` (rad): zero where a
    motion passes through.

    It tells a loop that closes in isolated flat configurations alone, where starts
    converge slowly, from one that moves. Damped Gauss-Newton from random starts of the
    other joints.
    """
    problem = Closure(loop)
    rng = np.random.default_rng(seed)
    theta = rng.uniform(-np.pi, np.pi, (starts, loop.n))
    theta[:, 0] = angle
    for _ in range(STEPS):
        step = _damped_step(problem, theta)
        theta[:, 1:] += np.clip(step, -LONGEST_STEP, LONGEST_STEP)
    residuals = problem.residuals(theta)
    return float(np.linalg.norm(residuals, axis=1).min())


def _damped_step(problem: Closure, theta: np.ndarray) -> np.ndarray:
    """Steps (k, n - 1) of Gauss-Newton from configurations (k, n), joint 1 held."""
    residual = problem.residuals(theta)
    jacobian = problem.jacobians(theta)[:, :, 1:]
    size = np.sum(residual**2, axis=1)
    damping = DAMPING * np.minimum(1.0, size) + LEAST_DAMPING
    identity = np.eye(problem.n - 1)
    square = np.einsum("kij,kil->kjl", jacobian, jacobian)
    normal = square + damping[:, None, None] * identity
    descent = -np.einsum("kij,ki->kj", jacobian, residual)
    return np.linalg.solve(normal, descent[..., None])[..., 0]
