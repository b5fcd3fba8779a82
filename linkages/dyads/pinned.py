"""A group of parts of a mechanism as bodies with pins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from linkages.dyads.generic import UnfollowedError
from linkages.dyads.group import Pattern, all_assemblies, generic_of
from linkages.dyads.plan import Plan, Step

DYAD = 2  # configurations in which a dyad closes


@dataclass(frozen=True)
class GenericCount:
    """In how many complex ways something closes: by a formula, or followed along paths
    with a ``trace`` test."""

    ways: int
    trace: float = 0.0


class Ends(NamedTuple):
    """The places of two pins of a part, in the part and elsewhere."""

    own: list[complex]
    there: list[complex]


class PinnedGroup:
    """The parts of a ``step``, ``part`` that of every body, with the joints that hold
    them, in a plane or on a sphere. Raises `UnfollowedError` where these are not pins,
    or do not hold it."""

    def __init__(self, part: tuple[int, ...], step: Step, is_spherical: bool):
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
        self.pattern = Pattern(bodies, len(self.standing), is_spherical)
        if not all(contact.is_turn for contact in step.contacts):
            raise UnfollowedError("it has slides")
        if not self.pattern.is_square:
            raise UnfollowedError("it moves, or has more bars than hold it")

    def assemblies(
        self, own: Mapping[tuple[int, str], complex], standing: Sequence[complex]
    ) -> tuple[list[list[Ends]], int]:
        """Where the first two pins of every part are in the part, and where they are in
        each of the regular assemblies, from the places of the pins of parts and those
        that stand; and how many complex ones are singular. Raises `UnfollowedError`."""
        pins = [[own[one, name] for name in self.joints[one]] for one in self.parts]
        found = all_assemblies(self.pattern, pins, standing)
        regular = [
            [
                Ends(numbers[:2], places[list(pair[:2])].tolist())
                for numbers, pair in zip(pins, self.pattern.bodies, strict=True)
            ]
            for places in found.places
        ]
        return regular, found.singular


def are_held_by_pins(plan: Plan, is_spherical: bool) -> bool:
    """Whether pins hold all groups of a plan larger than dyads."""
    try:
        for step in plan.groups:
            PinnedGroup(plan.part, step, is_spherical)
    except UnfollowedError:
        return False
    return True


def generic_count(
    part: tuple[int, ...], step: Step, is_spherical: bool
) -> GenericCount:
    """In how many complex ways a step closes, for generic lengths."""
    if step.is_group:
        generic = generic_of(PinnedGroup(part, step, is_spherical).pattern)
        return GenericCount(generic.count, generic.trace or 0.0)
    return GenericCount(DYAD if len(step.parts) == DYAD else 1)
