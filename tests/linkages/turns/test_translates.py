"""Forms that whole turns lead to are counted, also those that limits cut off."""

import itertools

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from bifurc.system import relative_gaps
from linkages.closure.closure import Closure
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.turns.translates import translates_of
from linkages.turns.turn_lattice import Count, TurnLattice
from tests.maps import map_of

Z = (0, 0, 1)
# of four bars none of which turns fully: the first swings over less than a turn
PLACES = ((0, 0, 0), (1, 1.2, 0), (2.2, 1.5, 0), (2, 0, 0))
BODIES = ("frame", "crank", "rod", "rocker", "frame")
SETTINGS = SearchSettings(starts=40, certify=False)
ROUND = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
REACH = np.pi / 200  # from any place of a unit circle to such points


def revolutes(limits):
    joints = [
        Joint(f"J{k}", "revolute", (BODIES[k], BODIES[k + 1]), PLACES[k], Z)
        for k in range(1, 4)
    ]
    first = Joint("H", "revolute", BODIES[:2], PLACES[0], Z, limits=(limits,))
    return Mechanism((first, *joints))


def screw_and_slide(limits):
    """The same with a screw for the first joint, and a slide that takes up how far it
    advances."""
    screw = ("frame", "nut")
    first = Joint("H", "helical", screw, PLACES[0], Z, pitch=0.5, limits=(limits,))
    slide = Joint("P", "prismatic", ("nut", "crank"), direction=Z)
    return Mechanism((first, slide, *revolutes(limits).joints[1:]))


def screws(limits):
    joints = []
    for k, own in enumerate(limits):
        pair = (BODIES[k], BODIES[k + 1])
        place = PLACES[k]
        joint = Joint(f"H{k}", "helical", pair, place, Z, pitch=0.5, limits=(own,))
        joints.append(joint)
    return Mechanism(tuple(joints))


def mapped(mechanism):
    atlas = map_of(mechanism, settings=SETTINGS)
    return atlas, translates_of(atlas)


# the first joint swings from -2.628 to 0.876
@pytest.mark.parametrize("make", [revolutes, screw_and_slide])
@pytest.mark.parametrize(
    ("limits", "forms", "are_all"),
    [
        ((-2.7, 7.2), 2, True),
        ((-3.0, 6.85), 2, False),
        ((-3.0, 3.9), 2, False),
        ((-10.0, 11.0), 4, False),
    ],
)
def test_a_form_that_limits_cut_off_a_turn_away_is_counted(
    make, limits, forms, are_all
):
    atlas, translates = mapped(make(limits))
    assert translates.forms == forms
    assert translates.are_all is are_all
    statement = atlas.completeness.statement
    assert (f"stands for at least {forms} forms" in statement) is not are_all
    assert ("whole or cut off by them" in statement) is not are_all


@pytest.mark.parametrize("make", [revolutes, screw_and_slide])
def test_nothing_is_said_where_a_form_ends_before_the_next_turn(make):
    _, translates = mapped(make((-3.0, 3.6)))
    assert translates is None


def test_of_parallel_screws_all_are_counted_that_are_partly_within_the_limits():
    limits = [(-5.0, 8.0), (-7.0, 6.5), (-6.0, 9.0), (-8.0, 5.0)]
    mechanism = screws(limits)
    atlas, translates = mapped(mechanism)
    (form,) = atlas.forms
    assert form.branch.closed
    points = form.branch.sample(2000)
    turns = [k for k in itertools.product(range(-4, 5), repeat=4) if sum(k) == 0]
    shifts = 2 * np.pi * np.array(turns)
    assert relative_gaps(Closure(mechanism), points[0] + shifts).max() < 1e-11
    low, high = np.array(limits).T
    inside = [np.all((points + one > low) & (points + one < high), 1) for one in shifts]
    whole = sum(bool(np.all(one)) for one in inside)
    partly = sum(bool(np.any(one)) for one in inside)
    assert whole < partly <= translates.forms
    assert not translates.are_all


def loop_of_screws(pitches, seed):
    """A loop of four parallel axes at random places, with such pitches."""
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2 * np.pi, 4))
    radii = rng.uniform(0.5, 1.5, 4)
    names = ("a", "b", "c", "d", "a")
    joints = []
    for k, pitch in enumerate(pitches):
        x, y = radii[k] * np.array([np.cos(angles[k]), np.sin(angles[k])])
        pair, kind = names[k : k + 2], "helical" if pitch else "revolute"
        own = {"pitch": pitch} if pitch else {}
        joints.append(Joint(f"J{k}", kind, pair, (x, y, 0), Z, **own))
    return Mechanism(tuple(joints))


