"""Sizes of hinges leave the walls and the play that are asked for."""

import math

import pytest

from linkages.printing.assembly import Dimensions
from linkages.values import GeometryError

SIZES = [(6.0, 0.3, 1.2), (2.4, 0.3, 1.2), (20.0, 0.1, 0.8), (3.0, 1.0, 1.5)]


@pytest.mark.parametrize("sizes", SIZES)
def test_no_wall_is_thinner_than_asked_for(sizes):
    dimensions = Dimensions(*sizes)
    wall = dimensions.wall - 1e-12
    assert dimensions.hinge_radius - dimensions.bore_radius >= wall
    assert dimensions.hinge_radius - dimensions.cap_bore_radius >= wall
    assert 2 * dimensions.pin_radius >= wall
    assert 2 * dimensions.rod_radius >= wall
    end_of_cap = dimensions.hinge_radius * math.sin(math.radians(45))
    assert end_of_cap >= wall


@pytest.mark.parametrize("sizes", SIZES)
def test_what_turns_has_the_play_in_all_directions(sizes):
    dimensions = Dimensions(*sizes)
    assert dimensions.bore_radius - dimensions.pin_radius == pytest.approx(sizes[1])
    between_eyes = 2 * dimensions.step - dimensions.eye_height
    assert between_eyes == pytest.approx(sizes[1])
    outer_face = dimensions.step + dimensions.eye_height / 2
    assert -dimensions.bottom - outer_face == pytest.approx(sizes[1])
    assert dimensions.rod_radius < dimensions.eye_height / 2
    assert dimensions.arm - dimensions.elbow_radius > dimensions.hinge_radius


@pytest.mark.parametrize(
    ("sizes", "name"),
    [
        ((0.0, 0.3, 1.2), "diameter"),
        ((-1.0, 0.3, 1.2), "diameter"),
        ((math.nan, 0.3, 1.2), "diameter"),
        ((2.3, 0.3, 1.2), "diameter"),
        ((6.0, 0.0, 1.2), "play"),
        ((6.0, math.inf, 1.2), "play"),
        ((6.0, 0.3, 0.0), "wall"),
    ],
)
def test_what_cannot_be_printed_is_refused_by_name(sizes, name):
    with pytest.raises(GeometryError, match=name):
        Dimensions(*sizes)
