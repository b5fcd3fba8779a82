import math

import pytest

from linkages.catalogue import entry
from linkages.families.wohlhart import wohlhart_symmetric
from linkages.values import GeometryError


def test_twists_alternate_and_add_up_to_full_turns():
    loop = wohlhart_symmetric(2.0, 1.0)
    assert loop.twists == pytest.approx((1.0, 2 * math.pi - 1.0) * 3)
    assert loop.lengths == (2.0,) * 6


def test_a_twist_in_degrees_is_refused():
    with pytest.raises(GeometryError, match="twist alpha"):
        wohlhart_symmetric(1.0, 90.0)


def test_the_input_angle_of_the_right_angled_mechanism_stays_within_120_degrees(
    trace_form, reference_cases
):
    case = next(
        c
        for c in reference_cases
        if c["linkage"] == "wohlhart-symmetric" and not c["parameters"]
    )
    theta = trace_form(entry("wohlhart-symmetric").build(), case["forms"][0]["theta"])
    assert math.degrees(abs(theta).max()) == pytest.approx(120.0, abs=0.2)
