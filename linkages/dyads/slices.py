"""All configurations of a mechanism with one joint at given values, and what
they say of its motions.

Where dyads build the mechanism from a driver (`linkages.dyads.plan`), every
configuration at a value of the driver is known, and a motion on which the driver passes
that value cannot be missed. A motion on which it stands still needs a dyad that closes
in a whole curve of configurations. Where no driver is of that use, larger groups build
the mechanism from two drivers, one at a time, that no motion leaves standing both.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.completeness import Claim, Level, Scope
from bifurc.decisions import is_singular_path_end
from bifurc.problem import Problem
from bifurc.seeds import Audit
from linkages.dyads.build import Builder, Geometry, TooManyError
from linkages.dyads.generic import UnfollowedError
from linkages.dyads.geometry import DegenerateDyadError, PlaneGeometry
from linkages.dyads.pinned import GenericCount, are_held_by_pins
from linkages.dyads.plan import Plan, make_plan
from linkages.dyads.space import SpaceGeometry
from linkages.statements import LinkageClaim, random_assemblies
from linkages.structure.placement import Placement
from linkages.structure.plane import normal_of_plane
from linkages.structure.structure import Structure, Unknown

SLICES = 36  # of a driver's period, or of its limits
MOST_DRIVERS = 4
MOST_POINTS = 20_000  # in the slices of a driver, with whole turns within limits
TURN = 2 * math.pi
MOST_TRIED = 16  # variables that are looked at as drivers


class _Slice(NamedTuple):
    """What is built at all values of a driver: ``points`` (k, n), whether the driver
    ``always_moves`` on a motion, how far apart, rad or the structure's unit, the
    values are (``step``), and how many configurations of larger groups were ``followed``
    at each."""

    points: np.ndarray
    always_moves: bool
    step: float
    followed: GenericCount | None


@dataclass(frozen=True, eq=False)
class DyadSlices:
    """Configurations ``starts`` (k, n) of a ``structure``, all that there are at the
    values of some ``drivers``, numbers of unknowns, ``step`` apart.

    ``misses_none``: a motion that is not among them is a small one. ``counts``: how
    many complex configurations there are at a value of every driver, or without one,
    where these were followed along paths, with the ``trace`` test of them; none where
    dyads do. Without a driver so many of them may be ``singular``, which are left out, and
    on motions of which nothing is known.
    """

    structure: Structure
    starts: np.ndarray
    drivers: tuple[int, ...]
    steps: tuple[float, ...]
    misses_none: bool
    counts: tuple[int, ...] = ()
    trace: float = 0.0
    singular: int = 0

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """How sure it is that no motion is missing: the search has traced one through
        every configuration in the slices."""
        nowhere = np.empty((0, len(self.structure.unknowns)))
        if not self.drivers:
            has_all = bool(self.counts) and not self.singular
            return Audit((self._claim_of_assemblies(),), nowhere, has_all)
        return Audit((self._claim_of_motions(), random_assemblies()), nowhere)

    def _claim_of_motions(self) -> Claim:
        """That motions on which a driver passes a slice are here."""
        if self.counts:
            return LinkageClaim.GROUPS.claim(
                Scope.MOTIONS,
                Level.CERTIFIED,
                moves=self._moves(),
                complex=" and ".join(map(str, sorted(set(self.counts)))),
                trace=self.trace,
            )
        kind, level = LinkageClaim.DYADS, Level.CERTIFIED
        if not self.misses_none:
            kind, level = LinkageClaim.DYADS_MISSING, Level.ESTIMATED
        return kind.claim(Scope.MOTIONS, level, moves=self._moves())

    def _claim_of_assemblies(self) -> Claim:
        """That all assemblies of what nothing moves are here."""
        if not self.counts:
            return LinkageClaim.ALL_BUILT.claim(Scope.MOTIONS, Level.CERTIFIED)
        followed = {"complex": self.counts[0], "trace": self.trace}
        if self.singular:
            return LinkageClaim.REGULAR_OF_GROUPS.claim(
                Scope.ASSEMBLIES, None, singular=self.singular, **followed
            )
        return LinkageClaim.ALL_OF_GROUPS.claim(
            Scope.MOTIONS, Level.CERTIFIED, real=len(self.starts), **followed
        )

    @property
    def leaves_motions_open(self) -> bool:
        """Whether nothing is said of motions, but of all regular assemblies."""
        return bool(self.singular)

    def _moves(self) -> str:
        """On which motions a driver passes a slice, as text."""
        ways: dict[str, list[str]] = {}
        for driver, step in zip(self.drivers, self.steps, strict=True):
            unknown = self.structure.unknowns[driver]
            if unknown.is_angle:
                way = f"turns by more than {np.degrees(step):.4g} degrees"
            else:
                way = f"slides by more than {step * self.structure.unit:.4g}"
            ways.setdefault(way, []).append(unknown.label)
        parts = [f"{' or '.join(labels)} {way}" for way, labels in ways.items()]
        return f"on which {', or '.join(parts)}"


def built_at_once(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> DyadSlices | None:
    """All assemblies of the mechanism of a ``structure`` that nothing moves; None where
    dyads and larger groups in a plane do not build it."""
    geometry = _geometry(structure)
    if geometry is None or follows_many_turns(structure):
        return None
    plan = make_plan(structure.mechanism, (), with_groups=True)
    if plan is None:
        return None
    try:
        return _built(Builder(structure, geometry, plan))
    except TooManyError:
        return None


def pins_hold_all(structure: Structure) -> bool:
    """Whether dyads and groups of bodies on pins build the mechanism of a ``structure``
    that nothing moves: where these do not find all assemblies, no other paths do."""
    geometry = _geometry(structure)
    plan = make_plan(structure.mechanism, (), with_groups=True)
    if geometry is None or not geometry.has_pins or plan is None:
        return False
    return are_held_by_pins(plan, geometry.is_spherical)


def for_subject(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> DyadSlices | None:
    """Slices of the mechanism of a ``structure`` at evenly spaced values, the first one
    drawn, of a few of its variables; None where dyads do not build it, or build too
    many configurations."""
    geometry = _geometry(structure)
    if geometry is None or follows_many_turns(structure):
        return None
    if make_plan(structure.mechanism, ()) is not None:
        return None
    try:
        slices = _slices_of_dyads(structure, geometry, rng)
        if not slices and geometry.has_pins:
            slices = _slices_of_groups(structure, geometry, rng)
    except TooManyError:
        return None
    return _joined(structure, slices) if slices else None


def _joined(structure: Structure, slices: Mapping[int, _Slice]) -> DyadSlices:
    """All slices, by the number of the unknown that drives."""
    parts = slices.values()
    counts = [one.followed for one in parts if one.followed is not None]
    always_moves = any(one.always_moves for one in parts) or bool(counts)
    return DyadSlices(
        structure,
        np.concatenate([one.points for one in parts]),
        tuple(slices),
        tuple(one.step for one in parts),
        misses_none=always_moves or len(slices) == len(structure.unknowns),
        counts=tuple(one.ways for one in counts),
        trace=max((one.trace for one in counts), default=0.0),
    )


def _built(builder: Builder) -> DyadSlices | None:
    """The assemblies of what nothing moves; None where it is not known that they are
    all."""
    try:
        points = _points_at(builder, None, (0.0,))
    except UnfollowedError:
        return None
    if points is None:
        return None
    count = builder.generic_count()
    return DyadSlices(
        builder.structure,
        points,
        (),
        (),
        misses_none=True,
        counts=(count.ways,) if count else (),
        trace=count.trace if count else 0.0,
        singular=builder.singular,
    )


def _geometry(structure: Structure) -> Geometry | None:
    """That of the plane in which all moves, else that of turns in space, or on a
    sphere; None where other joints move, too."""
    mechanism = structure.mechanism
    normal = normal_of_plane(mechanism)
    if normal is not None:
        return PlaneGeometry(normal, structure.unit)
    motions = [one.motion for one in mechanism.variables if one.locked is None]
    is_free = any(pair.center is not None for pair in mechanism.pairs)
    if is_free or any(not one.is_turn or one.advance for one in motions):
        return None
    given = [one.motion for one in mechanism.variables if one.locked != 0.0]
    placement = Placement.of_chain(given, structure.unit)
    is_on_sphere = placement.is_spherical and all(one.is_turn for one in given)
    return SpaceGeometry(structure.unit, placement.origin if is_on_sphere else None)


def stands(problem: Problem, structure: Structure) -> bool:
    """Whether nothing moves about the closed configuration next to the reference, not
    even to first order: else paths would end there at a singular one."""
    points, _ = problem.project(structure.reference[None])
    (matrix,) = problem.jacobians(points)
    sizes = np.linalg.norm(matrix, axis=1, keepdims=True)
    rows = matrix / np.where(sizes > 0.0, sizes, 1.0)
    values = np.linalg.svd(rows, compute_uv=False)
    if len(values) < problem.n:
        return False
    return not is_singular_path_end(float(values[-1] / values[0]))


def follows_many_turns(structure: Structure) -> bool:
    """Whether something follows an angle that may turn by more than a full turn within
    its limits: it is elsewhere after each."""
    columns = list(structure.column_of.values())
    return any(
        unknown.is_angle
        and unknown.period == np.inf
        and unknown.high - unknown.low > TURN
        and columns.count(number) > 1
        for number, unknown in enumerate(structure.unknowns)
    )


def _slices_of_dyads(
    structure: Structure, geometry: Geometry, rng: np.random.Generator
) -> dict[int, _Slice]:
    """The slices of unknowns, by number, from which dyads build the mechanism: of a few
    where one of them always moves, else of all."""
    slices: dict[int, _Slice] = {}
    always_moves = False
    for number, unknown in enumerate(structure.unknowns[:MOST_TRIED]):
        plan = make_plan(structure.mechanism, (unknown.variable,))
        if plan is None:
            continue
        one = _slice(Builder(structure, geometry, plan), number, rng)
        if one is None:
            continue
        slices[number] = one
        always_moves = always_moves or one.always_moves
        if always_moves and len(slices) >= MOST_DRIVERS:
            break
    return slices


def _slices_of_groups(
    structure: Structure, geometry: Geometry, rng: np.random.Generator
) -> dict[int, _Slice]:
    """The slices of a few unknowns, by number, from which larger groups build the
    mechanism, and of which one moves on every motion; none where that is not known."""
    plans: dict[int, Plan] = {}
    for number, unknown in enumerate(structure.unknowns[:MOST_TRIED]):
        plan = make_plan(structure.mechanism, (unknown.variable,), with_groups=True)
        if plan is not None and are_held_by_pins(plan, geometry.is_spherical):
            plans[number] = plan
    slices: dict[int, _Slice] = {}
    while drivers := _that_move(structure, geometry, plans):
        left = [one for one in drivers if one not in slices]
        if not left:
            return {one: slices[one] for one in drivers}
        number = left[0]
        found = _slice(Builder(structure, geometry, plans[number]), number, rng)
        if found is None:
            del plans[number]
        else:
            slices[number] = found
    return {}


def _that_move(
    structure: Structure, geometry: Geometry, plans: Mapping[int, Plan]
) -> tuple[int, ...]:
    """The unknowns, of those with ``plans`` with the least groups, of which one moves
    on every motion: where they stand still, dyads build all. None where there are not
    such."""
    order = sorted(plans, key=lambda number: plans[number].largest_group)
    for count in range(2, MOST_DRIVERS + 1):
        for numbers in itertools.combinations(order, count):
            variables = [structure.unknowns[number].variable for number in numbers]
            plan = make_plan(structure.mechanism, variables)
            if plan is None:
                continue
            builder = Builder(structure, geometry, plan)
            if builder.is_never_degenerate(_values(structure, None, 0.0)):
                return numbers
    return ()


def _slice(builder: Builder, number: int, rng: np.random.Generator) -> _Slice | None:
    """That of an unknown, by number; None where it is not known that it has all
    configurations."""
    structure = builder.structure
    places, step = places_of_slices(structure.unknowns[number], rng)
    try:
        points = _points_at(builder, number, places)
        count = builder.generic_count()
    except UnfollowedError:
        return None
    if points is None:
        return None
    at_first = _values(structure, number, places[0])
    always_moves = builder.is_never_degenerate(at_first)
    return _Slice(points, always_moves, step, count)


def places_of_slices(
    unknown: Unknown, rng: np.random.Generator
) -> tuple[list[float], float]:
    """Evenly spaced values of an unknown, the first one drawn, and their distance, in
    rad or the structure's unit."""
    low, high = unknown.low, unknown.high
    if np.isfinite(unknown.period):
        low, high = 0.0, unknown.period
    elif unknown.is_angle:
        # what is a turn away is the same configuration
        high = min(high, low + TURN)
    step = (high - low) / SLICES
    places = low + step * (np.arange(SLICES) + rng.uniform())
    return places.tolist(), step


