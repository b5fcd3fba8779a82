"""A configuration as lines and dots."""

import numpy as np
import pytest

from linkages.catalogue import entry
from linkages.scene import best_view, clearance, make_scene

THETA = np.array(
    [1.9647976316996774, -2.6592578491396988, -1.9647976316996774, 2.6592578491396988]
)
BENNETT = {
    "a": 1.5530272779924215,
    "alpha": 1.1519173063162575,
    "beta": 0.8726646259971648,
}


def test_links_and_offsets_make_one_closed_line():
    loop = entry("bennett").build(**BENNETT)
    scene = make_scene(loop, THETA)
    assert np.allclose(scene.normals[:, 1], np.roll(scene.offsets[:, 0], -1, axis=0))
    assert np.allclose(scene.normals[:, 0], scene.offsets[:, 1])
    assert np.allclose(
        np.linalg.norm(np.diff(scene.normals, axis=1)[:, 0], axis=1), loop.lengths
    )


def test_axes_point_across_their_links():
    scene = make_scene(entry("bennett").build(**BENNETT), THETA)
    along, link = (
        np.diff(lines, axis=1)[:, 0] for lines in (scene.axes, scene.normals)
    )
    assert np.allclose(np.einsum("ij,ij->i", along, link), 0)
    assert np.allclose(np.einsum("ij,ij->i", np.roll(along, -1, axis=0), link), 0)


def test_offsets_are_drawn_at_their_length():
    loop = entry("dietmaier").build()
    scene = make_scene(loop, np.linspace(0, 1, 6))
    assert np.allclose(
        np.linalg.norm(np.diff(scene.offsets, axis=1)[:, 0], axis=1),
        np.abs(loop.arrays[2]),
    )


def test_a_square_seen_from_the_best_direction_keeps_its_corners_apart():
    loop = entry("rhombus").build()
    scene = make_scene(loop, np.full(4, np.pi / 2))
    elevation, azimuth = np.radians(best_view(scene)[:2])
    look = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    flat = np.eye(3) - np.outer(look, look)
    distances = clearance(scene.joints @ flat, scene.normals @ flat)
    assert distances.joints > 0.6  # of links of length 1
    assert clearance(scene.joints, scene.normals) == pytest.approx((1.0, 1.0))


def test_links_of_a_spherical_linkage_are_chords_of_the_unit_sphere():
    loop = entry("spherical-four-bar").build()
    scene = make_scene(loop, np.array([0.3, 1.0, -2.0, 0.5]))
    assert np.allclose(scene.axes[:, 0], 0)
    chords = np.linalg.norm(np.diff(scene.normals, axis=1)[:, 0], axis=1)
    assert np.allclose(chords, 2 * np.sin(loop.arrays[1] / 2))
