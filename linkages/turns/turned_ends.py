"""Where limits cut forms off that are listed up to whole turns, and others go on.

A form that ends at a limit may go on within the limits some whole turns away. What is
there is no part of what is listed, not even up to whole turns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch
from bifurc.problem import Problem
from bifurc.seeds import Audit
from linkages.statements import LinkageClaim, estimated
from linkages.turns.turn_lattice import TurnLattice


@dataclass(frozen=True, eq=False)
class TurnedEnds:
    """The ends of forms of a ``problem`` that shifts of the ``lattice`` bring within
    the limits, and what ``judge`` says of the forms, if there is one."""

    problem: Problem
    lattice: TurnLattice
    judge: Callable[[Sequence[Branch], float], Audit] | None

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """What is said of the ``branches`` in about so many ``seconds``, and the ends of
        those that are cut off among the starts."""
        nowhere = np.empty((0, self.problem.n))
        claim = estimated(LinkageClaim.FOLLOWED_FROM_TURNS)
        audit = Audit((claim,), nowhere)
        if self.judge is not None:
            audit = self.judge(branches, seconds)
        starts = [self._turned(branch) for branch in branches if not branch.closed]
        return replace(audit, starts=np.concatenate([audit.starts, *starts]))

    def _turned(self, branch: Branch) -> np.ndarray:
        """The ends (k, n) of a branch, moved to where they are inside the limits; those
        that are at a limit everywhere are left out."""
        ends = branch(np.array([0.0, branch.length]))
        inmost = np.array([self.lattice.inmost(end) for end in ends])
        is_inside = self.problem.excess(inmost) < -self.problem.slack
        turned: np.ndarray = inmost[is_inside]
        return turned
