"""Within limits a loop has the forms that it has without them, cut there, and the map
says that these are all."""

from dataclasses import replace

import numpy as np
import pytest

import linkages
from bifurc import SearchSettings
from bifurc.branch import Outcome
from bifurc.completeness import Level
from bifurc.curves.continuation import trace_branch
from linkages.closure.cut_at_limits import (
    cut_motions,
    for_subject,
    loop_without_limits,
)
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.families.four_bar import four_bar
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.of_loop import mechanism_of_loop
from linkages.readout.readout import Readout
from linkages.statements import LinkageClaim
from tests.linkages.closure.test_within_limits import line_symmetric_loop, rccc
from tests.maps import map_of

PLAIN = SearchSettings(certify=False, near_motions=False)
SAMPLES = 20_000  # of a form
# joints, by number, with limits about a configuration of a form, rad
LOOPS = {
    "torus-5r-13-plus-plus": {0: (-1.7, 0.2)},
    "goldberg-5r": {0: (-0.2, 0.4), 1: (-0.1, 0.02)},
    "serial-goldberg-6r": {5: (-0.076, 0.01)},
    "reconfigurable-bricard-1": {0: (-0.14, 0.11)},
    "wohlhart-double-goldberg": {3: (-2.0, 0.4)},
}


def limited_loop(name, limits, seed=0):
    """A loop of the catalogue, its configuration drawn from its forms, and with
    limits."""
    loop = linkages.load(name).loop
    atlas = map_of(loop, settings=PLAIN)
    rng = np.random.default_rng(seed)
    branch = atlas.forms[rng.integers(len(atlas.forms))].branch
    free = mechanism_of_loop(loop, branch(rng.uniform() * branch.length))
    joints = list(free.joints)
    for k, pair in limits.items():
        joints[k] = replace(joints[k], limits=(pair,))
    return free, Mechanism(tuple(joints))


def parts_of_samples(free, limits):
    """How many parts of the forms of a loop without limits are within them, and how
    long they are together, by dense samples."""
    count, length = 0, 0.0
    readout = Readout(free)
    for form in map_of(free, settings=PLAIN).forms:
        branch = form.branch
        places = np.linspace(0.0, branch.length, SAMPLES, endpoint=not branch.closed)
        values = readout.values(branch(places))
        is_inside = np.ones(SAMPLES, dtype=bool)
        for k, (low, high) in limits.items():
            is_inside &= (values[:, k] - low) % (2 * np.pi) <= high - low
        is_begin = is_inside & ~np.roll(is_inside, 1)
        if not branch.closed:
            is_begin[0] = is_inside[0]
        count += np.count_nonzero(is_begin)
        length += np.count_nonzero(is_inside) * branch.length / SAMPLES
    return count, length


@pytest.mark.parametrize("name", LOOPS)
def test_forms_within_limits_are_those_without_cut_there(name):
    free, mechanism = limited_loop(name, LOOPS[name])
    count, length = parts_of_samples(free, LOOPS[name])
    atlas = map_of(mechanism)
    assert len(atlas.forms) == count
    total = sum(form.branch.length for form in atlas.forms)
    # a part begins and ends within a sample of where it is said to
    assert total == pytest.approx(length, abs=count * 2e-3)
    assert atlas.completeness.level is Level.CERTIFIED
    assert "cut at the limits" in atlas.completeness.statement


def test_that_nothing_is_within_limits_is_certified():
    atlas = map_of(line_symmetric_loop(R0=(-1.0, -0.95)))
    assert not atlas.forms
    assert atlas.completeness.level is Level.CERTIFIED


def cut_of(mechanism):
    """What is held against the forms of a mechanism."""
    problem = MechanismClosure(mechanism)
    rng = np.random.default_rng(0)
    return for_subject(problem, problem.structure, rng, 50)


def test_parts_that_are_not_listed_are_starts_and_take_the_level():
    mechanism = line_symmetric_loop(R0=(-2.5, -2.45))
    audit = cut_of(mechanism)([], 60.0)
    problem = MechanismClosure(mechanism)
    assert len(audit.starts) >= 2
    assert np.all(problem.domain.are_inside(audit.starts))
    assert np.abs(problem.residuals(audit.starts)).max() < 1e-9
    assert audit.level is Level.ESTIMATED
    assert LinkageClaim.PARTS_NOT_LISTED.is_kind_of(audit.claims[0])


def test_a_map_without_limits_that_ended_early_certifies_nothing():
    mechanism = line_symmetric_loop(R0=(-2.5, -2.45))
    branches = [form.branch for form in map_of(mechanism).forms]
    assert cut_of(mechanism)(branches, 60.0).level is Level.CERTIFIED
    assert cut_of(mechanism)(branches, 1e-6).level is Level.ESTIMATED


def test_each_combination_of_whole_turns_has_its_stretches():
    low, turn = -2.5, 2 * np.pi
    counts = []
    for high in (low + 0.05, low + 0.05 + turn, low + 0.05 + 3 * turn):
        cut = cut_of(line_symmetric_loop(R0=(low, high)))
        atlas = map_of(cut.single.loop, settings=PLAIN)
        parts = [cut_motions(cut.structure, cut.single, f.branch) for f in atlas.forms]
        values = np.concatenate([part.points[:, 0] for part in parts])
        assert np.all((values >= low) & (values <= high))
        counts.append(np.count_nonzero((values - low) % turn < 0.05))
    assert counts == [counts[0], 2 * counts[0], 4 * counts[0]]


@pytest.mark.parametrize(
    "mechanism", [line_symmetric_loop(), rccc((-1.0, 1.0))], ids=["free", "slides"]
)
def test_what_has_no_limits_or_slides_is_no_loop_to_be_cut(mechanism):
    assert loop_without_limits(MechanismClosure(mechanism).structure) is None


def kite_within_limits():
    """A kite but for the last bits of its lengths, as files give it, in a configuration
    in which it is not flat, its joints turned by less than 2.9 rad from there."""
    loop = four_bar(1.0, 2.0, 2.0 + 2e-15, 1.0)
    atlas = map_of(loop, settings=PLAIN)
    branches = [form.branch for form in atlas.forms]
    branch = max(branches, key=lambda branch: np.ptp(branch.sample(50)[:, 0]))
    joints = mechanism_of_loop(loop, branch(0.3 * branch.length)).joints
    return Mechanism(tuple(replace(joint, limits=((-2.9, 2.9),)) for joint in joints))


# A step from some of these ends at the point, where bridges before it have no room.
DISTANCES = np.geomspace(1e-4, 0.3, 12)


def test_a_form_is_followed_through_a_bifurcation_from_however_near_it():
    mechanism = kite_within_limits()
    atlas = map_of(mechanism, settings=PLAIN)
    assert {form.branch.outcome for form in atlas.forms} == {Outcome.LEFT_REGION}
    assert len(atlas.bifurcations) == 2
    problem = MechanismClosure(mechanism)
    for bifurcation in atlas.bifurcations:
        for tangent in bifurcation.point.tangents:
            steps = np.outer(DISTANCES, tangent)
            starts, _ = problem.project(bifurcation.point.u + steps)
            for start in starts:
                branch = trace_branch(problem, start, -tangent)
                assert branch.outcome is Outcome.LEFT_REGION
