"""Meshes of the solids that models are made of, each of a size of 1 about its middle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SIDES = 24  # of the prism that stands for a cylinder
RINGS = 12  # of a ball, from pole to pole
FULL_TURN = 2 * np.pi


class Mesh(NamedTuple):
    """Vertices (k, 3), their normals (k, 3) and triangles (m, 3), which turn to the
    left seen from outside."""

    positions: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray


def cylinder() -> Mesh:
    """A closed cylinder about z, of radius and height 1."""
    angles = FULL_TURN * np.arange(SIDES) / SIDES
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(SIDES)], axis=1)
    up = np.array([0.0, 0.0, 0.5])
    # the wall has normals of its own, so that edges are sharp
    positions = np.concatenate([ring - up, ring + up, ring - up, ring + up])
    upward = np.tile([0.0, 0.0, 1.0], (SIDES, 1))
    normals = np.concatenate([ring, ring, -upward, upward])
    triangles = []
    for k in range(SIDES):
        low, next_low = k, (k + 1) % SIDES
        high, next_high = low + SIDES, next_low + SIDES
        triangles += [[low, next_low, next_high], [low, next_high, high]]
    bottom, top = 2 * SIDES, 3 * SIDES
    for k in range(1, SIDES - 1):
        triangles.append([bottom, bottom + k + 1, bottom + k])
        triangles.append([top, top + k, top + k + 1])
    return Mesh(positions, normals, np.array(triangles))


def box() -> Mesh:
    """A cube with edges of 1."""
    positions: list[np.ndarray] = []
    normals: list[np.ndarray] = []
    triangles: list[list[int]] = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            normal = sign * np.eye(3)[axis]
            across = np.eye(3)[(axis + 1) % 3]
            along = np.cross(normal, across)
            first = len(positions)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                positions.append(0.5 * (normal + a * across + b * along))
                normals.append(normal)
            triangles.append([first, first + 1, first + 2])
            triangles.append([first, first + 2, first + 3])
    return Mesh(np.array(positions), np.array(normals), np.array(triangles))


def ball() -> Mesh:
    """A ball of radius 1."""
    heights = np.linspace(0.0, np.pi, RINGS + 1)
    angles = FULL_TURN * np.arange(SIDES) / SIDES
    rows = [
        np.stack(
            [
                np.sin(height) * np.cos(angles),
                np.sin(height) * np.sin(angles),
                np.full(SIDES, np.cos(height)),
            ],
            axis=1,
        )
        for height in heights
    ]
    positions = np.concatenate(rows)
    triangles = []
    for ring in range(RINGS):
        for k in range(SIDES):
            top, next_top = ring * SIDES + k, ring * SIDES + (k + 1) % SIDES
            low, next_low = top + SIDES, next_top + SIDES
            if ring > 0:  # those at a pole have no area
                triangles.append([top, low, next_top])
            if ring < RINGS - 1:
                triangles.append([next_top, low, next_low])
    return Mesh(positions, positions.copy(), np.array(triangles))
