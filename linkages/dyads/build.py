"""The configurations of a mechanism at a value of its driver, built part by part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from linkages.dyads.generic import UnfollowedError
from linkages.dyads.geometry import PlaneGeometry
from linkages.dyads.pinned import GenericCount, PinnedGroup, generic_count
from linkages.dyads.plan import Contact, Plan, Step
from linkages.dyads.space import SpaceGeometry
from linkages.mechanisms.joint import Motion
from linkages.structure.structure import Structure

MOST = 256  # configurations at one value of the driver


class TooManyError(ArithmeticError):
    """There are more configurations than are worth the time."""


# How bodies move and dyads close.
Geometry: TypeAlias = PlaneGeometry | SpaceGeometry


class Builder:
    """Builds the mechanism of a ``structure`` by a ``plan``, in a ``geometry``.

    ``singular``: how many complex configurations of larger groups were left out so far,
    as they are of lower rank, or not isolated.
    """

    def __init__(self, structure: Structure, geometry: Geometry, plan: Plan):
        self.structure = structure
        self.mechanism = structure.mechanism
        self.geometry = geometry
        self.plan = plan
        self.singular = 0
        # the bodies of every pair, by number
        self.ends = [ends[:2] for ends in structure.groups.ends.values()]

    def configurations(self, values: Sequence[float]) -> list[list[Any]]:
        """The poses of all bodies in every configuration in which the known variables
        have these ``values`` (those of others are not read), rad and the user's unit.

        Raises `DegenerateDyadError` where a dyad closes in a whole curve of them,
        `UnfollowedError` where it is not known that all of a larger group were found,
        and `TooManyError`.
        """
        inner = self._inner_poses(values)
        states: list[dict[int, Any]] = [{self.plan.start: self.geometry.rest}]
        for step in self.plan.steps:
            states = [
                {**state, **dict(zip(step.parts, poses, strict=True))}
                for state in states
                for poses in self._closed(step, state, inner)
            ]
            if len(states) > MOST:
                raise TooManyError
        parts = list(enumerate(self.plan.part))
        return [
            [state[part].after(inner[body]) for body, part in parts] for state in states
        ]

    def is_never_degenerate(self, values: Sequence[float]) -> bool:
        """Whether no dyad can close in a curve of configurations, wherever the parts
        are that it stands on, and whatever the driver's value is; other known
        ``values`` are locks."""
        for known in self.plan.known:
            numbers = self.mechanism.pairs[known].variables
            is_driven = any(self.mechanism.variables[k].locked is None for k in numbers)
            if is_driven and self.plan.part[self.ends[known][0]] != self.plan.start:
                return False  # lengths within a placed part change with the driver
        inner = self._inner_poses(values)
        standing = dict.fromkeys(self.plan.part, self.geometry.rest)
        for step in self.plan.steps:
            if step.is_group:
                return False
            if len(step.parts) == 1:
                ends = (self._end(one, standing, inner) for one in step.contacts)
                if self.geometry.leaves_loose(*ends):
                    return False
                continue
            joints = self._dyad(step, standing, inner)
            if self.geometry.may_be_degenerate(*joints):
                return False
        return True

    # --- parts ------------------------------------------------------------------------

    def _inner_poses(self, values: Sequence[float]) -> dict[int, Any]:
        """The pose of every body in its part, by number: in the first body of it."""
        poses = dict.fromkeys(self.plan.part, self.geometry.rest)
        left = list(self.plan.known)
        while left:
            number = next(k for k in left if not poses.keys().isdisjoint(self.ends[k]))
            left.remove(number)
            base, moved = self.ends[number]
            motion: Any = self.geometry.rest
            for k in self.mechanism.pairs[number].variables:
                of_variable = self.mechanism.variables[k].motion
                step = self.geometry.motion(of_variable, values[k])
                motion = motion.after(step)
            if moved not in poses:
                poses[moved] = poses[base].after(motion)
            elif base not in poses:
                poses[base] = poses[moved].after(motion.inverse())
        return poses

    # --- steps ------------------------------------------------------------------------

    def _closed(
        self, step: Step, state: dict[int, Any], inner: dict[int, Any]
    ) -> Sequence[tuple[Any, ...]]:
        """The poses of the parts of a step, in every way in which it closes."""
        if step.is_group:
            return self._closed_group(step, state, inner)
        if len(step.parts) == 1:
            ends = [self._end(contact, state, inner) for contact in step.contacts]
            return [(pose,) for pose in self.geometry.close_monad(*ends)]
        return self.geometry.close_dyad(*self._dyad(step, state, inner))

    def _closed_group(
        self, step: Step, state: dict[int, Any], inner: dict[int, Any]
    ) -> Sequence[tuple[Any, ...]]:
        """The same for a larger group, in a plane or on a sphere. Raises
        `UnfollowedError`."""
        geometry = self.geometry
        if not geometry.has_pins:
            raise UnfollowedError("its axes are anywhere in space")
        group = PinnedGroup(self.plan.part, step, geometry.is_spherical)
        own: dict[tuple[int, str], complex] = {}  # places of pins in parts
        for contact in step.contacts:
            for body in (contact.first, contact.second):
                part = self.plan.part[body]
                pose = state.get(part, geometry.rest).after(inner[body])
                own[part, contact.joint] = geometry.pin(pose, self._motion(contact))
        standing = [own[part, joint] for joint, part in group.standing.items()]
        regular, singular = group.assemblies(own, standing)
        self.singular += singular
        return [
            tuple(geometry.held_by_pins(*ends) for ends in parts) for parts in regular
        ]

    def generic_count(self) -> GenericCount | None:
        """How many complex configurations there are, for generic lengths; None where
        dyads are all that is built."""
        if not self.plan.has_groups:
            return None
        is_spherical = self.geometry.is_spherical
        counts = [
            generic_count(self.plan.part, step, is_spherical)
            for step in self.plan.steps
        ]
        ways = math.prod(one.ways for one in counts)
        return GenericCount(ways, max(one.trace for one in counts))

    def _dyad(
        self, step: Step, state: dict[int, Any], inner: dict[int, Any]
    ) -> tuple[Any, Any, Any]:
        """The three joints of a dyad."""
        one, contact, other = step.contacts
        motion = self._motion(contact)
        middle = self.geometry.joint(
            inner[contact.first], inner[contact.second], motion
        )
        return self._end(one, state, inner), middle, self._end(other, state, inner)

    def _end(
        self, contact: Contact, state: dict[int, Any], inner: dict[int, Any]
    ) -> Any:
        """A joint that leads from what stands to a part."""
        pose = state[self.plan.part[contact.first]].after(inner[contact.first])
        own = inner[contact.second]
        return self.geometry.joint(pose, own, self._motion(contact))

    def _motion(self, contact: Contact) -> Motion:
        return self.mechanism.variables[contact.variable].motion

    # --- unknowns ---------------------------------------------------------------------

    def unknowns(self, poses: Sequence[Any]) -> np.ndarray:
        """The unknowns (n,) of the structure at these poses of all bodies, but for what
        others are coupled to; angles between -pi and pi."""
        result = np.zeros(len(self.structure.unknowns))
        for pair, (base, moved) in zip(self.mechanism.pairs, self.ends, strict=True):
            if len(pair.variables) != 1:
                continue
            (number,) = pair.variables
            share = self.structure.share(number)
            if share is None or share.rate != 1.0 or share.offset != 0.0:
                continue
            relative = poses[base].inverse().after(poses[moved])
            motion = self.mechanism.variables[number].motion
            unit = 1.0 if motion.is_turn else self.structure.unit
            result[share.column] = self.geometry.value(relative, motion) / unit
        return result
