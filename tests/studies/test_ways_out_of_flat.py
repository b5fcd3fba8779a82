"""The study of all ways out of the flat state."""

import pytest

from studies.ways_out_of_flat import FAMILIES, ways_out


@pytest.mark.parametrize("name", FAMILIES)
def test_every_way_is_traced_along_its_closed_form(name):
    found = ways_out(name, 1, 2)
    assert found.ways == found.expected == found.traced + found.on_surfaces
    # of residuals of 1e-13, next to the flat state, where F' loses rank
    assert found.error < 1e-9
    assert found.residual < 1e-13
