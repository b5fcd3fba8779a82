"""Spherical mechanisms given as points on a sphere and arcs of great circles between
them (`linkages.files.figures`); the axes of all joints run through the centre."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from linkages.decisions import is_bar_assembled, is_one_direction
from linkages.files.figures import (
    Figure,
    FigureKind,
    Piece,
    joints_of_figure,
    polished,
    read_figure,
    table_of_points,
)
from linkages.mechanisms.joint import Joint, JointKind, unit_vector
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import check_number, checked_list, checked_number, require

Content: TypeAlias = Mapping[str, Any]
Places: TypeAlias = dict[str, np.ndarray]
# points on arcs are so far along and then aside, to the left seen from outside, rad
Arcs: TypeAlias = Figure[np.ndarray, np.ndarray]

NEWTON_STEPS = 60


def read_arcs(content: Content, name: str, unit: float) -> Mechanism:
    """The mechanism of the points and arcs of a file; angles are in this ``unit``, in
    rad.

    Where angles are given that the points do not fit, the points are moved until they
    do (least squares). Raises `GeometryError` for anything wrong, and where arcs of
    these angles cannot be assembled next to the points.
    """
    assembly = assembled_arcs(content, unit)
    joints = joints_of_figure(
        assembly.figure, assembly.places, assembly.hold_together, _joint_at
    )
    return Mechanism(joints, name)


class ArcAssembly(NamedTuple):
    """A ``figure`` of arcs with the ``places`` of all its points where arcs have their
    angles."""

    figure: Arcs
    places: Places

    def hold_together(self, first: Sequence[str], second: Sequence[str]) -> bool:
        """Whether points that two bodies have in common are in different directions from
        the centre."""
        axes = [self.places[point] for point in first if point in second]
        across = [np.cross(axes[0], axis) for axis in axes[1:]]
        return any(not is_one_direction(float(np.linalg.norm(x))) for x in across)

    def normal(self, arc: Piece) -> np.ndarray:
        """The unit normal (3,) of the plane of an arc, from its start to its end."""
        return _normal(f"arc {arc.name}", self.places[arc.start], self.places[arc.end])

    def angle(self, arc: Piece) -> float:
        """The angle of an arc, rad."""
        return _angle_between(self.places, arc)


def assembled_arcs(content: Content, unit: float) -> ArcAssembly:
    """The arcs of a file, whose angles are in this ``unit``, in rad, with the places of
    their points; raises `GeometryError` as `read_arcs`."""

    def angle(what: str, value: Any) -> float:
        check_number(what, value)
        result = unit * float(value)
        allowed = "more than 0 and less than half a turn"
        require(0.0 < result < np.pi, what, value, allowed)
        return result

    kind = FigureKind(
        "arc",
        "an",
        "angle",
        "[along, aside]",
        angle,
        lambda what, row: unit * _numbers(what, row, 2),
    )
    table = table_of_points(content, "[x, y, z]")
    points = {point: _direction(f"point {point}", row) for point, row in table.items()}
    figure = read_figure(content, kind, points)
    places = _assembled(figure)
    assembly = ArcAssembly(figure, places)
    for arc in figure.pieces:
        assembly.normal(arc)
    return assembly


def _joint_at(name: str, bodies: tuple[str, ...], place: np.ndarray) -> Joint:
    """The joint of bodies about the axis through a place (3,)."""
    x, y, z = place.tolist()
    return Joint(name, JointKind.REVOLUTE, bodies, (x, y, z), (x, y, z))


def _direction(what: str, row: object) -> np.ndarray:
    numbers = _numbers(what, row, 3)
    is_away = bool(np.any(numbers))
    require(is_away, what, numbers.tolist(), "away from the centre")
    return unit_vector(numbers)


def _numbers(what: str, row: object, count: int) -> np.ndarray:
    row = checked_list(what, row, f"a list of {count} numbers", (count,))
    return np.array([checked_number(what, value) for value in row])


# --- assembly -------------------------------------------------------------------------


def _places(figure: Arcs, points: Places) -> Places:
    """The directions of all points, those on arcs among them."""
    places = dict(points)
    for name, one in figure.on_pieces.items():
        start, end = places[one.start], places[one.end]
        normal = _normal(f"points_on_arcs {name}", start, end)
        along, aside = one.numbers
        middle = np.cos(along) * start + np.sin(along) * np.cross(normal, start)
        places[name] = np.cos(aside) * middle + np.sin(aside) * normal
    return places


def _normal(what: str, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The unit normal (3,) of the plane of an arc."""
    across = np.cross(start, end)
    sine = float(np.linalg.norm(across))
    value = "between points in one direction from the centre, or opposite to it"
    is_arc = not is_one_direction(sine)
    require(is_arc, what, value, "an arc of a great circle")
    return across / sine


def _assembled(figure: Arcs) -> Places:
    """The directions of all points where every arc has its angle."""
    places = _places(figure, figure.points)
    for arc in figure.pieces:
        if arc.measure is None:
            _normal(f"arc {arc.name}", places[arc.start], places[arc.end])
    if not any(arc.measure is not None for arc in figure.pieces):
        return places
    angles = [
        _angle_between(places, arc) if arc.measure is None else arc.measure
        for arc in figure.pieces
    ]
    if figure.free:
        places = _fitted(figure, figure.free, np.array(angles))
    misfits = [
        abs(_angle_between(places, arc) - angle)
        for arc, angle in zip(figure.pieces, angles, strict=True)
    ]
    worst = int(np.argmax(misfits))
    arc = figure.pieces[worst]
    allowed = (
        "such that the arcs can be assembled next to the points; as near as they "
        f"come, arc {arc.name} misses its angle by {np.degrees(misfits[worst]):.3g} deg"
    )
    value = f"{np.degrees(angles[worst]):.10g} deg"
    is_assembled = is_bar_assembled(misfits[worst])
    require(is_assembled, f"angle of arc {arc.name}", value, allowed)
    return places


def _angle_between(places: Places, arc: Piece) -> float:
    start, end = places[arc.start], places[arc.end]
    return float(np.arctan2(np.linalg.norm(np.cross(start, end)), start @ end))


def _fitted(figure: Arcs, free: Sequence[str], angles: np.ndarray) -> Places:
    """The directions of all points where the angles of all arcs are best fitted."""
    from scipy.optimize import least_squares

    def placed(values: np.ndarray) -> Places:
        moved = zip(free, values.reshape(-1, 3), strict=True)
        units = {name: place / np.linalg.norm(place) for name, place in moved}
        return _places(figure, figure.points | units)

    def gaps(values: np.ndarray) -> np.ndarray:
        places = placed(values)
        now = np.array([_angle_between(places, arc) for arc in figure.pieces])
        lengths = np.linalg.norm(values.reshape(-1, 3), axis=1) - 1.0
        return np.concatenate([now - angles, lengths])

    def derivatives(values: np.ndarray) -> np.ndarray:
        return _differences(gaps, values)

    start = np.concatenate([figure.points[name] for name in free])
    solution = least_squares(gaps, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    return placed(polished(gaps, derivatives, solution, NEWTON_STEPS))


def _differences(
    gaps: Callable[[np.ndarray], np.ndarray], values: np.ndarray
) -> np.ndarray:
    """The derivatives (m, n) of ``gaps`` (m,) at ``values`` (n,), as central
    differences."""
    step = float(np.finfo(float).eps) ** (1 / 3)
    columns = [
        (gaps(values + move) - gaps(values - move)) / (2 * step)
        for move in step * np.eye(len(values))
    ]
    return np.array(columns).T
