"""Ranges of joint variables along forms: which whole turns they have."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.ranges import variable_ranges
from linkages.readout.readout import Readout
from tests.maps import map_of

FEW = SearchSettings(starts=40)
UPWARDS = (0.0, 0.0, 1.0)


def screw_jack(limits):
    """A screw, a jaw that the nut turns against, and a guide."""
    return Mechanism(
        (
            Joint(
                "A",
                "helical",
                ("frame", "nut"),
                (0, 0, 0),
                UPWARDS,
                pitch=1.0,
                limits=limits,
            ),
            Joint("B", "revolute", ("nut", "jaw"), (0, 0, 2), UPWARDS),
            Joint("D", "prismatic", ("frame", "jaw"), None, UPWARDS),
        )
    )


def four_bar(limits=None):
    points = [(0, 0, 0), (1, 1, 0), (3, 1, 0), (3, 0, 0)]
    bodies = ["frame", "a", "b", "c", "frame"]
    joints = [
        Joint(f"J{k}", "revolute", (bodies[k], bodies[k + 1]), point, UPWARDS)
        for k, point in enumerate(points)
    ]
    joints[0] = replace(joints[0], limits=(limits,))
    return Mechanism(tuple(joints))


def ranges_of(mechanism):
    """The ranges in degrees of every form, by label."""
    atlas = map_of(mechanism, settings=FEW)
    readout = Readout(mechanism)
    forms = []
    for form in atlas.forms:
        points = form.branch(np.linspace(0.0, form.branch.length, 1001))
        ends = form.branch(np.array([0.0, form.branch.length]))
        points = np.concatenate([ends, points])
        found = variable_ranges(readout, form.branch, points)
        forms.append(
            {one.label: np.degrees([one.low, one.high]).round(2) for one in found}
        )
    return forms


@pytest.mark.parametrize("limits", [(0.0, 4 * np.pi), (-6 * np.pi, np.pi)])
def test_a_nut_turns_back_by_as_much_as_its_screw(limits):
    (form,) = ranges_of(screw_jack((limits,)))
    low, high = np.degrees(limits)
    np.testing.assert_allclose(form["A"], [low, high], atol=0.01)
    np.testing.assert_allclose(form["B"], [-high, -low], atol=0.01)


def test_angles_of_a_form_through_the_reference_are_0_there():
    for form in ranges_of(four_bar((-1.0, 1.0))):
        low, high = np.array(list(form.values())).T
        assert np.all(low <= 0.01)
        assert np.all(high >= -0.01)
        if low[0] < 0.0 < high[0]:
            break
    else:
        pytest.fail("no form passes the reference configuration")


def test_ranges_of_a_loop_do_not_hang_on_its_unit():
    ranges = ranges_of(four_bar())
    for factor in (1e-4, 30.0):
        scaled = ranges_of(four_bar().scaled(factor))
        for form, other in zip(ranges, scaled, strict=True):
            for label, pair in form.items():
                np.testing.assert_allclose(pair, other[label], atol=0.02)


@pytest.mark.parametrize("width", [3e-4, 1e-5, 1e-8])
def test_both_forms_of_a_four_bar_are_found_between_narrow_limits(width):
    mechanism = four_bar((0.3, 0.3 + width))
    atlas = map_of(mechanism, settings=FEW)
    assert len(atlas.forms) == 2
    assert len(atlas.points) + len(atlas.rigid) == 0
    assert atlas.completeness.level.value == "certified"
    for form in atlas.forms:
        ends = form.branch(np.array([0.0, form.branch.length]))
        assert np.abs(ends[1] - ends[0]).max() > 0.99 * width
        assert form.rank == 3


def test_limits_beyond_a_turn_have_the_other_angles_on_both_sides():
    crank = Joint(
        "A",
        "revolute",
        ("frame", "crank"),
        (0, 0, 0),
        UPWARDS,
        limits=((-7.0, 7.0),),
    )
    mechanism = Mechanism(
        (
            crank,
            Joint("B", "revolute", ("crank", "rod"), (0.6, 0.8, 0), UPWARDS),
            Joint("C", "revolute", ("rod", "slider"), (3, 0, 0), UPWARDS),
            Joint("D", "prismatic", ("frame", "slider"), None, (1, 0, 0)),
        )
    )
    first, second = ranges_of(mechanism)
    through_reference, other = sorted((first, second), key=lambda form: -form["D"][1])
    low, high = through_reference["B"]
    assert low < -360.0
    assert high > 360.0
    for pair in (other["B"], other["C"]):
        assert -180.0 < pair.mean() <= 180.0
