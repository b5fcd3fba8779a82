"""Loops are closed in the variables of a spanning tree."""

import numpy as np
import pytest

from linkages.formats.assembly import Assembly, BodyJoint, frame_along
from linkages.formats.joint_values import limits_left
from linkages.formats.tree_closing import TreeClosing
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import JointKind

KINDS = [kind for kind in JointKind if kind is not JointKind.RIGID]
STEP = 1e-6


def frame(rng):
    return frame_along(rng.normal(size=3), rng.normal(size=3))


def chain(kind, closed_by, rng, coupled=()):
    """Four bodies on joints of a kind, the last one joined to the first."""
    joints = []
    poses = {"0": np.eye(4)}
    for k in range(3):
        frames = frame(rng), frame(rng)
        bodies = str(k), str(k + 1)
        poses[bodies[1]] = poses[bodies[0]] @ frames[0] @ np.linalg.inv(frames[1])
        pitch = 0.7 if kind is JointKind.HELICAL else None
        cosine = 1.0 if kind is JointKind.UNIVERSAL else 0.0
        own = {f"J{k}": coupled[k]} if k < len(coupled) and coupled[k] else {}
        ends = bodies[::-1] if k == 1 else bodies
        if k == 1:
            frames = frames[::-1]
        joints.append(
            BodyJoint(f"J{k}", kind, ends, frames, cosine, pitch, coupled=own)
        )
    joints.append(BodyJoint("end", closed_by, ("3", "0"), (frame(rng), frame(rng))))
    return Assembly("chain", tuple(poses), tuple(joints), poses)


@pytest.mark.parametrize("closed_by", [JointKind.RIGID, JointKind.SPHERICAL])
@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_are_those_of_the_steps(kind, closed_by):
    rng = np.random.default_rng(4)
    closing = TreeClosing(chain(kind, closed_by, rng))
    count = closing._led.shape[1]
    poses = closing._moved(closing._given, 0.3 * rng.normal(size=count))
    _, matrix = closing._system(poses)
    for column in range(count):
        step = STEP * np.eye(count)[column]
        after = closing._system(closing._moved(poses, step))[0]
        before = closing._system(closing._moved(poses, -step))[0]
        rate = (after - before) / (2 * STEP)
        np.testing.assert_allclose(matrix[:, column], rate, atol=1e-7)


def test_variables_that_are_coupled_move_together():
    rng = np.random.default_rng(5)
    coupled = (None, None, Coupling("J0", -2.0, 0.5))
    assembly = chain(JointKind.REVOLUTE, JointKind.SPHERICAL, rng, coupled)
    closing = TreeClosing(assembly)
    assert closing._led.shape == (3, 2)
    steps = closing._to_couplings(closing._given)
    np.testing.assert_allclose(steps[closing._labels.index("J2")], 0.5)


def test_limits_that_are_left_are_told():
    rng = np.random.default_rng(6)
    whole = chain(JointKind.REVOLUTE, JointKind.SPHERICAL, rng)
    first, *others = whole.joints
    limited = BodyJoint("J0", first.kind, first.bodies, first.frames, limits=((1, 2),))
    assembly = Assembly("chain", whole.bodies, (limited, *others), whole.poses)
    poses = np.array(list(whole.poses.values()))
    assert limits_left(assembly, poses) == {"J0": pytest.approx(0.0)}
