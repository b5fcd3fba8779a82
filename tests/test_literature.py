"""Mechanisms that the literature holds up as hard: their forms and the half-branches at
their singular points."""

from collections import Counter

import numpy as np
import pytest
from scipy.spatial import Delaunay

from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import LocatedPoint
from bifurc.singular.point import Kind
from bifurc.system import jacobian_at
from linkages.closure.closure import Closure
from linkages.files.fold import mechanism_of_fold
from linkages.loop import Loop
from tests.bifurc.known_curves import double_watt
from tests.maps import map_of
from tests.samples import one_in


def test_cyclohexane_has_one_flexible_form_and_two_rigid_chairs():
    # six equal bonds at the tetrahedral angle, each the axis of a joint: a
    # line-symmetric octahedral linkage of Bricard
    twist = np.arccos(1 / 3)
    atlas = explore(
        Closure(Loop((0,) * 6, (twist,) * 6, (1,) * 6, "cyclohexane")),
        settings=SearchSettings(starts=300, count=True),
    )
    assert len(atlas.forms) == 1
    assert atlas.forms[0].branch.closed
    assert not atlas.points
    assert atlas.completeness.level == "counted"
    chairs = sorted(np.degrees(theta).tolist() for theta in atlas.rigid)
    np.testing.assert_allclose(chairs, [[-60, 60] * 3, [60, -60] * 3], atol=1e-9)


