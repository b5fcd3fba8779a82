"""The clearance of bodies of a mechanism: the least distance that there is."""

import pytest

from linkages.links.clearance import TOLERANCE, approaches_along, distances_of
from linkages.links.parts import Bodies
from linkages.readout.poses import Poses
from linkages.structure.structure import Structure
from tests.linkages.links.test_clearance import nearest_by_optimisation
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import rods
from tests.maps import map_of

MECHANISMS = {
    "CRCR": lambda: mechanism_of_case(cases()["Bennett geometry with joints CRCR"]),
    "rods": rods,
}


@pytest.mark.parametrize("name", MECHANISMS)
def test_no_place_of_a_form_has_bodies_nearer_than_is_said(name):
    mechanism = MECHANISMS[name]()
    structure = Structure(mechanism)
    form = map_of(mechanism).forms[0]
    bodies = Bodies(structure)
    approaches = approaches_along(bodies, form.branch)
    assert [one.links for one in approaches]
    assert approaches == sorted(approaches, key=lambda one: one.distance)
    samples = form.branch.sample(2001)
    lines = bodies.lines(samples)
    for approach in approaches:
        names = {mechanism.bodies[body] for body in approach.links}
        assert not any(names <= set(joint.bodies) for joint in mechanism.joints)
        there = distances_of(bodies, lines, approach.theta[None], approach.links)
        assert there[0] == pytest.approx(approach.distance, abs=1e-12)
        sampled = distances_of(bodies, lines, samples, approach.links).min()
        assert approach.distance <= sampled + 1e-9 * structure.unit
        assert approach.error <= 2 * TOLERANCE * structure.unit


def test_distances_are_those_of_the_nearest_points_of_two_bodies():
    mechanism = MECHANISMS["CRCR"]()
    structure = Structure(mechanism)
    form = map_of(mechanism).forms[0]
    bodies = Bodies(structure)
    points = form.branch.sample(3)
    lines = bodies.lines(points)
    pair = bodies.pairs_apart(lines)[0]
    poses = Poses(structure).at(points)
    distances = distances_of(bodies, lines, points, pair)
    for pose, distance in zip(poses, distances, strict=True):
        placed = [
            lines[body] @ pose[body, :3, :3].T + pose[body, :3, 3] for body in pair
        ]
        expected = min(
            nearest_by_optimisation(one, other, rods=1)
            for one in placed[0]
            for other in placed[1]
        )
        assert distance == pytest.approx(expected, abs=1e-7)
