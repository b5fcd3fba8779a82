"""The configurations of a planar mechanism at a value of its driver."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from linkages.mechanisms.dyads.geometry import (
    End,
    Middle,
    Pin,
    Pivot,
    Rail,
    Slider,
    close_dyad,
    close_monad,
    may_be_degenerate,
)
from linkages.mechanisms.dyads.plan import Contact, Plan, Step
from linkages.mechanisms.dyads.poses import AT_REST, PlanePose
from linkages.mechanisms.joint import Motion
from linkages.mechanisms.mechanism import Pair
from linkages.mechanisms.structure import Structure

__all__ = ["Builder", "TooManyError"]

MOST = 256  # configurations at one value of the driver


class TooManyError(ArithmeticError):
    """There are more configurations than are worth the time."""


class Builder:
    """Builds the mechanism of a ``structure``, which moves in the plane across
    ``normal`` (3,), by a ``plan``."""

    def __init__(self, structure: Structure, normal: np.ndarray, plan: Plan):
        self.structure = structure
        self.mechanism = structure.mechanism
        self.plan = plan
        self.normal = normal
        self.numbers = {body: k for k, body in enumerate(self.mechanism.bodies)}

    def configurations(self, values: Sequence[float]) -> list[list[PlanePose]]:
        """The poses of all bodies in every configuration in which the known variables
        have these ``values`` (those of others are not read), rad and the user's unit.

        Raises `DegenerateDyadError` where a dyad closes in a whole curve of them, and
        `TooManyError`.
        """
        inner = self._inner_poses(values)
        states: list[dict[int, PlanePose]] = [{self.plan.part[0]: AT_REST}]
        for step in self.plan.steps:
            states = [
                {**state, **dict(zip(step.parts, poses, strict=True))}
                for state in states
                for poses in self._closed(step, state, inner)
            ]
            if len(states) > MOST:
                raise TooManyError
        return [self._poses_of_bodies(state, inner) for state in states]

    def is_never_degenerate(self, values: Sequence[float]) -> bool:
        """Whether no dyad can close in a curve of configurations, wherever the parts
        are that it stands on. The known ``values`` within parts are of no account."""
        inner = self._inner_poses(values)
        standing = dict.fromkeys(self.plan.part, AT_REST)
        for step in self.plan.steps:
            if len(step.parts) == 1:
                if not any(contact.is_turn for contact in step.contacts):
                    return False
                continue
            one, contact, other = step.contacts
            ends = self._end(one, standing, inner), self._end(other, standing, inner)
            middle = self._middle(contact, inner)
            if may_be_degenerate(ends[0], middle, ends[1], self.structure.unit):
                return False
        return True

    # --- parts ------------------------------------------------------------------------

    def _inner_poses(self, values: Sequence[float]) -> dict[int, PlanePose]:
        """The pose of every body in its part, by number: in the first body of it."""
        poses = dict.fromkeys(self.plan.part, AT_REST)
        left = [self.mechanism.pairs[number] for number in self.plan.known]
        while left:
            for pair in left:
                base, moved = self.numbers[pair.base], self.numbers[pair.moved]
                if base in poses or moved in poses:
                    break
            left.remove(pair)
            motion = self._pair_motion(pair, values)
            if base in poses and moved not in poses:
                poses[moved] = poses[base].after(motion)
            elif moved in poses and base not in poses:
                poses[base] = poses[moved].after(motion.inverse())
        return poses

    def _pair_motion(self, pair: Pair, values: Sequence[float]) -> PlanePose:
        pose = AT_REST
        for number in pair.variables:
            motion = self.mechanism.variables[number].motion
            pose = pose.after(self._motion(motion, values[number]))
        return pose

    def _motion(self, motion: Motion, value: float) -> PlanePose:
        if not motion.is_turn:
            return PlanePose(1 + 0j, value * self._flat(motion.direction))
        turn = cmath.exp(1j * value * self._sense(motion))
        center = self._flat(motion.point)
        return PlanePose(turn, center - turn * center)

    def _sense(self, motion: Motion) -> float:
        """1 where a turn is about the normal, -1 where it is the other way round."""
        return 1.0 if motion.direction @ self.normal > 0 else -1.0

    @cached_property
    def _axes(self) -> np.ndarray:
        """Unit vectors (2, 3) of the plane, right-handed about the normal."""
        other = np.eye(3)[np.argmin(np.abs(self.normal))]
        first = np.cross(other, self.normal)
        first /= np.linalg.norm(first)
        return np.array([first, np.cross(self.normal, first)])

    def _flat(self, vector: np.ndarray) -> complex:
        """A vector (3,) in the plane."""
        x, y = self._axes @ vector
        return complex(x, y)

    # --- steps ------------------------------------------------------------------------

    def _closed(
        self, step: Step, state: dict[int, PlanePose], inner: dict[int, PlanePose]
    ) -> Sequence[tuple[PlanePose, ...]]:
        """The poses of the parts of a step, in every way in which it closes."""
        size = self.structure.unit
        if len(step.parts) == 1:
            ends = [self._end(contact, state, inner) for contact in step.contacts]
            return [(pose,) for pose in close_monad(ends[0], ends[1], size)]
        one, contact, other = step.contacts
        middle = self._middle(contact, inner)
        ends = [self._end(one, state, inner), self._end(other, state, inner)]
        return close_dyad(ends[0], middle, ends[1], size)

    def _end(
        self,
        contact: Contact,
        state: dict[int, PlanePose],
        inner: dict[int, PlanePose],
    ) -> End:
        """A joint that leads from what stands to a part."""
        pose = state[self.plan.part[contact.first]].after(inner[contact.first])
        own = inner[contact.second]
        motion = self.mechanism.variables[contact.variable].motion
        if contact.is_turn:
            center = self._flat(motion.point)
            return Pivot(pose(center), own(center))
        along = pose.turn * self._flat(motion.direction)
        return Rail(pose.after(own.inverse()), along)

    def _middle(self, contact: Contact, inner: dict[int, PlanePose]) -> Middle:
        """A joint between the two parts of a step."""
        one, other = inner[contact.first], inner[contact.second]
        motion = self.mechanism.variables[contact.variable].motion
        if contact.is_turn:
            center = self._flat(motion.point)
            return Pin(one(center), other(center))
        along = one.turn * self._flat(motion.direction)
        return Slider(one.after(other.inverse()), along)

    def _poses_of_bodies(
        self, state: dict[int, PlanePose], inner: dict[int, PlanePose]
    ) -> list[PlanePose]:
        return [
            state[part].after(inner[body]) for body, part in enumerate(self.plan.part)
        ]

    # --- unknowns ---------------------------------------------------------------------

    def unknowns(self, poses: Sequence[PlanePose]) -> np.ndarray:
        """The unknowns (n,) of the structure at these poses of all bodies; angles
        between -pi and pi."""
        result = np.zeros(len(self.structure.unknowns))
        for pair in self.mechanism.pairs:
            base, moved = self.numbers[pair.base], self.numbers[pair.moved]
            relative = poses[base].inverse().after(poses[moved])
            if len(pair.variables) != 1:
                continue
            (number,) = pair.variables
            motion = self.mechanism.variables[number].motion
            share = self.structure.share(number)
            if share is None:
                continue
            if motion.is_turn:
                value = cmath.phase(relative.turn) * self._sense(motion)
            else:
                way = relative.shift / self._flat(motion.direction)
                value = way.real / self.structure.unit
            if share.rate == 1.0 and share.offset == 0.0:
                result[share.column] = value
        return result