def test_a_flat_folding_vertex_has_four_half_branches_flat_and_folded():
    # sectors of 60, 90, 120 and 90 degrees: opposite ones make 180 degrees, so that it
    # folds flat (Kawasaki)
    sectors = tuple(np.radians([60.0, 90.0, 120.0, 90.0]))
    atlas = explore(
        Closure(Loop((0,) * 4, sectors, (0,) * 4, "vertex of four creases")),
        settings=SearchSettings(count=True),
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


def triangulated(rng, vertices):
    """Places of the corners of a quadrangle and of inner vertices of four triangles or
    more, and the triangles (t, 3) between them."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    while True:
        corners = square + rng.uniform(-0.15, 0.15, size=(4, 2))
        inner = rng.uniform(0.15, 0.85, size=(vertices, 2))
        mesh = Delaunay(np.concatenate([corners, inner]))
        first, second, third = mesh.points[mesh.simplices].transpose(1, 2, 0)
        (a, b), (c, d) = second - first, third - first
        shapes = (a * d - b * c) / np.maximum(a**2 + b**2, c**2 + d**2)
        degrees = np.bincount(mesh.simplices.ravel())[4:]
        if len(mesh.convex_hull) == 4 and degrees.min() > 3 and shapes.min() > 0.15:
            return mesh.points, mesh.simplices


def pops_up(points, joints, vertex, folds):
    """Whether a vertex goes up (h,) as creases fold by small ``folds`` (h, j): on which
    side of the cone of its folds these are, beside those of a vertex that is lifted."""
    ends = [[int(end) for end in joint.name.split("-")] for joint in joints]
    others = {k: sum(pair) - vertex for k, pair in enumerate(ends) if vertex in pair}
    arms = {k: points[other] - points[vertex] for k, other in others.items()}
    order = sorted(arms, key=lambda k: np.arctan2(*arms[k][::-1]))
    spokes = np.array([arms[k] for k in order])
    d = spokes / np.linalg.norm(spokes, axis=1)[:, None]
    sides = np.stack([spokes, np.roll(spokes, -1, axis=0)], axis=1)
    slopes = np.linalg.solve(sides, -np.ones((len(d), 2, 1)))[:, :, 0]
    across = d[:, ::-1] * [-1.0, 1.0]
    lifted = np.sum((slopes - np.roll(slopes, 1, axis=0)) * across, axis=1)
    form = np.triu(np.outer(d[:, 0], d[:, 1]) - np.outer(d[:, 1], d[:, 0]), 1)
    return folds[:, order] @ (form + form.T) @ lifted > 0.0


def flat_quadrangle(vertices, seed):
    """Places of the corners and inner vertices of one, the sheet, and its flat state as a
    singular point."""
    points, triangles = triangulated(np.random.default_rng(seed), vertices)
    content = {
        "vertices_coords": points.tolist(),
        "faces_vertices": triangles.tolist(),
    }
    sheet = mechanism_of_fold(content, "sheet")
    problem = Closure(sheet)
    flat = np.zeros(problem.n)
    null_space = np.linalg.svd(jacobian_at(problem, flat))[2][2 * vertices :].T
    point = classify_singular_point(problem, LocatedPoint(flat, null_space, 1e-14))
    return points, sheet, point


@pytest.mark.parametrize("seed", one_in(5, range(5)))
@pytest.mark.parametrize("vertices", [1, 2, 3, 4, 5])
def test_a_triangulated_quadrangle_leaves_the_flat_state_as_its_vertices_pop(
    vertices, seed
):
    """Twice for each choice of up and down: 2^v branches (Chen and Santangelo 2018)."""
    points, sheet, point = flat_quadrangle(vertices, seed)
    assert point.is_clear
    assert point.dimension == 1
    ups = [
        pops_up(points, sheet.joints, vertex, point.half_branches)
        for vertex in range(4, vertices + 4)
    ]
    ways = Counter(map(tuple, np.transpose(ups).tolist()))
    assert list(ways.values()) == [2] * 2**vertices


def test_branches_of_a_sheet_that_are_not_told_apart_put_its_flat_state_in_doubt():
    """Two of the 64 half-branches leave within 1e-4 of two others."""
    _, _, point = flat_quadrangle(5, 36)
    assert len(point.half_branches) == 62
    assert not point.is_clear


def vertex_of_sectors(sectors):
    """A vertex with creases between sectors (k,) (rad), as a mechanism."""
    turns = np.cumsum(sectors)
    count = len(turns)
    rim = np.transpose([np.cos(turns), np.sin(turns)]).tolist()
    faces = [[0, 1 + k, 1 + (k + 1) % count] for k in range(count)]
    content = {"vertices_coords": [[0.0, 0.0], *rim], "faces_vertices": faces}
    return mechanism_of_fold(content, "vertex")


def test_a_vertex_of_six_equal_sectors_has_the_threefold_motion_of_the_formula():
    """By turns creases fold by half-angle tangents x and y with
    3 x^2 y^2 = x^2 + 4 x y + y^2."""
    problem = Closure(vertex_of_sectors(np.full(6, np.pi / 3)))
    for x in np.linspace(0.7, 4.0, 8):
        for y in np.roots([3 * x**2 - 1, -4 * x, -(x**2)]):
            folds = 2 * np.arctan(np.tile([x, y], 3))
            assert np.abs(problem.residuals(folds[None])).max() < 1e-14
            folds[::2] += 0.01
            assert np.abs(problem.residuals(folds[None])).max() > 1e-4


@pytest.mark.parametrize("seed", range(3))
def test_folds_about_a_flat_foldable_vertex_of_four_keep_their_ratio(seed):
    """Of half-angle tangents, of a crease between sectors s and t over that beyond s
    (Evans, Lang, Magleby and Howell 2015)."""
    s, t = np.random.default_rng(seed).uniform(0.5, 2.5, size=2)
    atlas = map_of(vertex_of_sectors([np.pi - t, s, t, np.pi - s]))
    ratios = []
    for form in atlas.forms:
        inside = np.linspace(0.3, form.branch.length - 0.3, 20)
        tangents = np.tan(form.branch(inside) / 2)
        ratio = tangents[:, 1] / tangents[:, 0]
        np.testing.assert_allclose(ratio, ratio[0], rtol=1e-11)
        ratios.append(ratio[0])
    expected = [
        -np.cos((s + t) / 2) / np.cos((s - t) / 2),
        np.sin((s + t) / 2) / np.sin((s - t) / 2),
    ]
    np.testing.assert_allclose(sorted(ratios), sorted(expected), rtol=1e-12)
