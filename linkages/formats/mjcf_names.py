"""Names for what an MJCF model names otherwise than a mechanism does.

MuJoCo keeps names of bodies, of joints and of equalities apart, and needs none. Here
equalities are joints, several joints may be one, and a body between two joints has no
element of its own.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import replace

from linkages.formats.assembly import BodyJoint
from linkages.formats.xml_tree import Element


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

    def new_body(self, names: Iterable[str]) -> str:
        """The first of the names that no body has; it is taken from now on."""
        return _first_new(names, self.bodies)

    def new_axis(self, names: Iterable[str]) -> str:
        """The first of the names that no joint has; it is taken from now on."""
        return _first_new(names, self.joints)

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


def _first_new(names: Iterable[str], taken: set[str]) -> str:
    name = next(name for name in names if name not in taken)
    taken.add(name)
    return name
