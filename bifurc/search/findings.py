"""What a search knows so far."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import compress
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.certificate import Certificate
from bifurc.curves.monitor import Profile
from bifurc.curves.near_motion import NearMotionTrace, NearSurface
from bifurc.decisions import (
    Decision,
    is_lost_in_rounding,
    is_same_point,
    is_weakly_isolated,
    may_be_known,
    may_be_weak,
)
from bifurc.numerics.blur import same_reach
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.components import Components
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.seeds import Audit, Seeds
from bifurc.singular.point import SingularPoint

if TYPE_CHECKING:
    from bifurc.singular.germ import Germ  # mpmath takes long to import

# Shares of its length at which a branch is compared with those already known.
PLACES = np.array([0.11, 0.29, 0.47, 0.71, 0.93])
SHARPER = 1e-2  # times the distance of two assemblies: where they are weak


class Doubt(NamedTuple):
    """Whether a branch is refused a certificate, whether it stalls, and the arclength
    on which it is refused; less doubt is the smaller tuple."""

    is_refused: bool
    is_stalled: bool
    refused_length: float


NO_DOUBT = Doubt(is_refused=False, is_stalled=False, refused_length=0.0)


@dataclass(frozen=True, eq=False)
class TracedBranch:
    """A branch with what was seen along it.

    ``minima`` are arclengths (k,) and values (k,) of the local minima of the smallest
    regular singular value. ``located`` are the arclengths of minima that led to a
    singular point, ``passes`` those at which the branch passes it, ``missing`` those
    where one must be and none was located. ``misclosure`` is the largest along the
    branch, ``blur`` the distance, over the scale, to which its points are known.
    ``certificate`` says what is certified of it, None where that was not asked for or
    the problem has no bounds. ``multiplicity``: 1 of an ordinary curve, 2 of one that
    one step of deflation makes regular, 0 where it is not known.
    """

    branch: Branch
    profile: Profile
    minima: tuple[np.ndarray, np.ndarray]
    located: tuple[float, ...]
    misclosure: float = 0.0
    blur: float = 0.0
    passes: tuple[float, ...] = ()
    missing: tuple[float, ...] = ()
    certificate: Certificate | None = None
    multiplicity: int = 1

    @property
    def is_refused(self) -> bool:
        """Whether there is a certificate, and it does not hold."""
        return self.certificate is not None and not self.certificate.holds

    @property
    def doubt(self) -> Doubt:
        """How much of the branch is in doubt."""
        refused = 0.0
        if self.certificate is not None and self.is_refused:
            refused = self.certificate.refused_length
        is_stalled = self.branch.outcome is Outcome.STALLED
        return Doubt(self.is_refused, is_stalled, refused)


class PointSighting(NamedTuple):
    """A singular point that was looked at, its number, and whether it is new."""

    point: SingularPoint
    number: int
    is_new: bool


class Findings:
    """Branches, singular points, near motions, rigid assemblies and components of a
    problem, nothing twice; and the seeds they come from.

    ``seed_values`` (k, n) are the singular values at the seeds, ``seed_reach`` (k,) is
    how far from their curves they may have been found, ``fates`` what is known
    of each by its number. ``gaps`` are the residuals of starts that only nearly solve
    the system, ``gaps_of_stops`` those of starts that end short of one about nothing that
    is known. ``audit`` is the last word on what the branches leave out.
    """

    def __init__(self, problem: Problem):
        nowhere = np.empty((0, problem.n))
        self.problem = problem
        self.seeds = Seeds(nowhere, np.empty(0, dtype=bool), np.empty(0), nowhere)
        self.seed_values = nowhere
        self.seed_reach = np.empty(0)
        self.fates: dict[int, SeedFate] = {}
        self.traced: list[TracedBranch] = []
        self.points: list[SingularPoint] = []
        self.germs: list[Germ] = []  # of some of the points
        self.rigid: list[np.ndarray] = []
        self.hidden: list[float] = []  # about each of them
        self.near_motions: list[NearMotionTrace] = []
        self.short_stretches: list[NearMotionTrace] = []
        self.near_surfaces: list[NearSurface] = []
        self.components = Components()
        self.gaps: list[float] = []
        self.gaps_of_stops: list[float] = []
        self.audit: Audit | None = None
        self.awaits_audit = True

    @property
    def branches(self) -> list[Branch]:
        """The traced branches, in the order in which they were found."""
        return [traced.branch for traced in self.traced]

    # --- seeds ------------------------------------------------------------------------

    @property
    def open_seeds(self) -> list[int]:
        """Numbers of the seeds of which nothing is known yet."""
        return [k for k in range(len(self.seeds.points)) if k not in self.fates]

    def add_seeds(self, seeds: Seeds, values: np.ndarray) -> None:
        """Replace the seeds by ``seeds``, which begin with those known so far;
        ``values`` (k, n) are the singular values at the new ones."""
        self.seeds = seeds
        self.seed_values = np.concatenate([self.seed_values, values])
        own = self._same_place(seeds.points[len(self.seed_reach) :], values)
        self.seed_reach = np.concatenate([self.seed_reach, own])

    def set_components(self, components: Components) -> None:
        """Record the components of higher dimension, and the seeds that lie on them."""
        self.components = components
        for dimension, numbers in components.seeds.items():
            self._settle(numbers, SeedFate(Fate.ON_COMPONENT, dimension))
        self._settle(components.on_shaky, SeedFate(Fate.ON_COMPONENT, 2))

    def reopen_seeds(self, numbers: Iterable[int]) -> None:
        """Forget what is known of some seeds."""
        for number in numbers:
            del self.fates[number]

    def match_seeds(self, numbers: Sequence[int], branch: int) -> list[int]:
        """Those of the seeds that do not lie on a branch, given by its number; the fate
        of the others is settled."""
        if not numbers:
            return []
        points = self.seeds.points[list(numbers)]
        within = self.seed_reach[list(numbers)]
        reach = float(within.max())
        distance, _ = self.traced[branch].branch.nearest(points, within=reach)
        is_on = may_be_known(distance, within / may_be_known.threshold)
        matching = list(compress(numbers, is_on))
        self._settle(matching, SeedFate(Fate.ON_FORM, branch))
        return list(compress(numbers, ~is_on))

    def _settle(self, numbers: Iterable[int], fate: SeedFate) -> None:
        for number in numbers:
            self.fates[number] = fate

    # --- branches ---------------------------------------------------------------------

    def add_branch(self, traced: TracedBranch) -> int:
        """The number of a branch just recorded, which no audit has seen."""
        self.traced.append(traced)
        self.awaits_audit = True
        return len(self.traced) - 1

    def replace_branches(self, one: int, other: int, traced: TracedBranch) -> None:
        """Put a branch in the place of number ``one``, which it is together with number
        ``other``."""
        self.traced[one] = traced
        if other != one:
            del self.traced[other]
        for number, fate in self.fates.items():
            if fate.fate is not Fate.ON_FORM or other == one:
                continue
            branch = one if fate.number == other else fate.number
            self.fates[number] = SeedFate(Fate.ON_FORM, branch - (branch > other))
        self.awaits_audit = True

    def supersede_branches(
        self, numbers: Sequence[int], traced: Sequence[TracedBranch]
    ) -> None:
        """Put branches in the place of those with some ``numbers``, and forget which
        seeds lie on these."""
        kept = [k for k in range(len(self.traced)) if k not in numbers]
        renumbered = {number: place for place, number in enumerate(kept)}
        self.traced = [self.traced[number] for number in kept] + list(traced)
        for seed, fate in list(self.fates.items()):
            if fate.fate is not Fate.ON_FORM:
                continue
            if fate.number in renumbered:
                self.fates[seed] = SeedFate(Fate.ON_FORM, renumbered[fate.number])
            else:
                del self.fates[seed]
        self.awaits_audit = True

    def forget_covered(self, doubtful: Sequence[TracedBranch]) -> None:
        """Forget those of the ``doubtful`` branches that run along others wherever they
        solve anything."""
        others = [one.branch for one in self.traced if one not in doubtful]
        for traced in doubtful:
            numbers = [k for k, one in enumerate(self.traced) if one is traced]
            points = traced.branch(traced.branch.length * PLACES)
            gaps = self.problem.gaps(points)
            points = points[is_same_point(gaps, self.problem.scale)]
            if numbers and self._are_on(others, points):
                self.supersede_branches(numbers, [])

    def _are_on(self, branches: Sequence[Branch], points: np.ndarray) -> bool:
        """Whether each of the points (k, n) lies on one of the ``branches``."""
        within = self._same_place(points)
        are_there = np.zeros(len(points), dtype=bool)
        for branch in branches:
            distance, _ = branch.nearest(points)
            are_there |= is_same_point(distance, within / is_same_point.threshold)
        return bool(np.all(are_there))

    def branch_through(self, point: np.ndarray, within: float = 0.0) -> int | None:
        """The number of the first branch through a point (n,), as far as that is known,
        or at less than ``within`` scales from it."""
        known_to = float(self._same_place(point[None])[0])
        reach = max(known_to, within * self.problem.scale)
        for number, branch in enumerate(self.branches):
            distance, _ = branch.nearest(point, within=reach)
            unit = reach / may_be_known.threshold
            if may_be_known(float(distance[0]), unit):
                return number
        return None

    def branch_along(self, branch: Branch) -> int | None:
        """The number of the first known branch that runs along another one."""
        for number, known in enumerate(self.branches):
            if self._runs_along(known, branch):
                return number
        return None

    def forget_parts(self) -> None:
        """Forget branches that stalled on the way along another one, which was followed
        farther from another start."""
        for number in range(len(self.traced) - 1, -1, -1):
            branch = self.traced[number].branch
            if branch.outcome is not Outcome.STALLED:
                continue
            for other, longer in enumerate(self.branches):
                is_longer = other != number and longer.length > branch.length
                if is_longer and self._runs_along(longer, branch):
                    self.replace_branches(other, number, self.traced[other])
                    break

    def _runs_along(self, one: Branch, other: Branch) -> bool:
        """Whether a branch passes all along another one."""
        return self._are_on([one], other(other.length * PLACES))

    def _same_place(
        self, points: np.ndarray, values: np.ndarray | None = None
    ) -> np.ndarray:
        """How far from a curve points (k, n) of it may be found; ``values`` (k, n) are
        the singular values there, where they are known."""
        if values is None:
            values = singular_values(self.problem, points)
        reach = np.full(len(points), is_same_point.threshold)
        weak = np.flatnonzero(may_be_weak(values[:, max(self.problem.n - 2, 0)]))
        own = same_reach(self.problem, points[weak], values[weak])
        reach[weak] = np.maximum(reach[weak], own)
        within: np.ndarray = reach * self.problem.scale
        return within

    def near_motion_through(self, point: np.ndarray) -> int | None:
        """The number of the first near motion on which a point (n,) lies, as far as
        that is known."""
        for number, near in enumerate(self.near_motions):
            if near.runs_through(self.problem, point[None])[0]:
                return number
        return None

    def is_on_short_stretch(self, point: np.ndarray) -> bool:
        """Whether a point (n,) lies on a curve that is too short for a near motion."""
        place = point[None]
        return any(
            near.runs_through(self.problem, place)[0] for near in self.short_stretches
        )

    def add_near_motion(self, near: NearMotionTrace) -> int | None:
        """The number of a near motion, which is recorded, with its assemblies, if it is
        new: if it does not run along a known one for the most part. None for a short
        one."""
        if near.is_short:
            self.short_stretches.append(near)
            return None
        points = near.branch(near.branch.length * PLACES)
        for number, known in enumerate(self.near_motions):
            if np.median(known.runs_through(self.problem, points)) > 0.5:
                return number
        self.near_motions.append(near)
        for assembly in near.assemblies:
            self.rigid_assembly(assembly)
        return len(self.near_motions) - 1

    def set_audit(self, audit: Audit) -> None:
        """Record what the problem says of the branches known now."""
        self.audit = audit
        self.awaits_audit = False

    # --- points -----------------------------------------------------------------------

    def add_point(self, point: SingularPoint) -> PointSighting:
        """A singular point just recorded."""
        self.points.append(point)
        return PointSighting(point, len(self.points) - 1, is_new=True)

    def add_germ(self, germ: Germ) -> None:
        """Record the germ of a singular point that is recorded next, and forget what
        doubles saw where they lose its branches: points that more digits did not show,
        and assemblies."""
        self.germs.append(germ)
        upcoming = len(self.points)
        successors = {
            number: upcoming
            for number, point in enumerate(self.points)
            if not point.is_confirmed and self._is_hidden_by(germ, point.u)
        }
        self._drop_points(successors)
        ghosts = [k for k, u in enumerate(self.rigid) if self._is_hidden_by(germ, u)]
        for number in reversed(ghosts):
            self._forget_assembly(number, len(self.points))

    def _forget_assembly(self, number: int, point: int) -> None:
        """Forget a rigid assembly; the seeds there are at a singular ``point``, given by
        its number."""
        del self.rigid[number]
        del self.hidden[number]
        for seed, fate in list(self.fates.items()):
            if fate == SeedFate(Fate.RIGID, number):
                self.fates[seed] = SeedFate(Fate.AT_SINGULAR_POINT, point)
            elif fate.fate is Fate.RIGID and fate.number > number:
                self.fates[seed] = SeedFate(Fate.RIGID, fate.number - 1)

    def point_hidden_at(self, u: np.ndarray) -> PointSighting | None:
        """The known singular point whose branches doubles lose at a place ``u`` (n,):
        what they see there is the point, or a branch of it, or nothing at all."""
        for germ in self.germs:
            if self._is_hidden_by(germ, u):
                return self.point_at(germ.u, 0.0)
        return None

    def _is_hidden_by(self, germ: Germ, u: np.ndarray) -> bool:
        """Whether doubles lose the branches of a germ at a place ``u`` (n,)."""
        distance = self._distance(u, germ.u)
        if distance >= germ.radius:
            return False
        values = singular_values(self.problem, u[None])[0]
        return is_lost_in_rounding(float(values[self.problem.n - 2]))

    def point_near(self, u: np.ndarray, within: float) -> PointSighting | None:
        """The first known singular point at less than ``within`` scales from ``u``
        (n,)."""
        for number, distance in enumerate(self._distances_to_points(u)):
            if distance < within * self.problem.scale:
                return PointSighting(self.points[number], number, is_new=False)
        return None

    def point_at(self, u: np.ndarray, error: float) -> PointSighting | None:
        """The known singular point that one located at ``u`` (n,) to within ``error``
        is."""
        return self._point_within(u, error, is_same_point)

    def point_seen_from(self, u: np.ndarray) -> PointSighting | None:
        """The known singular point at a place ``u`` (n,) of a curve, as far as its error
        tells: what is farther away may be the same one."""
        return self._point_within(u, 0.0, may_be_known)

    def _point_within(
        self, u: np.ndarray, error: float, decision: Decision
    ) -> PointSighting | None:
        """The first known singular point that is at ``u`` (n,) by a ``decision`` on the
        distance, the error of the point or another one allowed for twice."""
        distances = self._distances_to_points(u)
        for number, (point, distance) in enumerate(
            zip(self.points, distances, strict=True)
        ):
            within = 2 * max(error, point.error)
            unit = self.problem.scale + within / decision.threshold
            if decision(distance, unit):
                return PointSighting(point, number, is_new=False)
        return None

    def nearest_point(self, number: int) -> tuple[int, float]:
        """The number of the singular point next to another one, given by its number, and
        how far apart they are; infinitely far where there is none."""
        apart = self._distances_to_points(self.points[number].u)
        apart[number] = np.inf
        nearest = int(np.argmin(apart))
        return nearest, apart[nearest]

    def merge_points(self, pairs: Sequence[tuple[int, int]]) -> None:
        """Take each of the ``pairs`` of singular points, by their numbers, for one: that
        which is confirmed, or else which doubles know less well, for they say so only
        where they see it. Two of which germs are known are two."""
        successors: dict[int, int] = {}
        for one, other in pairs:
            if one in successors or other in successors:
                continue
            if self._has_germ(one) and self._has_germ(other):
                continue
            less, more = sorted((one, other), key=self._standing)
            successors[less] = more
        self._drop_points(successors)

    def _drop_points(self, successors: dict[int, int]) -> None:
        """Forget the singular points with some numbers, each for its successor: another
        one, which may have a successor itself, or the one that is recorded next. The
        seeds at each of them are then at its last successor."""
        upcoming = len(self.points)
        kept = [k for k in range(upcoming + 1) if k not in successors]
        renumbered = {number: place for place, number in enumerate(kept)}
        self.points = [p for k, p in enumerate(self.points) if k not in successors]
        for seed, fate in list(self.fates.items()):
            if fate.fate is not Fate.AT_SINGULAR_POINT:
                continue
            number = fate.number
            while number in successors:
                number = successors[number]
            place = renumbered[number]
            self.fates[seed] = SeedFate(Fate.AT_SINGULAR_POINT, place)

    def forget_on_surface(self, number: int) -> None:
        """Forget a singular point, given by its number, that is one of many of a
        surface; the seeds at it are on that surface."""
        del self.points[number]
        for seed, fate in list(self.fates.items()):
            if fate.fate is not Fate.AT_SINGULAR_POINT:
                continue
            if fate.number == number:
                self.fates[seed] = SeedFate(Fate.ON_COMPONENT, 2)
            elif fate.number > number:
                self.fates[seed] = SeedFate(Fate.AT_SINGULAR_POINT, fate.number - 1)

    def _has_germ(self, number: int) -> bool:
        """Whether a singular point, given by its number, is where a germ is: the exact
        equations tell it from others."""
        u = self.points[number].u
        return any(np.array_equal(germ.u, u) for germ in self.germs)

    def _standing(self, number: int) -> tuple[bool, float]:
        """What is known of a singular point; that which is more stays."""
        point = self.points[number]
        return point.is_confirmed, point.error

    def rigid_at(
        self, u: np.ndarray, stiffness: float = np.inf, hidden: float = 0.0
    ) -> int | None:
        """The number of the known rigid assembly at ``u`` (n,), where the smallest
        singular value is its ``stiffness``.

        One that is weak has another beside it, as near as it is weak. All that rounding
        may have ``hidden`` on a stretch, as far from its middle, count as one.
        """
        unit = self.problem.scale
        if is_weakly_isolated(stiffness):
            unit *= SHARPER
        for number, known in enumerate(self.rigid):
            distance = self._distance(known, u)
            is_hidden = distance < max(hidden, self.hidden[number])
            if is_hidden or is_same_point(distance, unit):
                return number
        return None

    def rigid_within(self, u: np.ndarray, within: float) -> bool:
        """Whether a rigid assembly is at less than ``within`` scales from ``u`` (n,)."""
        reach = within * self.problem.scale
        return any(self._distance(known, u) < reach for known in self.rigid)

    def rigid_assembly(
        self, u: np.ndarray, stiffness: float = np.inf, hidden: float = 0.0
    ) -> int:
        """The number of the rigid assembly at ``u`` (n,), which is recorded if new; see
        `rigid_at`."""
        known = self.rigid_at(u, stiffness, hidden)
        if known is not None:
            return known
        self.rigid.append(u)
        self.hidden.append(hidden)
        return len(self.rigid) - 1

    def _distances_to_points(self, u: np.ndarray) -> list[float]:
        """How far each known singular point is from ``u`` (n,)."""
        if not self.points:
            return []
        places = np.array([point.u for point in self.points])
        gaps = self.problem.difference(places, u)
        distances: list[float] = np.linalg.norm(gaps, axis=1).tolist()
        return distances

    def _distance(self, one: np.ndarray, other: np.ndarray) -> float:
        return float(np.linalg.norm(self.problem.difference(one, other)))
