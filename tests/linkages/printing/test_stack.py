"""Where eyes, pins and caps of a planar mechanism in layers begin and end."""

from itertools import combinations, pairwise

import numpy as np
import pytest

from linkages.app.options import PrintOptions
from linkages.app.reports.stacking import stack_of
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import GeometryError
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.maps import map_of

NAMES = ("planar slider-crank RRRP", "K(2,3)")


@pytest.fixture(scope="module", params=NAMES)
def stack(request):
    atlas = map_of(mechanism_of_case(cases()[request.param]))
    return stack_of(atlas, atlas.forms[:1], PrintOptions())


def spans(stack):
    """What reaches from where to where along z, with the holder and the place, of eyes,
    heads and caps."""
    sizes = stack.dimensions
    rows = []
    for number, body in enumerate(stack.bodies):
        rows += [("eye", number, eye.place, *eye.span) for eye in body.eyes]
    for hinge in stack.hinges:
        head = hinge.bottom - sizes.round_end, hinge.bottom
        cap = hinge.cap, hinge.top + sizes.round_end
        rows += [("head", hinge.holder, hinge.place, *head)]
        rows += [("cap", hinge.holder, hinge.place, *cap)]
    return rows


def test_on_one_axis_parts_follow_each_other_with_the_play_between(stack):
    play = stack.dimensions.play
    point = stack.plan.forms[0].branch(0.7)
    poses = stack.poses(point[None])[0]
    places = [
        (poses[holder, :3, :3] @ place + poses[holder, :3, 3], low, high)
        for _, holder, place, low, high in spans(stack)
    ]
    for hinge in stack.hinges:
        pose = poses[hinge.holder]
        axis = pose[:3, :3] @ hinge.place + pose[:3, 3]
        on_axis = sorted(
            (low, high)
            for place, low, high in places
            if np.linalg.norm(place - axis) < 1e-6
        )
        gaps = [after[0] - before[1] for before, after in pairwise(on_axis)]
        if "J4" in hinge.name or "P4" in hinge.name:  # the slot is in between
            gaps.remove(max(gaps))
        assert gaps == pytest.approx([play] * len(gaps))


def test_heads_caps_and_rods_of_different_joints_have_heights_of_their_own(stack):
    """Below and above the layers of their own joint, so that only what is as wide as an
    eye, and so in a layer of its own, can be beside them."""
    sizes = stack.dimensions
    rows = spans(stack)
    heads = {row[3:] for row in rows if row[0] == "head"}
    caps = {row[3:] for row in rows if row[0] == "cap"}
    half = sizes.eye_height / 2
    middles = {stack.height(body) for body in range(len(stack.bodies))}
    layers = {(middle - half, middle + half) for middle in middles}
    for one, other in combinations(sorted(heads) + sorted(caps) + sorted(layers), 2):
        is_apart = one[1] < other[0] or other[1] < one[0]
        assert is_apart or (one in heads and other in heads) or one == other


def test_bodies_are_placed_as_the_mechanism_has_them(stack):
    parts = stack.plan.parts
    points = stack.plan.forms[0].branch.sample(5)
    poses, expected = stack.poses(points), parts.poses(points)
    for hinge, pin in zip(stack.hinges, _pins(stack), strict=True):
        holder, place = pin
        moved = poses[:, holder, :3, :3] @ hinge.place + poses[:, holder, :3, 3]
        wanted = expected[:, holder, :3, :3] @ place + expected[:, holder, :3, 3]
        flat = stack.scale * (wanted @ stack.turn.T)[:, :2]
        assert moved[:, :2] == pytest.approx(flat, abs=1e-9)
        assert moved[:, 2] == pytest.approx(0)


def _pins(stack):
    return [(pin.holder, line[0]) for pin in stack.plan.pins for line in pin.lines]


def test_joints_without_pins_are_refused():
    joints = list(mechanism_of_case(cases()["planar slider-crank RRRP"]).joints)
    first = joints[0]
    rigid = Joint("weld", JointKind.RIGID, (first.bodies[0], "plate"), first.point)
    atlas = map_of(Mechanism((*joints, rigid)))
    with pytest.raises(GeometryError, match="kind of joint weld"):
        stack_of(atlas, atlas.forms[:1], PrintOptions())
