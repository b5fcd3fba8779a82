"""What a JSON document says of a mechanism besides what it says of a loop."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from bifurc.atlas import Atlas
from linkages.mechanisms.subject import joint_values
from linkages.readout.facts import form_facts, loop_facts
from linkages.readout.readout import Readout
from linkages.structure.loose_chains import loose_chains
from linkages.turns.translates import translates_of


def describe_mechanism(atlas: Atlas, readout: Readout) -> dict[str, Any]:
    """The mechanism of an atlas; what is redundant holds where the first form or
    surface is regular, or else at the first assembly.

    The map leaves ``idle_bodies`` and ``idle_turns`` out, holds what is ``hanging``, if it
    ``holds_flaps``, and creases that ``stay_flat`` or are ``at_rest``, and counts the
    ``ways_out`` of a flat sheet and the freedoms of ``loose_chains``. Points are counted
    from the ``origin``, in the coordinates of the file, of which vertices of a crease
    pattern are ``vertices_moved`` away at most. ``translates`` is None where nothing is
    left out that differs by whole turns.
    """
    mechanism, structure = readout.mechanism, readout.structure
    place = _regular_place(atlas)
    loops = [] if place is None else loop_facts(readout, place)
    return {
        "bodies": list(mechanism.bodies),
        "frame": mechanism.frame,
        "joints": [joint_values(joint) for joint in mechanism.joints],
        "variables": _variables(readout),
        "motors": list(mechanism.motors),
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
        "idle_bodies": list(structure.idle_bodies),
        "idle_turns": list(structure.idle_turns),
        "hanging": [asdict(joint) for joint in structure.hanging.joints],
        "holds_flaps": structure.holds_flaps,
        "stay_flat": list(structure.stay_flat),
        "at_rest": list(mechanism.at_rest),
        "ways_out": structure.ways_out,
        "loose_chains": [asdict(chain) for chain in loose_chains(structure)],
        "characteristic_length": structure.unit,
        "origin": list(mechanism.origin),
        "coordinate_rounding": mechanism.coordinate_rounding,
        "vertices_moved": mechanism.moved,
        "translates": _translates(atlas),
    }


def _translates(atlas: Atlas) -> dict[str, Any] | None:
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


def _variables(readout: Readout) -> list[dict[str, Any]]:
    limits = readout.limits()
    variables: list[dict[str, Any]] = []
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
        return atlas.forms[0].branch(float(profile.arclength.flat[best]))
    if atlas.surfaces:
        return np.array(atlas.surfaces[0].samples[0])
    return np.array(atlas.rigid[0]) if len(atlas.rigid) else None


def describe_motion(atlas: Atlas, index: int, readout: Readout) -> dict[str, Any]:
    """What the joints and bodies do along the form of this ``index``."""
    facts = form_facts(atlas, index, readout)
    return {
        "ranges": {
            one.label: {"low": one.low, "high": one.high, "turns": one.turns}
            for one in facts.ranges
        },
        "still_joints": list(facts.still),
        "bodies_as_one": [list(group) for group in facts.groups],
    }
