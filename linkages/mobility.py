"""Does a loop move at all: a survey of its configurations, for verification and for
negative controls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Atlas
from bifurc.search.explore import explore
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import Loop

__all__ = ["Survey", "held_gap", "survey"]


@dataclass(frozen=True)
class Survey:
    """What exploring found: motion ``forms``, ``surfaces`` of mobility 2 or more,
    ``rigid`` assemblies.

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
        """0 for a rigid loop or one without real configurations, 1 for motion curves, 2
        for surfaces (2 or more)."""
        return 2 if self.atlas.surfaces else 1 if self.atlas.forms else 0


def survey(loop: Loop, starts: int = 40, seed: int = 0) -> Survey:
    """Explore ``loop`` from complete slices and from ``starts`` random starts."""
    problem = LoopClosure(loop)
    seeds = problem.seeds(np.random.default_rng(seed), starts)
    atlas = explore(problem, seeds=seeds, seed=seed)
    stiffness = float("nan")
    if len(atlas.rigid):
        jacobians = problem.jacobians(np.array(atlas.rigid))
        stiffness = float(
            np.linalg.svd(jacobians, compute_uv=False)[:, problem.n - 1].min()
        )
    gaps = seeds.gaps[seeds.gaps > 1e-10]
    return Survey(
        atlas,
        len(atlas.rigid),
        stiffness,
        float(gaps.min()) if len(gaps) else float("nan"),
    )


def held_gap(loop: Loop, angle: float = 1.0, starts: int = 60, seed: int = 0) -> float:
    """The smallest closure residual with joint 1 held at ``angle`` (rad): zero where a
    motion passes through.

    It tells a loop that closes in isolated flat configurations alone, where starts
    converge slowly, from one that moves. Damped Gauss-Newton from random starts of the
    other joints.
    """
    problem, rng = LoopClosure(loop), np.random.default_rng(seed)
    theta = rng.uniform(-np.pi, np.pi, (starts, loop.n))
    theta[:, 0] = angle
    for _ in range(60):
        residual, jacobian = (
            problem.residuals(theta),
            problem.jacobians(theta)[:, :, 1:],
        )
        damping = 0.1 * np.minimum(1.0, np.sum(residual**2, axis=1)) + 1e-14
        normal = np.einsum("kij,kil->kjl", jacobian, jacobian) + damping[
            :, None, None
        ] * np.eye(loop.n - 1)
        step = np.linalg.solve(
            normal, -np.einsum("kij,ki->kj", jacobian, residual)[..., None]
        )[..., 0]
        theta[:, 1:] += np.clip(step, -1.0, 1.0)
    return float(np.linalg.norm(problem.residuals(theta), axis=1).min())
