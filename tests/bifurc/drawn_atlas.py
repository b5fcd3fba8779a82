"""Atlases of curves drawn by hand on a torus, so that every number is known."""

import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint
from bifurc.branch import Branch, Outcome
from bifurc.completeness import Completeness
from bifurc.curves.monitor import Profile
from bifurc.singular.point import Kind, SingularPoint

PERIOD = 6.0
PERIODS = np.full(2, PERIOD)


def polygon(*corners: tuple[float, float], closed: bool = True) -> Branch:
    """The curve along straight pieces from corner to corner; a closed one ends where it
    began, modulo the period."""
    points = np.array(corners, dtype=float)
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    breaks = np.concatenate([[0.0], np.cumsum(lengths)])
    middles = 0.5 * (points[:-1] + points[1:])
    return Branch(
        pieces=np.stack([middles, 0.5 * steps], axis=1),
        centers=0.5 * (breaks[:-1] + breaks[1:]),
        radii=lengths / 2,
        breaks=breaks,
        residuals=0 * lengths,
        periods=PERIODS,
        outcome=Outcome.CLOSED if closed else Outcome.LEFT_REGION,
    )


def ring(y: float) -> Branch:
    """A closed curve once around x at constant y, of length `PERIOD`."""
    return polygon(*((float(x), y) for x in range(7)))


def bridge(x: float) -> Branch:
    """A closed curve once around y at constant x, of length `PERIOD`."""
    return polygon(*((x, float(y)) for y in range(7)))


def figure_eight() -> Branch:
    """Two unit squares run one after the other, which meet in the origin."""
    first = [(0, 0), (1, 0), (1, 1), (0, 1)]
    second = [(0, 0), (-1, 0), (-1, -1), (0, -1)]
    return polygon(*first, *second, (0, 0))


def draw(
    branches: dict[str, Branch],
    points: dict[str, list[tuple[str, float]]],
    dead: tuple[Event, ...] = (),
) -> Atlas:
    """An atlas of these branches and of singular points, each given by the forms that
    pass it and where."""
    profile = Profile(np.array([[0.5]]), np.ones((1, 1, 2)), 1)
    forms = [Form(name, branch, profile, 1.0) for name, branch in branches.items()]
    meeting_points = [_meet(branches, name, passes) for name, passes in points.items()]
    return Atlas(
        names=("x", "y"),
        units=("rad", "rad"),
        periods=PERIODS,
        forms=tuple(forms),
        points=tuple(meeting_points),
        near_misses=(),
        dead_points=dead,
        rigid=np.empty((0, 2)),
        surfaces=(),
        completeness=Completeness((), (), 0.0),
    )


def _meet(
    branches: dict[str, Branch], name: str, passes: list[tuple[str, float]]
) -> MeetingPoint:
    """A bifurcation that forms pass at these arclengths."""
    first_form, arclength = passes[0]
    point = SingularPoint(
        u=branches[first_form](arclength),
        rank=0,
        null_space=np.eye(2),
        error=0.0,
        half_branches=np.eye(2),
        tangents=np.eye(2),
        dimension=1,
        order=2,
        radius=1e-2,
    )
    names = list(branches)
    indices = tuple((names.index(form), s) for form, s in passes)
    tangents = np.ones((len(passes), 2))
    return MeetingPoint(name, Kind.BIFURCATION, point, indices, tangents)
