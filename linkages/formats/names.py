"""Names of bodies and joints that a file of another program can hold.

Such a file has names of its own for parts of a joint, forbids some names, and wants
every one given once. Where a mechanism has others, bodies and joints are renamed before
it is written, and the log says so.

MuJoCo keeps names of bodies, of joints and of equalities apart, and needs none. Here
equalities are joints, several joints may be one, and a body between two joints has no
element of its own: `TakenNames` gives them names when a model is read.
"""

from __future__ import annotations

import itertools
import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

from linkages.formats.assembly import BodyJoint
from linkages.formats.xml_tree import Element
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism, Pair

log = logging.getLogger(__name__)

NamesOfJoint: TypeAlias = Callable[[Joint], Iterable[str]]

WORLD = "world"  # what simulators call the body at rest


@dataclass(frozen=True)
class NameRules:
    """What names a format allows: ``is_allowed`` of one, ``of_joint`` all that stand in
    a file among joints for one, ``links_of_joint`` those among bodies, and whether
    bodies and joints are ``siblings``, of which no two have one name."""

    is_allowed: Callable[[str], bool]
    of_joint: NamesOfJoint
    links_of_joint: NamesOfJoint
    siblings: bool


def body_name(mechanism: Mechanism, body: str) -> str:
    """What a body is called in a file: the body at rest is the world."""
    return WORLD if body == mechanism.frame else body


def pair_name(joint: Joint, pair: Pair) -> str:
    """What the joint between the two bodies of a pair is called in a file."""
    return f"{joint.name}.{pair.moved}" if len(joint.bodies) > 2 else joint.name


def pair_names(joint: Joint) -> list[str]:
    """The names of all pairs of a joint."""
    if len(joint.bodies) == 2:
        return [joint.name]
    return [f"{joint.name}.{body}" for body in joint.bodies[1:]]


def row_text(numbers: Iterable[float]) -> str:
    """Numbers with all their digits."""
    return " ".join(repr(float(number) + 0.0) for number in numbers)


def with_names_for(mechanism: Mechanism, rules: NameRules) -> Mechanism:
    """The mechanism with names that the ``rules`` allow, each given once; the body at
    rest, which is the world in the file, keeps its own."""
    bodies = _names_of_bodies(mechanism, rules)
    taken_by_bodies = {bodies[body] for body in bodies if body != mechanism.frame}
    taken = taken_by_bodies if rules.siblings else set()
    renamed: dict[str, Joint] = {}
    # names that can stay are given first, so that no alternative takes one of them
    for most in (1, None):
        for joint in mechanism.joints:
            if joint.name in renamed:
                continue
            names = itertools.islice(_alternatives(joint.name, "joint"), most)
            own = _renamed(joint, names, bodies, rules, taken, taken_by_bodies)
            if own is None:
                continue
            taken.update(rules.of_joint(own), own.names)
            taken_by_bodies.update(rules.links_of_joint(own))
            renamed[joint.name] = own
    joints = [renamed[joint.name] for joint in mechanism.joints]
    labels: dict[str, str] = {}
    for joint, own in zip(mechanism.joints, joints, strict=True):
        labels |= zip(joint.labels, own.labels, strict=True)
    _say(bodies, "body")
    _say({name: joint.name for name, joint in renamed.items()}, "joint")
    for number, joint in enumerate(joints):
        coupled = tuple(
            one and replace(one, to=labels[one.to]) for one in joint.coupled
        )
        joints[number] = replace(joint, coupled=coupled)
    return replace(mechanism, joints=tuple(joints))


def _names_of_bodies(mechanism: Mechanism, rules: NameRules) -> dict[str, str]:
    """The name in the file of every body, by its own; those that are allowed stay."""
    bodies = {mechanism.frame: mechanism.frame}
    moving = [body for body in mechanism.bodies if body != mechanism.frame]
    bodies |= {body: body for body in moving if rules.is_allowed(body)}
    taken = {*bodies.values()} - {mechanism.frame}
    for body in moving:
        if body not in bodies:
            allowed = filter(rules.is_allowed, _alternatives(body, "body"))
            bodies[body] = first_new(allowed, taken)
    return {body: bodies[body] for body in (mechanism.frame, *moving)}


def _renamed(
    joint: Joint,
    names: Iterable[str],
    bodies: Mapping[str, str],
    rules: NameRules,
    taken: set[str],
    taken_by_bodies: set[str],
) -> Joint | None:
    """The joint with the first of the names such that none that stands in the file for
    it is taken; None where there is none."""
    own_bodies = tuple(bodies[body] for body in joint.bodies)
    for name in names:
        candidate = replace(joint, name=name, bodies=own_bodies)
        among_joints = set(rules.of_joint(candidate))
        among_bodies = set(rules.links_of_joint(candidate))
        if not all(map(rules.is_allowed, among_joints | among_bodies)):
            continue
        among_joints |= {*candidate.names}
        if not (among_joints & taken or among_bodies & taken_by_bodies):
            return candidate
    return None


def _alternatives(name: str, ending: str) -> Iterator[str]:
    """A name, and others that say what it was, with another end or begin: what stands
    in a file for a joint begins with its name and may end with that of a body."""
    yield name
    plain = name.replace("::", ".")
    yield plain
    yield f"{plain}.{ending}"
    yield f"{ending}.{plain}"
    for number in itertools.count(2):
        yield f"{plain}.{ending}{number}"
        yield f"{ending}{number}.{plain}"


def _say(names: Mapping[str, str], noun: str) -> None:
    for old, new in names.items():
        if new != old:
            log.warning("%s %s is called %s in the file", noun, old, new)


# --- names that are read --------------------------------------------------------------


class TakenNames:
    """The names of bodies, and of joints and their variables, that others must not
    have: at first those that the ``<worldbody>`` of a model gives."""

    def __init__(self, root: Element):
        self.bodies: set[str] = set()
        self.joints: set[str] = set()
        for worldbody in root.all("worldbody"):
            self._enter(worldbody)

    def _enter(self, element: Element) -> None:
        for child in element.children:
            name = child.attributes.get("name")
            if name is not None and child.tag == "body":
                self.bodies.add(name)
            elif name is not None and child.tag in ("joint", "freejoint"):
                self.joints.add(name)
            self._enter(child)

    def named_joint(
        self, joint: BodyJoint, names: Iterable[str], axes: Iterable[str] = ()
    ) -> BodyJoint:
        """The joint with the first of the names such that nothing else is called as it
        or one of its variables; they are taken from now on. The names of the ``axes``
        that it is made of are its own."""
        others = self.joints - set(axes)
        for name in names:
            candidate = replace(joint, name=name)
            own = {name, *candidate.labels}
            if not own & others:
                self.joints |= own
                return candidate
        raise ValueError("names that come to an end")


def numbered(*names: str) -> Iterator[str]:
    """The names, and the last of them with numbers."""
    yield from names
    for number in itertools.count(2):
        yield f"{names[-1]}.{number}"


def first_new(names: Iterable[str], taken: set[str]) -> str:
    """The first of the names that is not taken; it is from now on."""
    name = next(name for name in names if name not in taken)
    taken.add(name)
    return name
