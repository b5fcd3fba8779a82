"""Motions that are a whole turn of a joint apart, of which something advances: a helical
joint, or a slide that follows.

After a whole turn more it has advanced, and what closes the loop then is another form,
or none. Random starts reach such forms one by one; beside a known one
the others are found by turning each joint. Isolated assemblies have none beside them
that is known: they are looked for from starts at every turn.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_start_solved
from bifurc.problem import Problem
from bifurc.seeding import start_region
from bifurc.seeds import Audit
from bifurc.torus import common_period
from linkages.statements import LinkageClaim, estimated, random_assemblies
from linkages.structure.structure import Structure
from linkages.turns.turn_lattice import TurnLattice, turn_lattice, turning_rates

MOST_FORMS = 120  # beyond, forms beside them are not looked for
AT_A_TURN, MOST_STARTS = 50, 2000  # random starts, and those of all turns of a joint
PLACES = np.array([0.05, 0.35, 0.65, 0.95])  # on a form, of its length


def turns_that_advance(structure: Structure) -> dict[int, float]:
    """The unknowns, by number, whose turning advances something, and after what angle
    (rad) all that turns with one is back."""
    variables = structure.mechanism.variables
    shares = [structure.share(number) for number in range(len(variables))]
    advancing = {
        share.column
        for share, variable in zip(shares, variables, strict=True)
        if share and (variable.motion.advance or not variable.motion.is_turn)
    }
    rates = turning_rates(structure)
    angles = [one for one in sorted(advancing) if structure.unknowns[one].is_angle]
    periods = {number: common_period(rates[number]) for number in angles}
    return {n: period for n, period in periods.items() if np.isfinite(period)}


def starts_at_every_turn(
    problem: Problem, turns: dict[int, float], rng: np.random.Generator
) -> np.ndarray:
    """Random points (k, n), as many at each of the ``turns`` that a joint which advances
    may make within its limits, as `turns_that_advance` has them."""
    low, high = start_region(problem).T
    starts = [np.empty((0, problem.n))]
    for number, period in turns.items():
        count = math.ceil((high[number] - low[number]) / period)
        most = min(AT_A_TURN * count, MOST_STARTS)
        starts.append(rng.uniform(low, high, (most, problem.n)))
    return np.concatenate(starts)


def for_subject(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> WholeTurns | None:
    """Whole turns beside the motions of a mechanism; None where none advances
    anything."""
    turns = turns_that_advance(structure)
    if not turns:
        return None
    lattice = turn_lattice(structure)
    starts = np.empty((0, problem.n))
    if not lattice:
        starts = starts_at_every_turn(problem, turns, rng)
    return WholeTurns(problem, turns, lattice, starts)


@dataclass(frozen=True, eq=False)
class WholeTurns:
    """The forms of a ``problem`` with ``turns`` that advance, as `turns_that_advance`
    has them; those that shifts of the ``lattice`` lead to are one. ``starts`` (k, n)
    are at every turn."""

    problem: Problem
    turns: dict[int, float]
    lattice: TurnLattice
    starts: np.ndarray

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """Configurations a whole turn of a joint beside ``branches``, as starts; or, of
        many branches, that there may be more."""
        nowhere = np.empty((0, self.problem.n))
        if len(branches) > MOST_FORMS or seconds <= 0.0:
            claim = estimated(LinkageClaim.MORE_TURNS, forms=len(branches))
            return Audit((claim,), nowhere)
        claims = (estimated(LinkageClaim.TURNS_TRIED), random_assemblies())
        starts = [self._beside(branch) for branch in branches]
        return Audit(claims, np.concatenate([nowhere, *starts]))

    def _beside(self, branch: Branch) -> np.ndarray:
        """Closed configurations (k, n) within the limits, a whole turn beside a
        branch."""
        places = branch(PLACES * branch.length)
        turned = []
        for number, period in self.turns.items():
            for turn in (period, -period):
                beside = places.copy()
                beside[:, number] += turn
                turned.append(beside)
        points, gaps = self.problem.project(np.concatenate(turned))
        # what is outside the limits may have a translate inside
        solutions = self.lattice.homes(points[is_start_solved(gaps)])
        inside: np.ndarray = solutions[self.problem.domain.are_inside(solutions)]
        return inside


@dataclass(frozen=True, eq=False)
class TurnedEnds:
    """The ends of forms of a ``problem`` that shifts of the ``lattice`` bring within
    the limits, and what ``judge`` says of the forms, if there is one.

    A form that ends at a limit may go on within the limits some whole turns away. What
    is there is no part of what is listed, not even up to whole turns.
    """

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
        is_inside = self.problem.domain.excess(inmost) < -self.problem.domain.slack
        return inmost[is_inside]
