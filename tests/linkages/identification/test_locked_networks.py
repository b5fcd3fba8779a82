"""What networks become under two and three locks: table 5.4.1 of Song (2013), made by
machine, and what is left in single loops."""

from itertools import combinations
from math import pi

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.identification.identify import identify
from linkages.identification.locked_networks import locked_state, locked_states
from linkages.networks.assembly import assemble, motion_at
from linkages.networks.mechanism import lock_network
from linkages.values import GeometryError
from tests.linkages.networks.known_networks import facts, in_radians, kinks_of, network
from tests.maps import map_of

LOOPS = facts()["reduced_loops"]
LINKAGES = {
    "case 1 (1,5)": "waldron-hybrid",
    "case 1b (3,7)": "waldron-hybrid",
    "case 2 (2,5)": "generalized-l-shape-goldberg-variant-6r",
    "case 3 (2,4)": "isomerized-generalized-l-shape-goldberg-6r",
    "case 4 (2,6)": "generalized-double-goldberg",
    "5R (1,2)": "generalized-goldberg-5r",
    "5R (1,3)": "generalized-goldberg-5r",
    "L-shape 2/4": "generalized-l-shape-goldberg-6r",
    "L-shape 2/0": "generalized-l-shape-goldberg-variant-6r",
    "L-shape 4/0": "generalized-l-shape-goldberg-variant-6r",
    "L-shape 3/0": "waldron-hybrid",
    "L-shape 8/4": "generalized-goldberg-5r",
    "L-shape 8/2": "bennett",
    "serial U1/U2": "generalized-serial-goldberg-6r",
    "serial U1/V2": "generalized-serial-goldberg-variant-6r",
    "serial U0/U2": "generalized-goldberg-5r",
    "serial U0/U1": "bennett",
}
FEW = SearchSettings(starts=20, certify=False)


def state_of(kinks):
    """The motion left at kinks, and the names of the outer joints that move."""
    placed = lock_network(network(), kinks).placed
    motion = motion_at(placed.network, placed.locks, placed.reference)
    ring = placed.network.plan.ring
    still = motion.still(ring)
    return motion, {axis for axis in ring if axis not in still}


@pytest.mark.parametrize("pair", facts()["pairs"])
def test_every_pair_of_locks_leaves_mobility_1_and_these_joints(pair):
    kinks = dict(zip(pair.split("/"), np.radians([40, -75]), strict=True))
    motion, moving = state_of(kinks)
    assert motion.mobility == 1
    assert moving == {str(joint) for joint in facts()["pairs"][pair]}


def test_all_triples_of_locks_are_rigid_but_four():
    states = locked_states(network(), 3)
    moving = {"/".join(s.kinks) for s in states if s.mobility}
    assert (
        moving == {"1/2/3", "3/4/5", "5/6/7", "1/7/8"} == set(facts()["moving_triples"])
    )


@pytest.mark.parametrize("count", [2, 3])
def test_the_equations_of_the_mechanism_agree_with_the_closed_form(count):
    """The nullity of the Jacobian of all loops, with nothing of the closed form."""
    found = network()
    free = lock_network(found, {})
    problem = Closure(free)
    jacobian = problem.jacobians(np.zeros((1, problem.n)))[0]
    labels = {axis: free.placed.label(axis) for axis in found.plan.ring}
    columns = [one.label for one in problem.structure.unknowns]
    for axes in combinations(found.plan.ring, count):
        locked = {labels[axis] for axis in axes}
        kept = [k for k, label in enumerate(columns) if label not in locked]
        values = np.linalg.svd(jacobian[:, kept], compute_uv=False)
        nullity = len(kept) - np.count_nonzero(values > 1e-9)
        motion = motion_at(found, axes, free.placed.reference)
        assert motion.mobility == nullity, axes


THREE = {
    "l-shape-bennett-network": (
        {"2/4", "2/0", "4/0", "3/0"},
        {"8/4", "8/0", "1/4", "1/0", "2/5", "2/6", "5/0", "6/0"},
        {"8/1", "5/6"},
    ),
    "serial-bennett-network": (
        {"U1/U2", "V2/V1", "U1/V2", "U2/V1"},
        {"U0/U2", "U0/V2", "U1/U3", "U1/V3", "U2/V0", "U3/V1", "V3/V1", "V2/V0"},
        {"U0/V0", "U3/V3"},
    ),
}


@pytest.mark.parametrize("name", THREE)
def test_two_locks_of_three_loops_leave_a_6r_a_5r_or_a_bennett_loop(name):
    six, five, two_freedoms = THREE[name]
    found = network(name)
    reference = lock_network(found, {}).placed.reference
    joints = {}
    for axes in combinations(found.plan.ring, 2):
        motion = motion_at(found, axes, reference)
        moving = 8 - len(motion.still(found.plan.ring))
        joints["/".join(axes)] = (motion.mobility, moving)
    assert {pair for pair, (m, n) in joints.items() if (m, n) == (1, 6)} == six
    assert {pair for pair, (m, n) in joints.items() if (m, n) == (1, 5)} == five
    assert sum(found == (1, 4) for found in joints.values()) == 14
    assert {pair for pair, (m, _) in joints.items() if m == 2} == two_freedoms


