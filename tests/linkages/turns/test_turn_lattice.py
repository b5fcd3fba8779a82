"""Whole turns whose advances cancel lead to configurations that are one but for them."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from bifurc.system import relative_gaps
from linkages.app.answer.verdict import judge
from linkages.closure.closure import Closure
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.mechanism_document import describe_mechanism
from linkages.subject import subject_at
from linkages.turns.translates import translates_of
from tests.maps import map_of
from tests.samples import one_in

X, Z = (1, 0, 0), (0, 0, 1)
TURN = 2 * np.pi


def screws(points, pitches):
    """A loop of helical joints along z."""
    bodies = [f"b{k}" for k in range(len(points))]
    joints = []
    for k, (point, pitch) in enumerate(zip(points, pitches, strict=True)):
        pair = (bodies[k], bodies[(k + 1) % len(points)])
        joints.append(Joint(f"H{k}", "helical", pair, point, Z, pitch=pitch))
    return Mechanism(tuple(joints))


TRIANGLE = ((0, 0, 0), (1, 0, 0), (0, 2, 0))
FOUR_BAR = ((0, 0, 0), (1, 0, 0), (1.5, 2, 0), (0, 2.5, 0))
TURNS_EACH_WAY = 14  # of a joint of the four-bar, within its limits


def whole_turns(problem):
    """The basis of the lattice in turns."""
    return problem.lattice.basis / TURN


@pytest.mark.parametrize(
    ("pitches", "rank"),
    [
        ((1.0, 1.0, 1.0), 2),
        ((1.0, 0.7, 0.3), 2),
        ((1.0, np.sqrt(2.0), np.sqrt(2.0)), 1),
        ((1.0, np.sqrt(2.0), np.sqrt(3.0)), 0),
    ],
)
def test_whole_turns_cancel_where_pitches_are_in_proportion(pitches, rank):
    problem = Closure(screws(TRIANGLE, pitches))
    assert len(problem.lattice) == rank
    assert np.allclose(whole_turns(problem) @ pitches, 0.0, atol=1e-12)
    assert np.array_equal(whole_turns(problem), np.round(whole_turns(problem)))


def test_shifts_lead_from_closed_configurations_to_closed_ones():
    problem = Closure(screws(FOUR_BAR, (1.0, -2.0, 0.5, 1.5)))
    rng = np.random.default_rng(0)
    seeds = problem.seeds(rng, 40)
    turns = rng.integers(-3, 4, (len(seeds.points), len(problem.lattice)))
    shifted = seeds.points + turns @ problem.lattice.basis
    assert relative_gaps(problem, shifted).max() < 1e-12


def test_a_slide_takes_up_what_a_screw_advances():
    bodies = ["frame", "crank", "rod", "rocker", "screw"]
    places = [(0, 0, 0), (0.5, 1.0, 0), (2, 1.4, 0), (2.2, 0, 0)]
    joints = [
        Joint(f"R{k}", "revolute", (bodies[k], bodies[k + 1]), places[k], Z)
        for k in range(3)
    ]
    pair = ("rocker", "screw")
    joints.append(Joint("H", "helical", pair, places[3], Z, pitch=0.4))
    joints.append(Joint("P", "prismatic", ("screw", "frame"), direction=Z))
    problem = Closure(Mechanism(tuple(joints)))
    (shift,) = problem.lattice.basis
    unit = problem.structure.unit
    assert shift[problem.domain.names.index("H")] == pytest.approx(TURN)
    assert abs(shift[problem.domain.names.index("P")]) == pytest.approx(0.4 / unit)


def test_what_turns_between_two_screws_lets_no_advance_pass():
    joints = (
        Joint("H1", "helical", ("a", "b"), (0, 0, 0), Z, pitch=1.0),
        Joint("R1", "revolute", ("b", "c"), (1, 0, 0), X),
        Joint("H2", "helical", ("c", "d"), (1, 1, 0), Z, pitch=1.0),
        Joint("R2", "revolute", ("d", "a"), (0, 1, 0.3), X),
    )
    assert len(Closure(Mechanism(joints)).lattice) == 0


def test_a_turn_with_a_rack_on_it_is_not_free():
    joints = (
        Joint("A", "revolute", ("f", "c"), (0, 0, 0), Z),
        Joint("B", "revolute", ("c", "r"), (0.6, 0.8, 0), Z),
        Joint("C", "revolute", ("r", "s"), (3, 0, 0), Z),
        Joint("D", "prismatic", ("f", "s"), direction=X, coupled=(Coupling("A", 0.1),)),
    )
    assert len(Closure(Mechanism(joints)).lattice) == 0


@pytest.mark.parametrize("seed", one_in(3, range(3)))
def test_parallel_screws_have_a_form_for_each_assembly_mode(seed):
    settings = SearchSettings(starts=60, certify=False)
    mechanism = screws(FOUR_BAR, (1.0, 1.0, 1.0, 1.0))
    atlas = map_of(mechanism, settings=settings, seed=seed)
    assert len(atlas.forms) == 2
    translates = translates_of(atlas)
    # two joints of four turn to and fro, each at one of these places
    assert 2 * TURNS_EACH_WAY**2 * 4 <= translates.forms < 2 * (2 * 14 + 1) ** 2
    assert "2 forms (up to whole turns)" in judge(atlas).sentence


@pytest.mark.parametrize("seed", range(3))
def test_assemblies_of_screws_are_those_of_the_triangle(seed):
    settings = SearchSettings(starts=120, certify=False)
    mechanism = screws(TRIANGLE, (1.0, 1.0, 1.0))
    atlas = map_of(mechanism, settings=settings, seed=seed)
    assert len(atlas.rigid) == 2
    problem = Closure(mechanism)
    most = int(problem.domain.bounds[0, 1] / TURN)
    turns = np.arange(-most - 1, most + 1)
    grid = np.stack(np.meshgrid(turns, turns, turns), axis=-1).reshape(-1, 3)
    shifts = TURN * grid[grid.sum(axis=1) == 0]
    places = (atlas.rigid[:, None] + shifts).reshape(-1, 3)
    # every translate is closed, and so many of them are within the limits
    assert relative_gaps(problem, places).max() < 1e-11
    inside = np.count_nonzero(problem.domain.excess(places) <= 0.0)
    assert translates_of(atlas).assemblies == inside > 600
    assert f"with them {inside}" in judge(atlas).sentence


def test_assemblies_of_random_starts_are_said_to_be_the_fewest():
    settings = SearchSettings(starts=40, certify=False)
    mechanism = screws(TRIANGLE, (1.0, 1.0, 1.0))
    atlas = map_of(mechanism, settings=settings)
    assert "closes in at least" in judge(atlas).sentence


def with_limits(mechanism, limits):
    """The mechanism with limits of its joints, in turns."""
    pairs = [(TURN * low, TURN * high) for low, high in limits]
    joints = [
        replace(joint, limits=(pair,))
        for joint, pair in zip(mechanism.joints, pairs, strict=True)
    ]
    return replace(mechanism, joints=tuple(joints))


def test_what_closes_only_whole_turns_beside_its_reference_is_found():
    mechanism = screws(TRIANGLE, (1.0, 0.5, np.sqrt(2.0)))
    limits = [(-3.0, 3.0), (0.8, 6.1), (-6.1, 6.1)]
    settings = SearchSettings(starts=4, certify=False)
    atlas = map_of(with_limits(mechanism, limits), settings=settings)
    assert len(atlas.rigid) >= 1
    problem = Closure(with_limits(mechanism, limits))
    assert np.all(problem.domain.are_inside(atlas.rigid))
    assert relative_gaps(problem, atlas.rigid).max() < 1e-12


@pytest.mark.parametrize("low", [20.0, 20.7])
def test_starts_are_drawn_where_advances_cancel_within_the_limits(low):
    mechanism = screws(FOUR_BAR, (1.0, 1.0, np.sqrt(2.0), np.sqrt(2.0)))
    limits = [(low, low + 0.25)] + [(-30.0, 30.0)] * 3
    settings = SearchSettings(starts=200, certify=False)
    atlas = map_of(with_limits(mechanism, limits), settings=settings)
    (assembly,) = atlas.rigid
    assert TURN * low - 1e-9 <= assembly[0] <= TURN * (low + 0.25) + 1e-9


def four_bar(places, limits):
    """Four revolute joints along z through these places, with the limits (rad) of
    some by number."""
    bodies = ["frame", "crank", "rod", "rocker", "frame"]
    joints = []
    for k, place in enumerate(places):
        own = (limits[k],) if k in limits else ()
        pair = (bodies[k], bodies[k + 1])
        joints.append(Joint(f"J{k + 1}", "revolute", pair, place, Z, limits=own))
    return Mechanism(tuple(joints))


def test_forms_that_bifurcations_join_are_counted_once():
    kite = ((0, 0, 0), (0.6, 0.8, 0), (0.6, 1.8, 0), (3, 0, 0))
    wide = np.deg2rad(800.0)
    settings = SearchSettings(starts=60, certify=False)
    atlas = map_of(four_bar(kite, {1: (-wide, wide)}), settings=settings)
    assert len(atlas.forms) == 6
    # two go on to the limits, a turn apart, and four with the rod on the frame close
    assert translates_of(atlas).forms == 6
    statement = atlas.completeness.statement
    assert "of 6 forms listed here 2 differ otherwise" in statement
    assert "stands for at least 6 forms within the limits" in statement
    assert "6 forms (2 up to whole turns)" in judge(atlas).sentence
    document = describe_mechanism(atlas, subject_at(atlas).readout)
    assert document["translates"] == {
        "joints": ["J2"],
        "forms": 6,
        "assemblies": 0,
        "distinct_forms": 2,
        "are_all": False,
    }


def test_shaky_assemblies_are_counted_with_their_turns():
    places = ((0, 0, 0), (1, 0, 0), (3, 0, 0))
    bodies = ["f", "a", "b", "f"]
    wide = np.deg2rad(400.0)
    joints = [
        Joint(f"J{k}", "revolute", (bodies[k], bodies[k + 1]), place, Z)
        for k, place in enumerate(places)
    ]
    joints[0] = replace(joints[0], limits=((-wide, wide),))
    settings = SearchSettings(starts=40, certify=False)
    atlas = map_of(Mechanism(tuple(joints)), settings=settings)
    assert translates_of(atlas).assemblies == 3
    assert "with them 3" in judge(atlas).sentence


@pytest.mark.parametrize("limit", [30.0, 170.0])
def test_nothing_is_said_of_turns_where_no_other_fits(limit):
    crank_rocker = ((0, 0, 0), (0.5, 1.0, 0), (2, 1.4, 0), (2.2, 0, 0))
    narrow = np.deg2rad(limit)
    mechanism = four_bar(crank_rocker, {3: (-narrow, narrow)})
    settings = SearchSettings(starts=60, certify=False)
    atlas = map_of(mechanism, settings=settings)
    assert len(Closure(mechanism).lattice) == 1
    assert atlas.forms
    assert translates_of(atlas) is None
    assert "whole turns" not in atlas.completeness.statement + judge(atlas).sentence
    assert describe_mechanism(atlas, subject_at(atlas).readout)["translates"] is None
