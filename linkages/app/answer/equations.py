"""The closure equations that an atlas is of."""

from __future__ import annotations

from bifurc.atlas import Atlas
from bifurc.problem import Problem
from linkages.app.answer.configurations import readout_of
from linkages.closure.loop_closure import LoopClosure
from linkages.labels import loop_of


def equations_of(atlas: Atlas) -> Problem:
    """The closure of the loop or the mechanism of an atlas; raises `NoLinkageError` for
    an atlas of something else."""
    readout = readout_of(atlas)
    if readout is None:
        return LoopClosure(loop_of(atlas))
    from linkages.closure.mechanism_closure import MechanismClosure

    return MechanismClosure(readout.mechanism)
