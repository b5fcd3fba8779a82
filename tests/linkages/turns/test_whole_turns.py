"""Forms of helical joints do not depend on which of them random starts reach."""

import numpy as np
import pytest

from bifurc.completeness import Level
from bifurc.curves.continuation import trace_branch
from bifurc.settings import SearchSettings
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.turns import whole_turns
from linkages.turns.translates import translates_of
from tests.maps import map_of

Z = (0, 0, 1)


def nut_on_a_rocker(turns):
    """A four-bar whose rocker carries a nut, on a screw that slides along itself and
    makes so many turns either way."""
    places = [(0, 0, 0), (0.5, 1.0, 0), (2, 1.4, 0), (2.2, 0, 0)]
    bodies = ["frame", "crank", "rod", "rocker", "screw"]
    joints = [
        Joint(f"R{k}", "revolute", (bodies[k], bodies[k + 1]), places[k], Z)
        for k in range(3)
    ]
    limits = ((-turns * 2 * np.pi, turns * 2 * np.pi),)
    pair = ("rocker", "screw")
    joints.append(Joint("H", "helical", pair, places[3], Z, pitch=0.4, limits=limits))
    joints.append(Joint("P", "prismatic", ("screw", "frame"), direction=Z))
    return Mechanism(tuple(joints))


# the rocker swings less than half a turn about where it is given: within two and a half
# turns of the screw either way it does so at five of them
@pytest.mark.parametrize("seed", range(3))
def test_a_form_is_listed_once_with_all_whole_turns(seed):
    settings = SearchSettings(starts=4, certify=False)
    atlas = map_of(nut_on_a_rocker(2.5), settings=settings, seed=seed)
    (form,) = atlas.forms
    assert form.branch.closed
    screw = form.branch.sample(100)[:, atlas.names.index("H")]
    assert abs(screw.max() + screw.min()) < 2 * np.pi
    assert translates_of(atlas).forms == 5
    assert atlas.completeness.level is Level.ESTIMATED
    assert "a whole turn of a joint away" in atlas.completeness.statement
    assert "stands for 5 forms" in atlas.completeness.statement


def audit_of(number, seconds):
    """What is said beside so many forms."""
    problem = MechanismClosure(nut_on_a_rocker(2.5))
    branch = trace_branch(problem, problem.reference)
    rng = np.random.default_rng(0)
    judge = whole_turns.for_subject(problem, problem.structure, rng, 0)
    return judge([branch] * number, seconds)


def test_of_many_forms_it_is_said_that_there_are_more():
    audit = audit_of(whole_turns.MOST_FORMS + 1, 1.0)
    (claim,) = audit.claims
    assert f"at least {whole_turns.MOST_FORMS + 1} forms" in claim.text
    assert not len(audit.starts)


def test_without_time_for_proofs_none_are_looked_for():
    (claim,) = audit_of(1, 0.0).claims
    assert "at least 1 form in all" in claim.text


def test_what_is_beside_a_form_is_moved_to_where_it_is_listed():
    audit = audit_of(1, 1.0)
    assert len(audit.starts)
    problem = MechanismClosure(nut_on_a_rocker(2.5))
    assert np.abs(problem.lattice.homes(audit.starts) - audit.starts).max() == 0.0


def rack(ratio):
    """A crank that drives a rack, and a rod from the one to the other."""
    follows = (Coupling("A", ratio),)
    joints = (
        Joint("A", "revolute", ("frame", "crank"), (0, 0, 0), Z),
        Joint("B", "revolute", ("crank", "rod"), (0.6, 0.8, 0), Z),
        Joint("C", "revolute", ("rod", "slide"), (3, 0, 0), Z),
        Joint("D", "prismatic", ("frame", "slide"), None, (1, 0, 0), coupled=follows),
    )
    return Mechanism(joints)


def assemblies_of_rack(ratio, low, high):
    """The angles of the crank, up to a grid, at which the rod has its length."""
    angles = np.linspace(low, high, 1_000_001) + 1e-7
    along = 3 + ratio * angles - (0.6 * np.cos(angles) - 0.8 * np.sin(angles))
    aside = 0.6 * np.sin(angles) + 0.8 * np.cos(angles)
    excess = np.hypot(along, aside) - np.hypot(2.4, 0.8)
    return angles[1:][excess[1:] * excess[:-1] < 0]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("ratio", [0.1, -0.25])
def test_a_rigid_mechanism_has_its_assemblies_at_every_turn(ratio, seed):
    mechanism = rack(ratio)
    problem = MechanismClosure(mechanism)
    column = problem.domain.names.index("A")
    expected = assemblies_of_rack(ratio, *problem.domain.bounds[column])
    assert len(expected) >= 5
    settings = SearchSettings(starts=20, near_motions=False)
    atlas = map_of(mechanism, settings=settings, seed=seed)
    angles = np.sort([assembly[column] for assembly in atlas.rigid])
    assert angles == pytest.approx(expected, abs=1e-3)
