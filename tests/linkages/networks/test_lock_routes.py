"""Routes of a network over its locks."""

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.networks.lock_routes import (
    NetworkPlace,
    Switch,
    Travel,
    find_lock_route,
)
from linkages.networks.mechanism import lock_network
from linkages.values import GeometryError
from tests.linkages.networks.known_networks import facts, in_radians, network
from tests.maps import map_of

FEW = SearchSettings(starts=20, certify=False)
CASE_4 = in_radians(p2=40, p6=-75)
CASE_3 = in_radians(p2=40, p4=90)


def explore(mechanism):
    return map_of(mechanism, settings=FEW)


def route(start, goal):
    return find_lock_route(network(), start, goal, explore)


def test_case_4_becomes_case_3_where_joint_4_is_at_90_degrees():
    found = route(NetworkPlace(CASE_4, in_radians(p4=90)), NetworkPlace(CASE_3))
    (step,) = found.steps
    assert isinstance(step, Switch)
    assert (step.locked[0], step.released[0]) == ("4", "6")
    reference = facts()["reconfiguration"]["ring_angles_at_switch"]
    expected = [reference[f"p{joint}"] for joint in range(1, 9)]
    assert np.abs(found.start - expected).max() < 1e-12


def test_with_the_locks_of_case_3_joint_6_turns_twice():
    mechanism = lock_network(network(), CASE_3)
    (form,) = explore(mechanism).forms
    label = mechanism.placed.label("6")
    unknown = explore(mechanism).names.index(label)
    assert abs(form.branch.winding[unknown]) == 2


def test_a_route_travels_to_the_exchange_and_on_to_the_goal():
    found = route(
        NetworkPlace(CASE_4, in_radians(p4=30)),
        NetworkPlace(CASE_3, in_radians(p6=20)),
    )
    first, switch, last = found.steps
    assert isinstance(first, Travel) and isinstance(switch, Switch)
    assert isinstance(last, Travel)
    assert found.start[3] == pytest.approx(np.radians(30))
    assert first.end[[1, 3, 5]] == pytest.approx(np.radians([40, 90, -75]))
    assert last.end[[1, 3, 5]] == pytest.approx(np.radians([40, 90, 20]))
    # the path has no jumps, and ends where it is said to
    for step in (first, last):
        steps = np.linalg.norm(np.diff(step.route.path, axis=0), axis=1)
        assert steps.max() < 0.1
    assert found.length == pytest.approx(first.length + last.length)


def test_further_angles_choose_among_places():
    near = in_radians(p4=90, p1=150)
    found = route(NetworkPlace(CASE_4, near), NetworkPlace(CASE_3))
    assert found.starts == 1
    assert np.degrees(found.start[[0, 3]]) == pytest.approx([154.991, 90], abs=1e-3)


def test_another_kink_of_one_joint_needs_two_exchanges():
    found = route(
        NetworkPlace(in_radians(p1=20, p5=30)), NetworkPlace(in_radians(p1=25, p5=30))
    )
    assert found.switches == 2


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        (NetworkPlace(in_radians(p2=40)), NetworkPlace(CASE_3), "number of locks"),
        (
            NetworkPlace(in_radians(p2=40)),
            NetworkPlace(in_radians(p4=40)),
            "mobility 1 is left; they leave 2",
        ),
        (
            NetworkPlace(CASE_4, in_radians(p6=3)),
            NetworkPlace(CASE_3),
            "as the joint is locked",
        ),
        (
            NetworkPlace(in_radians(p1=40, p2=-75), in_radians(p3=3)),
            NetworkPlace(CASE_3),
            "at one place at least",
        ),
    ],
)
def test_places_that_are_none_are_refused(start, goal, message):
    with pytest.raises(GeometryError, match=message):
        route(start, goal)
