"""The values of a parameter at which the map of a family changes.

Members over the range are mapped. Where a map has a near miss, the equations of a
bifurcation with the parameter among the unknowns are solved from there: that is a value at
which a bifurcation appears. Bifurcations that are there all along are followed; where the
parameter turns back two of them are born. Where the angle of a joint changes along a form
the less the nearer a value is, the equations of a joint at rest are solved. Random starts,
with the parameter among the unknowns, reach motions that are there at one value alone.
Between members with different maps and no such value, further ones are mapped.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from functools import partial
from itertools import pairwise

import numpy as np

from bifurc import torus
from bifurc.atlas import Atlas
from bifurc.decisions import is_null, is_same_point, is_start_solved
from bifurc.equations.expression_problem import TapeProblem
from bifurc.following.rest_problem import RestProblem, rest_problems
from bifurc.following.singular_problem import SingularPointProblem
from bifurc.limits import CutOff, Deadline, current_deadline, cut_off_after, until
from bifurc.numerics.null_spaces import null_spaces
from bifurc.parametrised import ParametrisedProblem
from bifurc.seeding import start_region
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from linkages.parameters.member_search import MapShape, MemberSearch, TimeIsOver
from linkages.parameters.members import Members

MEMBERS = 24  # that are mapped over the range at first
LOOKED_AT = 3  # every one of so many of them is looked at more closely
# of their spacing: members at the ends or in the middle are special
OFF_CENTRE, OFF_END = 0.618, 0.02
HALVINGS = 12  # of an interval whose ends have different maps
BESIDE = 1e-3  # of the range, or less: how far from a value maps are compared
REST_REACH = 1.5  # of their spacing: so far from a member a rest is looked for
NEARBY = 1e-4  # rad: beside a special value points move with the root of a rounding
STARTS, SEED = 96, 0  # from which motions at one value alone are looked for
ROUNDING = 4e-16  # of a place, that doubles leave


class ChangeKind(Enum):
    """How a value was found at which a map changes."""

    # The equations of a singular point hold at this value alone.
    SINGULAR = "singular point"
    # Two bifurcations that are there on one side are one there.
    BIRTH = "birth"
    # Joints have one angle all along a form at this value alone.
    REST = "rest"
    # The members move, or move in more ways, at this value alone.
    MOTION = "motion"
    # Maps on both sides differ; no equation was found that says why.
    BETWEEN_MAPS = "between maps"


WORDS = {
    ChangeKind.SINGULAR: "at this value alone there is a singular point",
    ChangeKind.BIRTH: "two singular points become one",
    ChangeKind.REST: "at this value alone a joint rests along a form",
    ChangeKind.MOTION: "at this value alone there is a motion",
    ChangeKind.BETWEEN_MAPS: "maps beside it differ, for a reason that was not found",
}


@dataclass(frozen=True, eq=False)
class MapChange:
    """The map changes at this ``value`` of the parameter, known to ``error``: the
    ``kind`` says why, in a configuration ``u`` (n,) where there is one, and with the
    ``joints`` that rest along a form at this value alone; the maps ``before``,
    ``at`` the value and ``after`` it, None where there is no member; the ``problem`` whose
    ``solution`` it is, None where there is none."""

    value: float
    error: float
    kind: ChangeKind
    u: np.ndarray | None
    before: MapShape | None = None
    at: MapShape | None = None
    after: MapShape | None = None
    point: Kind | None = None
    joints: tuple[str, ...] = ()
    problem: SingularPointProblem | RestProblem | None = None
    solution: np.ndarray | None = None

    @property
    def what(self) -> str:
        """What happens there, in words."""
        words = WORDS[self.kind]
        if self.joints:
            words += f" ({', '.join(self.joints)})"
        is_of_maps = self.kind in (ChangeKind.BETWEEN_MAPS, ChangeKind.MOTION)
        if is_of_maps or self.at is None:
            return words
        if self.kind is ChangeKind.REST:
            at_rest = {joint for form in self.at.at_rest for joint in form}
            is_listed = at_rest.issuperset(self.joints)
        else:
            is_listed = self.point is not None
        if not is_listed:
            return f"{words}, which the map there does not list"
        return (
            words if self.point is None else f"{words}, of the kind {self.point.value}"
        )


@dataclass
class _SpecialSearch(MemberSearch):
    """The changes found so far, the ``shapes`` of the maps that were made, by their
    values, the maps ``at`` changes and how far from these others were made."""

    shapes: dict[float, MapShape | None] = field(default_factory=dict)
    changes: list[MapChange] = field(default_factory=list)
    at: dict[float, Atlas | None] = field(default_factory=dict)
    beside: dict[float, float] = field(default_factory=dict)

    @property
    def range(self) -> tuple[float, float]:
        """From where to where the parameter goes."""
        low, high = self.members.problem.parameters.bounds[0].tolist()
        return low, high

    @property
    def apart(self) -> float:
        """How far apart neighbouring maps are at most, the ends of the range among
        them."""
        return float(np.diff(sorted([*self.range, *self.shapes])).max())

    def look_over_range(self) -> None:
        """Look at members over the whole range."""
        low, high = self.range
        places = [OFF_END, *(k + OFF_CENTRE for k in range(MEMBERS)), MEMBERS - OFF_END]
        for k, place in enumerate(places):
            value = low + (high - low) * place / MEMBERS
            self.look_at(value, closely=k % LOOKED_AT == 0)
        self._from_random_starts()

    def look_at(self, value: float, closely: bool = True) -> None:
        """Map the member at a value, and look for changes from there; where not
        ``closely`` only from near misses."""
        if value in self.shapes:
            return
        atlas = self.map_at(np.array([value]))
        self.shapes[value] = self.shape(atlas)
        if atlas is None:
            return
        p = np.array([value])
        for u, nullity in self.starts(atlas, closely):
            self._from(u, p, nullity)
        self._from_forms(atlas, value)

    def look_beside(self, change: MapChange) -> None:
        """Map the member at a change, and those on both sides of it."""
        value = change.value
        if value in self.beside:
            return
        low, high = self.range
        others = [one.value for one in self.changes if one.value != value]
        room = min(abs(value - other) for other in (*others, low, high))
        step = max(min(BESIDE * (high - low), room / 3.0), 2.0 * change.error)
        self.at[value] = self.map_at(np.array([value]))
        for other in (value - step, value + step):
            self.look_at(other)
        self.beside[value] = step

    def compared(self, change: MapChange) -> MapChange:
        """A change with the maps beside it and at the value itself, as far as these were
        made."""
        value = change.value
        step = self.beside.get(value)
        atlas = self.at.get(value)
        return replace(
            change,
            before=None if step is None else self.shapes[value - step],
            at=self.shape(atlas),
            after=None if step is None else self.shapes[value + step],
            point=None if atlas is None else self._kind_at(atlas, change),
        )

    def _kind_at(self, atlas: Atlas, change: MapChange) -> Kind | None:
        """The kind of the singular point of the atlas at a change where its configuration
        is, as near as parameters of this many digits lead to it; None where there is
        none."""
        if change.u is None:
            return None
        p = np.array([change.value])
        for point in atlas.points:
            (own,) = self.members.in_equations(point.point.u[None], p)
            gap = torus.difference(own, change.u, atlas.periods)
            if np.linalg.norm(gap) < NEARBY:
                return point.kind
        return None

    def _from(self, u: np.ndarray, p: np.ndarray, nullity: int) -> None:
        """Solve the equations of a singular point from a configuration (n,) of a member;
        one that is there over a range is followed, and where the parameter turns back the
        map changes."""
        solved = self.solve(u, p, nullity)
        if solved is None:
            return
        problem, value = solved.problem, float(solved.p[0])
        sigma, _ = null_spaces(problem, solved.point[None])
        if not np.any(is_null(sigma[0])):
            size = float(problem.sizes[-1])
            error = ROUNDING * (size + abs(value)) / float(sigma[0, -1])
            change = MapChange(value, error, ChangeKind.SINGULAR, solved.u)
            self._add(replace(change, problem=problem, solution=solved.point))
            return
        curve = self.follow(solved)
        for place in () if curve is None else curve.places:
            value, kind = float(place.p[0]), ChangeKind.BIRTH
            self._add(MapChange(value, place.error, kind, place.u))

    def _from_forms(self, atlas: Atlas, value: float) -> None:
        """Solve the equations of a joint at rest from the forms of a member."""
        low, high = self.range
        reach = REST_REACH * (high - low) / MEMBERS
        for form in atlas.forms:
            p = np.array([value])
            recounted = partial(self.members.in_equations, p=p)
            for problem in rest_problems(
                self.members.problem, form.branch, p, reach, recounted
            ):
                self._from_rest(problem)

    def _from_rest(self, problem: RestProblem) -> None:
        """Solve the equations of a joint at rest."""
        points, gaps = problem.project(problem.start[None])
        found = float(points[0, -1])
        low, high = self.range
        if not (is_start_solved(float(gaps[0])) and low < found < high):
            return
        _, sigma, right = np.linalg.svd(
            problem.jacobians(points)[0], full_matrices=False
        )
        if is_null(float(sigma[-1]), problem.magnitude):
            return  # it rests along the forms of other members as well
        lever = float(np.linalg.norm(right[:, -1] / sigma))
        error = ROUNDING * (abs(found) + lever * problem.magnitude)
        joints = (self.members.joint(problem.resting),)
        change = MapChange(found, error, ChangeKind.REST, None, joints=joints)
        self._add(replace(change, problem=problem, solution=points[0]))

    def _from_random_starts(self) -> None:
        """Look for values at which alone there is a motion: there the closure, with the
        parameter among the unknowns, leaves the parameter no way to go."""
        own, sizes = self.members.problem, self.members.problem.sizes
        weights = np.ones(len(own.tape.outputs))
        problem = TapeProblem(
            own.tape.in_units(np.zeros(len(sizes)), sizes, weights),
            _region(own) / sizes[:, None],
            names=(*own.domain.names, *own.parameters.names),
        )
        rng = np.random.default_rng(SEED)
        points = problem.seeds(rng, STARTS, self.deadline).points
        for point, jacobian in zip(points, problem.jacobians(points), strict=True):
            if _is_held(jacobian):
                inverse = np.linalg.pinv(jacobian, rcond=float(is_null.threshold))
                value = float(point[-1] * sizes[-1])
                lever = float(sizes[-1] * np.linalg.norm(inverse[-1]))
                error = ROUNDING * (abs(value) + lever)
                # lengths that are rounding beside others of 0 have a map of their own
                self._from_motion(0.0 if abs(value) <= error else value, error)

    def _from_motion(self, value: float, error: float) -> None:
        """Map the member at a value at which alone there may be a motion."""
        low, high = self.range
        known = [*self.at, *(one.value for one in self.changes)]
        if any(is_same_point(abs(value - other), high - low) for other in known):
            return
        atlas = self.at[value] = self.map_at(np.array([value]))
        beside = sorted(self.shapes, key=lambda one: abs(one - value))[:2]
        if self.shape(atlas) not in [self.shapes[one] for one in beside]:
            self._add(MapChange(value, error, ChangeKind.MOTION, None))

    def _add(self, change: MapChange) -> None:
        low, high = self.range
        for k, one in enumerate(self.changes):
            if is_same_point(abs(one.value - change.value), high - low):
                first = change if one.kind is ChangeKind.REST else one
                joints = tuple(sorted({*one.joints, *change.joints}))
                self.changes[k] = replace(first, value=one.value, joints=joints)
                return
        self.changes.append(change)


@dataclass(frozen=True, eq=False)
class SpecialValues:
    """The ``changes`` that were found, in order, whether the search ``is_whole``: not
    ended by Ctrl-C or a deadline, and how far ``apart`` maps were made at most."""

    changes: tuple[MapChange, ...]
    is_whole: bool
    apart: float


def special_values(
    members: Members,
    settings: SearchSettings | None = None,
    deadline: Deadline | None = None,
) -> SpecialValues:
    """The values of the only free parameter, within its range, at which the map of the
    ``members`` changes.

    Between two neighbouring changes all maps that were made are alike. What shows on none
    of them, as a form that is there over a short range only, is among the changes only
    where its equations were solved from a map nearby.

    >>> import linkages
    >>> from linkages.catalogue import entry
    >>> family = entry("four-bar")
    >>> members = linkages.Members(family, family.defaults, {"d": (3.0, 3.7)})
    >>> [round(change.value, 12) for change in linkages.special_values(members).changes]
    [3.4]
    """
    search = _SpecialSearch(
        members, settings or SearchSettings(certify=False), deadline
    )
    is_whole = True
    end = deadline or current_deadline()
    try:
        with until(end), cut_off_after(end):
            search.look_over_range()
            _settle(search)
    except (KeyboardInterrupt, TimeIsOver, CutOff):
        is_whole = False
    changes = sorted(search.changes, key=lambda change: change.value)
    return SpecialValues(tuple(map(search.compared, changes)), is_whole, search.apart)


def _settle(search: _SpecialSearch) -> None:
    """Look beside every change and at it, and between maps that differ without one, until
    nothing new comes of it."""
    known = -1
    while known < len(search.changes):
        known = len(search.changes)
        for change in list(search.changes):
            search.look_beside(change)
        for first, last in list(pairwise(sorted(search.shapes))):
            _explain(search, first, last, HALVINGS)


def _explain(search: _SpecialSearch, first: float, last: float, halvings: int) -> None:
    """Find why the maps at two values differ, by maps between them."""
    if search.shapes[first] == search.shapes[last]:
        return
    if any(first <= change.value <= last for change in search.changes):
        return
    middle = 0.5 * (first + last)
    if not halvings:
        error, kind = 0.5 * (last - first), ChangeKind.BETWEEN_MAPS
        search.changes.append(MapChange(middle, error, kind, None))
        return
    search.look_at(middle)
    _explain(search, first, middle, halvings - 1)
    _explain(search, middle, last, halvings - 1)


def _region(problem: ParametrisedProblem) -> np.ndarray:
    """From where to where unknowns and parameters (n + q, 2) are drawn."""
    return np.concatenate([start_region(problem), problem.parameters.bounds])


def _is_held(jacobian: np.ndarray) -> bool:
    """Whether the last unknown stands still, to first order, while others move."""
    ranks = []
    for matrix in (jacobian[:, :-1], jacobian):
        sigma = np.linalg.svd(matrix, compute_uv=False)
        is_zero = [is_null(float(one), float(sigma[0])) for one in sigma]
        ranks.append(is_zero.count(False))
    return bool(ranks[1] == ranks[0] + 1 < jacobian.shape[1])
