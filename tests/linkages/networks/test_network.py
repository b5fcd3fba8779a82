"""The closed form of networks of Bennett loops, and the mechanism that they are."""

import numpy as np
import pytest

from linkages.closure.closure import Closure
from linkages.networks.assembly import assemble
from linkages.networks.entries import NETWORKS
from linkages.networks.mechanism import lock_network
from linkages.networks.placement import PlacedNetwork
from linkages.values import GeometryError
from tests.linkages.networks.known_networks import network

every_network = pytest.mark.parametrize("name", NETWORKS)


def states_of(found, step=500):
    """Some states of a network without locks."""
    return assemble(found, {})[::step]


@every_network
def test_the_outer_loop_closes_at_every_state(name):
    found = network(name)
    angles = found.ring_angles(states_of(found))
    # eight rounded transforms
    assert found.ring_loop.closure_error(angles).max() < 1e-14


def test_the_outer_loop_is_open_where_the_cells_do_not_close_around_the_centre():
    found = network()
    states = states_of(found)[0] + [0.0, 0.0, 0.0, 0.1]
    assert found.ring_loop.closure_error(found.ring_angles(states)) > 1e-3


@every_network
def test_rates_are_the_derivatives_of_the_angles(name):
    found = network(name)
    states = states_of(found)[3]
    for total in found.turns.values():
        rates = found.rates(total, states)
        for cell, step in enumerate(1e-6 * np.eye(len(states))):
            ahead = found.sums(total, states + step)
            behind = found.sums(total, states - step)
            assert rates[cell] == pytest.approx((ahead - behind) / 2e-6, abs=1e-7)


@every_network
def test_the_mechanism_closes_at_every_state(name):
    found = network(name)
    states = states_of(found)
    placed = PlacedNetwork(found, states[1])
    problem = Closure(placed.mechanism)
    variables = placed.variables(states)
    assert np.abs(problem.residuals(variables)).max() < 1e-13


@every_network
def test_the_mobility_is_three(name):
    found = network(name)
    problem = Closure(lock_network(found, {}))
    jacobian = problem.jacobians(np.zeros((1, problem.n)))[0]
    values = np.linalg.svd(jacobian, compute_uv=False)
    assert problem.n - np.count_nonzero(values > 1e-9) == 3


def test_bodies_joints_and_gruebler_are_those_of_the_source():
    mechanism = lock_network(network(), {})
    assert [joint.name for joint in mechanism.joints] == list("123456780")
    assert (len(mechanism.bodies), mechanism.independent_loops) == (12, 4)
    assert mechanism.gruebler == -9
    three = lock_network(network("l-shape-bennett-network"), {})
    assert (len(three.bodies), three.independent_loops, three.gruebler) == (10, 3, -6)


def test_lengths_are_checked_against_the_ratio():
    with pytest.raises(GeometryError, match="link b: sin"):
        NETWORKS["four-bennett-network"].build(b=2.0)
    given = network().links["b"].length
    built = NETWORKS["four-bennett-network"].build(b=given)
    assert built.links["b"].length == given


def test_a_rhombus_is_refused():
    with pytest.raises(GeometryError, match="different from"):
        network(gamma=35)


def test_a_lock_of_an_inner_joint_is_refused():
    with pytest.raises(GeometryError, match="one of the outer joints 1, 2"):
        lock_network(network(), {"0": 0.3})


def test_kinks_that_no_configuration_has_are_refused():
    kinks = dict(zip("2468", np.radians([30, 40, 30, 40]), strict=True))
    with pytest.raises(GeometryError, match="can be assembled"):
        lock_network(network(), kinks)


def test_a_lock_at_an_odd_joint_holds_one_state_and_at_an_even_one_a_difference():
    four = network("four-bennett-network")
    one, other = (
        four.ring_angles(np.array([1.0, -2.0, third, 1.0 - third]))
        for third in (0.3, 2.3)
    )
    # joints 1, 2, 3 stand still, all others turn
    gap = np.abs(np.sin((one - other) / 2))
    assert gap[:3].max() < 1e-14
    assert gap[3:].min() > 1e-2


@pytest.mark.parametrize("kinks", [(0, 0), (40, -40)])
def test_a_network_of_equal_loops_leaves_the_loop_of_the_form_that_is_not_folded(kinks):
    """Where it is folded, two of its links lie on each other."""
    equal = network(alpha=35, beta=35, gamma=62, delta=62)
    mechanism = lock_network(equal, dict(zip("26", np.radians(kinks), strict=True)))
    loop, still = mechanism.without_centre()
    assert still == ("2", "6") and loop.n == 6
    assert len(mechanism.still) > 2  # in the reference configuration


def test_locks_at_which_links_lie_on_each_other_leave_no_loop():
    equal = network(alpha=35, beta=35, gamma=62, delta=62)
    mechanism = lock_network(equal, {"2": np.pi, "6": np.pi})
    with pytest.raises(GeometryError, match="outer axes are not the same"):
        mechanism.without_centre()
