"""Mechanisms that the literature holds up as hard: their forms and the half-branches at
their singular points."""

import numpy as np
import pytest

from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import LocatedPoint
from bifurc.singular.point import Kind
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import Loop
from tests.bifurc.known_curves import double_watt


def test_cyclohexane_has_one_flexible_form_and_two_rigid_chairs():
    # six equal bonds at the tetrahedral angle, each the axis of a joint: a
    # line-symmetric octahedral linkage of Bricard
    twist = np.arccos(1 / 3)
    atlas = explore(
        LoopClosure(Loop((0,) * 6, (twist,) * 6, (1,) * 6, "cyclohexane")),
        settings=SearchSettings(starts=300, prove=True),
    )
    assert len(atlas.forms) == 1
    assert atlas.forms[0].branch.closed
    assert not atlas.points
    assert atlas.completeness.level == "proved"
    chairs = sorted(np.degrees(theta).tolist() for theta in atlas.rigid)
    np.testing.assert_allclose(chairs, [[-60, 60] * 3, [60, -60] * 3], atol=1e-9)


def test_a_flat_folding_vertex_has_four_half_branches_flat_and_folded():
    # sectors of 60, 90, 120 and 90 degrees: opposite ones make 180 degrees, so that it
    # folds flat (Kawasaki)
    sectors = tuple(np.radians([60.0, 90.0, 120.0, 90.0]))
    atlas = explore(
        LoopClosure(Loop((0,) * 4, sectors, (0,) * 4, "vertex of four creases")),
        settings=SearchSettings(prove=True),
    )
    assert len(atlas.forms) == 2
    assert [p.kind for p in atlas.points] == [Kind.BIFURCATION] * 2
    assert [len(p.point.half_branches) for p in atlas.points] == [4, 4]
    flat, folded = sorted(
        (p.point.u for p in atlas.points), key=lambda u: float(np.abs(u).max())
    )
    np.testing.assert_allclose(flat, 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(folded), np.pi, atol=1e-12)


@pytest.mark.parametrize("seed", range(2))
def test_the_double_watt_mechanism_has_a_cusp_in_the_middle(seed):
    # the middles leave the vertical as t^5 / (8 half arm^3), so that their heights
    # differ by the root of t^5
    problem, middle = double_watt(1.0, 0.2, 2.0)
    atlas = explore(problem, settings=SearchSettings(starts=60), seed=seed)
    assert len(atlas.points) == 1
    point = atlas.points[0]
    assert point.kind is Kind.CUSP
    assert np.linalg.norm(point.point.u - middle) < max(1e-4, point.point.error)
    assert len(point.point.half_branches) == 2
    assert point.point.half_branches[0] @ point.point.half_branches[1] > 0.99


def test_a_cusp_too_sharp_for_a_small_sphere_is_looked_at_on_a_larger_one():
    problem, middle = double_watt(2.0, 0.5, 0.8)
    null_space = np.linalg.svd(problem.jacobians(middle[None])[0])[2][6:].T
    point = classify_singular_point(problem, LocatedPoint(middle, null_space, 1e-14))
    assert point.kind is Kind.CUSP
    assert point.radius > 0.02 * problem.domain.scale
