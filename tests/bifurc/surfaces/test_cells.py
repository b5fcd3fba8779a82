"""Cells of charts in tangent planes, cut by lines and planes."""

import numpy as np
import pytest

import bifurc
from bifurc.numerics.corrector import compiled_equations
from bifurc.surfaces.covering import COVERS
from bifurc.surfaces.polygon import Polygon

OUTLINE = -1  # label of what nothing has cut


def cover_with_a_chart(dimension, radius, cuts=()):
    """A cover of a plane by a single chart, cut by some (normal, offset, label)."""
    n = dimension + 1
    names = dict.fromkeys("abcdef"[:n], (-9.0, 9.0))
    problem = bifurc.FunctionProblem(lambda u: [u[dimension]], names)
    cover = COVERS[dimension](
        compiled_equations(problem),
        problem.domain.scale,
        problem.domain.periods,
        problem.domain.bounds,
        agree=0.8,
        smooth=0.8,
        largest=radius,
        smallest=0.1 * radius,
        bend=0.2,
        flat=0.9,
        negligible=1e-9,
    )
    normals = np.array([normal for normal, _, _ in cuts], dtype=float)
    cover.add(
        np.zeros(n),
        np.ascontiguousarray(np.eye(n)[:, :dimension]),
        radius,
        is_clear=True,
        height=0.0,
        normals=normals.reshape(-1, dimension),
        offsets=np.array([offset for _, offset, _ in cuts], dtype=float),
        labels=np.array([label for _, _, label in cuts], dtype=int),
    )
    return cover


def polygon_of(radius, cuts=()):
    return Polygon(*cover_with_a_chart(2, radius, cuts).polygon(0))


def area(polygon: Polygon) -> float:
    x, y = polygon.vertices.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def test_the_octagon_touches_its_circle_and_nothing_has_cut_it() -> None:
    polygon = polygon_of(2.0)
    middles = 0.5 * (polygon.vertices + np.roll(polygon.vertices, -1, axis=0))
    assert np.linalg.norm(middles, axis=1) == pytest.approx(2.0)
    assert set(polygon.labels.tolist()) == {OUTLINE}


def test_a_cut_through_the_middle_leaves_half_and_labels_its_edge() -> None:
    half = polygon_of(1.0, [((1.0, 0.0), 0.0, 7)])
    assert area(half) == pytest.approx(0.5 * area(polygon_of(1.0)))
    assert np.count_nonzero(half.labels == 7) == 1
    cut = int(np.flatnonzero(half.labels == 7)[0])
    ends = half.vertices[[cut, (cut + 1) % len(half.vertices)]]
    assert ends[:, 0] == pytest.approx(0.0, abs=1e-15)


def test_a_line_that_misses_the_polygon_leaves_it_and_one_beyond_it_nothing() -> None:
    whole = polygon_of(1.0, [((1.0, 0.0), 2.0, 7)])
    assert np.array_equal(whole.vertices, polygon_of(1.0).vertices)
    nothing = [((1.0, 0.0), -2.0, 7), ((1.0, 0.0), 0.0, 8)]
    assert len(polygon_of(1.0, nothing).vertices) == 0


@pytest.mark.parametrize("dimension", [3, 4, 5])
def test_a_cell_is_closed_when_planes_all_around_touch_a_smaller_ball(
    dimension: int,
) -> None:
    normals = np.random.default_rng(0).normal(size=(40 * dimension, dimension))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    cuts = [(normal, 0.3, label) for label, normal in enumerate(normals)]
    one_side = [cut for cut in cuts if cut[0][0] > 0.0]
    closed, opened = (cover_with_a_chart(dimension, 1.0, c) for c in (cuts, one_side))
    # a plane that touches the ball touches the cell, which all others leave around it
    assert closed.facets(0).tolist() == list(range(len(cuts)))
    labels = [label for _, _, label in one_side]
    assert opened.facets(0).tolist() == [OUTLINE, *labels]
    assert len(closed) == 1 and closed.grow(9, 0, 9.0)[0].name == "COMPLETE"
    assert len(closed) == 1 and opened.grow(9, 0, 9.0)[0].name == "CHART_LIMIT"


@pytest.mark.parametrize("dimension", [3, 4, 5])
def test_a_plane_beyond_a_cell_leaves_it_and_one_behind_it_nothing(
    dimension: int,
) -> None:
    normal = np.ones(dimension) / np.sqrt(dimension)
    assert cover_with_a_chart(dimension, 1.0, [(normal, 9.0, 7)]).facets(0) == [OUTLINE]
    assert not len(cover_with_a_chart(dimension, 1.0, [(normal, -9.0, 7)]).facets(0))
