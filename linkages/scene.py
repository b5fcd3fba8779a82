"""A configuration as lines and dots: joint axes, common normals, offsets, and where to
look from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from linkages.loop import Loop

REACH = 0.22  # of the extent: half the drawn length of an axis beyond its links
STEEP = 0.9  # cosine of the normal of a plane that is seen from above
DIRECTIONS = 400  # from which a scene is looked at
CONCURRENT = 1e-12  # feet that are closer are one: the axes meet in a point


@dataclass(frozen=True)
class Scene:
    """Line segments (n, 2, 3) and points (n, 3) in the unit of the loop, in a frame
    centred on the linkage.

    ``axes`` are pieces of the joint axes, ``normals`` the common normals (the links),
    ``offsets`` the pieces of the axes between the feet of neighbouring normals,
    ``joints`` their midpoints, where the number of the joint belongs.
    """

    axes: np.ndarray
    normals: np.ndarray
    offsets: np.ndarray
    joints: np.ndarray

    @property
    def extent(self) -> float:
        """Largest distance of a foot from the centre."""
        return float(np.linalg.norm(self.normals.reshape(-1, 3), axis=1).max())


class View(NamedTuple):
    """Where to look from, in degrees, and what is up then."""

    elevation: float
    azimuth: float
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)


class Clearance(NamedTuple):
    """How well the joints of a scene are told apart: the least distance between two
    ``joints``, and that of a joint from one of the ``links`` that it is not on."""

    joints: float
    links: float


def make_scene(loop: Loop, theta: np.ndarray) -> Scene:
    """The scene of the configuration ``theta`` (n,), rad. Links of a spherical loop are
    chords of the unit sphere."""
    frames = loop.frames(theta)
    offsets = loop.arrays[2]
    directions = frames[:-1, :3, 2]
    # feet on each axis of the normals before and after it
    before = frames[:-1, :3, 3]
    after = before + offsets[:, None] * directions
    if np.ptp(np.concatenate([before, after]), axis=0).max() < CONCURRENT:
        return _spherical_scene(frames[:, :3, 2])
    centre = (before + after).mean(axis=0) / 2
    following = frames[1:, :3, 3] - centre  # feet on the next axis
    before = before - centre
    after = after - centre
    joints = (before + after) / 2
    extent = float(np.linalg.norm(joints, axis=1).max())
    half = (np.abs(offsets) / 2 + REACH * extent)[:, None] * directions
    return Scene(
        axes=np.stack([joints - half, joints + half], axis=1),
        normals=np.stack([after, following], axis=1),
        offsets=np.stack([before, after], axis=1),
        joints=joints,
    )


def _spherical_scene(directions: np.ndarray) -> Scene:
    """The scene of axes through the origin along ``directions`` (n + 1, 3), the last
    being the first again."""
    joints = directions[:-1]
    return Scene(
        axes=np.stack([0 * joints, (1 + REACH) * joints], axis=1),
        normals=np.stack([joints, directions[1:]], axis=1),
        offsets=np.stack([joints, joints], axis=1),
        joints=joints,
    )


# --- where to look from ---------------------------------------------------------------


def best_view(scene: Scene) -> View:
    """The view in which joints lie furthest apart and no axis is seen end on."""
    looks = looks_around(DIRECTIONS)
    return _view_along(looks[np.argmax(_clarities(scene, looks))])


def clearest_view(clarity: Callable[[np.ndarray], float]) -> View:
    """The view along a unit vector (3,), towards the eye, whose ``clarity`` is
    largest."""
    return _view_along(max(looks_around(DIRECTIONS), key=clarity))


def view_of_plane(normal: np.ndarray, orientation: np.ndarray) -> View:
    """The view along the ``normal`` (3,) of a plane, with x to the right, or else y, in
    the frame to which the rotation ``orientation`` (3, 3) leads."""
    look = orientation @ normal
    upward = np.array([0.0, 0.0, 1.0])
    if abs(look[2]) > STEEP:
        upward = np.array([0.0, 1.0, 0.0])
    right = np.cross(upward, look)
    largest = 0 if abs(right[0]) > 1 - STEEP else 1
    if right[largest] < 0:
        look = -look
    up = upward - (upward @ look) * look
    view = _view_along(orientation.T @ look)
    x, y, z = (orientation.T @ (up / np.linalg.norm(up))).tolist()
    return view._replace(up=(x, y, z))


def _view_along(look: np.ndarray) -> View:
    elevation = np.degrees(np.arcsin(np.clip(look[2], -1.0, 1.0)))
    azimuth = np.degrees(np.arctan2(look[1], look[0]))
    return View(float(elevation), float(azimuth))


def looks_around(count: int) -> np.ndarray:
    """Unit vectors (count, 3) on a spiral over the upper half of the sphere, the pole
    left out."""
    k = np.arange(count)
    z = (k + 0.5) / count * 0.9
    turn = k * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - z**2)
    return np.column_stack([ring * np.cos(turn), ring * np.sin(turn), z])


def _clarities(scene: Scene, looks: np.ndarray) -> np.ndarray:
    """For each view (k,) projected distances of joints and of joints from links, and
    how much is seen of every axis."""
    projections = np.eye(3) - looks[:, :, None] * looks[:, None, :]  # (k, 3, 3)
    joints = scene.joints @ projections
    normals = scene.normals @ projections[:, None]
    apart, off_links = _clearances(joints, normals)
    unit = max(scene.extent, 1e-12)
    axes = scene.axes[:, 1] - scene.axes[:, 0]
    visible_lengths = np.linalg.norm(axes @ projections, axis=-1)
    visible_shares = (visible_lengths / np.linalg.norm(axes, axis=1)).min(axis=-1)
    spreads = 4 * apart + 4 * off_links + 2 * _breadths(joints)
    return np.asarray(spreads / unit + np.minimum(visible_shares, 0.5))


def clearance(joints: np.ndarray, normals: np.ndarray) -> Clearance:
    """How far the joints (n, k) are from each other, and from the links (n, 2, k) that
    they are not on."""
    apart, off_links = _clearances(joints, normals)
    return Clearance(float(apart), float(off_links))


def _clearances(
    joints: np.ndarray, normals: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The two numbers (...,) of `clearance` for joints (..., n, k) and links
    (..., n, 2, k)."""
    n = joints.shape[-2]
    first, second = np.triu_indices(n, 1)
    gaps = joints[..., first, :] - joints[..., second, :]
    own = np.eye(n, dtype=bool)
    following = np.eye(n, k=-1, dtype=bool) | np.eye(n, k=n - 1, dtype=bool)
    to_links = distances_to_segments(joints, normals)[..., ~(own | following)]
    return np.linalg.norm(gaps, axis=-1).min(axis=-1), to_links.min(axis=-1)


def distances_to_segments(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Distances (..., p, q) of points (..., p, k) from line segments (..., q, 2, k)."""
    starts = segments[..., 0, :]
    along = segments[..., 1, :] - starts
    squares = np.maximum((along**2).sum(axis=-1), 1e-300)
    to_points = points[..., :, None, :] - starts[..., None, :, :]
    products = np.einsum("...ijk,...jk->...ij", to_points, along)
    fractions = products / squares[..., None, :]
    feet = np.clip(fractions, 0, 1)[..., None] * along[..., None, :, :]
    return np.asarray(np.linalg.norm(to_points - feet, axis=-1))


def breadth(points: np.ndarray) -> float:
    """The lesser extent of points (n, k) in the plane in which they spread most: 0 for
    points on one line."""
    return float(_breadths(points))


def _breadths(points: np.ndarray) -> np.ndarray:
    """The `breadth` (...,) of points (..., n, k)."""
    centers = points.mean(axis=-2, keepdims=True)
    extents = np.linalg.svd(points - centers, compute_uv=False)
    return np.asarray(extents[..., 1:2].sum(axis=-1) / points.shape[-2] ** 0.5)
