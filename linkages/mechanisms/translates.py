"""How many forms and assemblies those stand for that are listed up to whole turns."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.singular.point import Kind
from bifurc.text_tables import count_of

if TYPE_CHECKING:
    # they import networkx, which a verdict does not need
    from linkages.mechanisms.structure import Structure
    from linkages.mechanisms.turn_lattice import Count, TurnLattice

__all__ = ["Translates", "translates_of", "with_translates"]

SAMPLES = 64  # of a form, to see from where to where it goes
KEY = "translates"  # in the subject of an atlas


class Translates(NamedTuple):
    """How many ``assemblies`` and ``forms`` there are within the limits with all whole
    turns, and whether these ``are_all`` of them; None where they are not counted, as
    forms that a chain of bifurcations joins may be listed more than once. The turns are
    those of ``joints``, variables by label."""

    joints: tuple[str, ...]
    forms: int | None
    assemblies: int | None
    are_all: bool

    @property
    def sentence(self) -> str:
        """What is listed, and what that stands for."""
        counts = []
        if self.assemblies:
            counts.append(count_of(self.assemblies, "assembly"))
        if self.forms:
            counts.append(count_of(self.forms, "form"))
        differing = f"what differs by whole turns of {', '.join(self.joints)} alone"
        if self.forms is None:
            return f"{differing} may be listed once"
        text = f"{differing} is listed once, nearest to the middle of the limits"
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
    forms, assemblies = values["forms"], values["assemblies"]
    return Translates(
        tuple(values["joints"]),
        None if forms is None else int(forms),
        None if assemblies is None else int(assemblies),
        bool(values["are_all"]),
    )


def with_translates(atlas: Atlas, structure: Structure, lattice: TurnLattice) -> Atlas:
    """The atlas with what its forms and assemblies stand for, in its subject and in its
    statement; as it is where the ``lattice`` holds no whole turns, or none leads to
    anything that is not listed."""
    if not lattice:
        return atlas
    turning = [k for k in lattice.columns if structure.unknowns[k].is_angle]
    joints = tuple(structure.unknowns[k].label for k in turning)
    translates = _counted(atlas, lattice, joints)
    listed = (len(atlas.forms), len(_assemblies(atlas)))
    counts = (translates.forms, translates.assemblies)
    if translates.are_all and counts == listed and not atlas.surfaces:
        return atlas
    if _may_be_listed_twice(atlas, lattice):
        translates = Translates(joints, None, None, are_all=False)
    completeness = atlas.completeness
    statement = f"{completeness.statement}; {translates.sentence}"
    return replace(
        atlas,
        completeness=replace(completeness, statement=statement),
        subject={**atlas.subject, KEY: translates._asdict()},
    )


def _counted(atlas: Atlas, lattice: TurnLattice, joints: tuple[str, ...]) -> Translates:
    """How many translates all that is listed has, each for itself."""
    forms = [_count_of_form(lattice, form.branch) for form in atlas.forms]
    assemblies = [
        lattice.count_of_translates(point[None]) for point in _assemblies(atlas)
    ]
    return Translates(
        joints,
        forms=sum(form.number for form in forms),
        assemblies=sum(assembly.number for assembly in assemblies),
        are_all=all(one.are_all for one in forms + assemblies),
    )


def _assemblies(atlas: Atlas) -> list[np.ndarray]:
    """The isolated assemblies (n,) of an atlas, shaky ones after the others."""
    shaky = [point.point.u for point in atlas.points if point.kind is Kind.ISOLATED]
    return [*atlas.rigid, *shaky]


def _may_be_listed_twice(atlas: Atlas, lattice: TurnLattice) -> bool:
    """Whether a form may be listed with translates of it: through bifurcations other
    forms lead to them, and these are not where whole turns bring a form."""
    if atlas.bifurcations:
        return True
    closed = [form.branch for form in atlas.forms if form.branch.closed]
    shifts = [lattice.home(branch.sample(SAMPLES)) for branch in closed]
    return any(bool(np.any(shift)) for shift in shifts)


def _count_of_form(lattice: TurnLattice, branch: Branch) -> Count:
    """Of a form that goes to its limits it is not known which translates are itself."""
    points = branch.sample(SAMPLES)
    if not branch.closed:
        return lattice.fewest_translates(points)
    return lattice.count_of_translates(points)
