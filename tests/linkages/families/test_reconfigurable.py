import math

import numpy as np
import pytest

from linkages.catalogue import entry
from linkages.families.reconfigurable import (
    reconfigurable_bricard_1,
    reconfigurable_bricard_2,
)
from linkages.values import GeometryError

DEFAULTS = entry("reconfigurable-bricard-1").defaults


def test_the_dependent_lengths_and_offsets_are_those_of_the_spatial_triangle():
    loop = reconfigurable_bricard_1(**DEFAULTS)
    assert loop.lengths[2] == pytest.approx(0.8774858674, abs=1e-10)
    assert loop.offsets[:3] == pytest.approx(
        (0.4380717773, 0.7, 0.2774192257), abs=1e-10
    )


def test_the_two_linkages_differ_by_a_half_turn_of_one_twist():
    first, second = (
        reconfigurable_bricard_1(**DEFAULTS),
        reconfigurable_bricard_2(**DEFAULTS),
    )
    assert second.lengths == first.lengths and second.offsets == first.offsets
    assert first.twists[2] - second.twists[2] == pytest.approx(math.pi, abs=1e-15)


def test_a_length_c_with_another_bennett_ratio_is_refused():
    c = reconfigurable_bricard_1(**DEFAULTS).lengths[2]
    with pytest.raises(
        GeometryError, match=r"link 34: sin\(twist\)/length.*off by 0\.000389"
    ):
        reconfigurable_bricard_1(**DEFAULTS, c=1.001 * c)


def test_a_kink_that_needs_a_negative_length_is_refused():
    with pytest.raises(GeometryError, match="twist of link 34"):
        reconfigurable_bricard_1(**{**DEFAULTS, "kink": -2.0, "r2": -3.0})


def test_the_bifurcations_follow_from_the_triangle_in_closed_form(closure_gap):
    """Joints 1 and 3 at the angles of the triangle, one of them turned by pi; rank 4,
    as Song's appendix C."""
    loop = reconfigurable_bricard_1(**DEFAULTS)
    alpha, beta, kink = (DEFAULTS[k] for k in ("alpha", "beta", "kink"))
    first = math.atan2(
        math.sin(beta) * math.sin(kink),
        -(
            math.cos(alpha) * math.sin(beta) * math.cos(kink)
            + math.sin(alpha) * math.cos(beta)
        ),
    )
    third = math.atan2(
        math.sin(alpha) * math.sin(kink),
        -(
            math.sin(alpha) * math.cos(beta) * math.cos(kink)
            + math.cos(alpha) * math.sin(beta)
        ),
    )
    for theta in ((first - math.pi, kink, third), (first, kink, third + math.pi)):
        configuration = np.tile(theta, 2)
        assert closure_gap(loop, configuration) < 1e-14
        sigma = np.linalg.svd(loop.joint_screws(configuration), compute_uv=False)
        assert np.count_nonzero(sigma > 1e-12) == 4
