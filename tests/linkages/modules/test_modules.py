"""Modules: how many complex assemblies they have, and the real ones among them."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from bifurc.completeness import Level, Scope
from bifurc.limits import Deadline
from bifurc.paths.follow import distinct
from bifurc.paths.monodromy import CurveOverLine, Effort, Fibre
from linkages.closure.closure import Closure
from linkages.dyads.generic import UnfollowedError
from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.modules.assemblies import Module
from linkages.structure.structure import Structure
from tests.linkages.modules.common_types import (
    TYPES,
    platform,
    random_platform,
    vector,
)
from tests.samples import one_in

OF_LETTER = {
    "R": JointKind.REVOLUTE,
    "P": JointKind.PRISMATIC,
    "C": JointKind.CYLINDRICAL,
    "U": JointKind.UNIVERSAL,
    "S": JointKind.SPHERICAL,
}


def loop(letters, rng):
    joints = []
    for number, letter in enumerate(letters):
        bodies = f"b{number}", f"b{(number + 1) % len(letters)}"
        direction, other = rng.normal(size=(2, 3))
        values = {"point": vector(rng.normal(size=3))}
        if letter != "S":
            values["direction"] = vector(direction)
        if letter == "U":
            values["second_direction"] = vector(np.cross(direction, other))
        if letter == "P":
            del values["point"]
        joints.append(Joint(f"{letter}{number}", OF_LETTER[letter], bodies, **values))
    return Mechanism(tuple(joints))


def are_among(points, others):
    """Whether every one of some configurations (k, n) is one of the others."""
    gaps = np.abs(points[:, None] - others[None]).max(axis=2)
    return bool(np.all(gaps.min(axis=1, initial=np.inf) < 1e-6))


# --- counts ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", TYPES)
def test_shipped_solutions_are_all_of_a_generic_member(name):
    """Their number is that of the literature, and the trace test says so anew."""
    family = TYPES[name].family
    known = family.generic
    fibre = known.fibre
    assert known.count == TYPES[name].count
    assert len(distinct(fibre.solutions)) == known.count
    gaps = np.abs(family.family.residuals(fibre.solutions, fibre.parameters))
    sizes = 1.0 + np.abs(fibre.solutions).max() ** 2
    assert gaps.max() < 1e-13 * sizes
    assert trace_of(family, fibre) < 1e-9


def trace_of(family, fibre):
    """That of the curve over a line through a member of a family."""
    rng = np.random.default_rng(1)
    projection = family.projection
    sizes = np.where(projection.targets, 1.0, 0.0)
    looked_at = projection.coordinates_of(fibre.solutions)
    curve = CurveOverLine(family.family, fibre, sizes, looked_at, rng)
    trace = np.inf
    while not trace < 1e-6:
        curve.find_points(rng, Effort(Deadline()))
        trace = curve.trace(Effort(Deadline())) or np.inf
        assert len(curve.solutions) == len(fibre.solutions)
    return trace


def test_the_trace_test_misses_a_solution_that_is_left_out():
    family = TYPES["K(3,3)"].family
    fibre = family.generic.fibre
    with pytest.raises(AssertionError):
        trace_of(family, Fibre(fibre.parameters, fibre.solutions[:-1]))


def test_three_cylindrical_joints_close_in_two_ways():
    """Their angles close a spherical triangle, and the slides follow."""
    mechanism = loop("CCC", np.random.default_rng(3))
    module = Module(Structure(mechanism))
    assert module.count == 2
    closure = Closure(mechanism)
    known = module.configurations()
    assert len(known) == 2
    # the reference configuration among them
    assert np.abs(known).max(axis=1).min() < 1e-9
    assert np.abs(closure.residuals(known)).max() < 1e-11


def test_what_moves_is_no_module():
    with pytest.raises(UnfollowedError, match="moves"):
        Module(Structure(loop("RUSR", np.random.default_rng(3))))


# --- platforms ------------------------------------------------------------------------


@pytest.mark.parametrize("seed", one_in(4, range(1, 25)))
def test_a_platform_on_six_legs_has_all_its_assemblies(seed):
    mechanism = random_platform(seed)
    module = Module(Structure(mechanism))
    assert module.count == 40
    known = module.configurations()
    assert len(known) % 2 == 0
    closure = Closure(mechanism)
    starts = np.random.default_rng(1).normal(size=(500, closure.n))
    points, gaps = closure.project(starts)
    assert are_among(points[gaps < 1e-10], known)


# Dietmaier 1998: feet, heads and lengths of six legs
FEET = [
    [0.0, 0.0, 0.0],
    [1.107915, 0.0, 0.0],
    [0.549094, 0.756063, 0.0],
    [0.735077, -0.223935, 0.525991],
    [0.514188, -0.526063, -0.368418],
    [0.590473, 0.094733, -0.205018],
]
HEADS = [
    [0.0, 0.0, 0.0],
    [0.542805, 0.0, 0.0],
    [0.956919, -0.528915, 0.0],
    [0.665885, -0.353482, 1.402538],
    [0.478359, 1.158742, 0.107672],
    [-0.137087, -0.235121, 0.353913],
]
LENGTHS = [1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071]


def assembled(feet, heads, lengths):
    """Where the heads are in one assembly, by Newton's method from random poses."""
    rng = np.random.default_rng(0)

    def standing(pose):
        w, x, y, z = pose[:4] / np.linalg.norm(pose[:4])
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        rotation = np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross
        return heads @ rotation.T + pose[4:]

    def misfit(pose):
        gaps = np.linalg.norm(standing(pose) - feet, axis=1) - lengths
        return np.append(gaps, pose[:4] @ pose[:4] - 1.0)

    solutions = (
        least_squares(misfit, rng.normal(size=7), xtol=1e-15, ftol=1e-15, gtol=1e-15)
        for _ in range(100)
    )
    return next(standing(one.x) for one in solutions if one.cost < 1e-26)


def test_the_platform_of_dietmaier_has_40_real_assemblies():
    feet, heads, lengths = map(np.array, (FEET, HEADS, LENGTHS))
    mechanism = platform(feet, assembled(feet, heads, lengths))
    atlas = map_linkage(mechanism)
    (claim,) = (one for one in atlas.completeness.claims if one.scope is Scope.MOTIONS)
    assert claim.level is Level.CERTIFIED
    assert len(atlas.rigid) == 40
    assert "40 of 40 complex assemblies are real" in atlas.completeness.statement
