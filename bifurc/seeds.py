"""Starting points of a search, and what a problem says of what comes of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch
from bifurc.completeness import Claim, Level, worst_level
from bifurc.limits import Deadline


@dataclass(frozen=True, eq=False)
class Audit:
    """What a problem can say of a list of branches: its ``claims``, and ``starts``
    (k, n) from which a missing branch may be reached.

    ``has_all_isolated``: whether every solution of the problem is isolated, and among
    the starts of the search.
    """

    claims: tuple[Claim, ...]
    starts: np.ndarray
    has_all_isolated: bool = False

    @property
    def level(self) -> Level:
        """That of the worst claim."""
        return worst_level(self.claims) or Level.ESTIMATED


@dataclass(frozen=True, eq=False)
class Seeds:
    """Solutions to start from.

    ``points`` (k, n) solve the system; ``random`` (k,) says which of them come from
    random starts, the rest were constructed. ``missed`` (g, n) is where the random
    starts ended that reached no solution, ``gaps`` (g,) the residuals there. ``audit``,
    where the problem has one, judges the branches of a search, in about as many seconds
    as its second argument says. ``home``, where shifts of the unknowns lead from curves
    to others that are the same but for them, is the shift (n,) that brings samples
    (k, n) of a curve to the one among them that is to be traced. ``more``, where random
    starts are all there is, gives what so many further ones reach before a deadline.
    ``isolated`` (i, n) are those of which the problem knows that nothing leads on.
    """

    points: np.ndarray
    random: np.ndarray
    gaps: np.ndarray
    missed: np.ndarray
    audit: Callable[[Sequence[Branch], float], Audit] | None = None
    home: Callable[[np.ndarray], np.ndarray] | None = None
    more: Callable[[np.random.Generator, int, Deadline], Seeds] | None = None
    isolated: np.ndarray | None = None

    def know_isolated(self, point: np.ndarray) -> bool:
        """Whether a point (n,) of these is known to be isolated."""
        return self.isolated is not None and bool((self.isolated == point).all(1).any())

    def and_random(self, others: Seeds) -> Seeds:
        """These seeds and ``others``, all of random starts."""
        return replace(
            self,
            points=np.concatenate([self.points, others.points]),
            random=np.concatenate([self.random, others.random]),
            gaps=np.concatenate([self.gaps, others.gaps]),
            missed=np.concatenate([self.missed, others.missed]),
        )

    def with_constructed(self, points: np.ndarray) -> Seeds:
        """These seeds and after them further ``points`` (k, n) that solve the
        system."""
        constructed = np.zeros(len(points), dtype=bool)
        return replace(
            self,
            points=np.concatenate([self.points, points]),
            random=np.concatenate([self.random, constructed]),
        )
