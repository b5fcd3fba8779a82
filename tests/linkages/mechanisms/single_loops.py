"""Mechanisms that are single loops of revolute joints."""

from dataclasses import replace

import numpy as np

from bifurc.settings import SearchSettings
from linkages.linkage import load_linkage
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.of_loop import mechanism_of_loop
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.maps import map_of

__all__ = ["FEW", "SINGLE_LOOPS", "catalogue_loop", "single_loop", "with_a_held_joint"]

FEW = SearchSettings(starts=20, certify=False)
KNOWN = (
    "Sarrus linkage of 2 RRR chains",
    "two RRR chains in one plane (degenerate Sarrus)",
    "Miura-ori, one vertex (spherical 4R)",
    "Bennett geometry with joints RRRR",
)
OF_CATALOGUE = (
    "bennett",
    "goldberg-5r",
    "bricard-line-symmetric",
    "special-double-subtractive-goldberg",
    "parallelogram",
)
SINGLE_LOOPS = (*KNOWN, *OF_CATALOGUE)
ALONG = 0.7  # arclength of the first form at which the reference configuration is


def single_loop(name):
    """A single loop of the known mechanisms or of the catalogue."""
    if name in KNOWN:
        return mechanism_of_case(cases()[name])
    return catalogue_loop(name)


def catalogue_loop(name):
    """A loop of the catalogue as a mechanism: its joints in another order than round
    the loop, every third one turned round, called by letters."""
    loop = load_linkage(name).loop
    reference = map_of(loop, settings=FEW).forms[0].branch(ALONG)
    joints = []
    for number, joint in enumerate(mechanism_of_loop(loop, reference).joints):
        step = -1 if number % 3 == 1 else 1
        joints.append(
            replace(joint, name="abcdefg"[number], bodies=joint.bodies[::step])
        )
    order = np.random.default_rng(5).permutation(len(joints))
    return Mechanism(tuple(joints[number] for number in order), name)


def with_a_held_joint(mechanism):
    """A mechanism one of whose bodies is two, with a joint between them that is locked
    at 0."""
    first, *others = mechanism.joints
    hinge = Joint("held", "revolute", (first.bodies[1], "half"), (3, 1, 2), (1, 1, 0))
    moved = replace(first, bodies=(first.bodies[0], "half"))
    joints = (hinge, moved, *others)
    return Mechanism(joints, mechanism.name).with_locks({"held": 0.0})
