"""Bodies that turn about their own line only, which moves nothing else, are no part of
the mobility."""

from itertools import combinations

import numpy as np
import pytest

from bifurc import SearchSettings
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.mechanism_document import describe_mechanism
from linkages.readout.poses import Poses
from linkages.readout.readout import Readout
from linkages.values import GeometryError
from tests.linkages.mechanisms.frameworks import (
    OCTAHEDRON,
    flexible_octahedron,
    framework,
    places_of,
)
from tests.linkages.mechanisms.spatial_mechanisms import ring_with_rods
from tests.maps import map_of

FEW = SearchSettings(starts=40)
UP = np.array([0.0, 0.0, 2.0])
SIDEWAYS = np.array([3.0, 0.0, 0.0])


def freedoms(mechanism):
    """The freedoms at the reference configuration with all bodies in space, from the
    twists that joints allow, but for those of the whole."""
    bodies = {body: k for k, body in enumerate(mechanism.bodies)}
    rows = []
    for pair in mechanism.pairs:
        twists = [_twist(mechanism.variables[k].motion) for k in pair.variables]
        if pair.center is not None:
            twists = [np.append(e, np.cross(pair.center, e)) for e in np.eye(3)]
        allowed = np.array(twists).reshape(-1, 6)
        _, values, right = np.linalg.svd(allowed)
        rank = np.count_nonzero(values > 1e-9)
        for row in right[rank:]:
            line = np.zeros((len(bodies), 6))
            line[bodies[pair.moved]] = row
            line[bodies[pair.base]] = -row
            rows.append(line.ravel())
    rank = np.linalg.matrix_rank(np.array(rows), tol=1e-8)
    return 6 * len(bodies) - int(rank) - 6


def _twist(motion):
    if not motion.is_turn:
        return np.append(np.zeros(3), motion.direction)
    shift = np.cross(motion.point, motion.direction) + motion.advance * motion.direction
    return np.append(motion.direction, shift)


def mobility_at_reference(mechanism):
    problem = MechanismClosure(mechanism)
    points, gaps = problem.project(problem.reference[None])
    assert gaps[0] < 1e-12
    values = np.linalg.svd(problem.jacobians(points)[0], compute_uv=False)
    return problem.n - np.count_nonzero(values > 1e-8)


