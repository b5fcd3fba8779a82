"""Plane curves that are a product: each factor explored alone, and put together.

Next to a place where k curves cross their product grows with the power k of the
distance, so that doubles lose it farther away the more there are; each factor is regular
there. So the curves of every factor are those of an atlas of its own, and where two of
them cross is where one vanishes along the curves of the other, which bounds show. Only
factors whose curves touch, or meet at a point that is singular on one of them, are
explored together.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Provenance
from bifurc.branch import Outcome
from bifurc.completeness import Claim, Completeness, Doubt, Level, Scope, worst_level
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.monitor import profile_branch
from bifurc.decisions import is_one_crossing, may_be_one_crossing
from bifurc.equations.expression_problem import TapeProblem
from bifurc.equations.factors import Factors, irreducible_factors
from bifurc.equations.tape import Tape
from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from bifurc.limits import is_time_over, made_in_time
from bifurc.numerics.connected_parts import connected_parts
from bifurc.search.answer.assemble import (
    component_numbers,
    near_misses_of,
    smallest_value,
)
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from bifurc.search.answer.meeting_points import in_order
from bifurc.search.canonical_order import order_branches
from bifurc.search.crossings import crossings_with
from bifurc.search.records import TracedBranch
from bifurc.singular.point import Invariants, Kind, SingularPoint
from bifurc.torus import wrap, wrapped_periods

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

FEWEST = 3  # factors: where two cross their product is as well known as each of them
NEWTON_STEPS = 4  # to where two factors vanish
ROUNDING = 8 * np.finfo(float).eps
IN_BOUNDS = (
    1e-6  # over the sizes: a crossing nearer to a bound may be of parts of curves
)
BLURRED = 1e-13  # singular value of a product, over its magnitude
LONGEST_RADIUS = 1e-3  # of a section about a crossing, over the sizes


@dataclass(frozen=True, eq=False)
class _Part:
    """Some factors, by their ``numbers``, explored together: on a ``tape`` their
    product, each of them once, and the ``atlas`` of that with their powers."""

    numbers: tuple[int, ...]
    tape: Tape
    atlas: Atlas

    @property
    def forms(self) -> Sequence[Form]:
        return self.atlas.forms

    def vanishes_near(self, points: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Whether the product may vanish up to so far, (k, n), from points (k, n)."""
        low, high = self.tape.compiled.value_bounds(points - reach, points + reach)
        return np.asarray((low[:, 0] <= 0.0) & (high[:, 0] >= 0.0))


class _Sighting(NamedTuple):
    """Where a form, by its ``part`` and its ``number`` there, is seen to cross the curves
    of another part, at an arclength ``s`` next to a ``place`` (n,)."""

    part: int
    number: int
    s: float
    other: int
    place: np.ndarray


class _Pass(NamedTuple):
    """Such a crossing, at a ``place`` (n,) known to an ``error``, over the sizes."""

    part: int
    number: int
    s: float
    other: int
    place: np.ndarray
    error: float


def explored_by_factors(
    problem: FunctionProblem,
    part: Callable[[FunctionProblem], Atlas],
    whole: Callable[[], Atlas],
) -> Atlas:
    """The atlas of a problem. That of a plane curve of three factors or more is made of
    those of its factors, each explored as a ``part`` of its own as far as no other
    touches it; of others, and where all have to be explored together, it is the
    ``whole``, but for where there was no time for that and parts are known."""
    factors = _factors_of(problem)
    if factors is None:
        return whole()
    groups: list[tuple[int, ...]] = [(number,) for number in range(len(factors.powers))]
    known: dict[tuple[int, ...], _Part] = {}
    while True:
        for numbers in groups:
            if numbers not in known and not is_time_over():
                explored = _part_of(problem, factors, numbers, part)
                if explored is None:
                    return whole()
                known[numbers] = explored
        union = _union_of(problem, factors, groups, known)
        if union is None:
            return whole()
        passes, entangled = union.meetings()
        if not entangled or is_time_over():
            return union.atlas(union.left_apart(passes, entangled))
        groups = _joined(groups, entangled)
        if len(groups) == 1:
            atlas = whole()
            if not atlas.provenance.out_of_time:
                return atlas
            return union.atlas(union.left_apart(passes, entangled))


