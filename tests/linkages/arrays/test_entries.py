"""Arrays by name: their closed forms, their maps, and what is refused."""

import numpy as np
import pytest

import linkages
from linkages import Closure
from linkages.values import GeometryError

OPENED = np.radians([-40.0, 10.0, 40.0])  # of the angle between the rods of a unit


def turns(mechanism, by_kind):
    """The variables of all joints, by the first letters of their names."""
    return np.array([by_kind[joint.name[0]] for joint in mechanism.joints])


@pytest.mark.parametrize("units", [2, 5, 40])
@pytest.mark.parametrize("more", OPENED)
def test_all_units_of_scissors_open_by_the_same_angle(units, more):
    mechanism = linkages.load("scissors", units=units)
    point = turns(mechanism, {"P": -more, "U": -more, "L": more})
    # in lengths of up to 80 rods
    assert np.abs(Closure(mechanism).residuals(point[None])).max() < 1e-12


@pytest.mark.parametrize("units", [3, 6, 12])
@pytest.mark.parametrize("more", np.radians([-40.0, 5.0, 9.0]))
def test_a_ring_of_angulated_scissors_closes_at_every_angle(units, more):
    mechanism = linkages.load("angulated-scissors", units=units)
    for sense in (1.0, -1.0):
        point = turns(
            mechanism, {"P": sense * more, "O": -sense * more, "I": sense * more}
        )
        assert np.abs(Closure(mechanism).residuals(point[None])).max() < 1e-12


def test_a_rod_of_a_ring_has_two_arms_of_length_one_with_the_kink_of_its_unit():
    mechanism = linkages.load("angulated-scissors", units=5, angle=0.7)
    places = {joint.name: np.array(joint.point) for joint in mechanism.joints}
    arms = places["O1"] - places["P1"], places["I2"] - places["P1"]
    assert np.linalg.norm(arms, axis=1) == pytest.approx(1.0, abs=1e-14)
    kink = np.pi - np.arccos(arms[0] @ arms[1])
    assert kink == pytest.approx(2 * np.pi / 5, abs=1e-14)


def test_a_rhombus_of_three_scissors_is_open_or_folded():
    """Each of the two rhombi between three units turns all along, or stays folded."""
    atlas = linkages.map_linkage(linkages.load("scissors", units=3))
    assert len(atlas.forms) == 2**2
    assert [surface.dimension for surface in atlas.surfaces] == [2]


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (1, 3), (2, 2)])
def test_a_locked_array_of_bennett_loops_moves_with_one_freedom(rows, columns):
    array = linkages.load("bennett-array", rows=rows, columns=columns)
    assert array.independent_loops >= rows * columns
    atlas = linkages.map_linkage(array)
    assert atlas.mobility == 1


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        (
            "scissors",
            {"units": 1},
            "units: 1 is not allowed; it must be a whole number",
        ),
        (
            "scissors",
            {"angle": 4.0},
            "angle: 229.183 is not allowed; it must be from 5",
        ),
        ("angulated-scissors", {"angle": 2.2}, "it must be less than 120 degrees"),
        (
            "angulated-scissors",
            {"angle": 2 * np.pi / 3},
            "must be less than 120 degrees",
        ),
        ("bennett-array", {"rows": 0.5}, "rows: 0.5 is not allowed"),
        (
            "bennett-array",
            {"alpha": 0.1},
            "alpha: 5.72958 is not allowed; it must be from",
        ),
    ],
)
def test_what_makes_no_array_is_named_in_one_line(name, values, words):
    with pytest.raises(GeometryError) as raised:
        linkages.load(name, **values)
    assert words in str(raised.value)
