"""Forms of helical joints do not depend on which of them random starts reach."""

import numpy as np
import pytest

import linkages
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Level
from linkages.mechanisms import whole_turns
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism

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
def test_all_whole_turns_are_listed_whatever_the_seed(seed):
    settings = SearchSettings(starts=4, certify=False)
    atlas = linkages.map_linkage(nut_on_a_rocker(2.5), settings=settings, seed=seed)
    assert len(atlas.forms) == 5
    assert all(form.branch.closed for form in atlas.forms)
    assert len({round(form.branch.length, 6) for form in atlas.forms}) == 1
    assert atlas.completeness.level is Level.ESTIMATED
    assert "a whole turn of a joint away" in atlas.completeness.statement


def test_of_many_forms_it_is_said_that_there_are_more(monkeypatch):
    monkeypatch.setattr(whole_turns, "MOST_FORMS", 2)
    settings = SearchSettings(starts=8, certify=False)
    atlas = linkages.map_linkage(nut_on_a_rocker(2.5), settings=settings)
    assert len(atlas.forms) > 2
    assert f"at least {len(atlas.forms)} forms" in atlas.completeness.statement


def test_without_time_for_proofs_none_are_looked_for():
    settings = SearchSettings(starts=4, certify=False, prove=False)
    atlas = linkages.map_linkage(nut_on_a_rocker(2.5), settings=settings)
    assert "at least" in atlas.completeness.statement