def _union_of(
    problem: FunctionProblem,
    factors: Factors,
    groups: Sequence[tuple[int, ...]],
    known: Mapping[tuple[int, ...], _Part],
) -> _Union | None:
    """What is known of the factors, those of a group together where these are; None where
    nothing is."""
    parts = [
        part
        for numbers, part in known.items()
        if not any(set(numbers) < set(more) for more in known)
    ]
    left = sum(len(numbers) for numbers in groups if numbers not in known)
    return _Union(problem, parts, len(factors.powers), left) if parts else None


def _factors_of(problem: FunctionProblem) -> Factors | None:
    """The factors of a plane curve; None where it is none, or there are not many."""
    tape = problem.recording.tape
    if tape is None or problem.n != 2 or tape.m != 1 or problem.accuracy.noise:
        return None
    if not np.all(np.isfinite(problem.domain.bounds)):
        return None
    factors = irreducible_factors(tape, problem.domain.bounds)
    return None if factors is None or len(factors.powers) < FEWEST else factors


def _part_of(
    problem: FunctionProblem,
    factors: Factors,
    numbers: tuple[int, ...],
    explored: Callable[[FunctionProblem], Atlas],
) -> _Part | None:
    """Some factors explored together; None where they are no problem of their own, or
    have more than curves."""
    domain = problem.domain
    try:
        own = TapeProblem(
            factors.product(numbers),
            domain.bounds.tolist(),
            names=domain.names,
            units=domain.units,
            periods=domain.periods.tolist(),
        )
    except ProblemError:
        return None  # half of an angle may have no period of its own
    atlas = explored(own)
    if atlas.surfaces or atlas.near_motions:
        return None
    once = replace(factors, powers=(1,) * len(factors.powers))
    return _Part(numbers, once.product(numbers), atlas)


def _joined(
    groups: Sequence[tuple[int, ...]], pairs: Sequence[tuple[int, int]]
) -> list[tuple[int, ...]]:
    """The groups of factors, with each of the ``pairs``, by their numbers, in one."""
    members: dict[int, list[int]] = defaultdict(list)
    for number, group in zip(connected_parts(len(groups), pairs), groups, strict=True):
        members[number] += group
    return [tuple(sorted(numbers)) for numbers in members.values()]


