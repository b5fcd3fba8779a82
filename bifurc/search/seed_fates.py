"""What a seed lies on: the rules by which it is told."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc.curves.deflation import RankDeflated
from bifurc.decisions import (
    closes_to_rounding,
    is_beside_singular,
    is_known_assembly,
    is_start_solved,
    is_weakly_isolated,
    may_be_mobile,
    may_be_singular,
    may_nearly_move,
)
from bifurc.numerics.blur import distance_to_singular
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.findings import Run
from bifurc.search.point_search import SEED_REACH, PointSearch
from bifurc.search.records import Start, half_branch_starts
from bifurc.search.seed_book import SeedFate
from bifurc.search.solutions import polished
from bifurc.search.tracing import Tracer
from bifurc.singular.dimension import local_dimensions
from bifurc.system import relative_gaps

log = logging.getLogger(__name__)

# Singular values are over the problem's magnitude, lengths over its scale.
BLURRED = 1e-4  # accuracy of a seed where the rank is low: half the digits, at worst
TINY = 1e-300  # keeps a singular value of zero from being divided by
NULLITY_OF_SHAKY = 3  # or more: of a curve that one deflation of the rank makes regular
MOST_MOVES = 3  # of a solution to the curve that is listed for its own
SAMPLES = 256  # of a curve, by which it is told how far it is moved


@dataclass(frozen=True, eq=False)
class Seed:
    """A solution ``point`` (n,) of a ``problem`` with the singular ``values`` (n,)
    there."""

    problem: Problem
    point: np.ndarray
    values: np.ndarray

    def is_any(self) -> bool:
        """Whether it is a seed."""
        return True

    def cannot_move(self) -> bool:
        """Whether F' has full rank there."""
        return not may_be_mobile(float(self.values[self.problem.n - 1]))

    def is_weak(self) -> bool:
        """Whether F' has not full rank, or hardly."""
        return is_weakly_isolated(float(self.values[self.problem.n - 1]))

    def may_be_shaky(self) -> bool:
        """Whether F' may have rank n - 3 or less all along a curve."""
        return self.nullity >= NULLITY_OF_SHAKY and not self.problem.domain.is_large

    def may_be_singular(self) -> bool:
        """Whether it may be a singular point: a singular value is small there, and not
        just as small as it is all around."""
        is_small = may_be_singular(float(self.values[self.problem.n - 2]))
        return is_small and self._is_beside_singular

    @cached_property
    def _is_beside_singular(self) -> bool:
        return is_beside_singular(distance_to_singular(self.problem, self.point))

    @property
    def nullity(self) -> int:
        """How many singular values may be those of a singular point."""
        return int(np.count_nonzero(may_be_singular(self.values)))

    @property
    def blur(self) -> float:
        """How far, over the scale, it may lie from where it belongs: what its residual
        leaves open in the weakest direction, and no more where sheets lie near to each
        other."""
        weakest = float(self.values[self.problem.n - 2]) * self.problem.domain.scale
        return min(BLURRED, is_start_solved.threshold / max(weakest, TINY))


class _Rule(NamedTuple):
    """Where the ``test`` holds, a seed may have the fate that the ``action`` gives, for
    a ``reason``; where that is None, the rule says nothing of it."""

    test: Callable[[Seed], bool]
    action: Callable[[Seed], SeedFate | None]
    reason: str


