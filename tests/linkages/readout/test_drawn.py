"""Where on its map a mechanism is as its file draws it, and how it is seen there."""

import numpy as np
import pytest

from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.dead_points import driven_dead_points, moving_dead_points
from linkages.readout.drawn import drawn_place
from linkages.viewing.document import make_view_document

POINTS = {"A": (0.0, 0.0), "B": (0.2, 2.0), "C": (2.6, 0.9), "D": (3.0, 0.0)}
BODIES = ["ground", "rocker", "rod", "crank"]


def four_bar(right, up):
    """A crank-rocker in the plane of two unit vectors."""
    normal = tuple(np.cross(right, up).tolist())
    joints = []
    for k, (name, (x, y)) in enumerate(POINTS.items()):
        point = tuple((x * np.array(right) + y * np.array(up)).tolist())
        both = (BODIES[k], BODIES[(k + 1) % 4])
        joints.append(Joint(name, JointKind.REVOLUTE, both, point, normal))
    return Mechanism(tuple(joints), "crank-rocker")


X, Y, Z = np.eye(3).tolist()


@pytest.mark.parametrize(("right", "up"), [(X, Y), (X, Z), (Y, Z)])
def test_a_planar_mechanism_is_seen_as_drawn_and_opens_there(right, up):
    atlas = map_linkage(four_bar(right, up))
    drawn = drawn_place(atlas)
    assert drawn.name in {form.name for form in atlas.forms}
    assert np.abs(drawn.point).max() == 0.0
    at = atlas.forms[drawn.form].branch(drawn.s)
    assert np.abs(np.sin(at / 2)).max() < 1e-9
    document = make_view_document(atlas)
    assert document["drawn"]["place"] == [drawn.form, drawn.s]


def test_a_table_is_drawn_in_no_configuration():
    atlas = map_linkage(load("bennett"))
    assert drawn_place(atlas) is None
    assert make_view_document(atlas)["drawn"] is None


def test_dead_points_are_those_of_the_first_joint():
    atlas = map_linkage(four_bar(X, Y))
    driven = driven_dead_points(atlas)
    assert {atlas.names[event.index] for event in driven} == {"A"}
    assert len(driven) == 4
    assert len(moving_dead_points(atlas)) == len(atlas.dead_points) > len(driven)


def test_a_joint_that_stands_still_has_no_dead_point():
    atlas = map_linkage(load("special-double-subtractive-goldberg"))
    still = [
        (k, joint)
        for k, form in enumerate(atlas.forms)
        for joint in form.labels.get("inactive_joints", ())
    ]
    assert still
    moving = {(event.form, event.index + 1) for event in moving_dead_points(atlas)}
    assert not moving & set(still)
