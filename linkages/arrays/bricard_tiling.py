"""Threefold-symmetric Bricard loops (Chen, You and Tarnai 2005), joined like scissors.

All links of a loop have length 1, the twists alternate, and so do the angles theta and phi
at its joints; with the cosine c and the sine s of the twist

    c^2 + s^2 (cos theta + cos phi) + (1 + c^2) cos theta cos phi = 2 c sin theta sin phi.

There are two roots phi where 2 s^2 cos theta + 1 + 2 c^2 > 0: at every theta for twists
below 60 degrees. The joints with theta are the corners of an equilateral triangle. There two
loops meet, each the image of the other one by inversion at the joint: every bar goes
straight on as one of the other loop, so that both have the same theta. Inversions at two
points of a plane one after the other are a translation, and at three points, done twice,
they are nothing: such loops stand on a honeycomb and close at every theta.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import acos, atan2, cos, degrees, hypot, pi, sin

import numpy as np

from linkages.kinematics import joint_frames
from linkages.loop import Loop
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import require

CORNERS = 6
# at these corners an even loop meets the one so many columns and rows on
MEETINGS = {0: (1, 0), 2: (-1, 0), 4: (0, 1)}


def bricard_tiling(columns: int, rows: int, twist: float, angle: float) -> Mechanism:
    """So many loops in columns and rows, like bricks in a wall, with ``angle`` between the
    bars where loops meet; ``twist`` and angle in rad.

    Raises `GeometryError` for an angle that bars of this twist do not reach, and for one
    column of more than two loops, as a brick meets that above it or that below it.
    """
    is_joined = columns > 1 or rows < 3
    require(is_joined, "columns", columns, "2 or more where there are 3 rows or more")
    _require_reach(twist, angle)
    theta = pi - angle
    loop = Loop((1.0,) * CORNERS, (twist, -twist) * 3, (0.0,) * CORNERS)
    turns = np.array([theta, other_angle(twist, theta)] * 3)
    frames = joint_frames(loop.arrays, turns)[:CORNERS]
    tiling = _Tiling(columns, rows, frames)
    joints: dict[str, Joint] = {}
    for column, row in product(range(columns), range(rows)):
        for joint in tiling.joints(column, row):
            joints.setdefault(joint.name, joint)
    return Mechanism(tuple(joints.values()), "bricard-array")


def other_angle(twist: float, theta: float) -> float:
    """One of the angles phi (rad) of a loop of this ``twist`` (rad) beside ``theta`` (rad);
    the other one is -phi beside -theta."""
    c, s = cos(twist), sin(twist)
    by_cosine = s**2 + (1.0 + c**2) * cos(theta)
    by_sine = -2.0 * c * sin(theta)
    free = c**2 + s**2 * cos(theta)
    return atan2(by_sine, by_cosine) + acos(-free / hypot(by_cosine, by_sine))


def _require_reach(twist: float, angle: float) -> None:
    """Raise `GeometryError` for an angle (rad) between bars at which there is no phi."""
    bound = (1.0 + 2.0 * cos(twist) ** 2) / (2.0 * sin(twist) ** 2)
    least = degrees(acos(min(1.0, bound)))
    allowed = f"more than {least:.6g} degrees for this twist"
    require(cos(angle) < bound, "angle", f"{degrees(angle):g}", allowed)


@dataclass(frozen=True, eq=False)
class _Tiling:
    """How many ``columns`` and ``rows`` of loops there are, and the ``frames`` (6, 4, 4) of
    the corners of the first one. Loops are even or odd as their column and row add up."""

    columns: int
    rows: int
    frames: np.ndarray

    def joints(self, column: int, row: int) -> list[Joint]:
        """The joints of a loop, those where it meets others in the same way as these have
        them."""
        points = self._places(column, row)
        joints = []
        for corner in range(CORNERS):
            first = self._bar(column, row, (corner - 1) % CORNERS)
            second = self._bar(column, row, corner)
            joint = Joint(
                f"{self._owner(column, row, corner)}j{corner + 1}",
                JointKind.REVOLUTE,
                (first, second),
                tuple(points[corner].tolist()),
                tuple(self.frames[corner, :3, 2].tolist()),
            )
            joints.append(joint)
        return joints

    def _bar(self, column: int, row: int, number: int) -> str:
        """What a bar is called: one of its ends is at a corner at which loops meet."""
        meeting = number + number % 2
        return f"{self._owner(column, row, meeting)}b{number + 1}"

    def _owner(self, column: int, row: int, corner: int) -> str:
        """The loop after which a joint is called, of two that meet there the even one."""
        across, up = MEETINGS.get(corner % CORNERS, (0, 0))
        is_odd = (column + row) % 2
        i, j = column - across * is_odd, row - up * is_odd
        is_there = 0 <= i < self.columns and 0 <= j < self.rows
        return f"c{i}r{j}" if is_there else f"c{column}r{row}"

    def _places(self, column: int, row: int) -> np.ndarray:
        """Where the corners (6, 3) of a loop are."""
        points = self.frames[:, :3, 3]
        first, second, third = points[::2]
        is_odd = (column + row) % 2
        pairs = (column - is_odd + row) // 2
        offset = 2.0 * (row * (third - first) + pairs * (first - second))
        places: np.ndarray = offset + (2.0 * first - points if is_odd else points)
        return places
