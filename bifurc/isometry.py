"""An atlas in other unknowns, which are those that it has in another order, with other
signs, and counted from elsewhere.

All lengths stay what they are, so that curves keep their arclengths and pieces: no
piece is made again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, NearMotion, Surface
from bifurc.branch import Branch
from bifurc.errors import ProblemError
from bifurc.singular.point import SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.torus import whole_turns, wrap


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
    recount = _Recount(isometry, atlas.periods[isometry.columns])
    return replace(
        atlas,
        names=tuple(names),
        units=tuple(atlas.units[column] for column in isometry.columns),
        periods=recount.periods,
        forms=tuple(recount.form(form) for form in atlas.forms),
        points=tuple(recount.meeting_point(point) for point in atlas.points),
        near_misses=tuple(recount.event(event) for event in atlas.near_misses),
        dead_points=tuple(recount.event(event) for event in atlas.dead_points),
        rigid=recount.points(atlas.rigid),
        surfaces=tuple(recount.surface(surface) for surface in atlas.surfaces),
        near_motions=tuple(recount.near_motion(near) for near in atlas.near_motions),
    )


@dataclass(frozen=True, eq=False)
class _Recount:
    """The parts of an atlas in the new unknowns of an ``isometry``, with these
    ``periods`` (n,)."""

    isometry: Isometry
    periods: np.ndarray

    def points(self, points: np.ndarray) -> np.ndarray:
        """Points (..., n), periodic unknowns within half a period of 0."""
        return wrap(self.isometry.points(points), self.periods)

    def form(self, form: Form) -> Form:
        return replace(form, branch=self.isometry.branch(form.branch))

    def event(self, event: Event) -> Event:
        index = event.index if event.index < 0 else self.isometry.index(event.index)
        return replace(event, u=self.points(event.u), index=index)

    def meeting_point(self, point: MeetingPoint) -> MeetingPoint:
        tangents = self.isometry.directions(point.tangents)
        return replace(point, point=self.singular_point(point.point), tangents=tangents)

    def singular_point(self, point: SingularPoint) -> SingularPoint:
        directions = self.isometry.directions
        return replace(
            point,
            u=self.points(point.u),
            null_space=directions(point.null_space.T).T,
            half_branches=directions(point.half_branches),
            tangents=directions(point.tangents),
        )

    def surface(self, surface: Surface) -> Surface:
        charts = None if surface.charts is None else self.charts(surface.charts)
        return replace(surface, samples=self.points(surface.samples), charts=charts)

    def charts(self, charts: ChartAtlas) -> ChartAtlas:
        bases = self.isometry.directions(np.swapaxes(charts.bases, 1, 2))
        return replace(
            charts,
            centers=self.points(charts.centers),
            bases=np.swapaxes(bases, 1, 2),
            vertices=self.points(charts.vertices),
            periods=self.periods,
        )

    def near_motion(self, near: NearMotion) -> NearMotion:
        return replace(near, sample=self.points(near.sample))