def _values(structure: Structure, number: int | None, place: float) -> list[float]:
    """The values of all variables where an unknown, by number, is at a ``place``, rad
    and the user's unit; 0 for those that are not known."""
    point = np.zeros((1, len(structure.unknowns)))
    if number is not None:
        point[0, number] = place
    count = len(structure.mechanism.variables)
    return [float(structure.values(point, variable)[0]) for variable in range(count)]


def _points_at(
    builder: Builder, driver: int | None, places: Iterable[float]
) -> np.ndarray | None:
    """The configurations (k, n) within the limits at the ``places`` of a driver, by
    number; None where it is not known that they are all. Raises `TooManyError`."""
    points = []
    for place in places:
        values = _values(builder.structure, driver, place)
        try:
            states = builder.configurations(values)
        except DegenerateDyadError:
            return None
        if driver is not None and builder.singular:
            return None
        for poses in states:
            point = builder.unknowns(poses)
            if driver is not None:
                point[driver] = place
            points += within_limits(builder.structure, point)
            if len(points) > MOST_POINTS:
                raise TooManyError
    return np.array(points).reshape(-1, len(builder.structure.unknowns))


def within_limits(structure: Structure, point: np.ndarray) -> list[np.ndarray]:
    """The configurations (n,) within the limits that are ``point`` (n,) but for whole
    turns of limited angles, somewhat more of them than are wanted at most."""
    turning, turns = [], []
    for number, unknown in enumerate(structure.unknowns):
        if np.isfinite(unknown.period) or not np.isfinite(unknown.high):
            continue
        low, high = unknown.low - point[number], unknown.high - point[number]
        if unknown.is_angle:
            turning.append(number)
            first, last = math.ceil(low / TURN), math.floor(high / TURN)
            turns.append(range(first, last + 1))
        elif not low <= 0.0 <= high:
            return []
    points = []
    for counts in itertools.islice(itertools.product(*turns), MOST_POINTS + 1):
        moved = point.copy()
        moved[turning] += TURN * np.array(counts)
        points.append(moved)
    return points
