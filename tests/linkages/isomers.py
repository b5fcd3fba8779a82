"""Loops with two links exchanged, the opposite pair of their Bennett loop (Wohlhart
1991b), by which relations of the catalogue are tested."""

from dataclasses import replace

from linkages.loop import Loop


def isomerize(loop: Loop, joint: int) -> Loop:
    """``loop`` with the two links at ``joint`` (from 1), of one Bennett ratio,
    exchanged."""
    order = list(range(loop.n))
    order[joint - 2], order[joint - 1] = joint - 1, (joint - 2) % loop.n
    lengths = tuple(loop.lengths[k] for k in order)
    twists = tuple(loop.twists[k] for k in order)
    return replace(loop, lengths=lengths, twists=twists)
