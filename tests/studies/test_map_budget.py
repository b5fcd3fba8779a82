"""Where the time of a map goes adds up to the map."""

import numpy as np
import pytest

from linkages.linkage import load
from studies.map_budget import STEPS, budget, series_operations


def test_the_steps_and_the_rest_make_up_the_map():
    shares = budget(load("special-double-subtractive-goldberg"), maps=3)
    assert sum(share.share for share in shares) == pytest.approx(1.0)
    assert len(shares) == len(STEPS) + 1
    assert shares[-1].step == "the rest"
    assert shares[-1].share < 0.2
    # a function that was renamed would take no time
    assert [share.step for share in shares if share.seconds <= 0.0] == []


def test_operations_of_a_series_grow_with_the_square_of_its_order():
    ratio = series_operations(6, 32) / series_operations(6, 16)
    assert np.isclose(ratio, 4.0, rtol=0.1)
