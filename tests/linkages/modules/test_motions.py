"""Motions of mechanisms of any joints: complete slices by paths."""

import numpy as np
import pytest

from bifurc.completeness import Level, Scope
from linkages.closure.closure import Closure
from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.modules.equations import ClosureFamily
from linkages.modules.slices import Motions
from linkages.structure.structure import Structure
from tests.linkages.modules.test_modules import are_among, loop
from tests.samples import one_in

# loops of one freedom in space, and how many complex configurations there are at a value
# of the drivers that have least: a 3R arm takes a point anywhere in 4 ways (Pieper 1968)
COUNTS = {"RSSR": 2, "SUU": 4, "RSRRR": 4, "RCCC": 2, "PUPS": 2, "CCCP": 2, "RSSP": 2}


@pytest.mark.parametrize("letters", one_in(4, COUNTS))
def test_every_motion_of_a_loop_passes_a_slice(letters):
    atlas = map_linkage(loop(letters, np.random.default_rng(1)))
    assert atlas.completeness.level is Level.CERTIFIED
    (claim,) = (one for one in atlas.completeness.claims if one.scope is Scope.MOTIONS)
    assert claim.data["complex"] == str(COUNTS[letters])
    assert claim.data["trace"] < 1e-9


def test_a_slice_holds_what_random_starts_reach_there():
    mechanism = loop("RSUR", np.random.default_rng(2))
    motions = Motions(Structure(mechanism))
    assert 0 in motions.drivers(np.random.default_rng(0))
    known = motions.points(0, [0.7])
    closure = Closure(mechanism)
    starts = np.random.default_rng(0).uniform(-np.pi, np.pi, (150, closure.n))
    starts[:, 0] = 0.7
    for _ in range(25):
        values, rates = closure.residuals(starts), closure.jacobians(starts)[:, :, 1:]
        steps = np.einsum("knm,km->kn", np.linalg.pinv(rates), values)
        starts[:, 1:] -= steps
    solved = np.abs(closure.residuals(starts)).max(axis=1) < 1e-12
    assert np.count_nonzero(solved) > 20
    assert are_among(np.exp(1j * starts[solved]), np.exp(1j * known))


def rod_that_stands():
    """An RSSR loop, drawn where the crank's end is on the axis of the rocker, which
    turns there while the crank stands."""
    end, other_end = (2.0, 0.0, 0.4), (3.0, 0.0, 0.0)
    return Mechanism(
        (
            Joint("crank", "revolute", ("frame", "a"), (0, 0, 0), (0.2, 1.0, 0.3)),
            Joint("A", "spherical", ("a", "rod"), end),
            Joint("B", "spherical", ("rod", "b"), other_end),
            Joint("rocker", "revolute", ("b", "frame"), (2, 0, 0), (0, 0, 1)),
        )
    )


def test_what_stands_on_a_motion_is_no_driver():
    structure = Structure(rod_that_stands())
    assert [unknown.label for unknown in structure.unknowns] == ["crank", "rocker"]
    assert Motions(structure).drivers(np.random.default_rng(0)) == [1]
    atlas = map_linkage(rod_that_stands())
    assert atlas.completeness.level is Level.CERTIFIED
    travels = [np.ptp(form.branch.sample(50), axis=0) for form in atlas.forms]
    assert min(travel[0] for travel in travels) < 1e-9
    assert max(travel[0] for travel in travels) > 0.1


def test_a_mechanism_with_slides_is_on_no_sphere():
    """All turns of PUPS, those of one universal joint, meet at a point."""
    structure = Structure(loop("PUPS", np.random.default_rng(0)))
    assert not ClosureFamily(structure, is_driven=True).placement.is_spherical
