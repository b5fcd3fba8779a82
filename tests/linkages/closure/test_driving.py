"""Which joints are held so that one joint drives a mechanism."""

import itertools

import pytest

import linkages
from bifurc.settings import SearchSettings
from linkages.closure.driving import joints_to_hold
from linkages.files.bars import read_bars
from linkages.values import GeometryError

NAMES = "ABCDE"


def five_bar(*places):
    """A five-bar with its points at these places, A and E fixed."""
    bars = [[a, b] for a, b in itertools.pairwise(NAMES)]
    points = {name: list(place) for name, place in zip(NAMES, places, strict=True)}
    content = {"fixed": ["A", "E"], "bars": bars, "points": points}
    return read_bars(content, "five-bar")


def folded():
    """All points on a line: three motions to first order, and mobility two."""
    return five_bar((0, 0), (1, 0), (2, 0), (1, 0), (0.5, 0))


@pytest.mark.parametrize("driver", NAMES)
def test_a_singular_reference_configuration_holds_no_joint_too_many(driver):
    held = joints_to_hold(folded(), driver)
    assert len(held) == 1
    assert list(held.values()) == pytest.approx([0.0], abs=1e-12)


def test_what_is_held_at_a_singular_reference_configuration_leaves_a_motion():
    mechanism = folded()
    driven = mechanism.with_locks(joints_to_hold(mechanism, "A"))
    atlas = linkages.map_linkage(driven, settings=SearchSettings(starts=60))
    assert atlas.forms
    assert not atlas.surfaces


def test_at_a_regular_configuration_the_first_other_joint_is_held():
    places = (0, 0), (0.3, 1.1), (1.4, 1.9), (2.6, 1.0), (2.2, 0)
    assert list(joints_to_hold(five_bar(*places), "A")) == ["B"]
    assert list(joints_to_hold(five_bar(*places), "B")) == ["A"]


def test_a_driver_that_does_not_exist_is_named():
    with pytest.raises(GeometryError, match="joint variables A, B, C, D, E"):
        joints_to_hold(folded(), "X")
