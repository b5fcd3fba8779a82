"""A network as a mechanism: where its axes lie, and its bars as bodies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property

import numpy as np

from linkages.kinematics import joint_frames
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.networks.network import Network, wrap_angles

LOCKED_IN_PLACE = 0.0


class PlacedNetwork:
    """A ``network`` as the ``mechanism`` whose reference configuration are the states
    ``reference`` (c,) of its cells, with the axes of the ring in ``kinks`` held there,
    at these D-H angles (rad).

    Every bar is a body, every axis a joint of all bars on it. The variables of the
    joint at an axis are measured from the first bar that comes to it in the ring; the
    first variable is the D-H angle of the ring, less that in the reference.
    """

    def __init__(
        self,
        network: Network,
        reference: np.ndarray,
        kinks: Mapping[str, float] | None = None,
    ):
        self.network = network
        self.reference = np.asarray(reference, dtype=float)
        self.kinks = {} if kinks is None else dict(kinks)

    @property
    def locks(self) -> tuple[str, ...]:
        """The names of the locked joints."""
        return tuple(self.kinks)

    @cached_property
    def turns(self) -> dict[str, float]:
        """The D-H angles of the outer joints, rad, in the reference configuration."""
        angles = self.network.ring_angles(self.reference).tolist()
        turns = dict(zip(self.network.plan.ring, angles, strict=True))
        return turns | self.kinks

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism, its locks at 0."""
        points, directions = self._axes()
        joints = []
        for axis in self.network.plan.axes:
            bars = self.network.plan.bars_at(axis)
            locked = (LOCKED_IN_PLACE, *[None] * (len(bars) - 2))
            joint = Joint(
                axis,
                JointKind.REVOLUTE,
                bars,
                point=tuple(points[axis].tolist()),
                direction=tuple(directions[axis].tolist()),
                locked=locked if axis in self.kinks else (),
            )
            joints.append(joint)
        return Mechanism(tuple(joints), self.network.name)

    def label(self, axis: str) -> str:
        """What the variable of the mechanism is called that is the angle of the ring at
        an axis."""
        return self.mechanism.joint(axis).labels[0]

    # --- places -----------------------------------------------------------------------

    def _axes(self) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """A point (3,) of every axis, and its direction (3,)."""
        points: dict[str, np.ndarray] = {}
        directions: dict[str, np.ndarray] = {}
        for number, base in self._bases().items():
            frames = base @ self._frames[number]
            for corner, axis in enumerate(self.network.plan.cells[number].axes):
                points.setdefault(axis, frames[corner, :3, 3])
                directions.setdefault(axis, frames[corner, :3, 2])
        return points, directions

    @cached_property
    def _frames(self) -> list[np.ndarray]:
        """For every cell the frames (5, 4, 4) of its axes before they turn."""
        angles = self.network.corner_angles(self.reference)
        return [
            joint_frames(self.network.cell_loop(number).arrays, of_cell)
            for number, of_cell in enumerate(angles)
        ]

    def _bases(self) -> dict[int, np.ndarray]:
        """Where every cell stands (4, 4), the first one at the origin: cells meet in
        their common bar, through which they run in opposite senses."""
        plan = self.network.plan
        angles = self.network.corner_angles(self.reference)
        bases = {0: np.eye(4)}
        while len(bases) < len(plan.cells):
            for number, cell in enumerate(plan.cells):
                if number in bases:
                    continue
                for corner in range(4):
                    bar = plan.bar(cell, corner)
                    other = self._corner_of(bar, bases)
                    if other is None:
                        continue
                    of, leaving = other
                    turned = _turn(angles[of, leaving])
                    there = bases[of] @ self._frames[of][leaving] @ turned
                    here = self._frames[number][corner + 1] @ _turn(np.pi)
                    bases[number] = there @ np.linalg.inv(here)
                    break
        return bases

    def _corner_of(self, bar: str, cells: Iterable[int]) -> tuple[int, int] | None:
        """The first of the cells that has the bar, and the corner from which the bar
        leaves."""
        plan = self.network.plan
        for number in cells:
            for corner in range(4):
                if plan.bar(plan.cells[number], corner) == bar:
                    return number, corner
        return None

    # --- variables --------------------------------------------------------------------

    def variables(self, states: np.ndarray) -> np.ndarray:
        """The variables (..., v) of the mechanism, in its order, at states (..., c)."""
        now = self._directions(states)
        before = self._directions(self.reference)
        columns = []
        for axis in self.network.plan.axes:
            first, *others = self.network.plan.bars_at(axis)
            for bar in others:
                turned = now[axis, bar] - now[axis, first]
                at_reference = before[axis, bar] - before[axis, first]
                columns.append(turned - at_reference)
        return wrap_angles(np.stack(np.broadcast_arrays(*columns), axis=-1))

    def _directions(self, states: np.ndarray) -> dict[tuple[str, str], np.ndarray]:
        """The angle about each axis at which each bar leads away from it, from the
        first one."""
        angles = self.network.corner_angles(states)
        directions: dict[tuple[str, str], np.ndarray] = {}
        for axis in self.network.plan.axes:
            angle = np.zeros(angles.shape[:-2])
            for corner in self.network.plan.corners(axis):
                directions.setdefault((axis, corner.arrival), angle)
                angle = angle + np.pi + angles[..., corner.cell, corner.number]
                directions.setdefault((axis, corner.departure), angle)
        return directions


def _turn(angle: float) -> np.ndarray:
    """The displacement (4, 4) that turns about z."""
    turn = np.eye(4)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return turn
