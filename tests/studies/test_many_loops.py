"""Forms of mechanisms with many loops."""

from studies.many_loops import cost_of_sheet


def test_a_form_of_49_loops_closes_to_rounding_all_along():
    cost = cost_of_sheet(7)
    assert (cost.loops, cost.unknowns) == (49, 112)
    assert cost.error < 1e-12
