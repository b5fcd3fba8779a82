"""Shortest paths on surfaces whose geodesics are known."""

import numpy as np
import pytest

from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.geodesic import SurfacePathError, path_length, shortest_path
from tests.bifurc.known_surfaces import SPHERE, union


def chords(path: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.diff(path, axis=0), axis=1)


def test_a_path_on_the_sphere_is_a_great_circle(sphere_charts: ChartAtlas) -> None:
    start, goal = np.array([0.0, 0.0, 1.0]), np.array([0.6, 0.8, 0.0])
    path = shortest_path(SPHERE, sphere_charts, start, goal, 0.05)
    assert np.array_equal(path[0], start)
    assert np.allclose(path[-1], goal)
    assert np.abs(np.linalg.norm(path, axis=1) - 1).max() < 1e-12
    assert chords(path).sum() == pytest.approx(np.pi / 2, rel=1e-3)
    assert chords(path).max() < 0.06
    assert path_length(path) == pytest.approx(np.pi / 2, rel=1e-6)
    off_plane = path @ np.cross(start, goal)
    assert np.abs(off_plane).max() < 1e-3


def test_around_the_waist_of_a_hyperboloid_the_way_is_a_circle() -> None:
    # on so strong a saddle pulling without a measured step would swing from side to
    # side
    problem = union(
        lambda x, y, z: np.array([4 * x * x + 4 * y * y - 4 * z * z - 1]), size=0.7
    )
    start, goal = np.array([0.5, 0.0, 0.0]), np.array([-0.5, 0.0, 0.0])
    charts = cover_surface(problem, start[None])
    path = shortest_path(problem, charts, start, goal, 0.02)
    assert np.abs(path[:, 2]).max() < 1e-4
    assert np.abs(problem.residuals(path)).max() < 1e-12
    assert chords(path).sum() == pytest.approx(0.5 * np.pi, rel=1e-4)


def test_an_end_outside_the_charts_is_named(sphere_charts: ChartAtlas) -> None:
    start = np.array([0.0, 0.0, 1.0])
    with pytest.raises(SurfacePathError, match="goal lies in no chart"):
        shortest_path(SPHERE, sphere_charts, start, 2 * start, 0.1)
    with pytest.raises(SurfacePathError, match="start lies in no chart"):
        shortest_path(SPHERE, sphere_charts, 2 * start, start, 0.1)
