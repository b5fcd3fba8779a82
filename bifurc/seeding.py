"""Starting points, and the estimate of what they missed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import gammaincinv

if TYPE_CHECKING:
    from bifurc.branch import Branch
    from bifurc.problem import Problem

__all__ = [
    "CLOSED",
    "Audit",
    "Completeness",
    "Seeds",
    "missed_probability",
    "random_seeds",
]


CLOSED = 1e-12  # residual below which a start has reached a solution


@dataclass(frozen=True)
class Audit:
    """What a problem can say of a list of branches: ``level`` is "proved" (none is
    missing), "certified" (none that is larger than the ``statement`` says) or
    "estimated". From ``starts`` (k, n) a missing one may be reached."""

    level: str
    statement: str
    starts: np.ndarray


@dataclass(frozen=True)
class Seeds:
    """Solutions to start from.

    ``points`` (k, n) solve the system; ``random`` (k,) says which of them come from
    random starts, the rest were constructed; ``missed`` (g, n) is where the random
    starts ended that found no solution, ``gaps`` (g,) the residuals there. ``audit``,
    where the problem has one, judges the branches that were found, in about as many
    seconds as its second argument says.
    """

    points: np.ndarray
    random: np.ndarray
    gaps: np.ndarray
    missed: np.ndarray
    audit: Callable[[Sequence[Branch], float], Audit] | None = None

    def with_constructed(self, points: np.ndarray) -> Seeds:
        """These seeds and after them further ``points`` (k, n) that solve the
        system."""
        random = np.append(self.random, np.zeros(len(points), dtype=bool))
        return replace(
            self, points=np.concatenate([self.points, points]), random=random
        )


@dataclass(frozen=True)
class Completeness:
    """How sure it is that nothing is missing: ``level`` is "proved", "certified" or
    "estimated" as in `Audit`, or "out of time" or "interrupted"; ``missed_probability``
    bounds the chance that one more random start would find more.
    """

    level: str
    statement: str
    missed_probability: float


def random_seeds(
    problem: Problem, rng: np.random.Generator, count: int, closed_below: float = CLOSED
) -> Seeds:
    """Solutions reached from ``count`` random starts.

    Periodic unknowns are drawn from their period, the others from the bounds (from
    -scale to scale where these are infinite).
    """
    low = np.where(
        np.isfinite(problem.bounds[:, 0]), problem.bounds[:, 0], -problem.scale
    )
    high = np.where(
        np.isfinite(problem.bounds[:, 1]), problem.bounds[:, 1], problem.scale
    )
    periodic = np.isfinite(problem.periods)
    low = np.where(periodic, -0.5 * problem.periods, low)
    high = np.where(periodic, 0.5 * problem.periods, high)
    points, gaps = problem.project(rng.uniform(low, high, (count, problem.n)))
    solved = gaps < closed_below
    solved &= np.all(
        (points >= problem.bounds[:, 0]) & (points <= problem.bounds[:, 1]), axis=1
    )
    return Seeds(
        points[solved],
        np.ones(int(solved.sum()), dtype=bool),
        gaps[~solved],
        points[~solved],
    )


def missed_probability(hits: Sequence[int]) -> float:
    """Upper 95 % limit of the chance that one more random start would reach something
    not yet seen.

    ``hits``: how many starts reached each thing found. Good and Turing (Good 1953)
    estimate the unseen share by n1 / N, with n1 the number of things hit just once
    among N starts; n1 is close to Poisson, and its upper limit (Garwood 1936) is used
    in its place: 3 / N where nothing was hit just once.
    """
    total = int(sum(hits))
    if total == 0:
        return 1.0
    singles = sum(1 for h in hits if h == 1)
    return float(min(1.0, gammaincinv(singles + 1, 0.95) / total))
