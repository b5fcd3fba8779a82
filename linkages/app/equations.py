"""The closure equations that an atlas is of."""

from __future__ import annotations

from bifurc.atlas import Atlas
from bifurc.problem import Problem
from linkages.app.configurations import readout_of
from linkages.closure.loop_closure import LoopClosure
from linkages.labels import loop_of

__all__ = ["equations_of", "is_of_loop"]


def equations_of(atlas: Atlas) -> Problem:
    """The closure of the loop or the mechanism of an atlas; raises `NoLinkageError` for
    an atlas of something else."""
    if is_of_loop(atlas):
        return LoopClosure(loop_of(atlas))
    from linkages.mechanisms.closure import MechanismClosure

    readout = readout_of(atlas)
    assert readout is not None
    return MechanismClosure(readout.mechanism)


def is_of_loop(atlas: Atlas) -> bool:
    """Whether an atlas is of a single loop of revolute joints, and its unknowns are the
    joint angles."""
    readout = readout_of(atlas)
    return readout is None or readout.single_loop is not None
