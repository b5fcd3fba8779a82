"""All motions of a loop within the limits of its joints: those without them, cut there.

What moves within limits moves without them as well. So where all motions of a loop
without limits are known, all those within are known: the stretches of these motions
between the places at which a joint is at a limit. A joint with limits is no longer back
after a whole turn, so that a stretch stands for one at every combination of whole turns
that the limits leave room for.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.completeness import Claim, Completeness, Level, Scope
from bifurc.decisions import is_same_point
from bifurc.problem import Problem
from bifurc.seeds import Audit
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from linkages.closure.system import ClosureSystem
from linkages.slices.completeness import sliced_seeds
from linkages.slices.elimination import LONGEST
from linkages.statements import LinkageClaim, estimated
from linkages.structure.single_loop import SingleLoop, as_single_loop
from linkages.structure.structure import Structure
from linkages.turns.turn_classes import passes_but_for_turns
from linkages.turns.turn_lattice import TurnLattice, turn_lattice

if TYPE_CHECKING:
    from bifurc.atlas import Atlas

TURN = 2 * math.pi
HALVINGS = 60  # of a stretch in which a joint passes a limit
MOST_STRETCHES = 2000  # that are begun from
LARGEST_SEED = 2**32
QUICK = 10.0  # s for the loop without limits where nothing is to be proved


class Stretches(NamedTuple):
    """Configurations ``points`` (k, n) on the stretches of motions that lie within the
    limits, one on each, in the unknowns of a structure; how long (k,) the stretches
    are, and whether these ``are_all``."""

    points: np.ndarray
    lengths: np.ndarray
    are_all: bool


def for_subject(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> CutMotions | None:
    """The motions of a mechanism with limits that is a loop without them, to be mapped
    from ``count`` random starts; None for any other."""
    single = loop_without_limits(structure)
    if single is None:
        return None
    seed = int(rng.integers(LARGEST_SEED))
    nowhere = np.empty((0, problem.n))
    lattice = turn_lattice(structure)
    return CutMotions(structure, single, lattice, count, seed, nowhere)


def loop_without_limits(structure: Structure) -> SingleLoop | None:
    """The mechanism without its limits as a loop of revolute joints that slices are
    complete for; None where it is none, or has no limits."""
    mechanism = structure.mechanism
    if all(one.limits is None for one in mechanism.variables):
        return None
    joints = tuple(replace(joint, limits=()) for joint in mechanism.joints)
    single = as_single_loop(Structure(replace(mechanism, joints=joints)))
    if single is None or single.loop.n > LONGEST:
        return None
    return single


@dataclass(eq=False)
class CutMotions:
    """The motions of a loop without limits, ``single``, mapped from so many random
    starts, ``count``, of a ``seed`` and cut at the limits of a ``structure``, to be held
    against those found within them, which are listed up to whole turns of the
    ``lattice``."""

    structure: Structure
    single: SingleLoop
    lattice: TurnLattice
    count: int
    seed: int
    starts: np.ndarray
    _map: tuple[Atlas, Audit | None] | None = field(default=None, init=False)

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """How sure it is that ``branches`` are all motions, and starts on those that
        are not among them; the loop is mapped for about ``seconds``, and nothing is
        proved of it where these are 0."""
        if self._map is None:
            self._map = self._mapped(seconds)
        atlas, audit = self._map
        stretches = self._stretches(atlas)
        is_missed = ~_lie_on(stretches.points, branches, self.lattice)
        starts = np.concatenate([stretches.points[is_missed], self._others(atlas)])
        level, inner = Level.ESTIMATED, _claims_of(atlas.completeness)
        is_known = atlas.completeness.level in (Level.COUNTED, Level.CERTIFIED)
        if is_known and audit is not None and stretches.are_all:
            level, inner = Level.CERTIFIED, audit.claims
        first = replace(inner[0], words=f"without limits, {inner[0].words}")
        cut = LinkageClaim.CUT_AT_LIMITS.claim(Scope.MOTIONS, level)
        claims = (cut, first, *inner[1:])
        if np.any(is_missed):
            count = int(np.count_nonzero(is_missed))
            longest = float(stretches.lengths[is_missed].max())
            kind = LinkageClaim.PARTS_NOT_LISTED
            claims = (estimated(kind, count=count, longest=longest), *claims)
        return Audit(claims, starts)

    def _mapped(self, seconds: float) -> tuple[Atlas, Audit | None]:
        """The map of the loop without limits, and what slices say of it."""
        from bifurc.search.explore import explore

        settings = SearchSettings(
            starts=self.count,
            budget=seconds or QUICK,
            count=seconds > 0.0,
            near_motions=False,
        )
        loop, rng = self.single.loop, np.random.default_rng(self.seed)
        problem = ClosureSystem(loop)
        seeds = sliced_seeds(loop, problem, rng, self.count)
        judge = seeds.audit
        audits: list[Audit] = []

        def audit(branches: Sequence[Branch], seconds: float) -> Audit:
            assert judge is not None
            audits.append(judge(branches, seconds))
            return audits[-1]

        judged = replace(seeds, audit=audit)
        atlas = explore(problem, settings=settings, seed=self.seed, seeds=judged)
        return atlas, audits[-1] if audits else None

    def _stretches(self, atlas: Atlas) -> Stretches:
        """The stretches of all forms within the limits."""
        branches = [form.branch for form in atlas.forms]
        parts = [cut_motions(self.structure, self.single, one) for one in branches]
        nowhere = np.empty((0, len(self.structure.unknowns)))
        return Stretches(
            np.concatenate([nowhere, *(part.points for part in parts)]),
            np.concatenate([np.empty(0), *(part.lengths for part in parts)]),
            all(part.are_all for part in parts),
        )

    def _others(self, atlas: Atlas) -> np.ndarray:
        """Configurations (k, n) within the limits that lie on no form: assemblies, and
        points of surfaces."""
        points = [*atlas.rigid]
        points += [one.point.u for one in atlas.points if one.kind is Kind.ISOLATED]
        for surface in atlas.surfaces:
            points += [*surface.samples]
        angles = np.array(points).reshape(-1, self.single.loop.n)
        unknowns = self.single.to_unknowns(self.structure).points(angles)
        limits = _limits(self.structure)
        lifted = [one for row in unknowns for one in _lifts(row, limits)]
        return np.array(lifted).reshape(-1, unknowns.shape[1])


def _claims_of(completeness: Completeness) -> tuple[Claim, ...]:
    """All that is said of a map, as claims: its doubts are one of them, and that it
    ended early leaves open what is missing."""
    claims = tuple(
        replace(claim, level=Level.ESTIMATED) if claim.scope is Scope.SEARCH else claim
        for claim in completeness.claims
    )
    if not completeness.doubts:
        return claims
    doubts = "; ".join(doubt.text for doubt in completeness.doubts)
    return (estimated(LinkageClaim.DOUBT_WITHOUT_LIMITS, doubts=doubts), *claims)


def cut_motions(structure: Structure, single: SingleLoop, branch: Branch) -> Stretches:
    """The stretches of a motion of a loop, a ``branch`` in its joint angles, within the
    limits of a structure, between the places at which a joint is at a limit or turns
    back."""
    limits = _limits(structure)
    isometry = single.to_unknowns(structure)

    def unknowns(places: np.ndarray) -> np.ndarray:
        return isometry.points(branch(places))

    cuts = [np.array([0.0, branch.length])]
    for column, ends in limits.items():
        turning = branch.turning_points(int(isometry.columns[column]))
        edges = np.unique(np.concatenate([cuts[0], turning]))

        def unknown(places: np.ndarray, column: int = column) -> np.ndarray:
            return unknowns(places)[:, column]

        cuts += [edges, _passes(unknown, edges, ends)]
    places = np.unique(np.concatenate(cuts))
    middles = 0.5 * (places[1:] + places[:-1])
    points: list[np.ndarray] = []
    lengths: list[float] = []
    for row, length in zip(unknowns(middles), np.diff(places), strict=True):
        for lifted in _lifts(row, limits):
            points.append(lifted)
            lengths.append(float(length))
            if len(points) == MOST_STRETCHES:
                return Stretches(np.array(points), np.array(lengths), are_all=False)
    found = np.array(points).reshape(-1, len(structure.unknowns))
    return Stretches(found, np.array(lengths), are_all=True)


def _limits(structure: Structure) -> dict[int, tuple[float, float]]:
    """The limits of the unknowns that have some, rad, by number."""
    return {
        column: (unknown.low, unknown.high)
        for column, unknown in enumerate(structure.unknowns)
        if np.isfinite(unknown.high)
    }


def _passes(
    unknown: Callable[[np.ndarray], np.ndarray],
    edges: np.ndarray,
    limits: tuple[float, float],
) -> np.ndarray:
    """The arclengths (k,) at which an ``unknown`` of a motion, between whose ``edges``
    (j,) it does not turn back, is at one of its limits but for whole turns."""
    values = unknown(edges)
    begins, targets = [], []
    for k, (begin, end) in enumerate(pairwise(values)):
        low, high = sorted((begin, end))
        for limit in limits:
            first = math.ceil((low - limit) / TURN)
            last = math.floor((high - limit) / TURN)
            for turns in range(first, last + 1):
                begins.append(k)
                targets.append(limit + TURN * turns)
    number, target = np.array(begins, dtype=int), np.array(targets)
    before, after = edges[number], edges[number + 1]
    sign = np.sign(values[number + 1] - values[number])
    for _ in range(HALVINGS):
        middle = 0.5 * (before + after)
        is_past = sign * (unknown(middle) - target) > 0.0
        before, after = (
            np.where(is_past, before, middle),
            np.where(is_past, middle, after),
        )
    places: np.ndarray = 0.5 * (before + after)
    return places


def _lifts(
    point: np.ndarray, limits: dict[int, tuple[float, float]]
) -> list[np.ndarray]:
    """The configurations (n,) within the limits that are ``point`` (n,) but for whole
    turns of joints with limits, one more of them than are looked at at most."""
    turns = []
    for column, (low, high) in limits.items():
        first = math.ceil((low - point[column]) / TURN)
        last = math.floor((high - point[column]) / TURN)
        turns.append(range(first, last + 1))
    lifts = []
    for counts in itertools.islice(itertools.product(*turns), MOST_STRETCHES + 1):
        lifted = point.copy()
        lifted[list(limits)] += TURN * np.array(counts)
        lifts.append(lifted)
    return lifts


def _lie_on(
    points: np.ndarray, branches: Sequence[Branch], lattice: TurnLattice
) -> np.ndarray:
    """Which of the points (k, n) lie on one of the branches (k,), but for the whole
    turns of a lattice up to which forms are listed."""
    are_on = np.zeros(len(points), dtype=bool)
    for branch in branches:
        left = points[~are_on]
        if lattice:
            are_on[~are_on] = passes_but_for_turns(branch, left, lattice)
        elif len(left):
            are_on[~are_on] = is_same_point(branch.nearest(left)[0])
    return are_on
