"""Spherical mechanisms given as points on a sphere and arcs between them.

Every arc of a great circle is a body, and so is the frame, which holds the fixed
points. A point is a revolute joint of all bodies that it lies on; its axis runs through
the centre.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from linkages.decisions import is_bar_assembled, is_one_direction
from linkages.files.figure_bodies import (
    Piece,
    bodies_of_figure,
    check_held,
    check_point,
    read_fixed,
)
from linkages.files.joined_names import check_joined_names, joined_name
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import GeometryError, check_number, quoted

Content: TypeAlias = Mapping[str, Any]
Places: TypeAlias = dict[str, np.ndarray]

NEWTON_STEPS = 60
RANK = 1e-9  # singular value, over the largest, of a motion: no step along it


@dataclass(frozen=True)
class Arc:
    """An arc between two points, with the ``angle`` (rad) that is given for it."""

    start: str
    end: str
    angle: float | None = None

    @property
    def name(self) -> str:
        """What the body is called."""
        return joined_name(self.start, self.end)


@dataclass(frozen=True)
class PointOnArc:
    """A point as far ``along`` an arc from its start, and then as far ``aside``, to the
    left seen from outside, as angles (rad)."""

    start: str
    end: str
    along: float
    aside: float


@dataclass(frozen=True)
class _Arcs:
    """What a file says: directions (3,) of ``points``, which of them are ``fixed``,
    ``arcs``, and the points ``on_arcs``, in an order in which each follows its arc's
    ends."""

    points: Places
    fixed: tuple[str, ...]
    arcs: tuple[Arc, ...]
    on_arcs: dict[str, PointOnArc]


def read_arcs(content: Content, name: str, unit: float) -> Mechanism:
    """The mechanism of the points and arcs of a file; angles are in this ``unit``, in
    rad.

    Where angles are given that the points do not fit, the points are moved until they
    do (least squares). Raises `GeometryError` for anything wrong, and where arcs of
    these angles cannot be assembled next to the points.
    """
    points = _read_points(content)
    on_arcs = _read_points_on_arcs(content, points, unit)
    known = [*points, *on_arcs]
    fixed = read_fixed(content, known)
    arcs = _read_arcs(content, known, unit)
    system = _Arcs(points, fixed, arcs, on_arcs)
    joints = _joints(system, _assembled(system))
    check_held(fixed, joints)
    return Mechanism(tuple(joints), name)


# --- keys -----------------------------------------------------------------------------


def _read_points(content: Content) -> Places:
    table = content.get("points")
    if not isinstance(table, Mapping) or not table:
        raise GeometryError("points", quoted(table), "a table of points [x, y, z]")
    return {name: _direction(f"point {name}", row) for name, row in table.items()}


def _direction(what: str, row: object) -> np.ndarray:
    numbers = _numbers(what, row, 3)
    largest = np.abs(numbers).max()
    if largest == 0.0:
        raise GeometryError(what, numbers.tolist(), "away from the centre")
    scaled = numbers / largest
    direction: np.ndarray = scaled / np.linalg.norm(scaled)
    return direction


def _numbers(what: str, row: object, count: int) -> np.ndarray:
    if not isinstance(row, list) or len(row) != count:
        raise GeometryError(what, quoted(row), f"a list of {count} numbers")
    for value in row:
        check_number(what, value)
    return np.array(row, dtype=float)


def _read_points_on_arcs(
    content: Content, points: Places, unit: float
) -> dict[str, PointOnArc]:
    table = content.get("points_on_arcs", {})
    if not isinstance(table, Mapping):
        allowed = 'a table of points ["A", "B", [along, aside]]'
        raise GeometryError("points_on_arcs", quoted(table), allowed)
    on_arcs: dict[str, PointOnArc] = {}
    for name, row in table.items():
        what = f"points_on_arcs {name}"
        if name in points:
            raise GeometryError(what, quoted(name), "no name of a point in [points]")
        if not isinstance(row, list) or len(row) != 3:
            allowed = 'a list ["A", "B", [along, aside]]'
            raise GeometryError(what, quoted(row), allowed)
        for end in row[:2]:
            if end not in points and end not in on_arcs:
                raise GeometryError(what, quoted(end), "a point that stands before it")
        along, aside = (unit * _numbers(what, row[2], 2)).tolist()
        on_arcs[name] = PointOnArc(row[0], row[1], along, aside)
    return on_arcs


def _read_arcs(content: Content, known: Sequence[str], unit: float) -> tuple[Arc, ...]:
    rows = content.get("arcs")
    if not isinstance(rows, list) or not rows:
        raise GeometryError("arcs", quoted(rows), 'a list of arcs ["A", "B"]')
    arcs: list[Arc] = []
    for number, row in enumerate(rows, start=1):
        what = f"arcs[{number}]"
        if not isinstance(row, list) or len(row) not in (2, 3):
            raise GeometryError(what, quoted(row), '["A", "B"] or ["A", "B", angle]')
        for name in row[:2]:
            check_point(what, name, known)
        if row[0] == row[1]:
            raise GeometryError(what, row[:2], "an arc between two points")
        if any({arc.start, arc.end} == set(row[:2]) for arc in arcs):
            raise GeometryError(what, row[:2], "an arc that stands there once")
        angle = None
        if len(row) == 3:
            angle = _angle(f"angle of {what}", row[2], unit)
        arcs.append(Arc(row[0], row[1], angle))
    check_joined_names("arc", [(arc.start, arc.end) for arc in arcs])
    return tuple(arcs)


def _angle(what: str, value: object, unit: float) -> float:
    check_number(what, value)
    assert isinstance(value, int | float)
    angle = unit * float(value)
    if not 0.0 < angle < np.pi:
        raise GeometryError(what, value, "more than 0 and less than half a turn")
    return angle


# --- assembly -------------------------------------------------------------------------


def _places(system: _Arcs, points: Places) -> Places:
    """The directions of all points, those on arcs among them."""
    places = dict(points)
    for name, one in system.on_arcs.items():
        start, end = places[one.start], places[one.end]
        normal = _normal(f"points_on_arcs {name}", start, end)
        middle = np.cos(one.along) * start + np.sin(one.along) * np.cross(normal, start)
        places[name] = np.cos(one.aside) * middle + np.sin(one.aside) * normal
    return places


def _normal(what: str, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The unit normal (3,) of the plane of an arc."""
    across = np.cross(start, end)
    sine = float(np.linalg.norm(across))
    if is_one_direction(sine):
        value = "between points in one direction from the centre, or opposite to it"
        raise GeometryError(what, value, "an arc of a great circle")
    normal: np.ndarray = across / sine
    return normal


