"""What meets at a singular point."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from linkages.linkage import load
from linkages.mapping import map_linkage

BOX = [(-1.0, 1.0)] * 2


@pytest.mark.parametrize(
    "name", ["double-subtractive-goldberg", "double-subtractive-goldberg-type-i"]
)
def test_tangents_at_a_bifurcation_are_as_exact_as_the_point(name):
    atlas = map_linkage(load(name))
    assert len(atlas.bifurcations) == 4
    for bifurcation in atlas.bifurcations:
        exact = bifurcation.point.tangents
        cosines = np.abs(bifurcation.tangents @ exact.T)
        assert np.sort(cosines.max(axis=1)) == pytest.approx([1.0, 1.0], abs=1e-15)
        for (form, s), tangent in zip(
            bifurcation.passes, bifurcation.tangents, strict=True
        ):
            nearest = exact[np.argmax(np.abs(exact @ tangent))]
            assert np.abs(np.abs(tangent) - np.abs(nearest)).max() < 1e-15
            # it runs the way of the form
            assert tangent @ atlas.forms[form].branch(s, 1) > 1.0 - 1e-9


def test_where_second_order_gives_no_tangents_those_of_the_forms_are_taken():
    touching = FunctionProblem(lambda u: [u[1] * (u[1] - u[0] ** 2)], BOX)
    (point,) = explore(touching).bifurcations
    assert not len(point.point.tangents)
    assert np.abs(point.tangents) == pytest.approx(
        np.array([[1.0, 0.0], [1.0, 0.0]]), abs=1e-6
    )


def test_a_curve_beside_a_contact_of_high_order_does_not_pass_it():
    problem = FunctionProblem(lambda u: [(u[1] ** 2 - u[0] ** 8) * (u[1] - 0.05)], BOX)
    atlas = explore(problem)
    assert len(atlas.forms) == 3
    sizes = [len(point.passes) for point in atlas.bifurcations]
    assert sizes == [2, 2, 2]
    assert not any(point.note for point in atlas.points)
