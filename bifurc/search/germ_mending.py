"""Branches that were lost where they touch to a high order, found again by germs."""

from __future__ import annotations

import logging
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.misclosure import largest_misclosure
from bifurc.decisions import (
    is_lost_in_rounding,
    is_precise_enough,
    is_same_point,
    is_solution,
)
from bifurc.numerics.singular_values import singular_values
from bifurc.search.branch_examination import BranchExaminer
from bifurc.search.findings import TracedBranch
from bifurc.search.germ_branches import branches_of_germs, ends_of, passes_inside
from bifurc.search.run import Run
from bifurc.search.start import Start
from bifurc.singular.germ import Germ
from bifurc.singular.local_branches import LocalBranch

log = logging.getLogger(__name__)

PLACES = (np.arange(8) + 0.5) / 8  # of every piece, at which branches are compared
SAME_LENGTH = 0.02  # of a stretch: by which two ways to measure it differ
LENGTH_LOOKS = 200  # on a local branch, for its length
# Shares of the way to the end of half a local branch, at which a branch is held against
# it; where it ends at the point it may stall before.
SHARES = np.geomspace(2e-3, 1.0, 24)
BEFORE_CUSP = 0.1


class _Pass(NamedTuple):
    """Branch number ``branch`` passes a place at an arclength ``s``."""

    branch: int
    s: float


class GermMender:
    """Holds the branches of a ``run`` against the germs that it knows, and traces them
    again where they do not follow these."""

    def __init__(self, run: Run, examiner: BranchExaminer):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings
        self.examiner = examiner

    def mend(self) -> list[Start]:
        """Put branches traced outward from the germs in the place of those that pass
        them, where these do not all follow the germs; the starts on branches through
        singular points that this leads to."""
        germs = [germ for germ in self.findings.germs if germ.radius]
        if all(self._is_followed(germ) for germ in germs):
            return []
        settings = self.run.settings.tracing
        branches = branches_of_germs(
            self.problem, germs, settings, is_solution.threshold
        )
        if branches is None:
            log.info("no branches outward from germs at %s", [g.u for g in germs])
            return []
        superseded = self._superseded(germs, branches)
        if superseded is None:
            log.info("branches outward from germs leave out some that were traced")
            return []
        starts: list[Start] = []
        traced: list[TracedBranch] = []
        for branch in branches:
            misclosure = largest_misclosure(self.problem, branch)
            examined = self.examiner.examine(branch, misclosure)
            traced.append(examined.traced)
            starts += examined.starts
        self.findings.supersede_branches(superseded, traced)
        return starts

    # --- what follows a germ ----------------------------------------------------------

    def _is_followed(self, germ: Germ) -> bool:
        """Whether one branch passes each end of the half-branches of a germ, and goes on
        from there as the germ does."""
        passing = [self._passes(end) for end in ends_of(germ)]
        if not passing:
            branches = self.findings.branches
            return not any(len(passes_inside(branch, germ)) for branch in branches)
        if any(len(passes) != 1 for passes in passing):
            return False
        passed = {passes[0].branch for passes in passing}
        if any(self.findings.traced[number].is_refused for number in passed):
            return False
        return all(
            self._follows(germ, branch, *(passing[half][0] for half in branch.halves))
            for branch in germ.neighbourhood.branches
        )

    def _passes(self, place: np.ndarray) -> list[_Pass]:
        """The passes of all branches at a place (n,)."""
        within = is_same_point.threshold * self.problem.scale
        return [
            _Pass(number, float(s))
            for number, branch in enumerate(self.findings.branches)
            for s in branch.passes(place, within)
        ]

    def _follows(
        self, germ: Germ, local: LocalBranch, one: _Pass, other: _Pass
    ) -> bool:
        """Whether the branches that pass the ends of a local branch of a germ go along
        it."""
        if not self._runs_along(germ, local, 1.0, one):
            return False
        if not self._runs_along(germ, local, -1.0, other):
            return False
        lengths = [_length(local, side) for side in (1.0, -1.0)]
        if local.returns:
            passes = zip((one, other), lengths, strict=True)
            return all(self._ends_after(each, length) for each, length in passes)
        if one.branch != other.branch:
            return False
        branch = self.findings.branches[one.branch]
        way = abs(one.s - other.s)
        if branch.closed:
            way = min(way, branch.length - way)
        return abs(way - sum(lengths)) < SAME_LENGTH * sum(lengths)

    def _runs_along(
        self, germ: Germ, local: LocalBranch, side: float, at: _Pass
    ) -> bool:
        """Whether a branch is, to the digits that doubles know elsewhere, half a local
        branch, after the pass at its end.

        F is so flat beside the point that rounding leaves more open.
        """
        shares = SHARES[SHARES > BEFORE_CUSP] if local.returns else SHARES
        places = germ.u + local(side * shares)
        distances, _ = self.findings.branches[at.branch].nearest(places)
        return bool(np.all(is_precise_enough(distances, self.problem.scale)))

    def _ends_after(self, at: _Pass, length: float) -> bool:
        """Whether a branch ends after a pass and about so long a way."""
        branch = self.findings.branches[at.branch]
        if branch.outcome is not Outcome.STALLED:
            return False
        way = min(at.s, branch.length - at.s)
        return abs(way - length) < SAME_LENGTH * length

    # --- what is put in whose place ---------------------------------------------------

    def _superseded(
        self, germs: list[Germ], branches: list[Branch]
    ) -> list[int] | None:
        """The numbers of the known branches that are, where doubles tell, parts of the
        new ``branches``; None where one of them is in part only."""
        superseded = []
        for number, known in enumerate(self.findings.branches):
            if not any(len(passes_inside(known, germ)) for germ in germs):
                continue
            shares = self._shares_on(known, branches)
            if np.all(shares):
                superseded.append(number)
            elif np.any(shares):
                return None
        return superseded

    def _shares_on(self, known: Branch, branches: list[Branch]) -> np.ndarray:
        """Of the places (k,) of a known branch where doubles do not lose it, which are
        on one of the new ``branches``."""
        places = known(known.places(PLACES).ravel())
        values = singular_values(self.problem, places)
        places = places[~is_lost_in_rounding(values[:, self.problem.n - 2])]
        on_any = np.zeros(len(places), dtype=bool)
        for branch in branches:
            distances, _ = branch.nearest(places)
            on_any |= is_same_point(distances, self.problem.scale)
        return on_any


def _length(local: LocalBranch, side: float) -> float:
    """The length of one half of a local branch."""
    points = local(side * np.linspace(0.0, 1.0, LENGTH_LOOKS))
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
