"""Where a search of a mechanism begins, and what judges the motions that it finds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol, TypeAlias

import numpy as np

from bifurc.branch import Branch
from bifurc.completeness import Scope
from bifurc.decisions import is_start_solved
from bifurc.equations.system import ScaledTape
from bifurc.limits import Deadline, current_deadline, made_in_time, until
from bifurc.problem import Problem
from bifurc.seeding import random_seeds, start_region
from bifurc.seeds import Audit, Seeds
from bifurc.tables import count_of
from linkages.closure import cut_at_limits
from linkages.closure.system import ClosureSystem
from linkages.closure.within_limits import brought_within_limits
from linkages.dyads import slices as dyads
from linkages.dyads.slices import DyadSlices
from linkages.loop import Loop
from linkages.mechanisms.of_loop import mechanism_of_loop
from linkages.modules import assemblies
from linkages.modules import slices as modules
from linkages.slices.completeness import sliced_seeds
from linkages.statements import LinkageClaim, estimated
from linkages.structure.structure import Structure
from linkages.turns import whole_turns
from linkages.turns.whole_turns import TurnedEnds

# Of the time that is left, for random starts, to bring them within limits, and for each
# source: what random starts reach is not to be lost over it.
DRAWING, BRINGING, JUDGING = 0.25, 0.1, 0.3
MOST_BEYOND = 60  # solutions beyond the limits that are brought back to them


class Source(Protocol):
    """Points ``starts`` (k, n) near solutions, and how sure it is that ``branches`` are
    all motions, judged in about so many ``seconds``."""

    @property
    def starts(self) -> np.ndarray:
        """Points near solutions."""

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """What is said of the branches."""


@dataclass(frozen=True, eq=False)
class BesideFlatCreases:
    """What a ``judge``, if there is one, says of forms in ``n`` unknowns, and that so many
    ``creases`` are held flat."""

    creases: int
    n: int
    judge: Callable[[Sequence[Branch], float], Audit] | None

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """Both."""
        audit = Audit((), np.empty((0, self.n)))
        if self.judge is not None:
            audit = self.judge(branches, seconds)
        words = count_of(self.creases, "crease")
        claim = estimated(LinkageClaim.STAY_FLAT, creases=words)
        return replace(audit, claims=(*audit.claims, claim), has_all_isolated=False)


@dataclass(frozen=True, eq=False)
class BesideAssemblies:
    """All regular ``assemblies`` beside a ``source`` of motions; where that is None,
    nothing is known of these."""

    assemblies: DyadSlices
    source: Source | None

    @property
    def starts(self) -> np.ndarray:
        """Those of both."""
        starts = self.assemblies.starts
        if self.source is None:
            return starts
        return np.concatenate([starts, self.source.starts])

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """What both say."""
        of_assemblies = self.assemblies(branches, seconds)
        if self.source is None:
            return of_assemblies
        audit = self.source(branches, seconds)
        of_motions = [
            claim for claim in audit.claims if claim.scope is not Scope.ASSEMBLIES
        ]
        return replace(audit, claims=(*of_motions, *of_assemblies.claims))


# The source of a problem of a structure, drawn with a generator beside so many random
# starts; None where the method says nothing of such a mechanism.
ForSubject: TypeAlias = Callable[
    [Problem, Structure, np.random.Generator, int], Source | None
]


# what gives starts and judges what is traced: the first that applies to a mechanism
SOURCES: tuple[ForSubject, ...] = (
    dyads.built_at_once,
    assemblies.for_subject,
    dyads.for_subject,
    modules.for_subject,
    whole_turns.for_subject,
    cut_at_limits.for_subject,
)


def mechanism_seeds(
    problem: ClosureSystem,
    rng: np.random.Generator,
    count: int,
    deadline: Deadline | None,
) -> Seeds:
    """The closed configuration of a mechanism nearest to the reference, what the starts
    of a source lead to and what ``count`` random starts do or, where these lead beyond
    given limits, others within, and those that the mechanism knows itself.

    Before a ``deadline`` a share of the time is left for what is traced from there.
    """
    deadline = deadline or current_deadline()
    share = deadline.share(DRAWING)
    with until(share):
        drawn = _drawn(problem, rng, count, share)
    lattice = problem.lattice
    motions, regular = _sources(problem, rng, count, deadline)
    judge = BesideAssemblies(regular, motions) if regular else motions
    starts = problem.reference[None]
    if judge is not None:
        starts = np.concatenate([starts, judge.starts])
    points, gaps = problem.project(starts)
    solutions = points[is_start_solved(gaps)]
    with until(deadline.share(BRINGING)):
        brought = _from_beyond_limits(problem, solutions, drawn, rng)
    solutions = np.concatenate([solutions, brought])
    if lattice:
        # what is outside the limits may have a translate inside
        solutions = lattice.homes(solutions)
    is_inside = problem.domain.are_inside(solutions)
    seeds = drawn.with_constructed(solutions[is_inside])
    if motions is None and not problem.structure.is_held_flat:
        seeds = replace(seeds, more=partial(_drawn, problem))
    seeds = _judged(problem, replace(seeds, audit=judge))
    return seeds.with_constructed(_constructed(problem))


def _judged(problem: ClosureSystem, seeds: Seeds) -> Seeds:
    """The seeds with what whole turns, and creases that stay flat, add to what is said of
    the motions."""
    lattice, structure = problem.lattice, problem.structure
    sees_all = seeds.audit is not None
    if lattice:
        ends = TurnedEnds(problem, lattice, seeds.audit)
        seeds = replace(seeds, home=lattice.home, audit=ends)
    creases = {*structure.stay_flat}
    if problem.flat_state.is_isolated:
        creases |= {one.label for one in structure.unknowns}
        seeds = replace(seeds, isolated=problem.reference[None])
        if sees_all:  # folded states, too
            return seeds
    if not creases:
        return seeds
    return replace(seeds, audit=BesideFlatCreases(len(creases), problem.n, seeds.audit))


def ring_seeds(
    problem: ClosureSystem,
    rng: np.random.Generator,
    count: int,
    deadline: Deadline | None,
) -> Seeds:
    """What ``count`` random starts of a loop of turns lead to, and the slices of the
    mechanism that it is, drawn as the first of these."""
    loop = problem.subject
    assert isinstance(loop, Loop)
    deadline = deadline or current_deadline()
    drawn = sliced_seeds(loop, problem, rng, count, deadline)
    if not len(drawn.points):
        return drawn
    reference = drawn.points[0]
    structure = Structure(mechanism_of_loop(loop, reference))
    make = partial(modules.for_subject, problem, structure, rng, count)
    with until(deadline.share(JUDGING)):
        slices = made_in_time(make)
    if slices is None:
        return drawn
    points, gaps = problem.project(reference + slices.starts)
    points = points[is_start_solved(gaps)]
    return replace(drawn.with_constructed(points), audit=slices)


def _sources(
    problem: ClosureSystem, rng: np.random.Generator, count: int, deadline: Deadline
) -> tuple[Source | None, DyadSlices | None]:
    """The first of the sources that applies to the mechanism, and is made in a share of
    the time before a ``deadline``; and one that knows of regular assemblies alone. None
    where none is."""
    regular: DyadSlices | None = None
    for for_subject in SOURCES:
        make = partial(for_subject, problem, problem.structure, rng, count)
        with until(deadline.share(JUDGING)):
            source = made_in_time(make)
        if isinstance(source, DyadSlices) and source.leaves_motions_open:
            regular = source
        elif source is not None:
            return source, regular
    return None, regular


def _constructed(problem: ClosureSystem) -> np.ndarray:
    """Closed configurations (k, n) that the mechanism knows, and those in ways out of the
    flat state of a sheet; but where creases rest in a bound, as of these others may
    move."""
    folded = np.array([way.point for way in problem.flat_state.ways])
    folded = folded.reshape(-1, problem.n)
    folded = folded[~problem.domain.are_at_bounds(folded)]
    known = problem.structure.mechanism.assemblies()
    if len(known):
        known, _ = problem.project(known[:, list(problem.structure.column_of)])
        folded = np.concatenate([folded, known])
    return folded


def _from_beyond_limits(
    problem: ClosureSystem,
    solutions: np.ndarray,
    drawn: Seeds,
    rng: np.random.Generator,
) -> np.ndarray:
    """Closed configurations (k, n) within limits that are given, from those of the
    ``solutions`` (j, n) beyond them and some that random starts reached there: narrow
    limits leave few that are reached else."""
    if all(one.limits is None for one in problem.structure.mechanism.variables):
        return np.empty((0, problem.n))
    missed = drawn.missed[is_start_solved(drawn.gaps)]
    is_beyond = ~problem.domain.are_inside(solutions)
    beyond = np.concatenate([solutions[is_beyond], missed])[:MOST_BEYOND]
    tape = problem.compiled
    assert isinstance(tape, ScaledTape)  # that of a loop holds no unknowns
    return brought_within_limits(problem, tape.project, beyond, rng)


def _drawn(
    problem: ClosureSystem,
    rng: np.random.Generator,
    count: int,
    deadline: Deadline | None,
) -> Seeds:
    """What is reached from random starts before a deadline; where whole turns lead to
    the same again, half of them from a region that holds a translate of everything. None
    where a sheet is held flat."""
    if problem.structure.is_held_flat:
        count = 0
    lattice = problem.lattice
    if not lattice:
        return random_seeds(problem, rng, count, deadline=deadline)
    region = lattice.region(start_region(problem), problem.reference)
    homes = lattice.homes
    anywhere = random_seeds(problem, rng, count // 2, None, deadline, homes)
    rest = count - count // 2
    near = random_seeds(problem, rng, rest, region, deadline, homes)
    return anywhere.and_random(near)
