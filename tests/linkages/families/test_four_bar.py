import pytest

from linkages.families.four_bar import (
    form_patterns,
    four_bar,
    kite,
    parallelogram,
    rhombus,
)
from linkages.values import GeometryError


def test_special_four_bars_have_their_lengths_in_loop_order():
    assert parallelogram(1, 2).lengths == (1, 2, 1, 2)
    assert rhombus(3).lengths == (3, 3, 3, 3)
    assert kite(1, 2).lengths == (1, 2, 2, 1)


def test_a_link_too_long_for_the_others_is_refused_with_the_excess():
    with pytest.raises(GeometryError, match=r"link 34.*too long by 0\.001"):
        four_bar(1.0, 2.0, 6.001, 3.0)


def test_a_length_of_zero_is_refused():
    with pytest.raises(GeometryError, match="link 23"):
        four_bar(1.0, 0.0, 1.0, 1.0)


def test_a_four_bar_without_equal_links_has_no_named_forms():
    assert form_patterns(1.0, 2.4, 2.0, 2.7) == ()
    assert [p.name for p in form_patterns(1.0, 1.0, 2.0, 2.0)] == [
        "folded form (joints 2,4 inactive)",
        "kite form",
    ]
