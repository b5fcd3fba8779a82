"""How many forms and assemblies those stand for that are listed up to whole turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.completeness import Scope
from bifurc.singular.point import Kind
from bifurc.tables import count_of
from linkages.statements import LinkageClaim

if TYPE_CHECKING:
    # they import networkx, which a verdict does not need
    from linkages.structure.structure import Structure
    from linkages.turns.turn_lattice import Count, TurnLattice

# of a form, to see from where to where it goes: fewest, most, and how far apart between
SAMPLES, MOST_SAMPLES, APART = 200, 1000, 0.5
SLACK = 0.01  # of the distance of samples, by which a curve may be off its arclength
KEY = "translates"  # in the subject of an atlas


class Translates(NamedTuple):
    """How many ``assemblies`` and ``forms`` there are within the limits with all whole
    turns, and whether these ``are_all`` of them. The turns are those of ``joints``,
    variables by label. Of the ``listed_forms``, ``distinct_forms`` differ by more than
    whole turns: through bifurcations a form may lead to where it is again but for
    these."""

    joints: tuple[str, ...]
    forms: int
    assemblies: int
    listed_forms: int
    distinct_forms: int
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
        text = f"{differing} is listed once, nearest to the middle of the limits"
        if self.listed_forms > self.distinct_forms:
            listed = count_of(self.listed_forms, "form")
            verb = "differs" if self.distinct_forms == 1 else "differ"
            text = (
                f"{differing} is listed once, or again where bifurcations lead there or "
                f"limits cut it off: of {listed} listed here {self.distinct_forms} "
                f"{verb} otherwise"
            )
        if counts:
            fewest = "" if self.are_all else "at least "
            text += f"; with these turns what is listed stands for {fewest}"
            text += f"{' and '.join(counts)} within the limits"
        if self.forms and not self.are_all:
            text += ", whole or cut off by them"
        return text


def translates_of(atlas: Atlas) -> Translates | None:
    """What an atlas says of whole turns; None where nothing is listed up to them."""
    values = atlas.subject.get(KEY)
    if values is None:
        return None
    return Translates(**{**values, "joints": tuple(values["joints"])})


def with_translates(atlas: Atlas, structure: Structure, lattice: TurnLattice) -> Atlas:
    """The atlas with what its forms and assemblies stand for, in its subject and in its
    statement; as it is where the ``lattice`` holds no whole turns, or none leads to
    anything that is not listed."""
    if not lattice:
        return atlas
    turning = [k for k in lattice.columns if structure.unknowns[k].is_angle]
    joints = tuple(structure.unknowns[k].label for k in turning)
    translates = _counted(atlas, lattice, joints)
    listed = (len(atlas.forms), len(isolated_assemblies_of(atlas)))
    counts = (translates.forms, translates.assemblies)
    if translates.are_all and counts == listed and not atlas.surfaces:
        return atlas
    listed_once = LinkageClaim.UP_TO_TURNS.claim(
        Scope.MOTIONS, None, translates=translates.sentence
    )
    claims = (*atlas.completeness.claims, listed_once)
    return replace(
        atlas,
        completeness=replace(atlas.completeness, claims=claims),
        subject={**atlas.subject, KEY: translates._asdict()},
    )


def _counted(atlas: Atlas, lattice: TurnLattice, joints: tuple[str, ...]) -> Translates:
    """How many translates all that is listed has, what is one but for whole turns
    together."""
    # it imports modules that a verdict does not need
    from linkages.turns.turn_classes import classes_of_assemblies, classes_of_forms

    branches = [form.branch for form in atlas.forms]
    alike = classes_of_forms(branches, lattice)
    forms = [
        _count_of_class([_count_of_form(lattice, branch) for branch in branches])
        for branches in alike
    ]
    points = classes_of_assemblies(
        isolated_assemblies_of(atlas), atlas.periods, lattice
    )
    assemblies = [
        _count_of_class([lattice.count_of_translates(one[None]) for one in own])
        for own in points
    ]
    return Translates(
        joints,
        forms=sum(form.number for form in forms),
        assemblies=sum(assembly.number for assembly in assemblies),
        listed_forms=len(branches),
        distinct_forms=len(alike),
        are_all=all(one.are_all for one in forms + assemblies),
    )


def isolated_assemblies_of(atlas: Atlas) -> list[np.ndarray]:
    """All configurations (n,) of an atlas that have no others beside them, those of full
    rank first."""
    shaky = [point.point.u for point in atlas.points if point.kind is Kind.ISOLATED]
    return [*atlas.rigid, *shaky]


def _count_of_class(counts: Sequence[Count]) -> Count:
    """How many there are of what is one up to whole turns: as many as lead from any of
    those listed, and no fewer than are listed."""
    number = max(*(count.number for count in counts), len(counts))
    are_all = all(count.are_all for count in counts)
    return counts[0]._replace(number=number, are_all=are_all)


def _count_of_form(lattice: TurnLattice, branch: Branch) -> Count:
    """Of a form that goes to its limits it is not known which translates are itself."""
    extremes = [branch.turning_points(int(k)) for k in lattice.columns]
    count = int(np.clip(branch.length / APART, SAMPLES, MOST_SAMPLES))
    places = np.unique(np.concatenate([branch.arclengths(count), *extremes]))
    widest = float(np.diff(places, append=branch.length).max())
    points = branch(places)
    # no unknown changes by more than the curve is long: the rounding of pieces aside
    reach = (0.5 + SLACK) * widest
    if not branch.closed:
        return lattice.fewest_translates(points, reach)
    return lattice.count_of_closed(points, reach)
