"""An atlas in other unknowns: those that it has in another order, with other signs, and
counted from elsewhere; or in other units.

In an isometry all lengths stay what they are, so that curves keep their arclengths and
pieces: no piece is made again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, NearMotion, Surface
from bifurc.branch import Branch
from bifurc.errors import ProblemError
from bifurc.surfaces.factor import Factor
from bifurc.torus import whole_turns, wrap


class Course(NamedTuple):
    """A curve in other unknowns, and what gives its arclengths (...) where the former
    ones are (...)."""

    branch: Branch
    arclengths: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Unknowns:
    """Other unknowns of an atlas, and what gives in them points (..., n), unit vectors
    (..., n), orthonormal bases (..., n, k), one a column, curves, and the number, from 0,
    of a former unknown. Lengths are at most ``size`` times as large in them."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    periods: np.ndarray
    points: Callable[[np.ndarray], np.ndarray]
    directions: Callable[[np.ndarray], np.ndarray]
    bases: Callable[[np.ndarray], np.ndarray]
    course: Callable[[Branch], Course]
    index: Callable[[int], int]
    size: float = 1.0


@dataclass(frozen=True, eq=False)
class Isometry:
    """New unknown j is ``signs[j]`` (1 or -1) times that by which old unknown
    ``columns[j]`` exceeds ``origin[j]``; all (n,). Raises `ProblemError` where
    ``columns`` is no permutation or a sign is another number."""

    columns: np.ndarray
    signs: np.ndarray
    origin: np.ndarray

    def __post_init__(self) -> None:
        count = len(self.columns)
        if not np.array_equal(np.sort(self.columns), np.arange(count)):
            allowed = f"a permutation of 0 to {count - 1}"
            raise ProblemError("columns", self.columns, allowed)
        if np.shape(self.signs) != (count,) or np.any(np.abs(self.signs) != 1):
            raise ProblemError("signs", self.signs, f"{count} numbers, 1 or -1")
        if np.shape(self.origin) != (count,):
            raise ProblemError("origin", self.origin, f"{count} numbers")

    @staticmethod
    def identity(count: int) -> Isometry:
        """The isometry that leaves so many unknowns as they are."""
        return Isometry(np.arange(count), np.ones(count), np.zeros(count))

    @property
    def inverse(self) -> Isometry:
        """The isometry from the new unknowns to the old ones."""
        columns = np.argsort(self.columns)
        origin = -self.signs * self.origin
        return Isometry(columns, self.signs[columns], origin[columns])

    def points(self, points: np.ndarray) -> np.ndarray:
        """Points (..., n) in the new unknowns."""
        chosen = np.take(points, self.columns, axis=-1)
        recounted: np.ndarray = self.signs * (chosen - self.origin)
        return recounted

    def directions(self, vectors: np.ndarray) -> np.ndarray:
        """Directions (..., n), or whole turns, in the new unknowns."""
        recounted: np.ndarray = self.signs * np.take(vectors, self.columns, axis=-1)
        return recounted

    def index(self, index: int) -> int:
        """The number, from 0, of the new unknown that the old one of this number is."""
        return int(np.flatnonzero(self.columns == index)[0])

    def branch(self, branch: Branch) -> Branch:
        """A branch in the new unknowns; a periodic one begins within half a period of
        0."""
        periods = branch.periods[self.columns]
        pieces = self.directions(branch.pieces)
        recounted = replace(branch, pieces=pieces, periods=periods)
        if not len(pieces):
            return recounted
        pieces[:, 0] -= self.signs * self.origin
        start = recounted(0.0)
        turns = whole_turns(start - wrap(start, periods), periods)
        turning = turns != 0
        pieces[:, 0, turning] -= turns[turning] * periods[turning]
        return replace(recounted, pieces=pieces)


def recount_atlas(atlas: Atlas, isometry: Isometry, names: Sequence[str]) -> Atlas:
    """The atlas in the new unknowns of an isometry, which have these ``names``.

    Periodic unknowns of points lie within half a period of 0 then, wherever bounds were.
    What whoever knows more than the equations said, ``subject`` and ``labels``, stays as
    it is. Raises `ProblemError` for an atlas with a diagram, whose parameter is an
    unknown of its own.
    """
    if atlas.diagram is not None:
        raise ProblemError("atlas", "one with a diagram", "an atlas without one")
    if len(isometry.columns) != len(atlas.names) or len(names) != len(atlas.names):
        allowed = f"names and an isometry of {len(atlas.names)} unknowns"
        raise ProblemError("names", list(names), allowed)
    columns, signs = isometry.columns, isometry.signs
    periods = atlas.periods[columns]
    unknowns = Unknowns(
        names=tuple(names),
        units=tuple(atlas.units[column] for column in columns),
        periods=periods,
        points=lambda points: wrap(isometry.points(points), periods),
        directions=isometry.directions,
        bases=lambda bases: signs[:, None] * np.take(bases, columns, axis=-2),
        course=lambda branch: Course(isometry.branch(branch), lambda s: s),
        index=isometry.index,
    )
    return atlas_in(atlas, unknowns)


