"""Cylindrical and planar joints, which SDF does not know, from the chains of joints that
stand for them in files that are written here.

A joint C is written as C.turn and C.slide with a link C.turn.link between them, a planar
one as C.x, C.y and C.turn. Read as one again, it has its name, and the mechanism its
size and Grübler's count.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from linkages.formats.assembly import BodyJoint
from linkages.formats.composites import Axis, joints_of_axes
from linkages.mechanisms.joint import JointKind

WHOLE = JointKind.CYLINDRICAL, JointKind.PLANAR
WORDS = {JointKind.REVOLUTE: "hinge", JointKind.PRISMATIC: "slide"}


def link_behind(label: str) -> str:
    """What the link behind a variable is called in a chain."""
    return f"{label}.link"


def with_joints_of_chains(
    joints: Sequence[BodyJoint], pose_of: Callable[[str], np.ndarray]
) -> tuple[BodyJoint, ...]:
    """The ``joints`` with every chain as the joint that it stands for; ``pose_of`` gives
    the pose (4, 4) of a link. No joint has the links between any more."""
    by_name = {joint.name: joint for joint in joints}
    uses = Counter(body for joint in joints for body in joint.bodies)
    result: dict[str, BodyJoint | None] = dict(by_name)
    for kind in WHOLE:
        first, *_ = kind.facets.parts
        for start in joints:
            stem = start.name.removesuffix(f".{first}")
            names = [f"{stem}.{part}" for part in kind.facets.parts]
            links = [link_behind(name) for name in names[:-1]]
            is_chain = stem not in by_name and all(name in by_name for name in names)
            if not is_chain or any(uses[link] != 2 for link in links):
                continue
            chain = [by_name[name] for name in names]
            whole = _joined(stem, kind, chain, links, pose_of)
            if whole is not None:
                result |= {**dict.fromkeys(names), names[0]: whole}
    return tuple(joint for joint in result.values() if joint is not None)


def _joined(
    name: str,
    kind: JointKind,
    chain: Sequence[BodyJoint],
    links: Sequence[str],
    pose_of: Callable[[str], np.ndarray],
) -> BodyJoint | None:
    """The joint of this kind that a chain across ``links`` makes; None where it makes
    none."""
    base = next((one for one in chain[0].bodies if one != links[0]), "")
    moved = next((one for one in chain[-1].bodies if one != links[-1]), "")
    axes = []
    for joint, pair in zip(chain, pairwise([base, *links, moved]), strict=True):
        if set(joint.bodies) != {*pair} or joint.kind not in WORDS:
            return None
        frame = pose_of(joint.bodies[0]) @ joint.frames[0]
        # the world, which is no child in SDF, may be the body that moves
        sign = 1.0 if joint.bodies == pair else -1.0
        (limits,) = joint.limits
        word = WORDS[joint.kind]
        axes.append(Axis(joint.name, word, frame[:3, 3], sign * frame[:3, 2], limits))
    wholes = joints_of_axes(axes, {}, {})
    if len(wholes) > 1 or wholes[0].kind is not kind or wholes[0].is_reversed:
        return None
    (whole,) = wholes
    frames = (
        np.linalg.inv(pose_of(base)) @ whole.first,
        np.linalg.inv(pose_of(moved)) @ whole.second,
    )
    coupled = {label: to for joint in chain for label, to in joint.coupled.items()}
    bodies = base, moved
    return BodyJoint(name, kind, bodies, frames, limits=whole.limits, coupled=coupled)
