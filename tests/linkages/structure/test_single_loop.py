"""A mechanism that is one loop of revolute joints has the atlas of that loop."""

import numpy as np
import pytest

import linkages
from bifurc.settings import SearchSettings
from linkages.closure.closure import Closure
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.readout import Readout
from tests.maps import map_of

NAMES = [
    "bennett",
    "goldberg-5r",
    "bricard-line-symmetric",
    "special-double-subtractive-goldberg",
]
SEARCH = SearchSettings(starts=20, certify=False)


def mechanism_of(loop, theta, is_turned=False):
    """The axes of a loop at joint angles (n,) as a mechanism; every other joint turned
    round where asked for."""
    frames = loop.frames(theta)[:-1]
    joints = []
    for i in range(loop.n):
        bodies = (f"link {(i - 1) % loop.n + 1}", f"link {i + 1}")
        if is_turned and i % 2:
            bodies = bodies[::-1]
        point, direction = frames[i, :3, 3], frames[i, :3, 2]
        joints.append(Joint(f"J{i + 1}", "revolute", bodies, point, direction))
    return Mechanism(tuple(joints), loop.name)


@pytest.mark.parametrize("name", NAMES)
def test_the_atlas_is_that_of_the_loop(name):
    loop = linkages.load_linkage(name).loop
    expected = map_of(loop, settings=SEARCH)
    reference = expected.forms[0].branch(0.7)
    atlas = map_of(mechanism_of(loop, reference), settings=SEARCH)
    lengths = [form.branch.length for form in atlas.forms]
    assert np.allclose(lengths, [form.branch.length for form in expected.forms])
    assert [p.kind for p in atlas.points] == [p.kind for p in expected.points]
    assert atlas.completeness.level is expected.completeness.level
    assert linkages.mechanism_of(atlas) is not None
    with pytest.raises(linkages.NoLinkageError, match="it is of a mechanism"):
        linkages.loop_of(atlas)


def test_variables_are_measured_from_the_reference_configuration():
    loop = linkages.load_linkage("special-double-subtractive-goldberg").loop
    points = Closure(loop).seeds(np.random.default_rng(2), 4).points
    mechanism = mechanism_of(loop, points[0], is_turned=True)
    readout = Readout(mechanism)
    single = readout.single_loop
    to_unknowns = single.to_unknowns(readout.structure)
    assert np.abs(to_unknowns.points(single.reference)).max() < 1e-12
    # the general equations of the mechanism hold at the same variables
    problem = Closure(mechanism)
    others = points[:20] - points[0] + single.reference
    residuals = Closure(single.loop).residuals(others)
    assert np.abs(residuals).max() < 1e-12
    unknowns = to_unknowns.points(others)
    assert np.abs(problem.residuals(unknowns)).max() < 1e-12


def test_limits_locks_and_coinciding_axes_take_the_general_way():
    loop = linkages.load_linkage("bennett").loop
    theta = Closure(loop).seeds(np.random.default_rng(0), 1).points[0]
    mechanism = mechanism_of(loop, theta)
    assert Readout(mechanism).single_loop is not None
    assert Readout(mechanism.with_locks({"J1": 0.0})).single_loop is None
    first, *others = mechanism.joints
    doubled = Mechanism(
        (
            first,
            *others[:-1],
            Joint("K", "revolute", ("link 3", "arm"), others[-1].point, (0, 1, 2)),
            Joint("L", "revolute", ("arm", "link 4"), others[-1].point, (0, 1, 2)),
        )
    )
    assert Readout(doubled).single_loop is None


def loop_with_universal(is_turned):
    """The loop of a mechanism whose universal joint is given in the sense of the loop,
    or against it."""
    first, second = (0, 0, 1), (0, 1, 0)
    bodies = ("a", "b")
    if is_turned:
        first, second = second, first
        bodies = ("b", "a")
    universal = Joint(
        "U", "universal", bodies, (1, 0.2, 0.1), first, second_direction=second
    )
    joints = [
        Joint("A", "revolute", ("frame", "a"), (0, 0, 0), (0, 0.3, 1)),
        universal,
        Joint("C", "revolute", ("b", "c"), (2, 1, 0.4), (1, 0.2, 0.5)),
        Joint("D", "revolute", ("c", "d"), (1, 2, 0.7), (0.3, 1, 0.5)),
        Joint("E", "revolute", ("d", "frame"), (0, 2, 0.2), (0.3, -1, 0.5)),
    ]
    return Readout(Mechanism(tuple(joints))).single_loop


def test_a_universal_joint_against_the_sense_of_the_loop_has_its_turns_in_order():
    expected, turned = loop_with_universal(False), loop_with_universal(True)
    assert np.allclose(turned.loop.arrays, expected.loop.arrays, atol=1e-12)
    assert expected.variables.tolist() == [0, 1, 2, 3, 4, 5]
    assert turned.variables.tolist() == [0, 2, 1, 3, 4, 5]
    assert turned.signs.tolist() == [1, -1, -1, 1, 1, 1]
