"""The sentence on what a mechanism is, where its limits keep everything out."""

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.app.answer.verdict import judge
from linkages.app.exit_codes import ExitCode
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.beyond_limits import LimitedRange
from linkages.readout.ranges import VariableRange
from tests.maps import map_of

FEW = SearchSettings(starts=40)
UPWARDS = (0.0, 0.0, 1.0)


def slider_crank(crank=None, slide=None, height=2.5):
    """A crank of length 1, a rod of length 3, and a slide so high above the crank's
    axis: the crank turns to and fro where that is more than 2."""
    reach = 1.0 + np.sqrt(3.0**2 - height**2)
    joints = (
        Joint("A", "revolute", ("f", "c"), (0, 0, 0), UPWARDS, limits=(crank,)),
        Joint("B", "revolute", ("c", "r"), (1, 0, 0), UPWARDS),
        Joint("C", "revolute", ("r", "s"), (reach, height, 0), UPWARDS),
        Joint("D", "prismatic", ("f", "s"), None, (1, 0, 0), limits=(slide,)),
    )
    return Mechanism(joints, "slider-crank")


def verdict_of(mechanism):
    return judge(map_of(mechanism, settings=FEW))


def test_limits_of_a_turn_that_keep_everything_out_are_said():
    # sin A is 2.5 - 3 at least
    verdict = verdict_of(slider_crank(crank=tuple(np.radians((220.0, 320.0)))))
    assert verdict.code is ExitCode.DOES_NOT_MOVE
    assert verdict.sentence == (
        "The linkage has no real configuration within its limits. Without them it "
        "closes with A from -30.00 to 210.00 (limits: 220.00 to 320.00)."
    )


def test_limits_of_a_slide_that_keep_everything_out_are_said():
    verdict = verdict_of(slider_crank(slide=(50.0, 60.0), height=0.5))
    assert verdict.code is ExitCode.DOES_NOT_MOVE
    assert "closes with D from " in verdict.sentence
    assert "(limits: 50 to 60)" in verdict.sentence


def test_of_limits_that_exclude_each_other_both_are_said():
    crank = tuple(np.radians((80.0, 100.0)))
    verdict = verdict_of(slider_crank(crank=crank, slide=(1.5, 3.0), height=0.5))
    assert "closes with A at all angles (limits: 80.00 to 100.00)" in verdict.sentence
    assert ", D from " in verdict.sentence


def test_of_limits_each_within_its_range_only_what_was_found_is_said():
    crank = tuple(np.radians((80.0, 100.0)))
    verdict = verdict_of(slider_crank(crank=crank, slide=(-0.2, 0.0), height=0.5))
    assert verdict.code is ExitCode.DOES_NOT_MOVE
    assert verdict.sentence.startswith(
        "No configuration of the linkage was found within its limits (estimated). "
        "Without them it closes with A at all angles (limits: 80.00 to 100.00)"
    )


@pytest.mark.parametrize(
    ("limits", "range_", "meets"),
    [
        ((200.0, 220.0), (-170.0, -150.0), True),
        ((200.0, 220.0), (-130.0, -120.0), False),
        ((-30.0, 30.0), (340.0, 350.0), True),
        ((-720.0, -700.0), (10.0, 30.0), True),
        ((40.0, 50.0), (0.0, 39.0), False),
    ],
)
def test_limits_and_ranges_of_angles_meet_up_to_whole_turns(limits, range_, meets):
    limited = LimitedRange(
        "A",
        True,
        tuple(np.radians(limits)),
        (VariableRange("A", *np.radians(range_), 0),),
    )
    assert limited.meets_limits is meets


def test_a_singular_point_between_limits_next_to_it_is_no_open_loop():
    places = [(0, 0, 0), (1, 0, 0), (3, 0, 0), (2, 0, 0)]
    bodies = ["f", "a", "b", "c", "f"]
    limits = [((-1e-6, 1e-6),), (None,), (None,), (None,)]
    joints = [
        Joint(
            f"J{k}", "revolute", (bodies[k], bodies[k + 1]), place, UPWARDS, limits=own
        )
        for k, (place, own) in enumerate(zip(places, limits, strict=True))
    ]
    verdict = verdict_of(Mechanism(tuple(joints), "parallelogram, folded flat"))
    assert "no real configuration" not in verdict.sentence
    assert "closes at 1 singular point; whether it moves" in verdict.sentence
    assert verdict.code is ExitCode.NOTHING_KNOWN


@pytest.mark.parametrize("limits", [None, (-1.0, 1.0)])
def test_what_never_closes_stays_open(limits):
    joints = list(slider_crank(height=2.5).joints)
    joints[0] = Joint("A", "revolute", ("f", "c"), (0, 0, 0), UPWARDS, limits=(limits,))
    joints[3] = Joint("D", "prismatic", ("f", "s"), None, (1, 0, 0), locked=(50.0,))
    verdict = verdict_of(Mechanism(tuple(joints), "open"))
    assert verdict.code is ExitCode.DOES_NOT_MOVE
    assert "its loop stays open by" in verdict.sentence
