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
from linkages.modules.assemblies import Module, for_subject
from linkages.structure.structure import Structure
from tests.linkages.modules.common_types import (
    CHAINS,
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


LETTERS = [letters for counts in CHAINS.values() for letters in counts]


@pytest.mark.parametrize(
    "name", [*(name for name in TYPES if name not in LETTERS), *one_in(6, LETTERS)]
)
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
    assert module.generic.count == 2
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
    assert module.generic.count == 40
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


# --- frameworks in space --------------------------------------------------------------

# Lengths between seven points for which all complex assemblies are real: numbers of
# Legersky's SpatialGraphEmbeddings (Bartzos, Emiris, Legersky and Tsigaridas 2018)
SEVEN_POINTS = {
    16: {
        (4, 7): 7.19,
        (1, 3): 5.75,
        (5, 6): 7.9,
        (1, 6): 8.48,
        (3, 7): 5.91,
        (2, 5): 7.15,
        (3, 5): 5.09,
        (1, 2): 4.36,
        (4, 6): 8.78,
        (5, 7): 10.22,
        (3, 6): 7.06,
        (1, 7): 3.77,
        (2, 3): 3.81,
        (3, 4): 3.23,
        (2, 4): 6.05,
    },
    24: {
        (1, 2): 11.05,
        (4, 7): 5.65,
        (2, 6): 5.7,
        (5, 6): 4.7,
        (1, 4): 8.33,
        (1, 3): 4.77,
        (2, 3): 10.31,
        (3, 7): 7.1,
        (2, 5): 9.32,
        (2, 7): 6.0,
        (4, 6): 6.49,
        (5, 7): 5.77,
        (1, 5): 9.4,
        (3, 6): 8.57,
        (3, 4): 7.64,
    },
    32: {
        (4, 7): 8.74,
        (1, 3): 6.27,
        (5, 6): 9.23,
        (1, 4): 8.06,
        (2, 3): 8.83,
        (3, 7): 5.62,
        (2, 5): 9.74,
        (3, 5): 5.6,
        (1, 2): 10.95,
        (6, 7): 9.28,
        (5, 7): 7.88,
        (3, 6): 8.26,
        (1, 6): 11.56,
        (3, 4): 6.11,
        (2, 4): 8.95,
    },
    48: {
        (2, 7): 10.5361,
        (4, 7): 11.8471,
        (2, 6): 1.002,
        (5, 6): 4.4449,
        (1, 4): 5.7963,
        (1, 3): 1.9342,
        (1, 6): 2.0001,
        (3, 7): 10.5245,
        (1, 2): 1.9999,
        (6, 7): 10.5365,
        (5, 7): 11.2396,
        (1, 5): 4.4024,
        (4, 5): 7.0744,
        (2, 3): 0.55,
        (3, 4): 5.4247,
    },
}


def framework_in_space(points, bars):
    """Bars between points (k, 3), by numbers from 1."""
    names = {number: [] for number in range(1, len(points) + 1)}
    for start, end in bars:
        names[start].append(f"{start}-{end}")
        names[end].append(f"{start}-{end}")
    return Mechanism(
        tuple(
            Joint(
                f"P{number}",
                JointKind.SPHERICAL,
                tuple(own),
                vector(points[number - 1]),
            )
            for number, own in names.items()
        )
    )


def points_with(lengths):
    """Seven points (7, 3) with given distances, by Newton's method from random ones."""
    rng = np.random.default_rng(0)
    starts, ends = np.array(list(lengths)).T - 1
    wanted = np.array(list(lengths.values()))

    def misfit(numbers):
        points = numbers.reshape(-1, 3)
        gaps = points[starts] - points[ends]
        return np.sum(gaps**2, axis=1) - wanted**2

    solutions = (
        least_squares(
            misfit,
            wanted.mean() * rng.normal(size=21),
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        )
        for _ in range(100)
    )
    return next(one.x.reshape(-1, 3) for one in solutions if one.cost < 1e-18)


@pytest.mark.parametrize("count", one_in(4, SEVEN_POINTS))
def test_seven_points_in_space_have_as_many_real_assemblies_as_complex_ones(count):
    lengths = SEVEN_POINTS[count]
    module = Module(Structure(framework_in_space(points_with(lengths), lengths)))
    assert module.generic.count == count
    assert len(module.configurations()) == count


# --- what random starts reach ---------------------------------------------------------


def random_bars(rng, points):
    """A random minimally rigid graph in space by Henneberg's first two steps."""
    bars = {(1, 2), (1, 3), (2, 3)}
    for new in range(4, points + 1):
        ends = (1 + rng.choice(new - 1, 3, replace=False)).tolist()
        split = sorted(bars)[rng.integers(len(bars))]
        others = [point for point in range(1, new) if point not in split]
        if len(others) > 1 and rng.random() < 0.7:
            bars.discard(split)
            ends = [*split, *rng.choice(others, 2, replace=False).tolist()]
        bars |= {(end, new) for end in ends}
    return sorted(bars)


# loops that stand, and frameworks of so many points
KINDS = ("CCC", "RCS", 5, "PCS", "RRCC", 6, "CUC", 7)


@pytest.mark.parametrize("seed", one_in(10, range(60)))
def test_random_starts_reach_no_other_assembly(seed):
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    if isinstance(kind, int):
        points = rng.normal(size=(kind, 3))
        mechanism = framework_in_space(points, random_bars(rng, kind))
    else:
        mechanism = loop(kind, rng)
    closure = Closure(mechanism)
    structure = closure.structure
    found = for_subject(closure, structure, rng, 0)
    assert found is not None
    assert found.misses_none
    starts = rng.uniform(-np.pi, np.pi, size=(500, closure.n))
    points, gaps = closure.project(starts)
    points = points[(gaps < 1e-10) & closure.domain.are_inside(points)]
    away = points[:, None] - found.starts[None]
    is_angle = [unknown.is_angle for unknown in structure.unknowns]
    away = np.where(is_angle, np.abs(np.exp(1j * away) - 1.0), np.abs(away))
    assert np.all(away.max(axis=2).min(axis=1, initial=np.inf) < 1e-5)
