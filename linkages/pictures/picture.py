"""A configuration of a linkage as it is seen from one side: strokes in the plane of the
picture, in the user's unit of length.

Planar linkages are seen straight from above, x to the right where it lies in their plane,
with the field's symbols for ground, pins and sliders; others from where the page of
`bifurc view` shows them at first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from linkages.links.parts import Parts, Symbol
from linkages.links.traced_points import TracedPoint, traced_path
from linkages.mechanisms.joint import Shape
from linkages.scene import View

REACH = 0.22  # of the axis of a joint beyond its seat, in the same
LENGTH = 1.7  # of half the cylinder of a joint, in its radius
# of what stands for a joint, in its radius: half of it along its axis, across it, and in
# the third direction
BOXES = {Shape.BOX: (1.7, 0.85, 1.7), Shape.PLATE: (0.125, 3.5, 3.5)}
BALL = 1.5
FOOT = (1.7, 2.8)  # half the breadth of a foot on the ground, and its height, in radii
HATCH = 0.7  # length and distance of the strokes that are the ground, in radii
END_ON = 1e-6  # of an axis: less is seen of one that points at the eye
NOTHING = 1e-9  # of the size of the linkage: a line that is none
ROUND = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 13)  # half of a circle
CIRCLE = np.stack([np.cos(2.0 * ROUND), np.sin(2.0 * ROUND)], axis=1)
MOST_HINGES = 60  # of a sheet that are drawn
DOT = 0.5  # of a traced point, in the radius of a joint


class Part(Enum):
    """What a stroke is of; a rail is the frame of what moves in a plane."""

    LINK = "link"
    FRAME = "frame"
    RAIL = "rail"
    PANEL = "panel"
    AXIS = "axis"
    JOINT = "joint"
    GROUND = "ground"
    PATH = "path"
    FLEX = "flex"


@dataclass(frozen=True, eq=False)
class Stroke:
    """A polyline (k, 2), or a polygon where it is ``closed``. What has a larger ``depth``
    is nearer to the eye; joints hide all else."""

    part: Part
    points: np.ndarray
    depth: float
    closed: bool = False


class Name(NamedTuple):
    """The name of a joint, and where it is (2,)."""

    text: str
    place: np.ndarray


@dataclass(frozen=True, eq=False)
class Picture:
    """What is seen of a configuration, the farthest first."""

    strokes: list[Stroke]
    names: list[Name]

    @property
    def corners(self) -> np.ndarray:
        """The lower left and the upper right corner (2, 2)."""
        points = np.concatenate([stroke.points for stroke in self.strokes])
        return np.array([points.min(axis=0), points.max(axis=0)])


class Painter:
    """Makes pictures of some parts, all from one side: from where that of the
    configuration ``first`` (n,) is clear, with rails as long as slides are used at
    ``points`` (k, n), and the paths there of ``traced`` points. ``size`` is that of the
    linkage, ``radius`` that of a joint."""

    def __init__(
        self,
        parts: Parts,
        first: np.ndarray,
        points: np.ndarray,
        traced: Sequence[TracedPoint] = (),
    ):
        self._parts = parts
        self._lines = parts.lines(points)
        normal = parts.normal
        self._is_planar = normal is not None
        if normal is None:
            self._camera = _camera_of(parts.best_view(first))
        else:
            self._camera = _camera_above(normal)
        self.size = parts.extent(first, self._lines)
        self.radius = parts.joint_radius(first, self.size)
        self._has_many_joints = len(parts.symbols_at(first)) > MOST_HINGES
        self._traced = traced
        paths = [self._seen(traced_path(parts, one, points)) for one in traced]
        self._paths = [Stroke(Part.PATH, path[:, :2], -np.inf) for path in paths]

    def picture(self, point: np.ndarray) -> Picture:
        """The picture of a configuration (n,)."""
        strokes = []
        for body, pose in enumerate(self._poses(point)):
            strokes += self._strokes_of(body, pose)
        symbols = self._parts.symbols_at(point)
        names = []
        for symbol in symbols:
            strokes += self._strokes_at(symbol)
            text = symbol.name.removeprefix("joint ").removeprefix("joint")
            if text:
                names.append(Name(text, self._seen(symbol.place)[:2]))
        for one in self._traced:
            (seen,) = self._seen(traced_path(self._parts, one, point[None]))
            ring = seen[:2] + DOT * self.radius * CIRCLE
            strokes.append(Stroke(Part.JOINT, ring, np.inf, closed=True))
            names.append(Name(one.name, seen[:2]))
        strokes += self._paths
        strokes.sort(key=lambda stroke: (stroke.part is Part.JOINT, stroke.depth))
        return Picture(strokes, names)

    # --- places -----------------------------------------------------------------------

    def seen(self, places: np.ndarray, point: np.ndarray) -> np.ndarray:
        """Places (..., 3) of a configuration (n,), given with the frame at rest, as
        `Stroke` has them, with the depth as third number."""
        held = np.linalg.inv(self._parts.poses(point[None])[0][self._parts.held])
        return self._seen(places @ held[:3, :3].T + held[:3, 3])

    def _poses(self, point: np.ndarray) -> np.ndarray:
        """The poses (b, 4, 4) of all bodies seen from the one that is drawn at rest."""
        poses = self._parts.poses(point[None])[0]
        return np.asarray(np.linalg.inv(poses[self._parts.held]) @ poses)

    def _seen(self, places: np.ndarray) -> np.ndarray:
        """Places (..., 3) to the right, upwards and towards the eye."""
        return np.asarray(places @ self._camera.T)

    # --- strokes ----------------------------------------------------------------------

    def _strokes_of(self, body: int, pose: np.ndarray) -> list[Stroke]:
        """The panels of a body, or its lines where it has none."""
        sheets = []
        for corners in self._parts.panels(body):
            seen = self._seen(corners @ pose[:3, :3].T + pose[:3, 3])
            depth = float(seen[:, 2].mean())
            sheets.append(Stroke(Part.PANEL, seen[:, :2], depth, closed=True))
        if sheets:
            return sheets
        is_frame = body == self._parts.frame
        at_rest = Part.RAIL if self._is_planar else Part.FRAME
        part = at_rest if is_frame else Part.LINK
        strokes = []
        for line in self._lines[body]:
            if np.linalg.norm(line[1] - line[0]) < NOTHING * self.size:
                continue
            seen = self._seen(line @ pose[:3, :3].T + pose[:3, 3])
            strokes.append(Stroke(part, seen[:, :2], float(seen[:, 2].mean())))
        return strokes

    def _strokes_at(self, symbol: Symbol) -> list[Stroke]:
        """The axis of a joint, what stands for it, and the ground below it."""
        seen = self._seen(symbol.place)
        place, depth = seen[:2], float(seen[2])
        direction = self._seen(symbol.direction)
        outline = self.radius * _outline(symbol.shape, direction)
        is_crease = all(map(self._parts.panels, symbol.bodies))
        if is_crease and self._has_many_joints:
            return []  # they would cover the sheet, which shows them anyway
        has_axis = symbol.shape is Shape.CYLINDER and not is_crease
        behind = 0.0 if has_axis else self.radius  # a pin on a slider is seen
        strokes = [Stroke(Part.JOINT, place + outline, depth - behind, closed=True)]
        if has_axis and np.linalg.norm(direction[:2]) > END_ON:
            reach = REACH * self.size * direction[:2]
            axis = np.array([place - reach, place + reach])
            strokes.append(Stroke(Part.AXIS, axis, depth))
        if self._is_planar and symbol.is_on(self._parts.frame):
            strokes += self._ground(symbol, place, direction, depth)
        return strokes

    def _ground(
        self, symbol: Symbol, place: np.ndarray, direction: np.ndarray, depth: float
    ) -> list[Stroke]:
        """A foot below a pin; strokes beside the rail of a slider."""
        below = depth - self.radius
        if symbol.shape is not Shape.CYLINDER:
            along = direction[:2]
            aside = np.array([along[1], -along[0]])
            aside *= 1.0 if aside[1] <= 0 else -1.0
            start = place + BOXES[Shape.BOX][1] * self.radius * aside
            return _hatching(start, along, aside, 3 * self.radius, below)
        half, height = self.radius * np.array(FOOT)
        corners = np.array([[0.0, 0.0], [half, -height], [-half, -height]])
        foot = Stroke(Part.GROUND, place + corners, below, closed=True)
        floor = place - [0.0, height]
        across, down = np.array([1.0, 0.0]), np.array([0.0, -1.0])
        return [foot, *_hatching(floor, across, down, 1.5 * half, below)]


def _hatching(
    start: np.ndarray, along: np.ndarray, aside: np.ndarray, half: float, depth: float
) -> list[Stroke]:
    """A line through a place, and slanted strokes on one side of it."""
    line = np.array([start - half * along, start + half * along])
    strokes = [Stroke(Part.GROUND, line, depth)]
    step = half / 3
    for k in range(-2, 4):
        upper = start + k * step * along
        lower = upper + HATCH * step * (aside - along)
        strokes.append(Stroke(Part.GROUND, np.array([upper, lower]), depth))
    return strokes


def _outline(shape: Shape, direction: np.ndarray) -> np.ndarray:
    """What is seen (k, 2) of a shape of radius 1 whose axis is a unit vector (3,), to
    the right, upwards and towards the eye."""
    if shape is Shape.BALL:
        return BALL * CIRCLE
    seen = float(np.hypot(direction[0], direction[1]))
    end_on = abs(float(direction[2]))
    turn = np.arctan2(direction[1], direction[0]) if seen > END_ON else 0.0
    if shape is Shape.CYLINDER:
        end = _arc(0.0, end_on) + np.array([LENGTH * seen, 0.0])
        points = np.concatenate([end, -end])
    else:
        along, across, third = BOXES[shape]
        half = np.array([along * seen + third * end_on, across])
        points = half * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def _arc(start: float, depth: float) -> np.ndarray:
    """Points (k, 2) of a half of an ellipse of half axes ``depth`` and 1."""
    angles = start + ROUND
    return np.stack([depth * np.cos(angles), np.sin(angles)], axis=1)


# --- from where it is seen ------------------------------------------------------------


def _camera_of(view: View) -> np.ndarray:
    """Right, up and towards the eye (3, 3) of a view, z upwards."""
    elevation, azimuth = np.radians([view.elevation, view.azimuth])
    look = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.array([right, np.cross(look, right), look])


def _camera_above(normal: np.ndarray) -> np.ndarray:
    """The same straight above a plane: y is up where the plane is level, z elsewhere,
    and x is to the right, or y where x is across the plane."""
    is_level = abs(normal[2]) > 1 - END_ON
    up = np.array([0.0, 1.0, 0.0]) if is_level else np.array([0.0, 0.0, 1.0])
    up = up - (up @ normal) * normal
    up /= np.linalg.norm(up)
    right = np.cross(up, normal)
    turn = right[0] if abs(right[0]) > END_ON else right[1]
    sign = 1.0 if turn >= 0 else -1.0
    return np.array([sign * right, up, sign * normal])