@pytest.mark.parametrize("name", LOOPS)
def test_the_single_loop_left_is_that_of_the_reference(name):
    case = LOOPS[name]
    mechanism = lock_network(network(case["network"]), kinks_of(case))
    loop = mechanism.without_centre().loop
    ring = mechanism.placed.network.plan.ring
    kept = [axis for axis in ring if axis not in mechanism.still]
    loop = loop.relabelled(kept.index(case["keep"][0]))
    for column, key in zip(loop.arrays, ("a", "alpha", "R"), strict=True):
        # composites of 1e-16, offsets over the squared sine of a twist
        assert np.abs(column - case[key]).max() < 1e-13
    assert loop.closure_error(np.array(case["theta"])) < 1e-14


@pytest.mark.parametrize("name", LINKAGES)
def test_the_single_loop_left_is_recognised(name):
    case = LOOPS[name]
    mechanism = lock_network(network(case["network"]), kinks_of(case))
    expected = entry(LINKAGES[name])
    loop = mechanism.without_centre().loop
    assert identify(loop, entries=[expected], locking=False).names == (expected.name,)


def test_a_locked_state_names_joints_and_linkage():
    state = locked_state(lock_network(network(), in_radians(p1=40, p2=-75)))
    assert (state.becomes, state.mobility) == ("5R", 1)
    assert state.left == ("4", "5", "6", "7", "8")
    assert state.still == ("3",)
    assert state.linkages == ("generalized-goldberg-5r",)


def test_another_number_of_kinks_is_refused():
    with pytest.raises(GeometryError, match="number of kinks"):
        next(locked_states(network(), 2, (0.1,)))


# --- forms ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", [name for name in LOOPS if "forms" in str(LOOPS[name])]
)
def test_loop_and_locked_network_have_the_forms_of_the_reference(name):
    case = LOOPS[name]
    mechanism = lock_network(network(), kinks_of(case))
    atlas = map_of(mechanism, settings=FEW)
    assert len(atlas.forms) == case["network_forms"]
    assert not atlas.bifurcations
    alone = map_of(mechanism.without_centre().loop, settings=FEW)
    assert len(alone.forms) == case["single_loop_forms"]
    assert not alone.bifurcations
    lengths = [form.branch.length for form in alone.forms]
    assert lengths == pytest.approx(
        [case["single_loop_form_length_rad"]] * len(lengths), abs=0.01
    )


def test_removing_the_centre_adds_two_forms_and_four_bifurcations():
    mechanism = lock_network(network(), in_radians(p2=0, p6=0))
    atlas = map_of(mechanism, settings=FEW)
    assert (len(atlas.forms), len(atlas.bifurcations)) == (2, 0)
    alone = map_of(mechanism.without_centre().loop, settings=FEW)
    assert (len(alone.forms), len(alone.bifurcations)) == (4, 4)
    names = identify(
        mechanism.without_centre().loop,
        entries=[entry("wohlhart-double-goldberg")],
        locking=False,
    ).names
    assert names == ("wohlhart-double-goldberg",)


# --- four joints ----------------------------------------------------------------------

TWISTS = facts()["four_joints"]["twists_deg"]
FITTING = dict(zip(("alpha", "beta", "gamma", "delta"), TWISTS.values(), strict=True))


def four_locks(degrees):
    """Joints 2, 4, 6, 8 at these kinks."""
    return dict(zip("2468", np.radians(degrees), strict=True))


@pytest.mark.parametrize("kink", [0, 180])
def test_four_straight_or_folded_joints_move_under_the_condition(kink):
    mechanism = lock_network(network(**FITTING), four_locks([kink] * 4))
    atlas = map_of(mechanism, settings=FEW)
    assert [form.branch.closed for form in atlas.forms] == [True]
    loop = mechanism.without_centre().loop
    assert loop.n == 4
    assert identify(loop, entries=[entry("bennett")], locking=False).names == (
        "bennett",
    )


@pytest.mark.parametrize("kink", [0, 180])
def test_in_general_they_leave_the_flat_configurations_only(kink):
    states = assemble(network(), four_locks([kink] * 4))
    assert len(states)
    assert np.abs(np.sin(states)).max() < 1e-9


def test_straight_and_folded_in_turn_leave_the_flat_configurations_only():
    states = assemble(network(**FITTING), four_locks([0, 180, 0, 180]))
    assert np.abs(np.sin(states)).max(initial=0.0) < 1e-9


def test_the_condition_gives_the_twist_and_the_ratio_of_the_source():
    """tan(alpha/2) tan(beta/2) = tan(gamma/2) tan(delta/2) is equivalent to (5.4.1) of
    Song (2013), that the pairs a, b and c, d in line have one Bennett ratio; it makes
    pairs that are folded fit as well, of which nothing is said there."""
    alpha, beta, gamma, delta = np.radians(list(FITTING.values()))
    tangent = np.tan(gamma / 2) * np.tan(delta / 2) / np.tan(alpha / 2)
    assert 2 * np.arctan(tangent) == pytest.approx(beta, abs=1e-14)
    first = (np.sin(alpha) + np.sin(beta)) / np.sin(alpha + beta)
    second = (np.sin(gamma) + np.sin(delta)) / np.sin(gamma + delta)
    assert first == pytest.approx(second, abs=1e-13)
    assert alpha + beta < pi
