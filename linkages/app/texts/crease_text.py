"""How the creases of a pattern are assigned, in a sentence."""

from __future__ import annotations

from bifurc.tables import count_of
from linkages.mechanisms.mechanism import Mechanism


def assigned_creases(mechanism: Mechanism) -> set[str]:
    """The creases, by joint, that fold as they are assigned only."""
    return {
        one.joint
        for one in mechanism.creases
        if mechanism.joint(one.joint).limits == (one.limits,)
    }


def describe_creases(mechanism: Mechanism) -> str:
    """How many valleys and mountains there are, and between which fold angles they are
    followed."""
    letters = [one.letter for one in mechanism.creases]
    valleys = count_of(letters.count("V"), "valley fold")
    mountains = count_of(letters.count("M"), "mountain fold")
    if not assigned_creases(mechanism):
        return f"Creases fold either way: {valleys} and {mountains} are free."
    return (
        f"Creases fold as assigned: {valleys} from 0 to 180 degrees, {mountains} from "
        "-180 to 0; --free-creases lets them fold either way."
    )
