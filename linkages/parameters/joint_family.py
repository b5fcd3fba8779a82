"""Mechanisms given by joints as a family: the coordinates of joints are its parameters,
and so are ratios of gears and the values of locks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkages.closure.changes import Changes, Elements
from linkages.closure.motors import Number, is_zero
from linkages.entry import Parameter, ParameterKind
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint, Motion
from linkages.mechanisms.mechanism import Mechanism
from linkages.parameters.mechanism_family import MechanismFamily
from linkages.parameters.table_family import table_parameter
from linkages.structure.plane import normal_of_plane
from linkages.structure.structure import Structure

AXES = dict(zip("xyz", np.eye(3), strict=True))
RATIO, OFFSET, LOCKED = "ratio", "offset", "locked"
TWICE = 2.0  # a ratio goes from nothing to so much of it where no range is given


class JointFamily(MechanismFamily):
    """The mechanisms with the joints of a first one at other places, in a configuration
    in which it is closed: J1.x, J1.y and J1.z are the coordinates of joint J1, J2.ratio
    and J2.offset those of its coupling, J3.locked the value of a lock."""

    def __init__(self, mechanism: Mechanism):
        super().__init__(mechanism, ())
        self.parameters = tuple(_parameters(self.structure, mechanism))

    def changes(self, values: Mapping[str, Number], structure: Structure) -> Changes:
        return _MovedJoints(self, values, structure)

    def offsets(self, values: Mapping[str, float]) -> np.ndarray:
        """None: all are closed where they are drawn."""
        return np.zeros(len(self.structure.unknowns))

    def drawn(self, values: Mapping[str, float]) -> Mechanism:
        joints = tuple(_with(joint, values) for joint in self.mechanism.joints)
        return replace(self.mechanism, joints=joints)


def _with(joint: Joint, values: Mapping[str, float]) -> Joint:
    """A joint with the numbers that ``values`` have for it."""
    point = joint.point
    if point is not None:
        x, y, z = (
            values.get(f"{joint.name}.{axis}", x)
            for axis, x in zip(AXES, point, strict=True)
        )
        point = (x, y, z)
    locked = [
        values.get(f"{label}.{LOCKED}", value)
        for label, value in zip(joint.labels, joint.locked, strict=True)
    ]
    coupled = [
        one and Coupling(one.to, *(values[f"{label}.{key}"] for key in (RATIO, OFFSET)))
        for label, one in zip(joint.labels, joint.coupled, strict=True)
    ]
    return replace(joint, point=point, locked=tuple(locked), coupled=tuple(coupled))


# --- what the parameters are ----------------------------------------------------------


def _parameters(structure: Structure, mechanism: Mechanism) -> Iterator[Parameter]:
    size = structure.unit
    normal = normal_of_plane(mechanism)
    # along the axes of a planar mechanism nothing changes
    axes = [
        axis
        for axis, along in AXES.items()
        if normal is None or not np.allclose(np.abs(normal), along)
    ]
    shared = [one.joints for one in structure.points if len(set(one.joints)) > 1]
    fixed = {name for names in shared for name in names}
    for joint in mechanism.joints:
        is_free = joint.point is not None and joint.name not in fixed
        if is_free and not joint.kind.facets.is_point_drawn_only:
            for axis in axes:
                value = float(AXES[axis] @ joint.place)
                meaning = f"{axis} of joint {joint.name}"
                yield table_parameter(f"{joint.name}.{axis}", value, meaning, size)
        yield from _of_variables(joint, size, has_spheres=bool(structure.points))


def _of_variables(joint: Joint, size: float, has_spheres: bool) -> Iterator[Parameter]:
    """The numbers of couplings and locks; rods hang on locks."""
    motions = joint.motions * (len(joint.bodies) - 1)
    rows = zip(joint.labels, motions, joint.coupled, joint.locked, strict=True)
    for label, motion, coupling, lock in rows:
        unit = 0.0 if motion.is_turn else size
        if coupling is not None:
            ends = sorted((0.0, TWICE * coupling.ratio))
            meaning = f"ratio of {label} to {coupling.to}"
            kind = ParameterKind.NUMBER
            yield Parameter(f"{label}.{RATIO}", coupling.ratio, kind, meaning, *ends)
            meaning = f"offset of {label} from {coupling.to}"
            yield table_parameter(f"{label}.{OFFSET}", coupling.offset, meaning, unit)
        if lock is not None and not has_spheres:
            yield table_parameter(f"{label}.{LOCKED}", lock, f"lock of {label}", unit)


# --- what they change -----------------------------------------------------------------


class _MovedJoints(Changes):
    """The joints of a ``family`` at the places that ``values`` give, on both bodies."""

    def __init__(
        self,
        family: JointFamily,
        values: Mapping[str, Number],
        structure: Structure,
    ):
        self.structure = structure
        self.values, self.defaults = values, family.defaults
        self.variables = self.structure.mechanism.variables
        self.couplings = {
            label: one
            for joint in family.mechanism.joints
            for label, one in zip(joint.labels, joint.coupled, strict=True)
            if one is not None
        }

    def _moved(self, joint: str) -> list[Number]:
        """How far a joint is moved (3,), in the structure's unit."""
        names = [f"{joint}.{axis}" for axis in AXES]
        gaps = [
            self.values[name] - self.defaults[name] if name in self.defaults else 0.0
            for name in names
        ]
        return [gap if is_zero(gap) else gap / self.structure.unit for gap in gaps]

    def displacement(self, pair: int, side: int) -> Elements:
        pairs = self.structure.mechanism.pairs
        if pair >= len(pairs):
            return ()
        moved = zip(AXES.values(), self._moved(pairs[pair].joint), strict=True)
        return [
            (Motion(False, axis, np.zeros(3)), -gap if side else gap)
            for axis, gap in moved
            if not is_zero(gap)
        ]

    def _ends(self, closure: int) -> tuple[str, str]:
        """The joints at the two points that a closure brings together."""
        one = self.structure.closures[closure]
        if one.rod is not None:
            return one.rod.joints
        return one.joints[0], one.joints[0]

    def ends(self, closure: int) -> tuple[Sequence[Number], Sequence[Number]]:
        first, second = self._ends(closure)
        return self._moved(first), self._moved(second)

    def rod(self, closure: int) -> Number:
        rod = self.structure.closures[closure].rod
        first, second = self.ends(closure)
        if rod is None or all(is_zero(gap) for gap in (*first, *second)):
            return 0.0
        before = (rod.centers[1] - rod.centers[0]) / self.structure.unit
        square: Number = 0.0
        for x, a, b in zip(before.tolist(), first, second, strict=True):
            side = x + (b - a)
            square = square + side * side
        return np.sqrt(square) - rod.length / self.structure.unit

    def lock(self, variable: int) -> Number | None:
        name = f"{self.variables[variable].label}.{LOCKED}"
        if name not in self.defaults:
            return None
        return self.values[name] / self._unit(variable)

    def share(self, variable: int) -> tuple[Number, Number] | None:
        label = self.variables[variable].label
        if label not in self.couplings:
            return None
        rate, offset = 1.0, 0.0
        while label in self.couplings:
            own = [self.values[f"{label}.{key}"] for key in (RATIO, OFFSET)]
            offset = offset + rate * own[1]
            rate = rate * own[0]
            label = self.couplings[label].to
        unit, leader = self._unit(variable), self.variables[variable].leader.number
        return rate * (self._unit(leader) / unit), offset / unit

    def _unit(self, variable: int) -> float:
        """What a variable, by number, is counted in: rad or the structure's unit."""
        is_turn = self.variables[variable].motion.is_turn
        return 1.0 if is_turn else self.structure.unit
