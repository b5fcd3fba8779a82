"""A single loop as a mechanism, for what takes mechanisms only."""

from __future__ import annotations

import numpy as np

from linkages.loop import Loop
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism

FRAME = "frame"


def mechanism_of_loop(loop: Loop, theta: np.ndarray) -> Mechanism:
    """The mechanism whose reference configuration is the loop's at joint angles (n,),
    rad, in the frame of the link that joins the last joint to the first.

    Joints are called "J1", "J2", ..., that link "frame" and the others "link 12" and so
    on. Raises `GeometryError` for angles at which the loop is not closed.
    """
    frames = loop.frames(theta)
    bodies = [FRAME]
    for number in range(1, loop.n):
        bodies.append(f"link {number}-{number + 1}")
    joints = []
    for number in range(loop.n):
        axis = frames[number]
        following = bodies[(number + 1) % loop.n]
        joint = Joint(
            name=f"J{number + 1}",
            kind=JointKind.REVOLUTE,
            bodies=(bodies[number], following),
            point=tuple(axis[:3, 3].tolist()),
            direction=tuple(axis[:3, 2].tolist()),
        )
        joints.append(joint)
    return Mechanism(tuple(joints), loop.name)
