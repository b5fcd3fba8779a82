"""Polygons in tangent planes, cut by lines."""

import numpy as np
import pytest

from bifurc.surfaces.polygon import OUTLINE, Polygon, octagon

RIGHT = np.array([1.0, 0.0])


def area(polygon: Polygon) -> float:
    x, y = polygon.vertices.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def test_the_octagon_touches_its_circle_and_nothing_has_cut_it() -> None:
    polygon = octagon(2.0)
    middles = 0.5 * (polygon.vertices + np.roll(polygon.vertices, -1, axis=0))
    assert np.linalg.norm(middles, axis=1) == pytest.approx(2.0)
    assert set(polygon.labels.tolist()) == {OUTLINE}


def test_a_cut_through_the_middle_leaves_half_and_labels_its_edge() -> None:
    half = octagon(1.0).clip(RIGHT, 0.0, label=7)
    assert area(half) == pytest.approx(0.5 * area(octagon(1.0)))
    assert np.count_nonzero(half.labels == 7) == 1
    cut = int(np.flatnonzero(half.labels == 7)[0])
    ends = half.vertices[[cut, (cut + 1) % len(half.vertices)]]
    assert ends[:, 0] == pytest.approx(0.0, abs=1e-15)


def test_a_line_that_misses_the_polygon_leaves_it_and_one_beyond_it_nothing() -> None:
    polygon = octagon(1.0)
    whole = polygon.clip(RIGHT, 2.0, label=7)
    assert np.array_equal(whole.vertices, polygon.vertices)
    assert np.array_equal(whole.labels, polygon.labels)
    nothing = polygon.clip(RIGHT, -2.0, label=7)
    assert nothing.is_empty
    assert nothing.clip(RIGHT, 0.0, label=8).is_empty
