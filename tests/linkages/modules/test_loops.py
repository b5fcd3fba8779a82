"""Single loops as chains of single turns and slides."""

import numpy as np
import pytest

from linkages.closure.closure import Closure
from linkages.dyads.generic import find_generic
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.modules.assemblies import Module
from linkages.modules.equations import ClosureFamily, mirror_of
from linkages.modules.loops import SingleLoop, chains_of, single_loop
from linkages.modules.slices import Motions
from linkages.structure.structure import ClosureKind, Structure
from tests.linkages.modules.test_modules import are_among, loop
from tests.samples import one_in


def test_a_generic_member_of_a_type_has_the_same_count_anew():
    family = chains_of(ClosureKind.POINT, "RRR")
    generic = find_generic(family, 48)
    assert generic.count == 4
    assert generic.trace < 1e-9


def test_a_solution_that_agrees_with_another_in_a_coordinate_is_not_missed():
    """With the crank of RSSP held two places of the slide are left."""
    closures = ClosureFamily(Structure(loop("RSSP", np.random.default_rng(1))), True)
    generic = find_generic(closures.driven_by((0,)), 48)
    assert generic.count == 2


# loops, and how many complex configurations there are with their first unknown held
LOOPS = {
    "RSUR": 4,
    "RCCC": 2,
    "RSSR": 2,
    "RPSC": 2,
    "UCUR": 16,
    "PCUU": 16,
    "RPRPCR": 2,
    "RRRRRRR": 16,
}


@pytest.mark.parametrize("letters", one_in(3, LOOPS))
def test_a_loop_has_the_configurations_that_random_starts_reach(letters):
    """Newton's method leads from complex places to no others."""
    rng = np.random.default_rng(3)
    closures = ClosureFamily(Structure(loop(letters, rng)), True)
    place = 0.4 - 0.2j
    known = SingleLoop(closures).solutions(0, place)
    assert len(known) == LOOPS[letters]
    driven = closures.driven_by((0,))
    family, given = driven.family, driven.given_at(place)
    starts = rng.normal(size=(200, driven.n)) + 1j * rng.normal(size=(200, driven.n))
    for _ in range(60):
        values = family.residuals(starts, given)
        inverses = np.linalg.pinv(family.jacobians(starts, given))
        steps = np.einsum("knm,km->kn", inverses, values)
        sizes = np.abs(steps).max(axis=1, keepdims=True)
        starts = starts - steps / np.maximum(1.0, sizes)
    solved = np.abs(family.residuals(starts, given)).max(axis=1) < 1e-10
    assert np.count_nonzero(solved) > 5
    assert are_among(starts[solved], known)


def test_numbers_of_joints_and_the_way_round_make_no_other_type():
    families = set()
    for letters in ("RSUR", "URSR", "RURS", "SRUR"):
        structure = Structure(loop(letters, np.random.default_rng(1)))
        found = single_loop(ClosureFamily(structure, True))
        families |= {found.family(k) for k in range(len(structure.unknowns))}
    assert len(families) == 1


def test_a_loop_that_stands_needs_no_configurations_of_its_own():
    module = Module(Structure(loop("RRRRC", np.random.default_rng(1))))
    assert module.generic.count == 16
    known = module.configurations()
    assert np.abs(known).max(axis=1).min() < 1e-9
    assert np.abs(Closure(module.structure.mechanism).residuals(known)).max() < 1e-10


def test_a_rod_may_lead_out_of_the_plane_of_two_cranks():
    mechanism = Mechanism(
        (
            Joint("A", "revolute", ("frame", "a"), (0, 0, 0), (0, 0, 1)),
            Joint("S", "spherical", ("a", "rod"), (1.0, 0.2, 0.5)),
            Joint("T", "spherical", ("rod", "b"), (2.5, 1.5, -0.7)),
            Joint("B", "revolute", ("b", "frame"), (3, 0, 0), (0, 0, 1)),
        )
    )
    motions = Motions(Structure(mechanism))
    (driver,) = motions.drivers(np.random.default_rng(0))
    points = motions.points(driver, [0.0, 0.1])
    assert len(points) == 4
    assert np.abs(Closure(mechanism).residuals(points)).max() < 1e-10


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.09, 2.0])
def test_every_direction_is_a_reflection(angle):
    direction = np.array([-np.cos(angle), np.sin(angle) * 0.6, np.sin(angle) * 0.8])
    h = mirror_of(direction)
    reflected = 2.0 * h[0] * h / (h @ h) - [1.0, 0.0, 0.0]
    assert np.abs(reflected - direction).max() < 1e-8
