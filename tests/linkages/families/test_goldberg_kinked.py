"""6R linkages that locked networks of Bennett loops leave."""

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.catalogue import entry
from linkages.construction.constructions import lock, locked_angles
from linkages.construction.spatial_triangle import Kink
from linkages.entry import RelationKind
from linkages.identification.identify import identify
from linkages.mapping import map_linkage
from linkages.networks.assembly import assemble
from linkages.networks.entries import NETWORKS
from linkages.relations import relations_of
from linkages.values import GeometryError

SERIAL = "generalized-serial-goldberg-variant-6r"
L_SHAPE = "generalized-l-shape-goldberg-variant-6r"
ISOMER = "isomerized-generalized-l-shape-goldberg-6r"
NAMES = (SERIAL, L_SHAPE, ISOMER)
every_linkage = pytest.mark.parametrize("name", NAMES)


def member(name, rng):
    """A random member that the constructor accepts."""
    family = entry(name)
    for _ in range(20):
        try:
            return family.build(**family.draw(rng))
        except GeometryError:
            continue
    raise AssertionError(name)


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        (SERIAL, "serial-goldberg-variant-6r"),
        (L_SHAPE, "l-shape-goldberg-variant-6r"),
    ],
)
def test_straight_kinks_give_the_variants_of_baker(name, plain):
    family = entry(name)
    shared = {key: v for key, v in family.defaults.items() if "kink" not in key}
    straight = family.build(**shared, kink_1=Kink.STRAIGHT, kink_2=Kink.STRAIGHT)
    expected = entry(plain).build(**shared)
    for one, other in zip(straight.arrays, expected.arrays, strict=True):
        assert np.abs(one - other).max() < 1e-15


@every_linkage
def test_random_members_move_and_are_recognised(name):
    rng = np.random.default_rng(5)
    loop = member(name, rng).relabelled(2).mirrored()
    atlas = map_linkage(loop, settings=SearchSettings(starts=20, certify=False))
    assert atlas.forms and not atlas.surfaces
    assert identify(loop, entries=[entry(name)], locking=False).names == (name,)


@every_linkage
def test_a_length_that_is_off_leaves_nothing_that_moves(name):
    loop = entry(name).build()
    lengths = (loop.lengths[0] + 1e-3, *loop.lengths[1:])
    broken = type(loop)(lengths, loop.twists, loop.offsets)
    assert identify(broken, entries=[entry(name)], locking=False).names == ()
    atlas = map_linkage(broken, settings=SearchSettings(starts=20, certify=False))
    assert not atlas.forms


@pytest.mark.parametrize(
    ("network", "locks", "name"),
    [
        ("serial-bennett-network", ("U1", "V2"), SERIAL),
        ("four-bennett-network", ("2", "5"), L_SHAPE),
        ("four-bennett-network", ("2", "4"), ISOMER),
    ],
)
def test_the_closed_form_of_the_network_is_that_of_the_linkage(network, locks, name):
    """The ring's closed form with the gains of both composite links lies on the one
    form that is traced, and all around it."""
    found = NETWORKS[network].build()
    kinks = dict(zip(locks, np.radians([40.0, -75.0]), strict=True))
    loop = found.ring_loop
    theta = found.ring_angles(assemble(found, kinks))
    axes = list(found.plan.ring)
    for axis, kink in kinks.items():
        place = axes.index(axis)
        theta = locked_angles(loop, place + 1, kink, theta)
        loop = lock(loop, place + 1, kink)
        axes.remove(axis)
    assert identify(loop, entries=[entry(name)], locking=False).names == (name,)
    assert loop.closure_error(theta).max() < 1e-13
    settings = SearchSettings(starts=20, certify=False)
    (form,) = map_linkage(loop, settings=settings).forms
    distances, arclengths = form.branch.nearest(theta)
    assert distances.max() < 1e-9
    assert np.diff(np.sort(arclengths)).max() < form.branch.length / 4


def test_the_isomer_is_stated():
    (relation,) = relations_of(ISOMER)
    assert relation.kind is RelationKind.ISOMER
    assert relation.other == "generalized-l-shape-goldberg-6r"
