"""Chains of bodies that move by themselves."""

from dataclasses import replace

import pytest

import linkages
from bifurc.settings import SearchSettings
from linkages.app.texts.mechanism_text import describe_loops
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.readout import Readout
from linkages.structure.loose_chains import LooseChain, loose_chains
from linkages.structure.structure import Structure
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import platform

Z = (0, 0, 1)


def revolute(name, bodies, x, y):
    return Joint(name, "revolute", bodies, (x, y, 0), Z)


FOUR_BAR = (
    revolute("A", ("frame", "crank"), 0, 0),
    revolute("B", ("crank", "coupler"), 0, 1),
    revolute("C", ("coupler", "rocker"), 2, 1.5),
    revolute("D", ("rocker", "frame"), 2, 0),
)
KNEE = (
    Joint("E", "spherical", ("coupler", "r1"), (1, 2, 0.3)),
    Joint("K", "spherical", ("r1", "r2"), (1.5, 2.5, 1.5)),
    Joint("F", "spherical", ("r2", "frame"), (3, 1, 0.5)),
)
TWO_KNEES = (
    KNEE[0],
    KNEE[1],
    Joint("L", "spherical", ("r2", "r3"), (2.5, 2.0, 1.2)),
    Joint("F", "spherical", ("r3", "frame"), (3, 1, 0.5)),
)
FOUR_TURNS = (
    revolute("E", ("coupler", "b1"), 1, 2),
    revolute("G", ("b1", "b2"), 1.5, 3),
    revolute("H", ("b2", "b3"), 2.5, 3),
    revolute("F", ("b3", "frame"), 3, 1),
)


def chains_of(*joints):
    return loose_chains(Structure(Mechanism(joints)))


@pytest.mark.parametrize(
    ("joints", "bodies", "freedoms"),
    [
        (KNEE, ("r1", "r2"), 1),
        (TWO_KNEES, ("r1", "r2", "r3"), 3),
        (FOUR_TURNS, ("b1", "b2", "b3"), 1),
    ],
)
def test_a_chain_beside_a_four_bar_moves_by_itself(joints, bodies, freedoms):
    chains = chains_of(*FOUR_BAR, *joints)
    assert chains == (LooseChain(bodies, ("frame", "coupler"), freedoms),)


def test_a_chain_on_one_body_moves_by_itself():
    own = [replace(joint, bodies=joint.bodies[::-1]) for joint in FOUR_TURNS]
    own[0] = replace(own[0], bodies=("b1", "frame"))
    assert chains_of(*FOUR_BAR, *own) == (
        LooseChain(("b1", "b2", "b3"), ("frame",), 1),
        LooseChain(("crank", "coupler", "rocker"), ("frame",), 1),
    )


def test_what_is_locked_or_coupled_is_no_freedom_of_a_chain():
    mechanism = Mechanism((*FOUR_BAR, *FOUR_TURNS))
    assert loose_chains(Structure(mechanism.with_locks({"G": 0.0}))) == ()
    driven = replace(FOUR_TURNS[1], coupled=(Coupling("A", 0.5),))
    assert chains_of(*FOUR_BAR, FOUR_TURNS[0], driven, *FOUR_TURNS[2:]) == ()


# their legs hold them, and what turns about its own line alone is left out
@pytest.mark.parametrize(
    "mechanism",
    [
        platform(),
        platform((None,) * 6),
        mechanism_of_case(cases()["Sarrus linkage of 3 RRR chains"]),
        mechanism_of_case(cases()["Peaucellier-Lipkin inversor"]),
        Mechanism(FOUR_BAR),
    ],
    ids=str,
)
def test_chains_that_hold_the_rest_are_not_named(mechanism):
    assert loose_chains(Structure(mechanism)) == ()


def test_the_summary_names_a_chain_and_the_mobility_holds_its_freedom():
    with_knee = Mechanism((*FOUR_BAR, *KNEE))
    settings = SearchSettings(starts=10, charts=0)
    atlas = linkages.map_linkage(with_knee, settings=settings)
    assert {surface.dimension for surface in atlas.surfaces} == {2}
    text = describe_loops(atlas, Readout(with_knee))
    assert "1 of these freedoms between frame and coupler can be had by r1, r2" in text
