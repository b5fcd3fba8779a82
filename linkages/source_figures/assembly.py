"""Joint axes in space and the links between them, also those that a construction
removes: what the schematics of the sources show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from linkages.loop import Loop

UP = np.array([0.0, 0.0, 1.0])
NEARLY_PARALLEL = 1e-9  # sine of the angle between axes without a common normal


class Role(StrEnum):
    """What becomes of a link in a construction."""

    # It stays in the linkage.
    KEPT = "kept"
    # It is shared by two parts, or replaced, and stays visible.
    COMMON = "common"
    # It is taken away.
    REMOVED = "removed"


@dataclass(frozen=True, eq=False)
class Axis:
    """A joint axis: its unit ``direction`` (3,) and a ``point`` (3,) on it, the foot of
    a link."""

    point: np.ndarray
    direction: np.ndarray


@dataclass(frozen=True, eq=False)
class Bar:
    """The link from joint ``first`` to joint ``last``: ``ends`` (2, 3) are the feet of
    the common normal of their axes; ``label`` names length and twist."""

    first: str
    last: str
    ends: np.ndarray
    label: str = ""
    role: Role = Role.KEPT

    @property
    def length(self) -> float:
        """Distance of its axes."""
        return float(np.linalg.norm(self.ends[1] - self.ends[0]))


class Seat(NamedTuple):
    """Where a joint stands that is no end of a link: on the link from joint ``first``
    to joint ``last``, at a ``fraction`` of its length, beyond it above 1."""

    first: str
    last: str
    fraction: float


@dataclass
class Assembly:
    """Joint ``axes`` by their names, the links between them, and the ``seats`` of the
    joints that stand on links."""

    axes: dict[str, Axis] = field(default_factory=dict)
    bars: list[Bar] = field(default_factory=list)
    seats: dict[str, Seat] = field(default_factory=dict)

    def feet(self, name: str) -> np.ndarray:
        """Feet (k, 3) of the links on the axis of a joint; its own point where it has
        no link."""
        feet = []
        for bar in self.bars:
            if bar.first == name:
                feet.append(bar.ends[0])
            if bar.last == name:
                feet.append(bar.ends[1])
        return np.array(feet) if feet else self.axes[name].point[None]

    def joint(self, name: str) -> np.ndarray:
        """Where a joint (3,) is drawn: in the middle of the feet on its axis."""
        start, heights = self._heights(name)
        middle = (heights.min() + heights.max()) / 2
        return np.asarray(start + middle * self.axes[name].direction)

    def offset(self, name: str) -> np.ndarray:
        """The piece (2, 3) of an axis between the outermost feet on it."""
        start, heights = self._heights(name)
        ends = np.array([[heights.min()], [heights.max()]])
        return np.asarray(start + ends * self.axes[name].direction)

    def _heights(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """A foot (3,) on the axis of a joint, and how far from it all feet are (k,)."""
        feet = self.feet(name)
        return feet[0], (feet - feet[0]) @ self.axes[name].direction

    def points(self) -> np.ndarray:
        """Where all joints are drawn (k, 3)."""
        return np.array([self.joint(name) for name in self.axes])

    def remove(self, name: str) -> None:
        """Take a joint away, and the links to it."""
        del self.axes[name]
        self.bars = [bar for bar in self.bars if name not in (bar.first, bar.last)]

    def twist(self, bar: Bar) -> float:
        """Angle (rad) between the axes that a link joins, from 0 to pi."""
        first = self.axes[bar.first].direction
        last = self.axes[bar.last].direction
        sine = float(np.linalg.norm(np.cross(first, last)))
        return float(np.arctan2(sine, first @ last))


def loop_assembly(
    loop: Loop,
    theta: np.ndarray,
    names: Sequence[str] = (),
    labels: Sequence[str] = (),
) -> Assembly:
    """The axes and links of a loop at joint angles (n,), rad; ``names`` are those of
    its joints, else their numbers, ``labels`` of its links."""
    names = names or [str(i + 1) for i in range(loop.n)]
    labels = labels or [""] * loop.n
    frames = loop.frames(theta)
    offsets = loop.arrays.offsets
    out = Assembly()
    for i, name in enumerate(names):
        axis = Axis(frames[i, :3, 3], frames[i, :3, 2])
        out.axes[name] = axis
        start = axis.point + offsets[i] * axis.direction
        ends = np.stack([start, frames[i + 1, :3, 3]])
        following = names[(i + 1) % loop.n]
        out.bars.append(Bar(name, following, ends, labels[i]))
    return out


# --- joints that a loop does not show -------------------------------------------------


def turn(vector: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """``vector`` (3,) turned about the unit ``axis`` (3,) by an angle, rad (Rodrigues
    1840)."""
    along = (vector @ axis) * axis
    across = vector - along
    turned = np.cos(angle) * across + np.sin(angle) * np.cross(axis, vector)
    return np.asarray(along + turned)


def unit(vector: np.ndarray) -> np.ndarray:
    """A vector (3,) over its length."""
    return np.asarray(vector / np.linalg.norm(vector))


def far_axis(near: Axis, along: np.ndarray, length: float, twist: float) -> Axis:
    """The axis at the other end of a link that leaves the point of an axis in the unit
    direction ``along`` (3,)."""
    return Axis(near.point + length * along, turn(near.direction, along, twist))


def joint_after(
    before: Axis, at: Axis, angle: float, length: float, twist: float
) -> Axis:
    """The next axis of a chain that comes from ``before`` to ``at`` and turns there by
    ``angle`` (rad), without offset."""
    along = turn(unit(at.point - before.point), at.direction, angle)
    return far_axis(at, along, length, twist)


def fourth_joint(first: Axis, middle: Axis, last: Axis) -> Axis:
    """The fourth axis of the Bennett linkage with three axes in this order.

    A Bennett linkage is its own image under the half turn that exchanges opposite
    joints: about the line through the middle of ``first`` and ``last`` that also
    exchanges their axes. The fourth joint is the image of ``middle``.
    """
    centre = (first.point + last.point) / 2
    across = unit(last.point - first.point)
    candidates = []
    for sign in (1.0, -1.0):
        line = first.direction + sign * last.direction
        size = float(np.linalg.norm(line))
        if size > NEARLY_PARALLEL:
            line = line / size
            candidates.append((abs(float(line @ across)), sign, line))
    _, _, line = min(candidates, key=lambda candidate: candidate[:2])
    point = centre + turn(middle.point - centre, line, np.pi)
    return Axis(point, turn(middle.direction, line, np.pi))


def bar_between(
    assembly: Assembly, first: str, last: str, label: str = "", role: Role = Role.KEPT
) -> Bar:
    """The link along the common normal of two axes; between parallel axes, that between
    their points."""
    one = assembly.axes[first]
    other = assembly.axes[last]
    normal = np.cross(one.direction, other.direction)
    size = float(np.linalg.norm(normal))
    if size < NEARLY_PARALLEL:
        return Bar(first, last, np.stack([one.point, other.point]), label, role)
    # one.point + s one.direction + t normal = other.point + r other.direction
    columns = np.column_stack([one.direction, -other.direction, normal / size])
    heights = np.linalg.solve(columns, other.point - one.point)
    start = one.point + heights[0] * one.direction
    end = other.point + heights[1] * other.direction
    return Bar(first, last, np.stack([start, end]), label, role)
