"""Configurations of mechanisms on the screen and in JSON: units of the unknowns."""

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.app.texts.configurations import numbers_at
from linkages.app.texts.summary import make_summary
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.subject import subject_at
from tests.maps import map_of

FEW_STARTS = SearchSettings(starts=20, certify=False)
ON_BASE = np.array([0.0, 20.0, 120.0, 140.0, 240.0, 260.0])
ON_PLATE = np.array([-40.0, 60.0, 80.0, 180.0, 200.0, 300.0])


def platform(size):
    """A plate on six legs of fixed length, at a height of 1.1 sizes."""
    joints = []
    rows = zip(np.radians(ON_BASE), np.radians(ON_PLATE), strict=True)
    for k, (base, plate) in enumerate(rows):
        foot = size * np.array([np.cos(base), np.sin(base), 0.0])
        head = size * np.array([0.7 * np.cos(plate), 0.7 * np.sin(plate), 1.1])
        leg, rod = f"leg{k}", f"rod{k}"
        joints += [
            Joint(f"B{k}", "spherical", ("frame", leg), foot),
            Joint(f"L{k}", "prismatic", (leg, rod), None, head - foot, locked=(0.0,)),
            Joint(f"P{k}", "spherical", (rod, "plate"), head),
        ]
    return Mechanism(tuple(joints), "platform")


@pytest.mark.parametrize("size", [0.1, 1.0, 10.0])
def test_coordinates_of_a_plate_are_in_the_unit_of_the_file(size):
    mechanism = platform(size)
    atlas = map_of(mechanism, settings=FEW_STARTS)
    plate = mechanism.bodies.index("plate")
    readout = subject_at(atlas).readout
    (pair,) = readout.structure.free_pairs.values()
    assert len(atlas.rigid) > 1
    for assembly in atlas.rigid:
        pose = readout.poses(assembly[None])[0, plate]
        moved = pose[:3, :3] @ pair.center + pose[:3, 3] - pair.center
        numbers = numbers_at(atlas, assembly)
        np.testing.assert_allclose(numbers[:3], pose[:3, 0], atol=1e-9)
        np.testing.assert_allclose(numbers[6:], moved, atol=1e-9 * size)
    assert atlas.units == ("",) * 6 + ("size",) * 3


def test_the_heading_names_what_has_no_unit():
    atlas = map_of(platform(1.0), settings=FEW_STARTS)
    words = "plate.z (lengths, entries ax to bz of rotation matrices)"
    assert subject_at(atlas).heading(atlas).endswith(words)
    assert words in make_summary(atlas)
