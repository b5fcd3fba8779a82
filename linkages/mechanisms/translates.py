"""How many forms and assemblies those stand for that are listed up to whole turns."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.text_tables import count_of

if TYPE_CHECKING:
    # they import networkx, which a verdict does not need
    from linkages.mechanisms.structure import Structure
    from linkages.mechanisms.turn_lattice import TurnLattice

__all__ = ["Translates", "translates_of", "with_translates"]

SAMPLES = 64  # of a form, to see from where to where it goes
KEY = "translates"  # in the subject of an atlas


class Translates(NamedTuple):
    """How many ``assemblies`` and ``forms`` there are within the limits with all whole
    turns, and whether these ``are_all`` of them. The turns are those of ``joints``,
    variables by label."""

    joints: tuple[str, ...]
    forms: int
    assemblies: int
    are_all: bool

    @property
    def sentence(self) -> str:
        """What is listed, and what that stands for."""
        counts = []
        if self.assemblies:
            counts.append(count_of(self.assemblies, "assembly"))
        if self.forms:
            counts.append(count_of(self.forms, "form"))
        text = (
            f"what differs by whole turns of {', '.join(self.joints)} alone is listed "
            "once, nearest to the middle of the limits"
        )
        if counts:
            fewest = "" if self.are_all else "at least "
            text += f"; with these turns what is listed stands for {fewest}"
            text += f"{' and '.join(counts)} within the limits"
        return text


def translates_of(atlas: Atlas) -> Translates | None:
    """What an atlas says of whole turns; None where nothing is listed up to them."""
    values = atlas.subject.get(KEY)
    if values is None:
        return None
    return Translates(
        tuple(values["joints"]),
        int(values["forms"]),
        int(values["assemblies"]),
        bool(values["are_all"]),
    )


def with_translates(atlas: Atlas, structure: Structure, lattice: TurnLattice) -> Atlas:
    """The atlas with what its forms and assemblies stand for, in its subject and in its
    statement; as it is where the ``lattice`` holds no whole turns."""
    if not lattice:
        return atlas
    forms = [_count_of_form(lattice, form.branch) for form in atlas.forms]
    assemblies = [_count_within(lattice, point[None]) for point in atlas.rigid]
    turning = [k for k in lattice.columns if structure.unknowns[k].is_angle]
    joints = tuple(structure.unknowns[k].label for k in turning)
    translates = Translates(
        joints,
        forms=sum(form.number for form in forms),
        assemblies=sum(assembly.number for assembly in assemblies),
        are_all=all(one.are_all for one in forms + assemblies),
    )
    completeness = atlas.completeness
    statement = f"{completeness.statement}; {translates.sentence}"
    return replace(
        atlas,
        completeness=replace(completeness, statement=statement),
        subject={**atlas.subject, KEY: translates._asdict()},
    )


class _Count(NamedTuple):
    """How many translates there are, and whether that is all."""

    number: int
    are_all: bool


def _count_of_form(lattice: TurnLattice, branch: Branch) -> _Count:
    """Of a form that goes to its limits it is not known which translates are itself."""
    points = branch.sample(SAMPLES)
    if not branch.closed:
        return _Count(lattice.fewest_translates(points), False)
    return _count_within(lattice, points)


def _count_within(lattice: TurnLattice, points: np.ndarray) -> _Count:
    shifts = lattice.translates(points)
    return _Count(len(shifts.vectors), shifts.are_all)
