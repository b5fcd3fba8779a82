"""Dependent quantities that are handed in and do not fit are refused, by name and
amount."""

import numpy as np
import pytest

from linkages.families.back_to_back import back_to_back, matching_twist
from linkages.families.bricard_collapsible import doubly_collapsible_octahedral
from linkages.families.bricard_other import trihedral, wohlhart_hybrid
from linkages.families.bricard_plane import plane_symmetric_octahedral
from linkages.families.goldberg_5r import extended_myard, syncopated_goldberg
from linkages.families.goldberg_6r import serial_goldberg
from linkages.families.mavroidis_roth import dietmaier, mavroidis_roth
from linkages.families.mixed_double_goldberg import double_goldberg_type
from linkages.families.waldron import waldron_collinear, yu_baker
from linkages.values import GeometryError

TWISTS = tuple(np.radians([35.0, 62.0, 41.0, 22.0]))
OFF = 1 + 1e-3
DIETMAIER = (1.3, *np.radians([50, 75, 35, 62]), 1.13, 1.27, 0.31, -0.47)
OCTAHEDRON = (2.19, 0.94, 2.26, 0.81, 0.59, 1.9)


def needed_length(twist: float) -> float:
    return 1.0 * np.sin(twist) / np.sin(TWISTS[0])


@pytest.mark.parametrize("construct", [serial_goldberg, yu_baker, double_goldberg_type])
@pytest.mark.parametrize("which", [1, 2, 3])
def test_other_bennett_ratio(construct, which):
    name = "abcd"[which]
    right = needed_length(TWISTS[which])
    construct(1.0, *TWISTS, **{name: right})
    with pytest.raises(GeometryError, match=f"link {name}: sin.*off by 0.000"):
        construct(1.0, *TWISTS, **{name: OFF * right})


@pytest.mark.parametrize(
    ("construct", "good", "name"),
    [
        (
            lambda b: syncopated_goldberg(1.0, *TWISTS[:3], b=b),
            needed_length(TWISTS[1]),
            "link b",
        ),
        (
            lambda b: waldron_collinear(1.0, *TWISTS[:2], 2.0, *TWISTS[2:], b=b),
            needed_length(TWISTS[1]),
            "link b",
        ),
        (
            lambda c: mavroidis_roth(1.0, *TWISTS[:2], 1.1, 1.2, 0.3, 0.4, c=c),
            needed_length(TWISTS[1]),
            "link c",
        ),
        (
            lambda t: back_to_back(1.0, *TWISTS[:3], delta=t),
            matching_twist(*TWISTS[:3]),
            "tan",
        ),
        (
            lambda t: extended_myard(1.0, *TWISTS[:2], 0.0, alpha34=t),
            np.pi - 2 * TWISTS[0],
            "alpha34",
        ),
        (lambda a: trihedral(1.0, 0.7, 1.1, 0.9, 0.8, a), 1.55**0.5, "a61"),
        (
            lambda r: wohlhart_hybrid(1.0, 0.8, 1.25, -0.9, 1.3, 1.9, 0.4, 0.3, r),
            -0.7,
            "R6",
        ),
        (
            lambda a: dietmaier(*DIETMAIER, a34=a),
            dietmaier(*DIETMAIER).lengths[2],
            "a34",
        ),
        (
            lambda a: dietmaier(*DIETMAIER, a61=a),
            dietmaier(*DIETMAIER).lengths[5],
            "link a61",
        ),
        (
            lambda t: plane_symmetric_octahedral(*OCTAHEDRON, alpha56=t),
            plane_symmetric_octahedral(*OCTAHEDRON).twists[4],
            "alpha56",
        ),
    ],
)
def test_dependent_quantity_off_by_a_thousandth(construct, good, name):
    construct(good)
    with pytest.raises(GeometryError, match=name) as refusal:
        construct(good * OFF)
    assert "off by" in str(refusal.value)


def test_printed_twist_of_the_myard_linkage_is_refused_with_offsets():
    with pytest.raises(GeometryError, match="alpha34"):
        extended_myard(1.0, *TWISTS[:2], 0.4, alpha34=np.pi - 2 * TWISTS[0])


def test_values_without_a_linkage():
    with pytest.raises(GeometryError, match="a12"):
        trihedral(0.1, 0.7, 0.1, 0.9, 0.1)
    with pytest.raises(GeometryError, match="radius of a circle"):
        doubly_collapsible_octahedral(2.3, 0.4, -1.1, 1.9, 0.7, 2.5)
    with pytest.raises(GeometryError, match=r"cos\(alpha56\)"):
        plane_symmetric_octahedral(2.19, 3.0, 2.26, 0.81, 0.59, 1.9)
