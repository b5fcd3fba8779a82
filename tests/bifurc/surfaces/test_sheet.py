"""Sheets are followed over a tangent plane, however near others lie."""

import numpy as np
import pytest

from bifurc.surfaces.other_sheets import solutions_across
from bifurc.surfaces.sheet import follow_sheets
from tests.bifurc.known_surfaces import SPHERE, spheres

ANGLES = np.arange(8) * np.pi / 4
RIM = 0.5 * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
PLANES = np.tile(np.eye(3)[:, :2], (8, 1, 1))


@pytest.mark.parametrize("gap", [0.3, 0.125, 1e-2, 1e-4, 1e-5])
@pytest.mark.parametrize("is_outer", [False, True])
def test_a_sheet_is_followed_beside_another_one(gap: float, is_outer: bool) -> None:
    # with a gap of 0.125 the inner sphere's tangent plane meets the outer one at 0.5
    problem = spheres(np.zeros(3), 1.0, np.zeros(3), 1.0 + gap)
    radius = 1.0 + gap * is_outer
    centers = np.tile([0.0, 0.0, radius], (8, 1))
    points, are_reached = follow_sheets(problem, centers, PLANES, RIM)
    assert are_reached.all()
    assert np.abs(points[:, :2] - RIM).max() < 1e-12
    # rounding of the product, over the gap
    error = np.abs(np.linalg.norm(points, axis=1) - radius).max()
    assert error < 1e-15 / gap


def test_a_ray_ends_where_the_sheet_is_upright() -> None:
    centers = np.array([[0.0, 0.0, 1.0]])
    beyond = np.array([[1.2, 0.0]])
    points, are_reached = follow_sheets(SPHERE, centers, PLANES[:1], beyond)
    assert not are_reached[0]
    assert abs(np.linalg.norm(points[0]) - 1.0) < 1e-9


@pytest.mark.parametrize("gap", [0.1, 1e-3, 1e-5])
def test_the_other_sheet_is_seen_from_both_sides(gap: float) -> None:
    problem = spheres(np.zeros(3), 1.0, np.zeros(3), 1.0 + gap)
    centers = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0 + gap]])
    seen = solutions_across(problem, centers, PLANES[:2], np.array([0.2, 0.2])).points
    heights = np.sort(seen[:, 2])
    assert np.abs(heights - [1.0, 1.0 + gap]).max() < 1e-15 / gap
