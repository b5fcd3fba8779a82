"""A group of parts of a mechanism as bodies with pins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from linkages.dyads.geometry import PlanePose
from linkages.dyads.group import (
    Pattern,
    UnfollowedError,
    all_assemblies,
    generic_solutions,
)
from linkages.dyads.plan import Plan, Step

DYAD = 2  # configurations in which a dyad closes


@dataclass(frozen=True)
class GenericCount:
    """In how many complex ways something closes: by a formula, or followed along paths
    with a ``trace`` test."""

    ways: int
    trace: float = 0.0


class PinnedGroup:
    """The parts of a ``step``, ``part`` that of every body, with the joints that hold
    them. Raises `UnfollowedError` where these are not pins, or do not hold it."""

    def __init__(self, part: tuple[int, ...], step: Step):
        self.parts = step.parts
        joints: dict[int, dict[str, None]] = {one: {} for one in step.parts}
        self.standing: dict[str, int] = {}  # a part that stands, by joint
        for contact in step.contacts:
            for body in (contact.first, contact.second):
                one = part[body]
                if one in joints:
                    joints[one][contact.joint] = None
                else:
                    self.standing.setdefault(contact.joint, one)
        own = [name for names in joints.values() for name in names]
        names = list(dict.fromkeys([*self.standing, *own]))
        self.joints = {
            one: sorted(held, key=names.index) for one, held in joints.items()
        }
        bodies = tuple(
            tuple(names.index(name) for name in self.joints[one]) for one in self.parts
        )
        self.pattern = Pattern(bodies, len(self.standing))
        if not all(contact.is_turn for contact in step.contacts):
            raise UnfollowedError("it has slides")
        if not self.pattern.is_square:
            raise UnfollowedError("it moves, or has more bars than hold it")

    def poses(
        self,
        own: Mapping[tuple[int, str], complex],
        standing: Sequence[complex],
        size: float,
    ) -> list[tuple[PlanePose, ...]]:
        """The poses of the parts in all assemblies, from the places of the pins of
        parts and those that stand; ``size`` is a length of the mechanism. Raises
        `UnfollowedError`."""
        pins = [
            np.array([own[one, name] for name in self.joints[one]])
            for one in self.parts
        ]
        scaled = [places / size for places in pins]
        known = all_assemblies(self.pattern, scaled, np.array(standing) / size)
        bodies = list(zip(pins, map(list, self.pattern.bodies), strict=True))
        return [
            tuple(_pose(places, size * assembly[numbers]) for places, numbers in bodies)
            for assembly in known
        ]


def _pose(own: np.ndarray, places: np.ndarray) -> PlanePose:
    """The pose of a body with its first two pins in these places."""
    turn = complex((places[1] - places[0]) / (own[1] - own[0]))
    turn /= abs(turn)
    return PlanePose(turn, complex(places[0] - turn * own[0]))


def are_held_by_pins(plan: Plan) -> bool:
    """Whether pins hold all groups of a plan larger than dyads."""
    try:
        for step in plan.groups:
            PinnedGroup(plan.part, step)
    except UnfollowedError:
        return False
    return True


def generic_count(part: tuple[int, ...], step: Step) -> GenericCount:
    """In how many complex ways a step closes, for generic lengths."""
    if step.is_group:
        generic = generic_solutions(PinnedGroup(part, step).pattern)
        return GenericCount(generic.count, generic.trace or 0.0)
    return GenericCount(DYAD if len(step.parts) == DYAD else 1)
