"""Slices built of dyads hold every configuration, and what is said of them is true."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import linkages
from bifurc.completeness import Level
from bifurc.settings import SearchSettings
from bifurc.system import relative_gaps
from linkages.closure.closure import Closure
from linkages.dyads import slices as slices_module
from linkages.dyads.geometry import Pivot, PlaneGeometry
from linkages.dyads.slices import SLICES, built_at_once, for_subject
from linkages.files.arcs import read_arcs
from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.statements import LinkageClaim
from linkages.structure.structure import Structure
from tests.linkages.mechanisms.known_mechanisms import (
    cases,
    geared_five_bar,
    mechanism_of_case,
)
from tests.linkages.mechanisms.test_maps import slider_crank
from tests.linkages.turns.test_translates import revolutes
from tests.maps import map_of
from tests.samples import one_in


def six_bar_on_sphere():
    """A four-bar on a sphere, and a dyad between points beside two of its arcs."""
    return {
        "fixed": ["A", "D"],
        "arcs": [["A", "B"], ["B", "C"], ["C", "D"], ["E", "F"], ["F", "G"]],
        "points": {
            "A": [0, 0, 1],
            "B": [0.1, 0.4, 1],
            "C": [0.9, 0.8, 1],
            "D": [0.8, 0, 1],
            "F": [1.6, 1.4, 1],
        },
        "points_on_arcs": {"E": ["B", "C", [20, 35]], "G": ["C", "D", [15, -20]]},
    }


FEW = SearchSettings(starts=40, certify=False)
Z = (0, 0, 1)
BUILT = {
    "slider-crank": slider_crank(1.3, 0.2),
    "planar RPRP": mechanism_of_case(cases()["planar RPRP"]),
    "K(2,3)": mechanism_of_case(cases()["K(2,3)"]),
    "cranks": mechanism_of_case(
        cases()["three equal parallel cranks, pivots on a line"]
    ),
    "Dixon I": mechanism_of_case(cases()["Dixon I, K(3,3)"]),
    "on a sphere": read_arcs(six_bar_on_sphere(), "six-bar", np.pi / 180),
    # a group of the third class: a ternary link on three bars
    "double Watt": mechanism_of_case(
        cases()["double Watt mechanism with slanted couplers (cusp 3/2)"]
    ),
    "a network with two locks": linkages.load("four-bennett-network").held(
        {"1": 0.7, "5": 0.5}
    ),
}
NOT_BUILT = {
    "two freedoms": mechanism_of_case(cases()["parallelogram lattice 2 x 2"]),
    "slides in space": mechanism_of_case(cases()["Bennett geometry with joints CRCR"]),
    # creases of a Miura sheet come in line, and then fold together
    "Miura": mechanism_of_case(cases()["Miura-ori, 3 x 3 vertices"]),
}


def sliced(mechanism):
    return sliced_structure(Structure(mechanism))


def sliced_structure(structure):
    problem = Closure(structure.mechanism)
    given = problem, structure, np.random.default_rng(0), 0
    built = built_at_once(*given)
    return for_subject(*given) if built is None or built.singular else built


@pytest.mark.parametrize("name", BUILT)
def test_all_that_is_built_closes(name):
    slices = sliced(BUILT[name])
    problem = Closure(BUILT[name])
    assert len(slices.starts) > SLICES
    assert relative_gaps(problem, slices.starts).max() < 1e-12


@pytest.mark.parametrize("name", ["slider-crank", "K(2,3)", "cranks", "on a sphere"])
def test_a_slice_holds_what_random_starts_find_with_the_driver_locked(name):
    mechanism = BUILT[name]
    slices = sliced(mechanism)
    driver = slices.drivers[0]
    label = slices.structure.unknowns[driver].label
    column = slices.starts[:, driver]
    for turn in (0, 7, 15):
        value = float(column[0]) + turn * slices.steps[0]
        locked = mechanism.with_locks({label: value})
        atlas = map_of(locked, settings=FEW)
        assert len(atlas.rigid) == np.count_nonzero(np.abs(column - value) < 1e-9)


@pytest.mark.parametrize("name", BUILT)
def test_a_mechanism_of_dyads_is_certified(name):
    atlas = map_of(BUILT[name], settings=FEW)
    assert atlas.completeness.level is Level.CERTIFIED
    assert "turns by more than 10 degrees" in atlas.completeness.statement


@pytest.mark.parametrize("name", NOT_BUILT)
def test_nothing_is_said_where_dyads_do_not_build_it(name):
    assert sliced(NOT_BUILT[name]) is None


def eight_bar(seed):
    """Eight links and ten pins at random places; no part of it is rigid."""
    rng = np.random.default_rng(seed)
    pairs = list(combinations(range(8), 2))
    parts = [set(part) for size in range(2, 9) for part in combinations(range(8), size)]
    while True:
        edges = [pairs[k] for k in rng.choice(len(pairs), 10, replace=False)]
        inside = [sum(part.issuperset(edge) for edge in edges) for part in parts]
        freedoms = [
            3 * (len(part) - 1) - 2 * count
            for part, count in zip(parts, inside, strict=True)
        ]
        if min(freedoms) > 0:
            break
    joints = []
    for number, edge in enumerate(edges):
        point = (*rng.normal(size=2), 0.0)
        joints.append(Joint(f"J{number}", "revolute", tuple(map(str, edge)), point, Z))
    return Mechanism(tuple(joints))


# random ones that dyads build from no driver, and the complex configurations at a value
# of each of two
EIGHT_BARS = {
    4: (12, 12),
    8: (12, 16),
    25: (16, 16),
    38: (12, 14),
    57: (12, 16),
    69: (12, 16),
    102: (12, 16),
    125: (12, 12),
    141: (12, 16),
    158: (12, 16),
}


@pytest.mark.parametrize("seed", one_in(10, EIGHT_BARS))
def test_eight_bars_of_larger_groups_have_the_forms_of_many_random_starts(
    seed, monkeypatch
):
    mechanism = eight_bar(seed)
    found = map_linkage(mechanism, settings=FEW)
    assert found.completeness.level is Level.CERTIFIED
    assert sliced(mechanism).counts == EIGHT_BARS[seed]
    monkeypatch.setattr(slices_module, "_slices_of_groups", lambda *_: {})
    settings = SearchSettings(starts=4000, certify=False)
    dense = map_linkage(mechanism, settings=settings)
    assert dense.completeness.level is Level.ESTIMATED
    lengths, known = (
        sorted(form.branch.length for form in atlas.forms) for atlas in (found, dense)
    )
    assert np.allclose(lengths, known, rtol=1e-8)


@pytest.mark.parametrize("has_offset", [True, False])
def test_a_part_on_two_pins_at_one_place_may_move(has_offset):
    """A link on the coupler and the frame, which hold it once their pins are apart."""
    geometry = PlaneGeometry(np.array(Z), 1.0)
    one, other = Pivot(0j, 0j), Pivot(1j, 0.5j * has_offset)
    assert geometry.leaves_loose(one, other) is not has_offset


def test_a_rhombus_that_folds_leaves_motions_on_which_the_driver_stands_still():
    mechanism = mechanism_of_case(cases()["Peaucellier-Lipkin inversor"])
    slices = sliced(mechanism)
    assert not slices.misses_none
    audit = slices([], np.inf)
    assert audit.level is Level.ESTIMATED
    assert LinkageClaim.DYADS_MISSING.is_kind_of(audit.claims[0])


def test_one_start_is_enough_to_find_every_form():
    settings = SearchSettings(starts=1, certify=False)
    atlas = map_of(BUILT["Dixon I"], settings=settings)
    assert len(atlas.forms) == 8


def test_without_a_freedom_all_assemblies_are_built():
    mechanism = BUILT["K(2,3)"]
    label = Structure(mechanism).unknowns[0].label
    slices = sliced(mechanism.with_locks({label: 0.1}))
    assert slices.drivers == ()
    settings = SearchSettings(starts=1)
    locked = mechanism.with_locks({label: 0.1})
    atlas = map_of(locked, settings=settings)
    assert len(atlas.rigid) == len(slices.starts)
    assert "no assembly is missing" in atlas.completeness.statement


def four_bar(coupler, rocker, **changes):
    """A four-bar with a crank of 1 and a frame of 1.2, as a planar mechanism."""
    places = {"A": 0j, "B": 1j, "D": 1.2 + 0j}
    gap = places["D"] - places["B"]
    along = (abs(gap) ** 2 + coupler**2 - rocker**2) / (2 * abs(gap))
    height = np.sqrt(coupler**2 - along**2)
    places["C"] = places["B"] + gap / abs(gap) * complex(along, height)
    bodies = {
        "A": ("frame", "crank"),
        "B": ("crank", "coupler"),
        "C": ("coupler", "rocker"),
        "D": ("rocker", "frame"),
    }
    joints = []
    for name, pair in bodies.items():
        point = (places[name].real, places[name].imag, 0.0)
        more = changes.get(name, {})
        joints.append(Joint(name, "revolute", pair, point, Z, **more))
    return Mechanism(tuple(joints))


def test_limits_hold_in_slices():
    limited = four_bar(1.5, 1.1, A={"limits": ((-0.5, 1.0),)})
    slices = sliced(limited)
    column = [one.label for one in slices.structure.unknowns].index("A")
    angles = slices.starts[:, column]
    assert angles.min() >= -0.5
    assert angles.max() <= 1.0


def test_what_is_geared_to_the_driver_is_known_with_it():
    """A five-bar, its cranks on gears."""
    mechanism = geared_five_bar(-2.0, 0.1)
    slices = sliced(mechanism)
    labels = [slices.structure.unknowns[driver].label for driver in slices.drivers]
    assert labels == ["A"]
    assert relative_gaps(Closure(mechanism), slices.starts).max() < 1e-12


def test_slides_that_are_locked_stay_slides():
    """Four turns that meet in a point, the chain between them shifted there and back."""
    turns = [(0, 0, 1), (0, 0.6, 0.8), (0.6, 0.6, 0.53), (0.8, 0, 0.6)]
    slides = [(1, 0, 0), (0, 1, 0), (1, 1, 0)]
    values = (0.5, 0.5, -np.sqrt(0.5))
    bodies = ["ground", "a", "b", "c", "d", "e", "f", "ground"]
    joints = []
    for k, value in enumerate(values):
        pair = (bodies[k], bodies[k + 1])
        along = slides[k]
        joints.append(
            Joint(f"P{k}", "prismatic", pair, direction=along, locked=(value,))
        )
    for k, axis in enumerate(turns):
        pair = (bodies[k + 3], bodies[k + 4])
        joints.append(Joint(f"R{k}", "revolute", pair, (0, 0, 0), axis))
    mechanism = Mechanism(tuple(joints))
    structure = Structure(mechanism)
    slices = sliced_structure(structure)
    assert slices is not None
    closure = Closure(mechanism)
    assert len(slices.starts)
    assert relative_gaps(closure, slices.starts).max() < 1e-11


def test_a_body_that_turns_freely_is_not_certified_away():
    """Two pins of a link in one line: it turns while the driver stands still."""
    joints = (
        Joint("A", "revolute", ("ground", "link"), (0, 0, 0), Z),
        Joint("B", "revolute", ("link", "arm"), (0, 0, 0.1), Z),
        Joint("C", "revolute", ("arm", "ground"), (1, 0, 0), Z),
    )
    atlas = map_of(Mechanism(joints), settings=FEW)
    assert len(atlas.forms) == 1
    assert atlas.completeness.level is Level.ESTIMATED


def test_slices_hold_every_whole_turn_within_the_limits():
    turn, low = 2 * np.pi, -3.0
    counts = []
    for turns in (1, 2, 5):
        structure = Structure(revolutes((low, low + turns * turn)))
        points = sliced_structure(structure).starts
        values = points[:, structure.column_of[0]]
        assert np.all((values >= low) & (values <= low + turns * turn))
        problem = Closure(structure.mechanism)
        assert relative_gaps(problem, points).max() < 1e-9
        counts.append(len(points))
    assert counts == [counts[0], 2 * counts[0], 5 * counts[0]]


@pytest.mark.parametrize(("high", "is_built"), [(3.0, True), (9.0, False)])
def test_what_follows_many_turns_is_not_built_by_dyads(high, is_built):
    joints = geared_five_bar(ratio=0.5).joints
    leader = next(one.coupled[0].to for one in joints if one.coupled[0] is not None)
    limited = [
        replace(joint, limits=((-3.0, high),)) if joint.name == leader else joint
        for joint in joints
    ]
    structure = Structure(Mechanism(tuple(limited)))
    slices = sliced_structure(structure)
    assert (slices is not None) is is_built