def _assembled(system: _Arcs) -> Places:
    """The directions of all points where every arc has its angle."""
    places = _places(system, system.points)
    for arc in system.arcs:
        if arc.angle is None:
            _normal(f"arc {arc.name}", places[arc.start], places[arc.end])
    if not any(arc.angle is not None for arc in system.arcs):
        return places
    angles = [
        _angle_between(places, arc) if arc.angle is None else arc.angle
        for arc in system.arcs
    ]
    free = [name for name in system.points if name not in system.fixed]
    if free:
        places = _fitted(system, free, np.array(angles))
    misfits = [
        abs(_angle_between(places, arc) - angle)
        for arc, angle in zip(system.arcs, angles, strict=True)
    ]
    worst = int(np.argmax(misfits))
    if not is_bar_assembled(misfits[worst]):
        arc = system.arcs[worst]
        allowed = (
            "such that the arcs can be assembled next to the points; as near as they "
            f"come, arc {arc.name} misses its angle by {np.degrees(misfits[worst]):.3g} deg"
        )
        value = f"{np.degrees(angles[worst]):.10g} deg"
        raise GeometryError(f"angle of arc {arc.name}", value, allowed)
    return places


def _angle_between(places: Places, arc: Arc) -> float:
    start, end = places[arc.start], places[arc.end]
    return float(np.arctan2(np.linalg.norm(np.cross(start, end)), start @ end))


def _fitted(system: _Arcs, free: Sequence[str], angles: np.ndarray) -> Places:
    """The directions of all points where the angles of all arcs are best fitted."""
    from scipy.optimize import least_squares

    def placed(values: np.ndarray) -> Places:
        moved = zip(free, values.reshape(-1, 3), strict=True)
        units = {name: place / np.linalg.norm(place) for name, place in moved}
        return _places(system, system.points | units)

    def gaps(values: np.ndarray) -> np.ndarray:
        places = placed(values)
        now = np.array([_angle_between(places, arc) for arc in system.arcs])
        lengths = np.linalg.norm(values.reshape(-1, 3), axis=1) - 1.0
        return np.concatenate([now - angles, lengths])

    start = np.concatenate([system.points[name] for name in free])
    solution = least_squares(gaps, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    return placed(_polished(gaps, solution))


def _polished(
    gaps: Callable[[np.ndarray], np.ndarray], values: np.ndarray
) -> np.ndarray:
    """The ``values`` (n,) after Newton's method, as long as it makes ``gaps`` smaller;
    derivatives are central differences."""
    step = float(np.finfo(float).eps) ** (1 / 3)
    for _ in range(NEWTON_STEPS):
        columns = [
            (gaps(values + move) - gaps(values - move)) / (2 * step)
            for move in step * np.eye(len(values))
        ]
        now = gaps(values)
        trial = values - np.linalg.lstsq(np.array(columns).T, now, rcond=RANK)[0]
        if not np.linalg.norm(gaps(trial)) < np.linalg.norm(now):
            break
        values = trial
    return values


# --- bodies and joints ----------------------------------------------------------------


def _joints(system: _Arcs, places: Places) -> list[Joint]:
    """A revolute joint at every point on two bodies or more."""
    bodies = _bodies(system, places)
    joints = []
    for name, place in places.items():
        here = [body for body, points in bodies.items() if name in points]
        if not here and name not in system.on_arcs:
            raise GeometryError(f"point {name}", "on no arc", "the end of an arc")
        if len(here) < 2:
            continue
        x, y, z = place.tolist()
        joint = Joint(name, JointKind.REVOLUTE, tuple(here), (x, y, z), (x, y, z))
        joints.append(joint)
    return joints


def _bodies(system: _Arcs, places: Places) -> dict[str, list[str]]:
    """The points on every body, the frame first."""
    arcs = {arc.name: Piece(arc.start, arc.end) for arc in system.arcs}
    for name, arc in arcs.items():
        _normal(f"arc {name}", places[arc.start], places[arc.end])
    on_arcs = {name: Piece(one.start, one.end) for name, one in system.on_arcs.items()}

    def are_apart(points: Sequence[str]) -> bool:
        axes = [places[point] for point in points]
        across = [np.cross(axes[0], axis) for axis in axes[1:]]
        return any(not is_one_direction(float(np.linalg.norm(x))) for x in across)

    bodies = bodies_of_figure(system.fixed, arcs, on_arcs, are_apart)
    for name, one in system.on_arcs.items():
        if not any(name in points for points in bodies.values()):
            ends = f"{one.start} and {one.end}"
            allowed = f"on an arc; there is none between {ends}"
            raise GeometryError(f"points_on_arcs {name}", ends, allowed)
    return bodies
