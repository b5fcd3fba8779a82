"""Starting points of a search, and what is known of how complete it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch

__all__ = ["Audit", "Completeness", "Seeds"]


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
