"""Forms of mechanisms with many loops."""

import pytest

from studies.many_loops import cost_of_form


@pytest.mark.parametrize(
    ("family", "side", "unknowns", "pieces"),
    [("Miura-ori", 7, 112, 30), ("Bennett lattice", 5, 76, 35)],
)
def test_a_form_of_many_loops_closes_to_rounding_all_along(
    family, side, unknowns, pieces
):
    cost = cost_of_form(family, side)
    assert (cost.loops, cost.unknowns) == (side * side, unknowns)
    assert cost.error < 1e-12
    assert cost.pieces < pieces
