"""What a search knows so far, and what its parts share."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import compress
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.misclosure import NearMotionTrace, NearSurface
from bifurc.decisions import (
    Decision,
    is_lost_in_rounding,
    is_same_point,
    is_weakly_isolated,
    may_be_known,
)
from bifurc.limits import Deadline, whole
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.records import Components, PointSighting, RigidAssembly, TracedBranch
from bifurc.search.seed_book import Fate, SeedBook, SeedFate, reach_of_places
from bifurc.seeds import Audit
from bifurc.settings import SearchSettings
from bifurc.singular.point import SingularPoint
from bifurc.singular.prestress import SecondOrder, second_order_at
from bifurc.system import relative_gaps

if TYPE_CHECKING:
    from bifurc.singular.germ import Germ  # mpmath takes long to import

# Shares of its length at which a branch is compared with those already known.
PLACES = np.array([0.11, 0.29, 0.47, 0.71, 0.93])
SHARPER = 1e-2  # times the distance of two assemblies: where they are weak

Item = TypeVar("Item")


class Numbered(dict[int, Item], Generic[Item]):
    """Things of one kind in the order in which they were found, by numbers that they
    keep: what is forgotten leaves its number to no other one."""

    _count = 0

    @whole
    def add(self, item: Item) -> int:
        """The number of a thing just recorded."""
        self[self._count] = item
        self._count += 1
        return self._count - 1

    def as_they_come(self) -> Iterator[Item]:
        """All of them, also those that are added meanwhile."""
        number = 0
        while number < self._count:
            if number in self:
                yield self[number]
            number += 1


class Findings:
    """Branches, singular points, near motions, rigid assemblies and components of a
    problem, nothing twice; and the ``book`` of the seeds that they come from.

    ``gaps`` are the residuals of starts that only nearly solve the system,
    ``gaps_of_stops`` those of starts that end short of one about nothing that is known.
    ``audit`` is the last word on what the branches leave out.
    """

    def __init__(self, problem: Problem):
        self.problem = problem
        self.book = SeedBook(problem)
        self.traced: Numbered[TracedBranch] = Numbered()
        self.points: Numbered[SingularPoint] = Numbered()
        self.germs: list[Germ] = []  # of some of the points
        self.rigid: Numbered[RigidAssembly] = Numbered()
        self.near_motions: Numbered[NearMotionTrace] = Numbered()
        self.short_stretches: list[NearMotionTrace] = []
        self.near_surfaces: list[NearSurface] = []
        self.components = Components()
        self.gaps: list[float] = []
        self.gaps_of_stops: list[float] = []
        self.audit: Audit | None = None
        self.awaits_audit = True
        self._orders: dict[bytes, SecondOrder] = {}
        self._with_all_crossings: list[Branch | SingularPoint] = []

    @property
    def branches(self) -> list[Branch]:
        """The traced branches, in the order in which they were found."""
        return [traced.branch for traced in self.traced.values()]

    @whole
    def set_components(self, components: Components) -> None:
        """Record the components of higher dimension, and the seeds that lie on them."""
        self.components = components
        for dimension, numbers in components.seeds.items():
            self.book.settle(numbers, SeedFate(Fate.ON_COMPONENT, dimension))
        self.book.settle(components.on_shaky, SeedFate(Fate.ON_COMPONENT, 2))

    @whole
    def set_audit(self, audit: Audit) -> None:
        """Record what the problem says of the branches known now."""
        self.audit = audit
        self.awaits_audit = False

    # --- branches ---------------------------------------------------------------------

    @whole
    def add_branch(self, traced: TracedBranch) -> SeedFate:
        """That of seeds on a branch just recorded, which no audit has seen."""
        self.awaits_audit = True
        return SeedFate(Fate.ON_FORM, self.traced.add(traced))

    def match_seeds(self, numbers: Sequence[int], branch: int) -> list[int]:
        """Those of the seeds that do not lie on a branch, given by its number; the fate
        of the others is settled."""
        if not numbers:
            return []
        points = self.book.seeds.points[list(numbers)]
        within = self.book.reach[list(numbers)]
        reach = float(within.max())
        distance, _ = self.traced[branch].branch.nearest(points, reach)
        is_on = may_be_known(distance, within / may_be_known.threshold)
        matching = compress(numbers, is_on)
        self.book.settle(matching, SeedFate(Fate.ON_FORM, branch))
        return list(compress(numbers, ~is_on))

    @whole
    def replace_branches(self, one: int, other: int, traced: TracedBranch) -> None:
        """Put a branch in the place of number ``one``, which it is together with number
        ``other``."""
        self.traced[one] = traced
        self.awaits_audit = True
        if other != one:
            del self.traced[other]
            one_fate = SeedFate(Fate.ON_FORM, one)
            self.book.move(SeedFate(Fate.ON_FORM, other), one_fate)

    @whole
    def forget_branch(self, number: int) -> None:
        """Forget a branch, and which seeds lie on it."""
        del self.traced[number]
        self.book.move(SeedFate(Fate.ON_FORM, number), None)
        self.awaits_audit = True

    def forget_covered(self, doubtful: Sequence[int]) -> None:
        """Forget those of the ``doubtful`` branches, given by their numbers, that run
        along others wherever they solve anything."""
        others = [one.branch for k, one in self.traced.items() if k not in doubtful]
        for number in doubtful:
            branch = self.traced[number].branch
            points = branch(branch.length * PLACES)
            gaps = relative_gaps(self.problem, points)
            points = points[is_same_point(gaps, self.problem.domain.scale)]
            if _are_on(others, points, reach_of_places(self.problem, points)):
                self.forget_branch(number)

    def forget_parts(self) -> None:
        """Forget branches that stalled on the way along another one, which was followed
        farther from another start."""
        for number in reversed(list(self.traced)):
            branch = self.traced[number].branch
            if branch.outcome is not Outcome.STALLED:
                continue
            for other, longer in self.traced.items():
                is_longer = longer.branch.length > branch.length
                if is_longer and self._runs_along(longer.branch, branch):
                    self.replace_branches(other, number, longer)
                    break

    def branch_through(self, point: np.ndarray, within: float = 0.0) -> SeedFate | None:
        """That of a seed on the first branch through a point (n,), as far as that is
        known, or at less than ``within`` scales from it."""
        known_to = float(reach_of_places(self.problem, point[None])[0])
        reach = max(known_to, within * self.problem.domain.scale)
        for number, traced in self.traced.items():
            distance, _ = traced.branch.nearest(point, within=reach)
            unit = reach / may_be_known.threshold
            if may_be_known(float(distance[0]), unit):
                return SeedFate(Fate.ON_FORM, number)
        return None

    def are_on_branches(self, points: np.ndarray) -> np.ndarray:
        """Which of the points (k, n) lie on some branch, as far as they are known."""
        within = reach_of_places(self.problem, points)
        unit = within / may_be_known.threshold
        are_on = np.zeros(len(points), dtype=bool)
        for branch in self.branches:
            distances, _ = branch.nearest(points, float(within.max(initial=0.0)))
            are_on |= may_be_known(distances, unit)
        return are_on

    def branch_along(self, branch: Branch) -> SeedFate | None:
        """That of a seed on the first known branch that runs along another one."""
        if not self.traced:
            return None
        points = branch(branch.length * PLACES)
        within = reach_of_places(self.problem, points)
        for number, known in self.traced.items():
            if _are_on([known.branch], points, within):
                return SeedFate(Fate.ON_FORM, number)
        return None

    def _runs_along(self, one: Branch, other: Branch) -> bool:
        """Whether a branch passes all along another one."""
        points = other(other.length * PLACES)
        return _are_on([one], points, reach_of_places(self.problem, points))

    # --- crossings --------------------------------------------------------------------

    @whole
    def set_all_crossings(self) -> None:
        """Record that the branches known now have to cross at no other points than those
        known now."""
        self._with_all_crossings = [*self.branches, *self.points.values()]

    @property
    def have_all_crossings(self) -> bool:
        """Whether that is known of the branches and points known now."""
        now = [*self.branches, *self.points.values()]
        then = self._with_all_crossings
        is_same = [one is other for one, other in zip(now, then, strict=False)]
        return len(now) == len(then) and all(is_same)

    # --- shifts -----------------------------------------------------------------------

    def shift_home(self, samples: np.ndarray) -> np.ndarray:
        """The shift (n,) that brings ``samples`` (k, n) of a curve, or a single point,
        to what is listed for all that are the same but for shifts; 0 where none
        lead."""
        home = self.book.seeds.home
        return np.zeros(samples.shape[1]) if home is None else home(samples)

    def moved_home(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n), each where it is listed."""
        if self.book.seeds.home is None:
            return points
        moved = [point + self.shift_home(point[None]) for point in points]
        return np.array(moved).reshape(points.shape)

    # --- near motions -----------------------------------------------------------------

    def near_motion_through(self, point: np.ndarray) -> SeedFate | None:
        """That of a seed on the first near motion on which a point (n,) lies, as far as
        that is known."""
        for number, near in self.near_motions.items():
            if near.runs_through(self.problem, point[None])[0]:
                return SeedFate(Fate.ON_NEAR_MOTION, number)
        return None

    def add_near_motion(self, near: NearMotionTrace) -> SeedFate | None:
        """That of a seed on a near motion, which is recorded, with its assemblies, if it
        is new: if it does not run along a known one for the most part. None for a short
        one."""
        if near.is_short:
            self.short_stretches.append(near)
            return None
        points = near.branch(near.branch.length * PLACES)
        for number, known in self.near_motions.items():
            if np.median(known.runs_through(self.problem, points)) > 0.5:
                return SeedFate(Fate.ON_NEAR_MOTION, number)
        fate = SeedFate(Fate.ON_NEAR_MOTION, self.near_motions.add(near))
        for assembly in near.assemblies:
            self.add_assembly(assembly)
        return fate

    # --- points -----------------------------------------------------------------------

    @whole
    def add_point(
        self, point: SingularPoint, germ: Germ | None = None
    ) -> PointSighting:
        """A singular point just recorded. Where its ``germ`` is known, what doubles saw
        where they lose its branches is that point: points that more digits did not
        show, and assemblies."""
        ghosts: list[int] = []
        assemblies: list[int] = []
        if germ is not None:
            self.germs.append(germ)
            ghosts = [
                number
                for number, other in self.points.items()
                if not other.is_confirmed and self._is_hidden_by(germ, other.u)
            ]
            assemblies = [
                number
                for number, assembly in self.rigid.items()
                if self._is_hidden_by(germ, assembly.place)
            ]
        sighting = PointSighting(point, self.points.add(point), is_new=True)
        for number in ghosts:
            self.forget_point(number, sighting.fate)
        for number in assemblies:
            del self.rigid[number]
            self.book.move(SeedFate(Fate.RIGID, number), sighting.fate)
        return sighting

    @whole
    def forget_point(self, number: int, fate: SeedFate) -> None:
        """Forget a singular point, given by its number; the seeds there have another
        ``fate``."""
        del self.points[number]
        self.book.move(SeedFate(Fate.AT_SINGULAR_POINT, number), fate)

    @whole
    def merge_points(self, pairs: Sequence[tuple[int, int]]) -> None:
        """Take each of the ``pairs`` of singular points, by their numbers, for one: that
        which is confirmed, or else which doubles know less well, for they say so only
        where they see it. Two of which germs are known are two."""
        for one, other in pairs:
            if one not in self.points or other not in self.points:
                continue
            if self._has_germ(one) and self._has_germ(other):
                continue
            less, more = sorted(
                (one, other),
                key=lambda k: (self.points[k].is_confirmed, self.points[k].error),
            )
            self.forget_point(less, SeedFate(Fate.AT_SINGULAR_POINT, more))

    def _has_germ(self, number: int) -> bool:
        """Whether a singular point, given by its number, is where a germ is: the exact
        equations tell it from others."""
        u = self.points[number].u
        return any(np.array_equal(germ.u, u) for germ in self.germs)

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
        for number, distance in self._distances_to_points(u).items():
            if distance < within * self.problem.domain.scale:
                return PointSighting(self.points[number], number, is_new=False)
        return None

    def point_at(
        self, u: np.ndarray, error: float, decision: Decision = is_same_point
    ) -> PointSighting | None:
        """The first known singular point that one located at ``u`` (n,) to within
        ``error`` is, by a ``decision`` on the distance; the error of the point, or that
        other one, is allowed for twice."""
        for number, distance in self._distances_to_points(u).items():
            point = self.points[number]
            within = 2 * max(error, point.error)
            unit = self.problem.domain.scale + within / decision.threshold
            if decision(distance, unit):
                return PointSighting(point, number, is_new=False)
        return None

    def nearest_point(self, number: int) -> tuple[int, float]:
        """The number of the singular point next to another one, given by its number, and
        how far apart they are; infinitely far where there is none."""
        apart = self._distances_to_points(self.points[number].u)
        apart[number] = np.inf
        nearest = min(apart, key=lambda other: apart[other])
        return nearest, apart[nearest]

    def _distances_to_points(self, u: np.ndarray) -> dict[int, float]:
        """How far each known singular point, by its number, is from ``u`` (n,)."""
        if not self.points:
            return {}
        places = np.array([point.u for point in self.points.values()])
        gaps = self.problem.domain.difference(places, u)
        distances = np.linalg.norm(gaps, axis=1).tolist()
        return dict(zip(self.points, distances, strict=True))

    def _distance(self, one: np.ndarray, other: np.ndarray) -> float:
        return float(np.linalg.norm(self.problem.domain.difference(one, other)))

    # --- assemblies -------------------------------------------------------------------

    def assembly_at(
        self, u: np.ndarray, stiffness: float = np.inf, hidden: float = 0.0
    ) -> SeedFate | None:
        """That of a seed at the known rigid assembly at ``u`` (n,), where the smallest
        singular value is its ``stiffness``.

        One that is weak has another beside it, as near as it is weak. All that rounding
        may have ``hidden`` on a stretch, as far from its middle, count as one.
        """
        unit = self.problem.domain.scale
        if is_weakly_isolated(stiffness):
            unit *= SHARPER
        for number, known in self.rigid.items():
            distance = self._distance(known.place, u)
            is_hidden = distance < max(hidden, known.hidden)
            if is_hidden or is_same_point(distance, unit):
                return SeedFate(Fate.RIGID, number)
        return None

    @whole
    def add_assembly(
        self, u: np.ndarray, stiffness: float = np.inf, hidden: float = 0.0
    ) -> SeedFate:
        """That of a seed at the rigid assembly at ``u`` (n,), which is recorded if new;
        see `assembly_at`."""
        place = self.moved_home(u[None])[0]
        known = self.assembly_at(place, stiffness, hidden)
        if known is not None:
            return known
        return SeedFate(Fate.RIGID, self.rigid.add(RigidAssembly(place, hidden)))

    def known_near(
        self, u: np.ndarray, within: float
    ) -> tuple[np.ndarray, SeedFate] | None:
        """The first known singular point, or assembly that is held, at less than
        ``within`` scales from ``u`` (n,), and the fate of a seed there."""
        sighting = self.point_near(u, within)
        if sighting is not None:
            return sighting.point.u, sighting.fate
        for number, known in self.rigid.items():
            is_near = (
                self._distance(known.place, u) < within * self.problem.domain.scale
            )
            if is_near and self.is_held(known.place):
                return known.place, SeedFate(Fate.RIGID, number)
        return None

    def is_held(self, u: np.ndarray) -> bool:
        """Whether a solution (n,) at which F' is singular is there for certain, and the
        problem knows that no motion passes it, or a stress or the bounds hold it."""
        if self.book.seeds.know_isolated(u):
            return True
        if not self.problem.is_given_at(u):
            return False
        order = self.second_order(u)
        return bool(len(order.flexes)) and order.is_prestress_stable

    def second_order(self, u: np.ndarray) -> SecondOrder:
        """What second order says of a solution (n,), which is asked once."""
        key = u.tobytes()
        if key not in self._orders:
            self._orders[key] = second_order_at(self.problem, u)
        return self._orders[key]

    # --- all of them ------------------------------------------------------------------

    def is_known_about(self, u: np.ndarray, within: float, from_branch: float) -> bool:
        """Whether a singular point or an assembly is at less than ``within`` scales from
        ``u`` (n,), or a branch at less than ``from_branch`` scales."""
        if self.point_near(u, within) is not None:
            return True
        if self.branch_through(u, from_branch) is not None:
            return True
        reach = within * self.problem.domain.scale
        return any(self._distance(one.place, u) < reach for one in self.rigid.values())


def _are_on(branches: Sequence[Branch], points: np.ndarray, within: np.ndarray) -> bool:
    """Whether each of the points (k, n), as far as it is known, ``within`` (k,), lies on
    one of the ``branches``."""
    unit = within / is_same_point.threshold
    are_there = np.zeros(len(points), dtype=bool)
    for branch in branches:
        distance, _ = branch.nearest(points, float(within.max(initial=0.0)))
        are_there |= is_same_point(distance, unit)
    return bool(are_there.all())


@dataclass(frozen=True)
class Run:
    """A search under way: what is searched, how, until when, and what is known so far.

    It stops at the ``deadline``, which a Ctrl-C makes pass.
    """

    problem: Problem
    settings: SearchSettings
    deadline: Deadline
    findings: Findings

    @property
    def is_over(self) -> bool:
        """Whether the budget is used up."""
        return self.deadline.passed