# --- what an atlas is made of ---------------------------------------------------------


def atlas_in(atlas: Atlas, unknowns: Unknowns) -> Atlas:
    """An atlas in other unknowns."""
    courses = [unknowns.course(form.branch) for form in atlas.forms]
    forms = zip(atlas.forms, courses, strict=True)
    return replace(
        atlas,
        names=unknowns.names,
        units=unknowns.units,
        periods=unknowns.periods,
        forms=tuple(_form(form, course, unknowns.size) for form, course in forms),
        points=tuple(_meeting_point(p, courses, unknowns) for p in atlas.points),
        near_misses=tuple(_event(e, courses, unknowns) for e in atlas.near_misses),
        dead_points=tuple(_event(e, courses, unknowns) for e in atlas.dead_points),
        rigid=unknowns.points(atlas.rigid),
        surfaces=tuple(_surface(surface, unknowns) for surface in atlas.surfaces),
        near_motions=tuple(_near_motion(near, unknowns) for near in atlas.near_motions),
    )


def _form(form: Form, course: Course, size: float) -> Form:
    certificate = form.certificate
    if certificate is not None:
        # a bound is known in units of one size only
        certificate = replace(
            certificate,
            gaps=course.arclengths(certificate.gaps),
            blurred=course.arclengths(certificate.blurred),
            bound=certificate.bound / size,
        )
    arclength = course.arclengths(form.profile.arclength)
    profile = replace(form.profile, arclength=arclength)
    return replace(form, branch=course.branch, profile=profile, certificate=certificate)


def _event(event: Event, courses: Sequence[Course], unknowns: Unknowns) -> Event:
    index = event.index if event.index < 0 else unknowns.index(event.index)
    s = _arclength(courses[event.form], event.s)
    return replace(event, s=s, u=unknowns.points(event.u), index=index)


def _arclength(course: Course, s: float) -> float:
    return float(course.arclengths(np.array(s)))


def _meeting_point(
    meeting: MeetingPoint, courses: Sequence[Course], unknowns: Unknowns
) -> MeetingPoint:
    passes = [(form, _arclength(courses[form], s)) for form, s in meeting.passes]
    point = replace(
        meeting.point,
        u=unknowns.points(meeting.point.u),
        null_space=unknowns.bases(meeting.point.null_space),
        error=unknowns.size * meeting.point.error,
        half_branches=unknowns.directions(meeting.point.half_branches),
        tangents=unknowns.directions(meeting.point.tangents),
        radius=unknowns.size * meeting.point.radius,
    )
    tangents = unknowns.directions(meeting.tangents)
    return replace(meeting, point=point, passes=tuple(passes), tangents=tangents)


def _surface(surface: Surface, unknowns: Unknowns) -> Surface:
    charts = surface.charts
    if charts is not None:
        charts = replace(
            charts,
            centers=unknowns.points(charts.centers),
            bases=unknowns.bases(charts.bases),
            radii=unknowns.size * charts.radii,
            areas=unknowns.size**2 * charts.areas,
            area_errors=unknowns.size**2 * charts.area_errors,
            vertices=unknowns.points(charts.vertices),
            periods=unknowns.periods,
        )
    factors = tuple(_factor(factor, unknowns) for factor in surface.factors)
    samples = unknowns.points(surface.samples)
    return replace(surface, samples=samples, charts=charts, factors=factors)


def _factor(factor: Factor, unknowns: Unknowns) -> Factor:
    size = factor.size
    if size is not None:
        size *= unknowns.size**factor.dimension
    numbers = sorted(unknowns.index(number) for number in factor.unknowns)
    return factor._replace(unknowns=tuple(numbers), size=size)


def _near_motion(near: NearMotion, unknowns: Unknowns) -> NearMotion:
    branch = near.branch
    if branch is not None:
        branch = unknowns.course(branch).branch
    return replace(near, branch=branch, sample=unknowns.points(near.sample))
