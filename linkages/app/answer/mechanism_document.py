"""What a JSON document says of a mechanism besides what it says of a loop."""

from __future__ import annotations

from typing import Any, TypedDict

import numpy as np

from bifurc.atlas import Atlas
from linkages.mechanisms.subject import joint_values
from linkages.readout.facts import form_facts, loop_facts
from linkages.readout.readout import Readout
from linkages.structure.loose_chains import loose_chains
from linkages.turns.translates import translates_of


class RangeDocument(TypedDict):
    """The range of a variable along a form, rad or the user's unit, and its turns."""

    low: float
    high: float
    turns: int


class FormMotionDocument(TypedDict):
    """What the joints and bodies of a mechanism do along a form."""

    ranges: dict[str, RangeDocument]
    still_joints: list[str]
    bodies_as_one: list[list[str]]


class LoopDocument(TypedDict):
    """A loop of the cycle basis, and which of its constraints are redundant."""

    joints: list[str]
    constraints: int
    rank: int
    redundant: int
    dependent_joints: list[str]


class VariableDocument(TypedDict):
    """A joint variable: its unit, "rad" or "length", the limits within which it is
    followed (None for angles without limits) and the value at which it is locked."""

    name: str
    joint: str
    unit: str
    limits: list[float] | None
    locked: float | None


class LooseChainDocument(TypedDict):
    """The ``bodies`` of a chain ``between`` one body or two that has ``freedoms`` of
    its own, whatever the rest does."""

    bodies: list[str]
    between: list[str]
    freedoms: int


class TranslatesDocument(TypedDict):
    """How many ``forms`` and ``assemblies`` what is listed up to whole turns of
    ``joints`` stands for, at least or, where these ``are_all``, exactly. Of the forms
    that are listed ``distinct_forms`` differ by more than such turns."""

    joints: list[str]
    forms: int
    assemblies: int
    distinct_forms: int
    are_all: bool


class MechanismDocument(TypedDict):
    """The mechanism of a map: ``idle_bodies`` turn about the line between their two
    spherical joints, ``idle_turns`` are variables that turn but a body by itself; the
    map leaves both out, and counts the freedoms of ``loose_chains``. Points are counted
    from the ``origin``, in the coordinates of the file, and off by
    ``coordinate_rounding`` at most. ``translates`` is None where nothing is left out
    that differs by whole turns."""

    bodies: list[str]
    frame: str
    joints: list[dict[str, Any]]
    variables: list[VariableDocument]
    loops: list[LoopDocument]
    idle_bodies: list[str]
    idle_turns: list[str]
    loose_chains: list[LooseChainDocument]
    characteristic_length: float
    origin: list[float]
    coordinate_rounding: float
    translates: TranslatesDocument | None


def describe_mechanism(atlas: Atlas, readout: Readout) -> MechanismDocument:
    """The mechanism of an atlas; what is redundant holds where the first form or
    surface is regular, or else at the first assembly."""
    mechanism = readout.mechanism
    place = _regular_place(atlas)
    loops = [] if place is None else loop_facts(readout, place)
    return {
        "bodies": list(mechanism.bodies),
        "frame": mechanism.frame,
        "joints": [joint_values(joint) for joint in mechanism.joints],
        "variables": _variables(readout),
        "loops": [
            {
                "joints": list(loop.joints),
                "constraints": loop.constraints,
                "rank": loop.rank,
                "redundant": loop.redundant,
                "dependent_joints": list(loop.dependent),
            }
            for loop in loops
        ],
        "idle_bodies": list(readout.structure.idle_bodies),
        "idle_turns": list(readout.structure.idle_turns),
        "loose_chains": [
            {
                "bodies": list(chain.bodies),
                "between": list(chain.between),
                "freedoms": chain.freedoms,
            }
            for chain in loose_chains(readout.structure)
        ],
        "characteristic_length": readout.structure.unit,
        "origin": list(mechanism.origin),
        "coordinate_rounding": mechanism.coordinate_rounding,
        "translates": _translates(atlas),
    }


def _translates(atlas: Atlas) -> TranslatesDocument | None:
    translates = translates_of(atlas)
    if translates is None:
        return None
    return {
        "joints": list(translates.joints),
        "forms": translates.forms,
        "assemblies": translates.assemblies,
        "distinct_forms": translates.distinct_forms,
        "are_all": translates.are_all,
    }


def _variables(readout: Readout) -> list[VariableDocument]:
    limits = readout.limits()
    variables: list[VariableDocument] = []
    for variable in readout.mechanism.variables:
        pair = limits.get(variable.label)
        variables.append(
            {
                "name": variable.label,
                "joint": variable.joint,
                "unit": "rad" if variable.motion.is_turn else "length",
                "limits": None if pair is None else list(pair),
                "locked": variable.locked,
            }
        )
    return variables


def _regular_place(atlas: Atlas) -> np.ndarray | None:
    """A configuration (n,) of the atlas where as little as can be is singular."""
    if atlas.forms:
        profile = atlas.forms[0].profile
        best = int(np.argmax(profile.smallest))
        place: np.ndarray = atlas.forms[0].branch(float(profile.arclength.flat[best]))
        return place
    if atlas.surfaces:
        return np.array(atlas.surfaces[0].samples[0])
    return np.array(atlas.rigid[0]) if len(atlas.rigid) else None


def describe_motion(atlas: Atlas, index: int, readout: Readout) -> FormMotionDocument:
    """What the joints and bodies do along the form of this ``index``."""
    facts = form_facts(atlas, index, readout)
    ranges: dict[str, RangeDocument] = {
        one.label: {"low": one.low, "high": one.high, "turns": one.turns}
        for one in facts.ranges
    }
    return {
        "ranges": ranges,
        "still_joints": list(facts.still),
        "bodies_as_one": [list(group) for group in facts.groups],
    }