def assemblies_of_opposite_screws(seed):
    """How many there are with equal and opposite pitches next to each other: both turn
    by one angle, and the last link, of fixed length, closes the loop."""
    joints = loop_of_screws((0.3, -0.3, 0, 0), seed).joints
    places = np.array([complex(*joint.point[:2]) for joint in joints])
    one, two, three, last = np.roll(places, -1) - places
    open_loop = np.array([last, one, two])  # of the turn z: last + one z + two z^2
    polynomial = np.convolve(open_loop, np.conj(open_loop[::-1]))
    polynomial[2] -= abs(three) ** 2
    roots = np.roots(polynomial[::-1])
    return np.count_nonzero(np.abs(np.abs(roots) - 1) < 1e-6)


# equal advances cancel: the body between the revolute joints moves along a circle, and
# a circle meets another one twice; of screws across, one turn is as much a rational
# function of the other of degree one; or three turns that add up to none leave a triangle
@pytest.mark.parametrize(
    "pitches", [(0.3, 0.3, 0, 0), (0.3, 0, 0.3, 0), (0.3, 0.3, 0.3, 0)]
)
@pytest.mark.parametrize("seed", [0, 1, 5])
def test_assemblies_beside_near_motions_are_listed_once(pitches, seed):
    atlas = map_of(loop_of_screws(pitches, seed))
    assert len(atlas.rigid) == 2


@pytest.mark.parametrize("seed", [0, 1, 5])
def test_assemblies_of_opposite_screws_are_those_of_a_polynomial(seed):
    atlas = map_of(loop_of_screws((0.3, -0.3, 0, 0), seed))
    assert len(atlas.rigid) == assemblies_of_opposite_screws(seed)


def lattice(shifts, high):
    """The lattice of these shifts in a plane, with limits from -1.5 to ``high``."""
    basis = np.array(shifts, dtype=float)
    pivots = tuple(int(np.flatnonzero(row)[0]) for row in basis)
    return TurnLattice(basis, pivots, np.array([[-1.5, high]] * 2))


def circle(begin=0.0):
    return np.stack([np.cos(ROUND + begin), np.sin(ROUND + begin)], axis=1)


def test_a_circle_beside_a_corner_of_the_limits_is_not_within_them():
    # the square about the circle at (6, 6) reaches the corner, the circle does not
    assert lattice([(6, 6)], 5.2).count_of_closed(circle(), REACH) == Count(1, True)


@pytest.mark.parametrize(("begin", "number"), [(0.0, 2), (REACH, 1)])
def test_what_lies_between_the_points_of_a_curve_is_in_doubt(begin, number):
    # half a point's distance on either side of 225 degrees the circle is within
    count = lattice([(6, 6)], 5.295).count_of_closed(circle(begin), REACH)
    assert count == Count(number, False)


def test_each_part_that_is_left_of_a_curve_is_counted():
    # a saddle's rim goes down on two sides: there it is still within three higher up
    rim = np.stack([np.cos(ROUND), np.sin(ROUND), np.cos(2.0 * ROUND)], axis=1)
    limits = np.array([[-2.0, 2.0], [-2.0, 2.0], [-1.5, 2.5]])
    up = TurnLattice(np.array([[0.0, 0.0, 3.0]]), (2,), limits)
    assert up.count_of_closed(rim, 2.0 * REACH) == Count(1 + 2, False)


@pytest.mark.parametrize(("high", "are_all"), [(4.9, True), (5.5, False)])
def test_a_curve_across_the_limits_may_be_cut_off_beside_it(high, are_all):
    limits = np.array([[0.0, 10.0], [-2.0, high]])
    along = np.linspace(0.0, 10.0, 201)
    wave = np.stack([along, np.sin(along)], axis=1)
    up = TurnLattice(np.array([[0.0, 6.0]]), (1,), limits)
    assert up.fewest_translates(wave, 0.05) == Count(1, are_all)


def test_a_curve_that_whole_turns_bring_onto_itself_is_counted_once():
    # two joints that turn fully and opposite: each turn of both leads along the curve
    limits = np.array([[-10.0, 11.0], [-30.0, 30.0]])
    along = np.linspace(-10.0, 11.0, 201)
    line = np.stack([along, 0.3 * np.sin(along) - along], axis=1)
    turns = 2 * np.pi * np.array([[1.0, -1.0], [0.0, 1.0]])
    both = TurnLattice(turns[:1], (0,), limits)
    each = TurnLattice(turns, (0, 1), limits)
    assert both.fewest_translates(line, 0.1).number == 1
    # those the second joint of which stays within its limits all along, a turn apart:
    # no more than 13 lines of slope -1 cross the limits so
    assert 7 <= each.fewest_translates(line, 0.1).number <= 13


@pytest.mark.parametrize("turns", range(-2, 3))
def test_a_curve_of_joints_that_turn_fully_is_moved_to_the_middle(turns):
    limits = np.array([[-10.0, 11.0], [-30.0, 30.0]])
    each = TurnLattice(2 * np.pi * np.eye(2), (0, 1), limits)
    along = np.linspace(-10.0, 11.0, 201)
    line = np.stack([along, 2 * np.pi * turns + 0.3 - along], axis=1)
    # the second joint turns back, the first one still crosses its limits
    assert each.home(line) == pytest.approx([0.0, -2 * np.pi * turns])
