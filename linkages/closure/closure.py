"""The closure of what moves as a problem for `bifurc`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bifurc.limits import Deadline
from bifurc.seeds import Seeds
from linkages.closure.system import ClosureSystem
from linkages.loop import Loop
from linkages.slices.completeness import sliced_seeds

RING = 7  # joints of a loop that is sliced as a mechanism: with one held it stands


class Closure(ClosureSystem):
    """The closure equations of a subject, and where a search of them begins: a loop at
    complete slices of its joints, a mechanism where the first source begins that applies
    to it. ``as_drawn`` tells of an assembly of a mechanism, which is given by one, whether
    what is singular in it is as it is drawn."""

    as_drawn: Callable[[np.ndarray], bool] | None = None

    @property
    def given_state(self) -> np.ndarray | None:
        """The reference configuration of a mechanism, or of a sheet that is flat there one
        near it in which all its creases fold; a loop is given by its table."""
        if isinstance(self.subject, Loop):
            return None
        ways = self.flat_state.ways
        is_left = bool(ways) and not ways[0].rest.any()
        return ways[0].point if is_left else self.reference

    def is_given_at(self, point: np.ndarray) -> bool:
        """Whether what is singular at a configuration (n,) is as it is drawn."""
        return self.as_drawn is not None and self.as_drawn(point)

    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """Closed configurations to start from, ``count`` random starts among what they
        come of, and what judges the branches that are traced from them."""
        is_loop = isinstance(self.subject, Loop)
        if isinstance(self.subject, Loop) and self.subject.n != RING:
            return sliced_seeds(self.subject, self, rng, count, deadline)
        # it imports networkx, which other loops do not need
        from linkages.closure.mechanism_seeds import mechanism_seeds, ring_seeds

        seeds = ring_seeds if is_loop else mechanism_seeds
        return seeds(self, rng, count, deadline)
