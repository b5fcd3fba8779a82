"""Bodies are where joints let them be: poses and joint variables of closed
configurations."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkages.closure.mechanism_closure import MechanismClosure
from linkages.readout.readout import Readout
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import (
    one_of_each,
    platform,
    rods,
    rsrs,
    samples,
)

MECHANISMS = [
    one_of_each(),
    rods(),
    rsrs(),
    platform(),
    platform((0.0, 0.02, -0.03, 0.05, None, None)),
    mechanism_of_case(cases()["Bennett geometry with joints CRCR"]),
    mechanism_of_case(cases()["Miura-ori, 3 x 3 vertices"]),
    mechanism_of_case(cases()["three equal parallel cranks, pivots on a line"]),
]


@pytest.mark.parametrize("mechanism", MECHANISMS, ids=str)
def test_at_closed_configurations_every_joint_holds(mechanism):
    problem = MechanismClosure(mechanism)
    readout = Readout(mechanism)
    rng = np.random.default_rng(1)
    starts = np.concatenate(
        [
            problem.reference + 0.3 * rng.normal(size=(12, problem.n)),
            samples(problem, rng, 12),
        ]
    )
    points, gaps = problem.project(starts)
    points = points[gaps < 1e-13]
    assert len(points)
    poses, values = readout.poses(points), readout.values(points)
    for pair in mechanism.pairs:
        base = poses[:, mechanism.bodies.index(pair.base)]
        moved = poses[:, mechanism.bodies.index(pair.moved)]
        relative = np.linalg.inv(base) @ moved
        if pair.center is not None:
            center = np.append(pair.center, 1.0)
            assert np.allclose(relative @ center, center, atol=1e-11)
            continue
        expected = np.eye(4)
        for number in pair.variables:
            motion = mechanism.variables[number].motion
            expected = expected @ displacements(motion, values[:, number])
        assert np.allclose(relative, expected, atol=1e-11)


def displacements(motion, values):
    """Elementary displacements (k, 4, 4), with scipy's rotations."""
    result = np.tile(np.eye(4), (len(values), 1, 1))
    if not motion.is_turn:
        result[:, :3, 3] = values[:, None] * motion.direction
        return result
    rotation = Rotation.from_rotvec(values[:, None] * motion.direction).as_matrix()
    advance = motion.advance * values[:, None] * motion.direction
    result[:, :3, :3] = rotation
    result[:, :3, 3] = motion.point - rotation @ motion.point + advance
    return result


def test_the_variables_of_a_spherical_joint_are_its_rotation_vector():
    mechanism = rsrs()
    problem = MechanismClosure(mechanism)
    readout = Readout(mechanism)
    assert np.allclose(readout.variables(problem.reference)["S1"], 0.0)
    points, _ = problem.project(problem.reference[None] + 0.2)
    vector = readout.variables(points[0])["S1"]
    a_and_b = points[0, -6:].reshape(2, 3)
    rotation = Rotation.from_rotvec(vector).as_matrix()
    assert np.allclose(rotation[:, :2].T, a_and_b)


def test_a_slide_counts_in_the_unit_of_the_file():
    mechanism = rods().scaled(7.0)
    problem = MechanismClosure(mechanism)
    column = problem.domain.names.index("P")
    point = problem.reference.copy()
    point[column] = 0.3
    expected = 0.3 * problem.structure.unit
    assert Readout(mechanism).variables(point)["P"] == pytest.approx(expected)


def test_rods_and_legs_are_one_equation_each_and_idle():
    problem = MechanismClosure(platform((None,) * 6))
    assert problem.residuals(problem.reference[None]).shape == (1, 6 + 3)
    assert problem.n == 6 + 9
    assert len(problem.structure.idle_bodies) == 12
