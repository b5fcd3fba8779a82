"""How the creases of a pattern are assigned, in a sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bifurc.tables import count_of
from linkages.mechanisms.mechanism import Mechanism

if TYPE_CHECKING:
    # it imports networkx, which a loop does not need
    from linkages.structure.structure import Structure

NAMED = 8  # creases that stay flat beyond this number are only counted


def assigned_creases(mechanism: Mechanism) -> set[str]:
    """The creases, by joint, that fold as they are assigned only."""
    return {
        one.joint
        for one in mechanism.creases
        if mechanism.joint(one.joint).limits == (one.limits,)
    }


def describe_creases(structure: Structure) -> str:
    """How many valleys and mountains there are, and between which fold angles they are
    followed; and which stay flat."""
    mechanism = structure.mechanism
    letters = [one.letter for one in mechanism.creases]
    valleys = count_of(letters.count("V"), "valley fold")
    mountains = count_of(letters.count("M"), "mountain fold")
    if not assigned_creases(mechanism):
        return f"Creases fold either way: {valleys} and {mountains} are free."
    text = (
        f"Creases fold as assigned: {valleys} from 0 to 180 degrees, {mountains} from "
        "-180 to 0; --free-creases lets them fold either way."
    )
    return "\n".join([text, *_that_stay_flat(structure)])


def _that_stay_flat(structure: Structure) -> list[str]:
    """The creases that stay flat, as a line; none where all fold."""
    labels = structure.stay_flat
    if not labels:
        return []
    if structure.is_held_flat:
        return ["As they are assigned none of them leaves the flat state."]
    more = f" and {len(labels) - NAMED} more" if len(labels) > NAMED else ""
    names = ", ".join(labels[:NAMED]) + more
    verb = "stays" if len(labels) == 1 else "stay"
    return [
        f"Held: {count_of(len(labels), 'crease')} {verb} flat about the flat state "
        f"({names}); --with-flat-creases looks for where they fold farther on."
    ]
