"""Mechanisms that the literature holds up as hard: their forms and the half-branches at their singular points."""

import numpy as np
import pytest

from bifurc.explore import explore
from bifurc.problem import FunctionProblem
from bifurc.singular import Kind
from linkages.closure import LoopClosure
from linkages.loop import Loop


def test_cyclohexane_has_one_flexible_form_and_two_rigid_chairs():
    # six equal bonds at the tetrahedral angle, each the axis of a joint: a line-symmetric octahedral linkage of Bricard
    twist = np.arccos(1 / 3)
    atlas = explore(LoopClosure(Loop((0,) * 6, (twist,) * 6, (1,) * 6, "cyclohexane")), starts=300, prove=True)
    assert len(atlas.forms) == 1
    assert atlas.forms[0].branch.closed
    assert not atlas.points
    assert atlas.completeness.level == "proved"
    chairs = sorted(np.degrees(theta).tolist() for theta in atlas.rigid)
    np.testing.assert_allclose(chairs, [[-60, 60] * 3, [60, -60] * 3], atol=1e-9)


def test_a_flat_folding_vertex_has_four_half_branches_flat_and_folded():
    # sectors of 60, 90, 120 and 90 degrees: opposite ones make 180 degrees, so that it folds flat (Kawasaki)
    sectors = tuple(np.radians([60.0, 90.0, 120.0, 90.0]))
    atlas = explore(LoopClosure(Loop((0,) * 4, sectors, (0,) * 4, "vertex of four creases")), prove=True)
    assert len(atlas.forms) == 2
    assert [p.kind for p in atlas.points] == [Kind.BIFURCATION] * 2
    assert [len(p.point.half_branches) for p in atlas.points] == [4, 4]
    flat, folded = sorted((p.point.u for p in atlas.points), key=lambda u: float(np.abs(u).max()))
    np.testing.assert_allclose(flat, 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(folded), np.pi, atol=1e-12)


ARM, COUPLER, APART = 1.0, 0.2, 3.0  # of a Watt linkage the arms and half of the coupler; of the two linkages
MIDDLE = np.array([0.0, COUPLER, 0.0, -COUPLER, APART, COUPLER, APART, -COUPLER])


def double_watt(u):
    """Two Watt linkages, mirror images, whose middles are joined by a bar (Connelly and Servatius 1994)."""
    p, q, r, s = u.reshape(4, 2)
    pivots = np.array([[-ARM, COUPLER], [ARM, -COUPLER], [APART + ARM, COUPLER], [APART - ARM, -COUPLER]])
    bars = [
        (p, pivots[0], ARM), (p, q, 2 * COUPLER), (q, pivots[1], ARM), (r, pivots[2], ARM), (r, s, 2 * COUPLER),
        (s, pivots[3], ARM), ((p + q) / 2, (r + s) / 2, APART),
    ]  # fmt: skip
    return np.array([(a - b) @ (a - b) - length**2 for a, b, length in bars])


@pytest.mark.parametrize("seed", range(2))
def test_the_double_watt_mechanism_has_a_cusp_in_the_middle(seed):
    # the middles leave the vertical as t^5 / (8 COUPLER ARM^3), so that their heights differ by the root of t^5
    problem = FunctionProblem(double_watt, [(x - 2, x + 2) for x in MIDDLE])
    atlas = explore(problem, starts=60, seed=seed)
    assert len(atlas.points) == 1
    point = atlas.points[0]
    assert point.kind is Kind.CUSP
    assert np.linalg.norm(point.point.u - MIDDLE) < max(1e-4, point.point.error)
    assert len(point.point.half_branches) == 2
    assert point.point.half_branches[0] @ point.point.half_branches[1] > 0.99
