"""A configuration as lines and dots: joint axes, common normals, offsets, and where to
look from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkages.loop import Loop

__all__ = ["Scene", "best_view", "breadth", "clearance", "make_scene"]

# half the drawn length of an axis beyond its links, of the extent of the linkage
REACH = 0.22
DIRECTIONS = 400


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


def make_scene(loop: Loop, theta: np.ndarray) -> Scene:
    """The scene of the configuration ``theta`` (n,), rad. Links of a spherical loop are
    chords of the unit sphere."""
    frames = loop.frames(theta)
    direction, arrive = frames[:-1, :3, 2], frames[:-1, :3, 3]
    leave = arrive + loop.arrays[2][:, None] * direction
    if np.ptp(np.concatenate([arrive, leave]), axis=0).max() < 1e-12:
        return _spherical(frames[:, :3, 2])
    centre = (arrive + leave).mean(axis=0) / 2
    arrive, leave, following = (
        arrive - centre,
        leave - centre,
        frames[1:, :3, 3] - centre,
    )
    middle = (arrive + leave) / 2
    half = np.abs(loop.arrays[2]) / 2 + REACH * float(
        np.linalg.norm(middle, axis=1).max()
    )
    axes = np.stack(
        [middle - half[:, None] * direction, middle + half[:, None] * direction], axis=1
    )
    return Scene(
        axes,
        np.stack([leave, following], axis=1),
        np.stack([arrive, leave], axis=1),
        middle,
    )


def _spherical(directions: np.ndarray) -> Scene:
    """The scene of axes through the origin along ``directions`` (n + 1, 3), the last
    being the first again."""
    ends = directions[:-1]
    axes = np.stack([0 * ends, (1 + REACH) * ends], axis=1)
    return Scene(
        axes,
        np.stack([ends, directions[1:]], axis=1),
        np.stack([ends, ends], axis=1),
        ends,
    )


def best_view(scene: Scene) -> tuple[float, float]:
    """Elevation and azimuth, in degrees, from which joints lie furthest apart and no
    axis is seen end on."""
    k = np.arange(DIRECTIONS)
    z = (
        (k + 0.5) / DIRECTIONS * 0.9
    )  # a spiral over the upper half of the sphere, the pole left out
    turn = k * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - z**2)
    looks = np.column_stack([ring * np.cos(turn), ring * np.sin(turn), z])
    best = max(looks, key=lambda look: _clarity(scene, look))
    return float(np.degrees(np.arcsin(best[2]))), float(
        np.degrees(np.arctan2(best[1], best[0]))
    )


def clearance(joints: np.ndarray, normals: np.ndarray) -> tuple[float, float]:
    """The least distance of two joints (n, k), and of a joint from a link (n, 2, k)
    that it is not on."""
    n = len(joints)
    first, second = np.triu_indices(n, 1)
    apart = np.linalg.norm(joints[first] - joints[second], axis=1).min()
    start, along = normals[:, 0], normals[:, 1] - normals[:, 0]
    to = joints[:, None] - start[None]
    part = np.clip(
        np.einsum("ijk,jk->ij", to, along) / np.maximum((along**2).sum(axis=1), 1e-300),
        0,
        1,
    )
    away = np.linalg.norm(to - part[..., None] * along, axis=-1)
    others = ~(
        np.eye(n, dtype=bool)
        | np.eye(n, k=-1, dtype=bool)
        | np.eye(n, k=n - 1, dtype=bool)
    )
    return float(apart), float(away[others].min())


def breadth(points: np.ndarray) -> float:
    """The lesser extent of points (n, k) in the plane in which they spread most: 0 for
    points on one line."""
    return float(
        np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[1]
        / len(points) ** 0.5
    )


def _clarity(scene: Scene, look: np.ndarray) -> float:
    """Projected distances of joints and of joints from links, and how much is seen of
    every axis."""
    flat = np.eye(3) - np.outer(look, look)
    apart, away = clearance(scene.joints @ flat, scene.normals @ flat)
    unit = max(scene.extent, 1e-12)
    drawn = scene.axes[:, 1] - scene.axes[:, 0]
    shown = np.linalg.norm(drawn @ flat, axis=1) / np.linalg.norm(drawn, axis=1)
    return float(
        (4 * apart + 4 * away + 2 * breadth(scene.joints @ flat)) / unit
        + min(shown.min(), 0.5)
    )
