"""A search ends soon after its budget, whatever it does then."""

import pytest

from bifurc.limits import Deadline, TimeOver, check_time, ending_in_time, has_to_end


def test_a_block_ends_where_its_time_is_over():
    reached = []
    with ending_in_time(Deadline(0.0)):
        reached.append("begin")
        check_time()
        reached.append("end")
    assert reached == ["begin"]
    check_time()  # outside of a block nothing ends


def test_an_inner_block_ends_with_the_time_of_the_outer_one():
    with ending_in_time(Deadline(0.0)):
        with ending_in_time(Deadline(60.0)):
            check_time()
            pytest.fail("the outer time was over")
        assert has_to_end()
        with pytest.raises(TimeOver):
            check_time()


def test_without_a_budget_nothing_has_to_end():
    assert not has_to_end()
    with ending_in_time(Deadline()):
        assert not has_to_end()


def test_a_share_of_a_deadline_is_over_before_it():
    whole = Deadline(100.0)
    part = whole.share(0.25)
    assert 20.0 < part.left <= 25.0
    assert Deadline().share(0.25).left == float("inf")
