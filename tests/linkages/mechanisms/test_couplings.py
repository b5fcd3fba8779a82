"""Joints that follow others: gears, racks, screws."""

from dataclasses import replace

import numpy as np
import pytest

import linkages
from bifurc.settings import SearchSettings
from bifurc.system import hessian_at
from linkages.closure.closure import Closure
from linkages.closure.curvature import CurvatureBounds
from linkages.closure.driving import joints_to_hold
from linkages.file import LinkageFileError
from linkages.files.mechanism_file import mechanism_toml
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.subject import mechanism_from, mechanism_subject
from linkages.readout.facts import form_facts
from linkages.readout.readout import Readout
from linkages.structure.structure import Structure
from linkages.values import GeometryError
from tests.linkages.mechanisms.known_mechanisms import cases
from tests.linkages.mechanisms.test_maps import counts, lengths, slider_crank
from tests.maps import map_of

FEW = SearchSettings(starts=60)
Z = (0.0, 0.0, 1.0)


def five_bar(**couplings):
    """A symmetric five-bar with cranks of length 1 at A and E."""
    points = {"A": (0, 0), "B": (0, 1), "C": (1.5, 3.5), "D": (3, 1), "E": (3, 0)}
    bodies = ("frame", "left", "left rod", "right rod", "right", "frame")
    joints = []
    for number, (name, (x, y)) in enumerate(points.items()):
        pair = bodies[number : number + 2]
        if name == "E":
            pair = pair[::-1]  # the turn of the crank on the frame, as at A
        coupled = (couplings[name],) if name in couplings else ()
        joints.append(Joint(name, "revolute", pair, (x, y, 0), Z, coupled=coupled))
    return Mechanism(tuple(joints), "geared five-bar", is_planar=True)


def with_coupling(mechanism, name, *coupled):
    joints = [
        replace(joint, coupled=coupled) if joint.name == name else joint
        for joint in mechanism.joints
    ]
    return Mechanism(tuple(joints))


def test_cranks_geared_one_to_minus_one_keep_a_five_bar_symmetric():
    mechanism = five_bar(E=Coupling("A", -1.0))
    assert mechanism.gruebler == 1
    atlas = map_of(mechanism, settings=FEW)
    assert len(atlas.forms) == 2
    assert all(form.certificate.status.value == "certified" for form in atlas.forms)
    readout = Readout(mechanism)
    coupler = mechanism.bodies.index("left rod")
    places = []
    for form in atlas.forms:
        points = form.branch.sample(100)
        poses = readout.poses(points)[:, coupler] @ [1.5, 3.5, 0.0, 1.0]
        places.append(poses[:, 0])
        values = readout.values(points)
        assert np.allclose(values[:, 4], -values[:, 0], atol=1e-15)
    assert max(np.abs(x - 1.5).max() for x in places) < 1e-12


# Norton, Design of Machinery (2012): a geared five-bar of gear ratio 2 closes after two
# turns of the faster crank
def test_a_form_closes_when_all_gears_are_back():
    mechanism = five_bar(E=Coupling("A", 0.5, 0.3))
    assert Closure(mechanism).domain.periods[0] == pytest.approx(4 * np.pi)
    atlas = map_of(mechanism, settings=FEW)
    assert len(atlas.forms) == 2
    for number, form in enumerate(atlas.forms):
        assert form.branch.closed
        ranges = form_facts(atlas, number, Readout(mechanism)).ranges
        turns = {one.label: abs(one.turns) for one in ranges}
        assert (turns["A"], turns["E"]) == (2, 1)


def test_a_slide_coupled_to_its_turn_is_a_screw():
    joints = cases()["Bennett geometry with joints CRCR"]["joints"]
    joints = [Joint(**joint) for joint in joints]
    number = [joint.kind for joint in joints].index("cylindrical")
    name = joints[number].name
    screw = Joint(
        name,
        "helical",
        joints[number].bodies,
        joints[number].point,
        joints[number].direction,
        pitch=2 * np.pi * 0.2,
    )
    coupled = (None, Coupling(f"{name}.turn", 0.2))
    nut = replace(joints[number], coupled=coupled)
    limits = Readout(Mechanism((*joints[:number], nut, *joints[number + 1 :]))).limits()
    screw = replace(screw, limits=(limits[f"{name}.turn"],))
    atlases = []
    for joint in (screw, nut):
        mechanism = Mechanism((*joints[:number], joint, *joints[number + 1 :]))
        assert mechanism.gruebler == -1
        atlases.append(map_of(mechanism, settings=FEW))
    assert counts(atlases[0]) == counts(atlases[1])
    assert np.allclose(lengths(atlases[0]), lengths(atlases[1]), rtol=1e-9)


