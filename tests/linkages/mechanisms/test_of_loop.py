"""Single loops as mechanisms."""

import pytest

from linkages.catalogue import entry
from linkages.mechanisms.of_loop import mechanism_of_loop
from tests.maps import map_of


@pytest.mark.parametrize("name", ["bennett", "special-double-subtractive-goldberg"])
def test_the_mechanism_of_a_loop_has_its_forms(name):
    of_loop = map_of(name)
    start = of_loop.forms[0].branch(0.0)
    mechanism = mechanism_of_loop(entry(name).build(), start)
    assert len(mechanism.bodies) == len(mechanism.joints) == len(start)
    atlas = map_of(mechanism)
    lengths = sorted(form.branch.length for form in of_loop.forms)
    assert sorted(form.branch.length for form in atlas.forms) == pytest.approx(lengths)
    assert len(atlas.bifurcations) == len(of_loop.bifurcations)