class SeedJudge:
    """Tells what seeds of a ``run`` lie on, and has a ``tracer`` trace the curves there;
    the first of its rules that has an answer decides."""

    def __init__(self, run: Run, points: PointSearch, tracer: Tracer):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings
        self.points = points
        self.tracer = tracer
        self.rules = (
            _Rule(Seed.is_weak, self._known_point, "a known point, to rounding"),
            _Rule(Seed.cannot_move, self._assembly, "F' has full rank"),
            _Rule(Seed.is_any, self._near_motion, "a known near motion"),
            _Rule(Seed.may_be_shaky, self._shaky_curve, "rank n - 3 or less"),
            _Rule(Seed.may_be_singular, self._known_about, "known, as near as it is"),
            _Rule(Seed.may_be_singular, self._curve_of_lower_rank, "rank n - 2"),
            _Rule(Seed.may_be_singular, self._singular_point, "a singular point"),
            _Rule(Seed.is_any, self._curve, "a curve"),
            _Rule(Seed.is_any, self._assembly, "no curve runs through it"),
        )

    def fate_of(self, number: int) -> SeedFate:
        """What a seed, given by its number, lies on; the curves there are traced."""
        book = self.findings.book
        seed = Seed(self.problem, book.seeds.points[number], book.values[number])
        for rule in self.rules:
            fate = rule.action(seed) if rule.test(seed) else None
            if fate is not None:
                log.debug("seed %d is %s: %s", number, fate.fate.value, rule.reason)
                return fate
        raise AssertionError("the last rule has an answer for every seed")

    def _known_point(self, seed: Seed) -> SeedFate | None:
        """The known singular point, or assembly that is held, from which rounding does
        not tell it: F is rounding half-way, too."""
        known = self.findings.known_near(seed.point, is_known_assembly.threshold)
        if known is None:
            return None
        place, fate = known
        half_way = seed.point + 0.5 * self.problem.domain.difference(place, seed.point)
        gap = float(relative_gaps(self.problem, half_way[None])[0])
        return fate if closes_to_rounding(gap) else None

    def _near_motion(self, seed: Seed) -> SeedFate | None:
        """The known near motion on which it lies."""
        return self.findings.near_motion_through(seed.point)

    def _shaky_curve(self, seed: Seed) -> SeedFate | None:
        """The curve on which it lies where F' has rank n - 3 or less all along it."""
        fate = self.findings.branch_through(seed.point, seed.blur)
        if fate is not None:
            return fate
        n = self.problem.n
        deflated = RankDeflated(self.problem, n - seed.nullity)
        solutions, are_solved = deflated.next_to(seed.point[None])
        last = singular_values(deflated, solutions)[0, n - 2]
        if not are_solved[0] or may_be_singular(float(last)):
            return None
        if not deflated.is_curve_alone(solutions[0]) and (
            seed.nullity > NULLITY_OF_SHAKY or self._is_on_surface(solutions)
        ):
            return None
        branch = self.tracer.follow_deflated(deflated, Start(solutions[0]))
        if branch is None:
            return None
        fate = self.findings.branch_along(branch)
        if fate is None:
            examined = self.tracer.examiner.examine(branch)
            fate = self.findings.add_branch(examined.traced)
            self.tracer.branch_off(examined.starts)
        return fate

    def _is_on_surface(self, solutions: np.ndarray) -> bool:
        """Whether solutions fill two dimensions about one of some (k, n)."""
        local = local_dimensions(self.problem, solutions, self.run.deadline)
        return bool(np.any(local.dimension > 1))

    def _known_about(self, seed: Seed) -> SeedFate | None:
        """The known singular point or branch as near as it is known."""
        point = self.findings.point_near(seed.point, seed.blur)
        if point is not None:
            return point.fate
        branch = self.findings.branch_through(seed.point, seed.blur)
        if branch is not None:
            return branch
        hidden = self.findings.point_hidden_at(seed.point)
        return None if hidden is None else hidden.fate

    def _curve_of_lower_rank(self, seed: Seed) -> SeedFate | None:
        """The curve on which it lies where F' has rank n - 2 all along it."""
        return self.tracer.trace_lower_rank(seed.point)

    def _singular_point(self, seed: Seed) -> SeedFate | None:
        """The singular point that it is, or as near to one as its digits tell."""
        sighting = self.points.near(seed.point, seed.nullity, SEED_REACH)
        if sighting is None:
            return None
        self.tracer.branch_off(half_branch_starts(sighting.point))
        # points that were found on these branches may have taken its place
        known = self.findings.point_at(sighting.point.u, sighting.point.error)
        if known is None:
            known = self.findings.point_hidden_at(seed.point)
        return None if known is None else known.fate

    def _curve(self, seed: Seed) -> SeedFate | None:
        """The curve through it, or that which is listed for this one."""
        trace = self.tracer.trace(Start(self._moved_home(seed.point)))
        self.tracer.branch_off(trace.starts)
        return trace.fate

    def _moved_home(self, point: np.ndarray) -> np.ndarray:
        """A solution (n,) on the curve that is listed for the one through ``point``
        (n,), where curves are the same but for shifts."""
        if self.findings.book.seeds.home is None:
            return point
        for _ in range(MOST_MOVES):
            if self.findings.branch_through(point) is not None:
                break
            branch = self.tracer.follow(Start(point), self.run.settings.tracing)
            if not self.tracer.is_curve(branch):
                break
            samples = branch.sample(SAMPLES)
            shift = self.findings.shift_home(samples)
            if not np.any(shift):
                break
            shifted = samples + shift
            inmost = int(np.argmin(self.problem.domain.excess(shifted)))
            solutions, gaps = self.problem.project(shifted[[inmost]])
            if not is_start_solved(float(gaps[0])):
                break
            point = solutions[0]
        return point

    def _assembly(self, seed: Seed) -> SeedFate:
        """What a seed lies on that cannot move: a near motion, or nothing but itself.

        On a near motion only what is stiff enough to be told from its neighbours is an
        assembly of its own, besides those where the misclosure passes zero.
        """
        blurred = self.findings.point_hidden_at(seed.point)
        if blurred is not None:
            return blurred.fate
        solution = polished(self.problem, seed.point)
        place = (solution.point, solution.stiffness, solution.hidden)
        known = self.findings.assembly_at(*place)
        if known is not None:
            return known
        if is_weakly_isolated(solution.stiffness):
            double = self.points.at_assembly(solution.point)
            if double is not None:
                return double.fate
        near = None
        if self.run.settings.near_motions and may_nearly_move(solution.stiffness):
            near = self.tracer.near_motions.through(seed.point)
        if near is None or solution.is_isolated:
            return self.findings.add_assembly(*place)
        return near