def test_what_follows_a_locked_joint_is_locked_and_a_lock_holds_the_leader():
    mechanism = five_bar(E=Coupling("C", -2.0, 0.1), C=Coupling("A", 0.5, 0.2))
    held = mechanism.with_locks({"E": 0.5})
    values = {variable.label: variable.locked for variable in held.variables}
    assert values["A"] == pytest.approx(-0.8)
    assert values["C"] == pytest.approx(-0.2)
    assert values["E"] == pytest.approx(0.5)
    assert held.gruebler == mechanism.gruebler - 1
    with pytest.raises(GeometryError, match=r"lock: .* given once for A"):
        mechanism.with_locks({"A": 0.5, "E": 0.5})


def test_limits_of_coupled_joints_hold_for_all_of_them():
    coupled = five_bar(E=Coupling("A", -2.0, 0.5))
    joints = list(coupled.joints)
    joints[4] = replace(joints[4], limits=((-1.0, 2.0),))
    readout = Readout(Mechanism(tuple(joints)))
    assert readout.limits()["A"] == pytest.approx((-0.75, 0.75))
    assert readout.limits()["E"] == pytest.approx((-1.0, 2.0))
    joints[0] = replace(joints[0], limits=((0.8, 1.0),))
    with pytest.raises(GeometryError, match=r"limits of A .* overlap"):
        Structure(Mechanism(tuple(joints)))
    joints[0] = replace(joints[0], limits=(), locked=(1.0,))
    with pytest.raises(GeometryError, match=r"E, which follows A,: -1\.5"):
        Mechanism(tuple(joints))


def test_angles_that_never_come_back_are_followed_for_ten_turns():
    readout = Readout(five_bar(E=Coupling("A", np.sqrt(2.0))))
    assert readout.limits()["A"] == pytest.approx((-20 * np.pi, 20 * np.pi))


RACK = with_coupling(slider_crank(), "J4", Coupling("J1", 0.3))
TAKEN = {
    "gears": five_bar(E=Coupling("A", -2.0, 0.3), D=Coupling("E", 0.5)),
    "rack": RACK,
}


@pytest.mark.parametrize("name", TAKEN)
def test_derivatives_agree_with_differences_and_bounds(name):
    problem = Closure(TAKEN[name])
    rng = np.random.default_rng(3)
    points = problem.reference + 0.1 * rng.normal(size=(5, problem.n))
    step = 1e-6
    shifted = [
        (problem.residuals(points + d) - problem.residuals(points - d)) / (2 * step)
        for d in step * np.eye(problem.n)
    ]
    assert np.allclose(np.stack(shifted, axis=-1), problem.jacobians(points), atol=1e-8)
    bounds = CurvatureBounds(problem.structure, problem.curvature.residual)
    near, gaps = problem.project(points)
    assert np.all(gaps < 1e-12)
    norms = [np.linalg.norm(hessian_at(problem, point).ravel()) for point in near]
    largest = bounds.near_solutions * np.sqrt(problem.n)
    assert max(norms) < largest


WAYS = {
    "small": lambda mechanism: mechanism.scaled(1e-3),
    "large": lambda mechanism: mechanism.scaled(1e3),
    "mirrored": Mechanism.mirrored,
    "read back": lambda one: mechanism_from(mechanism_subject(one)["mechanism"], ""),
}


@pytest.mark.parametrize("way", WAYS)
def test_a_coupling_of_a_slide_and_a_turn_does_not_depend_on_units(way):
    case = cases()["Bennett geometry with joints CRCR"]
    joints = [Joint(**joint) for joint in case["joints"]]
    first = next(joint for joint in joints if joint.kind == "cylindrical").name
    turn = next(joint for joint in joints if joint.kind == "revolute").name
    mechanism = Mechanism(tuple(joints))
    mechanism = with_coupling(mechanism, first, None, Coupling(turn, 0.2, 0.01))
    expected = Closure(mechanism)
    problem = Closure(WAYS[way](mechanism))
    points = np.random.default_rng(1).normal(size=(3, problem.n))
    images = points
    if way == "mirrored":  # slides along axes that are turned round change their sign
        images = points * [
            -1.0 if "slide" in name else 1.0 for name in problem.domain.names
        ]
    gaps = np.linalg.norm(problem.residuals(images), axis=1)
    assert np.allclose(gaps, np.linalg.norm(expected.residuals(points), axis=1))