class _Union:
    """The atlases of ``parts`` of a ``problem`` put together, which has ``count``
    factors; so many of them are ``left`` that there was no time for."""

    def __init__(
        self, problem: FunctionProblem, parts: Sequence[_Part], count: int, left: int
    ):
        self.problem = problem
        self.parts = parts
        self.count = count
        self.left = left
        self.is_cut = False  # whether there was no time to look along all forms
        self.sizes = np.diff(problem.domain.bounds, axis=1)[:, 0]
        samples = [form.branch.sample(64) for part in parts for form in part.forms]
        if samples:
            seen = np.ptp(np.concatenate(samples), axis=0)
            self.sizes = np.where(seen > 0.0, np.minimum(seen, self.sizes), self.sizes)

    # --- where parts meet -------------------------------------------------------------

    def meetings(self) -> tuple[list[_Pass], list[tuple[int, int]]]:
        """All passes of forms at the curves of other parts, and the pairs of parts that
        are not plain crossings of each other. Parts for whose curves there is no time
        count as ``left``."""
        sightings: list[_Sighting] = []
        entangled: set[tuple[int, int]] = set()
        for one in range(len(self.parts)):
            if is_time_over():
                self.left += 1
                continue
            found, unclear = self._sightings_of(one)
            sightings += found
            entangled |= unclear | self._met_at_points(one)
        passes = self._settled(sightings)
        if self.left:
            return passes, []
        seen = {(each.part, each.other): 0 for each in passes}
        for each in passes:
            seen[each.part, each.other] += 1
            domain = self.problem.domain
            to_bounds = np.abs(each.place[:, None] - domain.bounds).min(axis=1)
            if np.any(to_bounds < IN_BOUNDS * self.sizes):
                entangled.add((each.part, each.other))
        for (one, other), count in seen.items():
            if seen.get((other, one), 0) != count:
                entangled.add((one, other))
        return passes, sorted(entangled)

    def _sightings_of(self, other: int) -> tuple[list[_Sighting], set[tuple[int, int]]]:
        """Where forms pass the curves of a part, by its number, and the pairs that it is
        not plainly met by."""
        owners = [
            (part, number)
            for part, each in enumerate(self.parts)
            for number in range(len(each.forms))
            if part != other
        ]
        branches = [self.parts[part].forms[number].branch for part, number in owners]
        tape = self.parts[other].tape
        crossings = crossings_with(tape, branches, self.sizes)
        sightings = [
            _Sighting(*owners[curve], s, other, branches[curve](s))
            for curve, s in crossings.zeros
        ]
        unclear = {(owners[curve][0], other) for curve in crossings.unclear}
        return sightings, unclear

    def _settled(self, sightings: Sequence[_Sighting]) -> list[_Pass]:
        """The passes, each where the two parts vanish next to the place, by Newton's
        method, with how exactly that is known, over the sizes."""
        if not sightings:
            return []
        pairs = np.array([(one.part, one.other) for one in sightings])
        places = np.array([one.place for one in sightings])
        for _ in range(NEWTON_STEPS):
            steps, smallest = self._newton_steps(pairs, places)
            places -= self.sizes * steps
        sizes = 1.0 + (np.abs(places) / self.sizes).max(axis=1)
        errors = ROUNDING * sizes / np.maximum(smallest, ROUNDING)
        return [
            _Pass(one.part, one.number, one.s, one.other, place, float(error))
            for one, place, error in zip(sightings, places, errors, strict=True)
        ]

    def _newton_steps(
        self, pairs: np.ndarray, places: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Steps (k, n) over the sizes from places (k, n) to where pairs (k, 2) of parts
        vanish, none where one of them is singular, and the sine (k,) of the angle between
        the two, or less."""
        values, rows = self._values_of(pairs, places)
        slopes = rows * self.sizes
        lengths = np.linalg.norm(slopes, axis=2)
        is_plain = np.all(lengths > 0.0, axis=1)
        directions = slopes[is_plain] / lengths[is_plain, :, None]
        ahead = values[is_plain] / lengths[is_plain]
        steps, smallest = np.zeros(places.shape), np.zeros(len(places))
        steps[is_plain] = (np.linalg.pinv(directions) @ ahead[:, :, None])[:, :, 0]
        smallest[is_plain] = np.linalg.svd(directions)[1][:, -1]
        return steps, smallest

    def _values_of(
        self, pairs: np.ndarray, places: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The products of pairs (k, 2) of parts at places (k, n), and their slopes (k, 2,
        n)."""
        values = np.empty(pairs.shape)
        rows = np.empty((*pairs.shape, places.shape[1]))
        for number, part in enumerate(self.parts):
            for side in range(2):
                here = np.flatnonzero(pairs[:, side] == number)
                if len(here):
                    tape = part.tape.compiled
                    values[here, side] = tape.residuals(places[here])[:, 0]
                    rows[here, side] = tape.jacobians(places[here])[:, 0]
        return values, rows

    def _met_at_points(self, one: int) -> set[tuple[int, int]]:
        """The pairs of a part, by its number, and others that may vanish at a singular
        point or an isolated solution of it, or in what is left out about the end of a
        form at one."""
        atlas = self.parts[one].atlas
        reaches = [(point.point.u, self._reach(atlas, point)) for point in atlas.points]
        reaches += [(u, ROUNDING) for u in atlas.rigid]
        if not reaches:
            return set()
        points = np.array([u for u, _ in reaches])
        reach = np.array([size for _, size in reaches])[:, None] * self.sizes
        return {
            (one, other)
            for other, part in enumerate(self.parts)
            if other != one and np.any(part.vanishes_near(points, reach))
        }

    def _reach(self, atlas: Atlas, point: MeetingPoint) -> float:
        """How far from a singular point the forms through it are not known, over the
        sizes."""
        gaps = [point.point.error / float(self.sizes.min()), ROUNDING]
        for form, s in point.passes:
            branch = atlas.forms[form].branch
            if branch.outcome in (Outcome.STALLED, Outcome.ENDS_AT_A_POINT):
                gap = self.problem.domain.difference(branch(s), point.point.u)
                gaps.append(2.0 * float((np.abs(gap) / self.sizes).max()))
        return max(gaps)

    # --- the atlas --------------------------------------------------------------------

    def left_apart(
        self, passes: Sequence[_Pass], pairs: Sequence[tuple[int, int]]
    ) -> list[_Pass]:
        """The passes but for those of ``pairs`` of parts, which count as ``left``."""
        self.left += len({part for pair in pairs for part in pair})
        return [one for one in passes if (one.part, one.other) not in pairs]

    def atlas(self, passes: Sequence[_Pass]) -> Atlas:
        """The atlas of all parts with these passes of forms at other parts."""
        owned = [
            (part, number)
            for part, each in enumerate(self.parts)
            for number in range(len(each.forms))
        ]
        listed = [self.parts[part].forms[number] for part, number in owned]
        order = order_branches(self.problem, [form.branch for form in listed]).tolist()
        numbers = {owned[k]: new for new, k in enumerate(order)}
        clusters = self._clusters(passes)
        points = self._points(clusters, numbers)
        listed = [listed[k] for k in order]
        traced = self._looked_along(listed)
        forms = _forms(self.problem, listed, traced, points)
        return replace(
            self.parts[0].atlas,
            forms=forms,
            points=points,
            near_misses=self._near_misses(traced, points),
            dead_points=self._dead_points(numbers),
            rigid=np.concatenate([part.atlas.rigid for part in self.parts]),
            completeness=self._completeness(clusters, numbers, points),
            closure_gap=self._closure_gap(),
            provenance=self._provenance(),
        )

    def _points(
        self,
        clusters: Sequence[Sequence[_Pass]],
        numbers: Mapping[tuple[int, int], int],
    ) -> tuple[MeetingPoint, ...]:
        """The singular points of all parts, and where these cross."""
        own = [
            _renumbered(point, part, numbers)
            for part, each in enumerate(self.parts)
            for point in each.atlas.points
        ]
        domain = self.problem.domain
        periods = wrapped_periods(domain.periods, domain.bounds)
        met = self._crossings(clusters, numbers)
        return in_order(self.problem, [*met, *own], periods)

    def _provenance(self) -> Provenance:
        """How the atlas came about."""
        known = [part.atlas.provenance for part in self.parts]
        return replace(
            known[0],
            interrupted=any(one.interrupted for one in known),
            out_of_time=any(one.out_of_time for one in known) or self._is_late,
            equations=self.problem.accuracy.equations,
            seconds=sum(one.seconds for one in known),
        )

    def _clusters(self, passes: Sequence[_Pass]) -> list[list[_Pass]]:
        """The passes, those at one place together, the best known first."""
        if not passes:
            return []
        in_order = sorted(passes, key=lambda one: one.error)
        places = np.array([one.place for one in in_order])
        errors = np.array([one.error for one in in_order])
        tree = self._tree(places)
        clusters = []
        is_open = np.ones(len(places), dtype=bool)
        reaches = is_one_crossing.threshold * (errors + errors[-1])
        for k in range(len(places)):
            if not is_open[k]:
                continue
            beside = tree.query_ball_point(tree.data[k], reaches[k], p=np.inf)
            near = np.sort(np.array(beside))
            near = near[is_open[near]]
            apart = self._apart(places[near], places[k])
            members = near[is_one_crossing(apart, errors[near] + errors[k])]
            is_open[members] = False
            clusters.append([in_order[member] for member in members.tolist()])
        return clusters

    def _tree(self, places: np.ndarray) -> cKDTree:
        """The places (k, n) over the sizes, to be looked up by where they are."""
        from scipy.spatial import cKDTree  # few searches need it

        periods = self.problem.domain.periods
        is_circle = np.isfinite(periods)
        turns = np.where(is_circle, periods, 1.0)
        within = np.where(is_circle, places % turns, places)
        within = np.where(is_circle & (within >= turns), 0.0, within)
        around = np.where(is_circle, turns / self.sizes, 0.0)
        return cKDTree(within / self.sizes, boxsize=around)

    def _apart(self, places: np.ndarray, others: np.ndarray) -> np.ndarray:
        """How far places (k, n) are from others (k, n), over the sizes (k,)."""
        gaps = self.problem.domain.difference(places, others)
        apart: np.ndarray = (np.abs(gaps) / self.sizes).max(axis=1)
        return apart

    def _crossings(
        self,
        clusters: Sequence[Sequence[_Pass]],
        numbers: Mapping[tuple[int, int], int],
    ) -> list[MeetingPoint]:
        """The points at which the passes of clusters meet."""
        if not clusters:
            return []
        tree = self._tree(np.array([cluster[0].place for cluster in clusters]))
        apart = tree.query(tree.data, k=2, p=np.inf)[0][
            :, 1
        ]  # infinite of a single one
        radii = np.minimum(LONGEST_RADIUS, 0.25 * apart)
        return [
            self._crossing(cluster, float(radius), numbers)
            for cluster, radius in zip(clusters, radii, strict=True)
        ]

    def _crossing(
        self,
        cluster: Sequence[_Pass],
        radius: float,
        numbers: Mapping[tuple[int, int], int],
    ) -> MeetingPoint:
        """The point at which the passes of a cluster meet, ``radius`` sizes from
        others."""
        through: dict[tuple[int, int], float] = {}
        for each in cluster:
            through.setdefault((each.part, each.number), each.s)
        tangents = self._tangents(through)
        count = len(through)
        pairs = count * (count - 1) // 2
        domain = self.problem.domain
        point = SingularPoint(
            u=wrap(cluster[0].place, wrapped_periods(domain.periods, domain.bounds)),
            rank=0,
            null_space=np.eye(2),
            error=max(one.error for one in cluster) * float(self.sizes.max()),
            half_branches=np.concatenate([tangents, -tangents]),
            tangents=tangents,
            dimension=1,
            order=2,
            radius=radius * float(self.sizes.min()),
            invariants=Invariants(count, count, pairs, (1,) * pairs),
        )
        passes = tuple((numbers[key], s) for key, s in through.items())
        return MeetingPoint("", Kind.BIFURCATION, point, passes, tangents)

    def _tangents(self, through: Mapping[tuple[int, int], float]) -> np.ndarray:
        """Unit tangents (k, 2) of forms, by part and number, at arclengths."""
        tangents = np.array(
            [
                self.parts[part].forms[number].branch(s, 1)
                for (part, number), s in through.items()
            ]
        )
        unit: np.ndarray = tangents / np.linalg.norm(tangents, axis=1, keepdims=True)
        return unit

    @property
    def _is_late(self) -> bool:
        return self.left > 0 or self.is_cut

    def _closure_gap(self) -> float:
        """By how much the product is missed where it vanishes nowhere."""
        return min(part.atlas.closure_gap for part in self.parts)

    def _looked_along(self, forms: Sequence[Form]) -> list[TracedBranch]:
        """What is seen along forms, as far as there is time."""
        seen = made_in_time(lambda: [self._traced(form) for form in forms])
        self.is_cut = seen is None
        return [_not_looked_at(form) for form in forms] if seen is None else seen

    def _traced(self, form: Form) -> TracedBranch:
        """A form with what the singular value of the product does along it."""
        branch = form.branch
        profile = profile_branch(self.problem, branch)
        minima = singular_value_minima(self.problem, branch, profile)
        return TracedBranch(branch, profile, minima, located=())

    def _near_misses(
        self, traced: Sequence[TracedBranch], points: Sequence[MeetingPoint]
    ) -> tuple[Event, ...]:
        """The near misses of the product; where it is nearly singular to rounding, forms
        cross or one of them is singular, and all such points are known."""
        periods = wrapped_periods(
            self.problem.domain.periods, self.problem.domain.bounds
        )
        located = [point.point for point in points]
        events = near_misses_of(self.problem, traced, located, points, periods)
        return tuple(one for one in events if one.value > max(BLURRED, 2.0 * one.error))

    def _dead_points(self, numbers: Mapping[tuple[int, int], int]) -> tuple[Event, ...]:
        """The dead points of all forms, form by form."""
        events = [
            replace(event, form=numbers[part, event.form])
            for part, each in enumerate(self.parts)
            for event in each.atlas.dead_points
        ]
        return tuple(sorted(events, key=lambda event: event.form))

    # --- how sure it is ---------------------------------------------------------------

    def _completeness(
        self,
        clusters: Sequence[Sequence[_Pass]],
        numbers: Mapping[tuple[int, int], int],
        points: Sequence[MeetingPoint],
    ) -> Completeness:
        """What is claimed and doubted of all parts together."""
        known = [part.atlas.completeness for part in self.parts]
        doubts = [*self._doubts(numbers, points), *self._doubts_of(clusters)]
        missed = max(one.missed_probability for one in known)
        return Completeness(tuple(self._claims(known)), tuple(doubts), missed)

    def _claims(self, known: Sequence[Completeness]) -> Iterator[Claim]:
        """What is claimed of the parts."""
        levels = [worst_level(one.claims) or Level.ESTIMATED for one in known]
        if self._is_late:
            budget = float(self.parts[0].atlas.provenance.settings.budget)
            late = SearchClaim.FACTORS_LEFT
            yield late.claim(
                Scope.SEARCH, Level.OUT_OF_TIME, budget=budget, left=self.left
            )
        order = list(Level)
        worst = max(range(len(known)), key=lambda k: order.index(levels[k]))
        yield SearchClaim.FACTORS.claim(
            Scope.MOTIONS,
            levels[worst],
            factors=self.count,
            weakest="; ".join(claim.text for claim in known[worst].claims),
        )

    def _doubts(
        self,
        numbers: Mapping[tuple[int, int], int],
        points: Sequence[MeetingPoint],
    ) -> Iterator[Doubt]:
        """What is open about each part, with forms and points as they are called now."""
        names = [f"Form {number + 1}" for number in range(len(numbers))]
        for part, each in enumerate(self.parts):
            called = {
                point.name: _name_of(point.point, points) for point in each.atlas.points
            }
            for doubt in each.atlas.completeness.doubts:
                forms = tuple(numbers[part, form] for form in doubt.forms)
                subject = called.get(doubt.subject, doubt.subject)
                moved = replace(doubt, forms=forms, subject=subject)
                yield moved.naming(names)

    def _doubts_of(self, clusters: Sequence[Sequence[_Pass]]) -> Iterator[Doubt]:
        """Whether crossings are one."""
        if not clusters:
            return
        places = np.array([cluster[0].place for cluster in clusters])
        errors = np.array([cluster[0].error for cluster in clusters])
        reach = may_be_one_crossing.threshold * 2.0 * float(errors.max())
        pairs = self._tree(places).query_pairs(reach, p=np.inf, output_type="ndarray")
        one, other = pairs.T
        apart = self._apart(places[one], places[other])
        close = np.count_nonzero(
            may_be_one_crossing(apart, errors[one] + errors[other])
        )
        if close:
            yield SearchDoubt.CROSSINGS_TOGETHER.doubt(count=int(close))


def _not_looked_at(form: Form) -> TracedBranch:
    """A form along which there was no time to look."""
    return TracedBranch(
        form.branch, form.profile, (np.empty(0), np.empty(0)), located=()
    )


def _renumbered(
    point: MeetingPoint, part: int, numbers: Mapping[tuple[int, int], int]
) -> MeetingPoint:
    """A point of a part, with the forms as they are numbered now."""
    passes = tuple((numbers[part, form], s) for form, s in point.passes)
    return replace(point, passes=passes)


def _name_of(point: SingularPoint, points: Sequence[MeetingPoint]) -> str:
    """What a singular point of a part is called now."""
    (name,) = [one.name for one in points if one.point is point]
    return name


def _forms(
    problem: FunctionProblem,
    forms: Sequence[Form],
    traced: Sequence[TracedBranch],
    points: Sequence[MeetingPoint],
) -> tuple[Form, ...]:
    """The forms as they are numbered now, with their components, and the singular values
    of the product along them."""
    components = component_numbers(len(forms), points)
    singular = {form for point in points for form, _ in point.passes}
    return tuple(
        replace(
            form,
            name=f"Form {index + 1}",
            profile=seen.profile,
            component=component,
            min_singular_value=0.0
            if index in singular
            else smallest_value(problem, seen),
        )
        for index, (form, seen, component) in enumerate(
            zip(forms, traced, components, strict=True)
        )
    )
