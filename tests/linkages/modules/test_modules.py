"""Modules: how many complex configurations they have, and the real ones among them."""

import numpy as np
import pytest

from linkages.closure.closure import Closure
from linkages.dyads.group import UnfollowedError
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.modules import solve
from linkages.modules.slices import for_subject
from linkages.modules.solve import Module
from linkages.structure.structure import Structure

K33 = [(i, j) for i in (0, 2, 4) for j in (1, 3, 5)]
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


@pytest.fixture(autouse=True)
def own_folder(tmp_path_factory, monkeypatch):
    """Generic solutions are kept with the tests."""
    folder = tmp_path_factory.getbasetemp() / "generic"
    monkeypatch.setenv(solve.CACHE, str(folder))
    return folder


def vector(numbers):
    x, y, z = map(float, numbers)
    return x, y, z


def on_sphere(directions, arcs):
    """Points (k, 3) on a sphere, and arcs between them."""
    bodies = {point: [] for arc in arcs for point in arc}
    for start, end in arcs:
        bodies[start].append(f"{start}-{end}")
        bodies[end].append(f"{start}-{end}")
    return Mechanism(
        tuple(
            Joint(
                f"P{point}",
                JointKind.REVOLUTE,
                tuple(own),
                (0.0, 0.0, 0.0),
                vector(directions[point]),
            )
            for point, own in sorted(bodies.items())
        )
    )


def platform(rng):
    joints = []
    for number in range(6):
        foot, head = rng.normal(size=(2, 3))
        leg = f"leg{number}"
        joints += [
            Joint(f"A{number}", JointKind.SPHERICAL, ("frame", leg), vector(foot)),
            Joint(f"B{number}", JointKind.SPHERICAL, (leg, "plate"), vector(head)),
        ]
    return Mechanism(tuple(joints))


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


def test_a_framework_on_a_sphere_has_all_its_assemblies():
    """K(3,3) has 16, with reflections."""
    mechanism = on_sphere(np.random.default_rng(5).normal(size=(6, 3)), K33)
    module = Module(Structure(mechanism))
    assert module.count == 16
    known = module.configurations({})
    assert len(known) % 2 == 0
    closure = Closure(mechanism)
    assert np.abs(closure.residuals(known)).max() < 1e-11
    starts = np.random.default_rng(1).uniform(-np.pi, np.pi, size=(800, closure.n))
    points, gaps = closure.project(starts)
    assert are_among(points[gaps < 1e-10], known)


def test_a_platform_on_six_legs_has_40_complex_assemblies():
    """Ronga and Vust 1995."""
    followed = []
    for seed in range(6):
        mechanism = platform(np.random.default_rng(seed))
        module = Module(Structure(mechanism))
        assert module.count == 40
        try:
            known = module.configurations({})
        except UnfollowedError:  # a path was lost, and that is said
            continue
        followed.append(seed)
        assert len(known) % 2 == 0
        closure = Closure(mechanism)
        starts = np.random.default_rng(1).normal(size=(800, closure.n))
        points, gaps = closure.project(starts)
        away = np.abs(points[gaps < 1e-10][:, None] - known[None]).max(axis=2)
        assert np.all(away.min(axis=1, initial=np.inf) < 1e-6)
    assert len(followed) >= 3


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


def test_generic_solutions_are_kept_and_read_again(own_folder, monkeypatch):
    structure = Structure(loop("RSSR", np.random.default_rng(3)))
    first = Module(structure, (0,)).generic
    monkeypatch.setattr(solve, "_known", {})
    monkeypatch.setattr(solve, "_found", None)  # would raise TypeError
    again = Module(structure, (0,)).generic
    assert np.array_equal(first.fibre.solutions, again.fibre.solutions)
    # what is no solution is not taken
    for file in own_folder.glob("*.npz"):
        kept = dict(np.load(file))
        np.savez(file, **(kept | {"solutions": kept["solutions"] + 0.5}))
    monkeypatch.setattr(solve, "_known", {})
    with pytest.raises(TypeError):
        _ = Module(structure, (0,)).generic