def test_limits_of_slides_on_turned_axes_are_mirrored():
    joint = Joint(
        "C", "cylindrical", ("a", "b"), (0, 0, 0), Z, limits=(None, (-1.0, 3.0))
    )
    other = Joint("D", "cylindrical", ("a", "b"), (1, 0, 0), (0, 1, 0))
    mirrored = Mechanism((joint, other)).mirrored()
    assert mirrored.joints[0].limits == (None, (-3.0, 1.0))


# --- files ----------------------------------------------------------------------------

FILE = """
[[joints]]
name = "J1"
kind = "revolute"
bodies = ["frame", "a"]
point = [0, 0, 0]
direction = [0, 0, 1]
[[joints]]
name = "J2"
kind = "revolute"
bodies = ["a", "b"]
point = [1, 0, 0]
direction = [0, 0, 1]
[[joints]]
name = "J3"
kind = "planar"
bodies = ["b", "frame"]
direction = [0, 0, 1]
coupled = [{}, {to = "J1", ratio = 0.5, offset = 0.25}, {}]
[[joints]]
name = "J4"
kind = "revolute"
bodies = ["frame", "b"]
point = [2, 0, 0]
direction = [0, 0, 1]
coupled = {to = "J1", ratio = -2.0, offset = 90}
"""


def read(tmp_path, text):
    path = tmp_path / "gears.toml"
    path.write_text(text, encoding="utf-8")
    return linkages.load(path)


def test_couplings_are_read_with_offsets_in_the_units_of_the_file(tmp_path):
    mechanism = read(tmp_path, FILE)
    assert mechanism.joint("J3").coupled == (None, Coupling("J1", 0.5, 0.25), None)
    (coupling,) = mechanism.joint("J4").coupled
    assert coupling == Coupling("J1", -2.0, np.pi / 2)


LAST = 'coupled = {to = "J1", ratio = -2.0, offset = 90}'
MALFORMED = {
    "coupled = 3": r"coupled of joint J4: 3 .* a table \{to, ratio, offset\}",
    'coupled = [{to = "J1", ratio = 1}, {}]': r"coupled of joint J4: .* a table",
    "coupled = {ratio = 2.0}": r"to of coupled of joint J4: a missing key",
    'coupled = {to = "J1"}': r"ratio of coupled of joint J4: a missing key",
    'coupled = {to = "J1", ratio = 0}': r"ratio of coupled of joint J4: 0 .* locked",
    'coupled = {to = "J1", ratio = nan}': r"ratio of coupled of joint J4: nan",
    'coupled = {to = "J1", ratio = "2"}': r'ratio of coupled of joint J4: "2"',
    'coupled = {to = "J1", ratio = 1, offset = inf}': r"offset of coupled .* J4: inf",
    'coupled = {to = "J1", gear = 1}': r"key of coupled of joint J4: 'gear'",
    'coupled = {to = "J9", ratio = 1}': r'coupled of J4: "J9" .* one of .* J1, J2',
    'coupled = {to = "J3", ratio = 1}': r'coupled of J4: "J3" .* J3\.x, J3\.y',
    'coupled = {to = "J4", ratio = 1}': r"coupled of J4: J4 -> J4 .* ends",
    "coupled = {to = 4, ratio = 1}": r"to of a coupling: 4",
    LAST + "\nlocked = 10": r"locked of joint J4: .* coupled to J1",
}


@pytest.mark.parametrize("number", range(len(MALFORMED)))
def test_a_malformed_coupling_is_refused_by_name_and_value(number, tmp_path):
    text, message = list(MALFORMED.items())[number]
    with pytest.raises(LinkageFileError, match=message):
        read(tmp_path, FILE.replace(LAST, text))


def test_couplings_that_lead_back_are_refused_with_the_way_round(tmp_path):
    text = FILE.replace(
        "point = [1, 0, 0]", 'point = [1, 0, 0]\ncoupled = {to = "J4", ratio = 2}'
    ).replace('{to = "J1", ratio = -2.0, offset = 90}', '{to = "J2", ratio = 1}')
    with pytest.raises(LinkageFileError, match=r"coupled of J2: J2 -> J4 -> J2"):
        read(tmp_path, text)


def test_what_follows_a_driver_drives_as_it_does():
    mechanism = five_bar(E=Coupling("B", 0.5))
    held = joints_to_hold(mechanism, "E")
    assert held == joints_to_hold(mechanism, "B")
    two = five_bar()
    assert list(joints_to_hold(two, "E")) == ["A"]


def test_couplings_are_written_to_toml(tmp_path):
    mechanism = read(tmp_path, FILE)
    again = read(tmp_path, mechanism_toml(mechanism))
    assert again.joints == mechanism.joints
