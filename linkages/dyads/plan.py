"""In which order the bodies of a mechanism are placed, one group after the other.

With some variables known, the drivers, bodies that are joined by known variables are
one part. From one of the largest parts on two parts at a time are placed, which close a
chain of three joints, or one part that two joints hold already (Assur's decomposition
into groups of the second class). Where nothing more is placed so, what is left is one
larger group, but for the dyads that stand on it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from networkx.utils import UnionFind

from linkages.mechanisms.mechanism import Mechanism

MOST_BEGUN = 3  # parts with which a plan may begin


class Contact(NamedTuple):
    """A joint between two bodies, by number, that turns about the point of the
    ``variable`` of this number, or slides along its direction."""

    joint: str
    first: int
    second: int
    variable: int
    is_turn: bool

    def reversed(self) -> Contact:
        """The joint as seen from its second body."""
        return self._replace(first=self.second, second=self.first)


class Step(NamedTuple):
    """One ``part`` or more that are placed next, and the ``contacts`` for it: those of
    one part lead from what stands to it; of two parts, from what stands to the first
    one, on to the second one, and from what stands to that; of a larger group they are
    all contacts of its parts, also with what stands."""

    parts: tuple[int, ...]
    contacts: tuple[Contact, ...]

    @property
    def is_group(self) -> bool:
        """Whether the parts are more than a dyad."""
        return len(self.parts) > 2


@dataclass(frozen=True)
class Plan:
    """The ``part`` of every body, by number, the ``known`` pairs, by number, and the
    ``steps`` in which parts are placed after the part ``start``."""

    start: int
    part: tuple[int, ...]
    known: tuple[int, ...]
    steps: tuple[Step, ...]

    @property
    def largest_group(self) -> int:
        """The number of parts of the largest group."""
        return max((len(step.parts) for step in self.steps), default=0)

    @property
    def groups(self) -> list[Step]:
        """The steps that place more than a dyad."""
        return [step for step in self.steps if step.is_group]

    @property
    def has_groups(self) -> bool:
        """Whether it takes more than dyads."""
        return bool(self.groups)


def make_plan(
    mechanism: Mechanism, drivers: Collection[int], with_groups: bool = False
) -> Plan | None:
    """How a ``mechanism`` is built where the variables of these numbers, the
    ``drivers``, and those that are locked have given values; None where dyads, and, if
    it is ``with_groups``, larger groups do not do."""
    known = _known_pairs(mechanism, drivers)
    if known is None:
        return None
    numbers = {body: k for k, body in enumerate(mechanism.bodies)}
    parts = UnionFind(range(len(numbers)))
    for number in known:
        pair = mechanism.pairs[number]
        parts.union(numbers[pair.base], numbers[pair.moved])
    part = tuple(parts[body] for body in range(len(numbers)))
    contacts = [
        contact
        for contact in _contacts(mechanism, numbers, known)
        if part[contact.first] != part[contact.second]
    ]
    sizes = Counter(part)
    starts = sorted(sizes, key=lambda one: (-sizes[one], one))
    plans = []
    for start in starts if with_groups else starts[:MOST_BEGUN]:
        steps = _steps(start, part, contacts, with_groups)
        if steps is not None:
            plans.append(Plan(start, part, tuple(known), steps))
    return min(plans, key=lambda plan: plan.largest_group, default=None)


def _known_pairs(mechanism: Mechanism, drivers: Collection[int]) -> list[int] | None:
    """The pairs, by number, that have known values only; None where one has a variable
    that is not known beside another, or that is coupled."""
    known = []
    leaders = [one.leader.number for one in mechanism.variables]
    for number, pair in enumerate(mechanism.pairs):
        is_known = [
            mechanism.variables[k].locked is not None or leaders[k] in drivers
            for k in pair.variables
        ]
        if all(is_known):
            known.append(number)
            continue
        first = pair.variables[0]
        is_coupled = leaders[first] != first or leaders.count(first) > 1
        if len(is_known) > 1 or is_coupled:
            return None
    return known


def _contacts(
    mechanism: Mechanism, numbers: dict[str, int], known: list[int]
) -> Iterator[Contact]:
    """The joints between any two bodies that do not stand at a known value; a joint of
    several joins each to each."""
    for joint in mechanism.joints:
        bodies = [
            (numbers[pair.moved], pair.variables[0])
            for number, pair in enumerate(mechanism.pairs)
            if pair.joint == joint.name and number not in known
        ]
        if bodies:
            bodies.insert(0, (numbers[joint.bodies[0]], bodies[0][1]))
        for k, (second, variable) in enumerate(bodies):
            is_turn = mechanism.variables[variable].motion.is_turn
            for first, _ in bodies[:k]:
                yield Contact(joint.name, first, second, variable, is_turn)


# --- order ----------------------------------------------------------------------------


def _steps(
    start: int, part: tuple[int, ...], contacts: list[Contact], with_groups: bool
) -> tuple[Step, ...] | None:
    """The steps that place all parts after one; None where they do not."""
    both = contacts + [contact.reversed() for contact in contacts]
    placed = {start}
    waiting = set(part) - placed
    steps = []
    while waiting:
        step = _next_step(part, both, placed)
        if step is None and with_groups:
            step = _group_left(part, contacts, placed)
        if step is None:
            return None
        steps.append(step)
        placed |= set(step.parts)
        waiting -= placed
    return tuple(steps)


def _next_step(
    part: tuple[int, ...], contacts: list[Contact], placed: set[int]
) -> Step | None:
    """A part, or else two, that are next to be placed."""
    holding: dict[int, list[Contact]] = {}  # from what is placed, by part
    for contact in contacts:
        first, second = part[contact.first], part[contact.second]
        if first in placed and second not in placed:
            beside = holding.setdefault(second, [])
            if all(contact.joint != other.joint for other in beside):
                beside.append(contact)
    for number in sorted(holding):
        if len(holding[number]) > 1:
            # two slides leave the place open where they are parallel
            turning = sorted(holding[number], key=lambda one: not one.is_turn)
            return Step((number,), tuple(turning[:2]))
    for contact in contacts:
        first, second = part[contact.first], part[contact.second]
        if first not in holding or second not in holding:
            continue
        for one in holding[first]:
            for other in holding[second]:
                # three different joints, not all of them slides
                three = (one, contact, other)
                joints = {each.joint for each in three}
                if len(joints) == 3 and any(each.is_turn for each in three):
                    return Step((first, second), three)
    return None


def _group_left(
    part: tuple[int, ...], contacts: list[Contact], placed: set[int]
) -> Step | None:
    """All parts that wait, but for the dyads that stand on the others."""
    group = set(part) - placed
    while dyad := _dyad_on_top(part, contacts, group, placed):
        group -= dyad
    own = []
    for contact in contacts:
        both = {part[contact.first], part[contact.second]}
        if both <= group | placed and not both <= placed:
            own.append(contact)
    return Step(tuple(sorted(group)), tuple(own)) if len(group) > 2 else None


def _dyad_on_top(
    part: tuple[int, ...], contacts: list[Contact], group: set[int], placed: set[int]
) -> set[int]:
    """Two parts of a ``group`` on which no other one stands; nothing where there are
    none."""
    joints = _joints_of(part, contacts, group | placed)
    for contact in contacts:
        both = {part[contact.first], part[contact.second]}
        if not both <= group or any(len(joints[one]) != 2 for one in both):
            continue
        first, second = (joints[one] for one in sorted(both))
        is_between_them = sum(contact.joint in own for own in joints.values()) == 2
        if is_between_them and len(first | second) == 3:
            return both
    return set()


def _joints_of(
    part: tuple[int, ...], contacts: list[Contact], present: set[int]
) -> dict[int, set[str]]:
    """The joints of every one of some parts with another of them."""
    joints: dict[int, set[str]] = {one: set() for one in present}
    for contact in contacts:
        both = {part[contact.first], part[contact.second]}
        if both <= present:
            for one in both:
                joints[one].add(contact.joint)
    return joints