# Bars and the mobility of the figure that they make.
FIGURES = {
    "triangle": ("ABC", ["AB", "BC", "CA"], 0),
    "tetrahedron": ("ABCD", [a + b for a, b in combinations("ABCD", 2)], 0),
    "skew quadrilateral": ("ABCD", ["AB", "BC", "CD", "DA"], 2),
    "skew pentagon": ("ABCDE", ["AB", "BC", "CD", "DE", "EA"], 4),
    "two triangles on an edge": ("ABCD", ["AB", "BC", "CA", "BD", "CD"], 1),
    "octahedron": ("ABCDEF", OCTAHEDRON, 0),
    "octahedron without a bar": ("ABCDEF", OCTAHEDRON[1:], 1),
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", FIGURES)
def test_bars_with_spherical_joints_have_the_mobility_of_their_figure(name, seed):
    points, bars, mobility = FIGURES[name]
    mechanism = framework(places_of(points, seed), bars)
    assert mobility_at_reference(mechanism) == mobility
    assert freedoms(mechanism) == mobility + len(bars)
    assert set(Readout(mechanism).structure.idle_bodies) == set(bars)


def platform_with(leg, seed):
    """Two plates and six legs, each the joints that ``leg`` gives for its ends."""
    rng = np.random.default_rng(seed)
    joints = []
    for k in range(6):
        start = rng.normal(size=3)
        end = rng.normal(size=3) + np.array([0.0, 0.0, 4.0])
        joints += leg(str(k), start, end)
    return Mechanism(tuple(joints))


def leg_with_a_turn(name, start, end):
    middle = tuple(0.3 * start + 0.7 * end)
    return [
        Joint(f"a{name}", "spherical", ("frame", f"x{name}"), tuple(start)),
        Joint(
            f"b{name}", "revolute", (f"x{name}", f"y{name}"), middle, tuple(end - start)
        ),
        Joint(f"c{name}", "spherical", (f"y{name}", "plate"), tuple(end)),
    ]


def leg_with_a_cylinder(name, start, end):
    joints = leg_with_a_turn(name, start, end)
    of_middle = joints[1]
    joints[1] = Joint(
        of_middle.name,
        "cylindrical",
        of_middle.bodies[::-1],
        of_middle.point,
        of_middle.direction,
    )
    return joints


def leg_with_two_turns(name, start, end):
    axis = tuple(end - start)
    return [
        Joint(f"a{name}", "spherical", ("frame", f"x{name}"), tuple(start)),
        Joint(f"b{name}", "revolute", (f"x{name}", f"y{name}"), tuple(start), axis),
        Joint(f"c{name}", "revolute", (f"z{name}", f"y{name}"), tuple(end), axis),
        Joint(f"d{name}", "spherical", (f"z{name}", "plate"), tuple(end)),
    ]


def leg_of_a_universal_joint(name, start, end):
    """The second axis of the universal joint runs along the leg."""
    rng = np.random.default_rng(int(name))
    first = tuple(rng.normal(size=3))
    return [
        Joint(
            f"a{name}",
            "universal",
            ("frame", f"x{name}"),
            tuple(start),
            first,
            tuple(end - start),
        ),
        Joint(f"c{name}", "spherical", (f"x{name}", "plate"), tuple(end)),
    ]


LEGS = {
    "revolute in a rod": (leg_with_a_turn, 2, 0),
    "cylinder in a leg": (leg_with_a_cylinder, 2, 6),
    "two turns in a rod": (leg_with_two_turns, 3, 0),
    "universal joint along a leg": (leg_of_a_universal_joint, 1, -6),
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", LEGS)
def test_turns_along_a_leg_are_idle(name, seed):
    leg, idle, mobility = LEGS[name]
    mechanism = platform_with(leg, seed)
    assert freedoms(mechanism) == max(mobility, 0) + 6 * idle
    assert mobility_at_reference(mechanism) == max(mobility, 0)


@pytest.mark.parametrize("seed", range(5))
def test_rods_between_moving_bodies_and_points_leave_the_freedoms_that_count(seed):
    """A four-bar with a tripod of rods: two on the coupler, one on the frame."""
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(4, 2))
    names = ("frame", "crank", "coupler", "rocker")
    joints = [
        Joint(
            f"J{k}", "revolute", (names[k - 1], names[k]), (*corners[k], 0), (0, 0, 1)
        )
        for k in range(4)
    ]
    top = tuple(rng.normal(size=3) + np.array([0, 0, 2]))
    feet = [("coupler", "r1"), ("r2", "coupler"), ("frame", "r3")]
    for k, bodies in enumerate(feet):
        place = tuple(rng.normal(size=3))
        joints.append(Joint(f"S{k}", "spherical", bodies, place))
    joints.append(Joint("T", "spherical", ("r2", "r1", "r3"), top))
    mechanism = Mechanism(tuple(joints))
    assert freedoms(mechanism) == mobility_at_reference(mechanism) + 3
    assert mobility_at_reference(mechanism) == 1


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_a_joint_of_rods_and_two_plates_holds_the_plates(order):
    """Whichever body a joint names first."""
    places = places_of("PQRABC", 3)
    bodies = ["frame", "plate", "r", "q"]
    bodies = bodies[order:] + bodies[:order]
    joints = (
        Joint("P", "spherical", tuple(bodies), tuple(places["P"])),
        Joint("Q", "spherical", ("plate", "r"), tuple(places["Q"])),
        Joint("R", "spherical", ("frame", "q"), tuple(places["R"])),
        Joint("A", "spherical", ("frame", "s"), tuple(places["A"])),
        Joint("B", "spherical", ("plate", "s"), tuple(places["B"])),
    )
    mechanism = Mechanism(joints)
    # the plate turns about P, held by one rod; rods r and q hang on one body each
    assert mobility_at_reference(mechanism) == 2
    assert freedoms(mechanism) == 2 + 3


@pytest.mark.parametrize("place", [1, 2, 10])
def test_a_plate_on_a_point_of_rods_moves_wherever_the_point_is_named(place):
    """Three rods hold point P; a plate hangs on it by a rod, on the base by four."""
    rng = np.random.default_rng(0)
    joints = [Joint("F0", "spherical", ("base", "q0"), tuple(rng.normal(size=3)))]
    joints.append(
        Joint("H", "spherical", ("plate", "r"), tuple(rng.normal(size=3) + UP))
    )
    for k in range(4):
        foot, head = tuple(rng.normal(size=3)), tuple(rng.normal(size=3) + UP)
        joints.append(Joint(f"B{k}", "spherical", (f"s{k}", "base"), foot))
        joints.append(Joint(f"C{k}", "spherical", ("plate", f"s{k}"), head))
    point = Joint("P", "spherical", ("r", "q0", "q1", "q2"), (3.0, 1.0, 1.0))
    joints.insert(place, point)
    for k in (1, 2):
        foot = tuple(rng.normal(size=3) + SIDEWAYS)
        joints.append(Joint(f"F{k}", "spherical", (f"q{k}", "base"), foot))
    mechanism = Mechanism(tuple(joints))
    assert mobility_at_reference(mechanism) == 1
    atlas = map_of(mechanism, settings=FEW)
    assert len(atlas.forms) == 2
    assert {form.certificate.status.value for form in atlas.forms} == {"certified"}


def test_bodies_of_a_figure_are_where_their_joints_are():
    mechanism = framework(places_of("ABCDEF", 2), OCTAHEDRON[1:])
    problem = MechanismClosure(mechanism)
    starts = problem.reference + 0.2 * np.random.default_rng(0).normal(
        size=(20, problem.n)
    )
    points, gaps = problem.project(starts)
    poses = Poses(problem.structure).at(points[gaps < 1e-12])
    assert len(poses) > 10
    for joint in mechanism.joints:
        places = [
            poses[:, mechanism.bodies.index(body)] @ np.append(joint.place, 1.0)
            for body in joint.bodies
        ]
        for place in places[1:]:
            np.testing.assert_allclose(place, places[0], atol=1e-11)


@pytest.mark.parametrize("bars", [OCTAHEDRON, OCTAHEDRON[::-1]])
def test_a_flexible_octahedron_of_bars_moves_whichever_bar_remains_a_body(bars):
    places = {joint.name: joint.place for joint in flexible_octahedron().joints}
    mechanism = framework(places, bars)
    atlas = map_of(mechanism, settings=FEW)
    (form,) = atlas.forms
    assert form.branch.closed
    assert (len(atlas.points), len(atlas.rigid), len(atlas.surfaces)) == (0, 2, 0)
    document = describe_mechanism(atlas, Readout(mechanism))
    assert set(document["idle_bodies"]) == set(OCTAHEDRON)


def test_a_tetrahedron_has_itself_and_its_mirror_image():
    names, bars, _ = FIGURES["tetrahedron"]
    mechanism = framework(places_of(names, 1), bars)
    for other in (mechanism, mechanism.mirrored(), mechanism.scaled(1e3)):
        atlas = map_of(other, settings=FEW)
        assert (len(atlas.forms), len(atlas.rigid), len(atlas.surfaces)) == (0, 2, 0)


def test_a_body_that_hangs_in_one_point_by_two_joints_is_refused():
    place = (1.0, 2.0, 3.0)
    joints = (
        Joint("a", "spherical", ("frame", "x"), place),
        Joint("b", "spherical", ("x", "y"), place),
        Joint("c", "spherical", ("y", "frame"), (0, 0, 0)),
    )
    with pytest.raises(GeometryError, match="joints a and b of body x"):
        MechanismClosure(Mechanism(joints))


def test_a_joint_beside_a_rigid_one_closes_a_loop_also_in_a_rod() -> None:
    start, end = (1.0, 0.2, 0.0), (0.3, 1.0, 2.0)
    joints = (
        Joint("hinge", "spherical", ("frame", "plate"), (0.0, 0.0, 0.0)),
        Joint("a", "spherical", ("frame", "x"), start),
        Joint("rigid", "rigid", ("x", "y")),
        Joint("pin", "revolute", ("x", "y"), (0.5, 0.5, 0.5), (1.0, 2.0, 0.5)),
        Joint("b", "spherical", ("y", "plate"), end),
    )
    mechanism = Mechanism(joints)
    rods = Readout(mechanism).structure.rods
    assert mobility_at_reference(mechanism) + len(rods) == freedoms(mechanism) == 3


def test_a_rod_without_length_is_refused_also_where_an_idle_turn_makes_it() -> None:
    center, elsewhere = (0.1, 0.2, 0.3), (1.5, 0.3, 0.9)
    joints = (
        Joint("a", "spherical", ("frame", "x"), center),
        Joint("turn", "revolute", ("x", "y"), center, (1.0, 0.5, -0.4)),
        Joint("b", "spherical", ("y", "z"), center),
        Joint("c", "universal", ("z", "frame"), elsewhere, (0, 0, 1), (1, 0, 0)),
    )
    with pytest.raises(GeometryError, match="joints a and b of body x: at one point"):
        MechanismClosure(Mechanism(joints))


@pytest.mark.parametrize("seed", range(30))
def test_random_mechanisms_have_the_mobility_of_their_joint_twists(seed):
    mechanism = ring_with_rods(np.random.default_rng(seed))
    try:
        structure = Readout(mechanism).structure
    except GeometryError as error:
        expected = ("at one point", "every one locked or rigid")
        assert any(part in str(error) for part in expected)
        return
    clusters = sum(len(point.directions) < 3 for point in structure.free_points)
    idle = len(structure.rods) + len(structure.idle_turns) + clusters
    assert mobility_at_reference(mechanism) + idle == freedoms(mechanism)
