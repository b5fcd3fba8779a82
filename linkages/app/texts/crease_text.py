"""How the creases of a pattern are assigned, in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bifurc.tables import count_of
from linkages.mechanisms.mechanism import Mechanism

if TYPE_CHECKING:
    # it imports networkx, which a loop does not need
    from linkages.structure.structure import Structure

NAMED = 8  # creases that are held beyond this number are only counted


def assigned_creases(mechanism: Mechanism) -> set[str]:
    """The creases, by joint, that fold as they are assigned only."""
    return {
        one.joint
        for one in mechanism.creases
        if mechanism.joint(one.joint).limits == (one.limits,)
    }


def describe_creases(structure: Structure) -> str:
    """How many valleys and mountains there are, and between which fold angles they are
    followed; which stay flat, and which are at rest."""
    mechanism = structure.mechanism
    letters = [one.letter for one in mechanism.creases]
    valleys = count_of(letters.count("V"), "valley fold")
    mountains = count_of(letters.count("M"), "mountain fold")
    if assigned_creases(mechanism):
        text = (
            f"Creases fold as assigned: {valleys} from 0 to 180 degrees, {mountains} from "
            "-180 to 0; --free-creases lets them fold either way."
        )
    else:
        text = f"Creases fold either way: {valleys} and {mountains} are free."
    return "\n".join([text, *_that_stay_flat(structure), *_ways_out(structure)])


def _ways_out(structure: Structure) -> list[str]:
    """How many ways lead out of the flat state of several vertices, where that is
    known."""
    ways = structure.ways_out if len(structure.flat_vertices) > 1 else None
    if not ways:
        return []
    verb = "leads" if ways == 1 else "lead"
    return [
        f"To leading order {count_of(ways, 'way')} of one freedom {verb} out of the flat "
        "state."
    ]


def _that_stay_flat(structure: Structure) -> list[str]:
    """The creases that stay flat, and those at rest, as a line each."""
    lines = []
    stay_flat, at_rest = structure.stay_flat, structure.mechanism.at_rest
    if structure.is_held_flat:
        lines.append("As they are assigned none of them leaves the flat state.")
    elif stay_flat:
        verb = "stays" if len(stay_flat) == 1 else "stay"
        lines.append(
            f"Held: {count_of(len(stay_flat), 'crease')} {verb} flat about the flat state "
            f"({_named(stay_flat)}); --with-flat-creases looks for where they fold "
            "farther on."
        )
    if at_rest:
        lines.append(
            f"Held as well: {count_of(len(at_rest), 'crease')} ({_named(at_rest)}), as in "
            "a way out of the flat state that was found; whether they can fold is not "
            "known."
        )
    return lines


def _named(labels: Sequence[str]) -> str:
    more = f" and {len(labels) - NAMED} more" if len(labels) > NAMED else ""
    return ", ".join(labels[:NAMED]) + more
