"""Modules: how many complex configurations they have, and the real ones among them."""

import numpy as np
import pytest

from bifurc.limits import Deadline
from bifurc.paths.follow import distinct
from bifurc.paths.monodromy import CurveOverLine, Effort, Fibre, Projection
from linkages.closure.closure import Closure
from linkages.dyads.group import UnfollowedError
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.modules.slices import for_subject
from linkages.modules.solve import Module, generic_solutions
from linkages.structure.structure import Structure
from tests.linkages.modules.common_types import (
    K33,
    PRISM,
    TYPES,
    random_on_sphere,
    random_platform,
    vector,
)

OF_LETTER = {
    "R": JointKind.REVOLUTE,
    "P": JointKind.PRISMATIC,
    "C": JointKind.CYLINDRICAL,
    "U": JointKind.UNIVERSAL,
    "S": JointKind.SPHERICAL,
}
# configurations of a spatial loop at a value of its first joint: of two-valued loops
# (RSSR, RCCC: Bennett's and Duffy's input-output equations of degree 2 in the tangent of
# the half-angle), and of a sphere on a curve of the fourth degree
OF_LOOPS = {"RSSR": 2, "RSCR": 4, "RUSR": 4}


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
    """Whether every one of some configurations (k, n) in angles is one of the others."""
    gaps = np.abs(np.exp(1j * points[:, None]) - np.exp(1j * others[None])).max(axis=2)
    return bool(np.all(gaps.min(axis=1, initial=np.inf) < 1e-6))


@pytest.mark.parametrize("name", TYPES)
def test_shipped_solutions_are_all_of_a_generic_member(name):
    """Their number is that of the literature, and the trace test says so anew."""
    family = TYPES[name].module.family
    known = generic_solutions(family)
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
    projection = Projection(family.are_targets, tuple(family.columns.values()))
    sizes = np.where(family.are_targets, 1.0, 0.0)
    looked_at = projection.coordinates_of(fibre.solutions)
    curve = CurveOverLine(family.family, fibre, sizes, looked_at, rng)
    trace = np.inf
    while not trace < 1e-6:
        curve.find_points(rng, Effort(Deadline()))
        trace = curve.trace(Effort(Deadline())) or np.inf
        assert len(curve.solutions) == len(fibre.solutions)
    return trace


def test_the_trace_test_misses_a_solution_that_is_left_out():
    family = TYPES["K(3,3) on a sphere"].module.family
    fibre = generic_solutions(family).fibre
    with pytest.raises(AssertionError):
        trace_of(family, Fibre(fibre.parameters, fibre.solutions[:-1]))


@pytest.mark.parametrize(("arcs", "count"), [(K33, 16), (PRISM, 32)])
def test_a_framework_on_a_sphere_has_all_its_assemblies(arcs, count):
    mechanism = random_on_sphere(arcs, 7)
    module = Module(Structure(mechanism))
    assert module.count == count
    known = module.configurations({})
    assert len(known) % 2 == 0
    closure = Closure(mechanism)
    assert np.abs(closure.residuals(known)).max() < 1e-11
    starts = np.random.default_rng(1).uniform(-np.pi, np.pi, size=(800, closure.n))
    points, gaps = closure.project(starts)
    assert are_among(points[gaps < 1e-10], known)


@pytest.mark.parametrize("seed", range(1, 7))
def test_a_platform_on_six_legs_has_all_its_assemblies(seed):
    mechanism = random_platform(seed)
    module = Module(Structure(mechanism))
    assert module.count == 40
    known = module.configurations({})
    assert len(known) % 2 == 0
    closure = Closure(mechanism)
    starts = np.random.default_rng(1).normal(size=(400, closure.n))
    points, gaps = closure.project(starts)
    away = np.abs(points[gaps < 1e-10][:, None] - known[None]).max(axis=2)
    assert np.all(away.min(axis=1, initial=np.inf) < 1e-6)


@pytest.mark.parametrize("letters", OF_LOOPS)
def test_a_spatial_loop_has_so_many_configurations_at_a_value(letters):
    mechanism = loop(letters, np.random.default_rng(3))
    module = Module(Structure(mechanism), (0,))
    assert module.count == OF_LOOPS[letters]
    closure = Closure(mechanism)
    known = module.configurations({0: 0.0})
    # the reference configuration among them
    assert np.abs(known).max(axis=1).min() < 1e-9
    assert np.abs(closure.residuals(known)).max() < 1e-11


def test_slices_of_a_spatial_loop_are_complete():
    mechanism = loop("RUSR", np.random.default_rng(3))
    closure = Closure(mechanism)
    rng = np.random.default_rng(0)
    slices = for_subject(closure, closure.structure, rng, 0)
    assert slices is not None
    assert slices.misses_none
    assert slices.counts == (4, 4, 4, 4)
    assert np.abs(closure.residuals(slices.starts)).max() < 1e-10


def test_what_moves_is_no_module():
    with pytest.raises(UnfollowedError, match="moves"):
        Module(Structure(loop("RUSR", np.random.default_rng(3))))
