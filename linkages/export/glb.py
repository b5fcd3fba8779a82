"""A linkage as an animated model: one animation for each form or route."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bifurc.figures.style import COLORS
from linkages.export.gltf import BinaryGltf, Track
from linkages.export.motion import Motion, Poses, link_poses
from linkages.links.rods import link_corners, seat_heights
from linkages.loop import GeometryError, Loop

__all__ = ["make_glb"]

SIDES = 24  # of the prism that stands for a cylinder
ROD_RADIUS = 0.03  # in characteristic lengths
JOINT_RADIUS = 0.07
JOINT_HEIGHT = 0.24
SECONDS = 8.0  # that an animation of one turn in joint space takes
SHORTEST = 3.0  # s
SMALLEST, LARGEST = 1e-12, 1e12  # characteristic lengths that floats of 32 bits hold
NOTHING = 1e-9  # in characteristic lengths: a rod that is none
JOINT_COLOR = "#444444"
FULL_TURN = 2 * np.pi
Z_TO_Y = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]  # glTF has y upwards


class _Solids(NamedTuple):
    """The meshes of a rod, by the link's colour, and of a joint."""

    rods: list[int]
    joint: int


@dataclass(frozen=True)
class _Rod:
    """A rod from its middle: ``rotation`` (4,) turns the z axis along it."""

    middle: np.ndarray
    rotation: np.ndarray
    length: float


def make_glb(loop: Loop, motions: Sequence[Motion], generator: str) -> bytes:
    """The model of a loop in binary glTF, with an animation for every motion.

    A node for each link, called "link 12" and so on, the last one at rest; its z axis
    is the axis of the joint behind it. Lengths are those of the loop, times in seconds.
    Raises `GeometryError` for lengths beyond floats of 32 bits.
    """
    size = loop.characteristic_length
    if not SMALLEST < size < LARGEST:
        allowed = f"between {SMALLEST:g} and {LARGEST:g}, for a model of 32-bit floats"
        raise GeometryError("characteristic length", size, allowed)
    file = BinaryGltf(generator)
    solids = _add_solids(file, loop.n)
    all_poses = [link_poses(loop, motion) for motion in motions]
    links = [_add_link(file, loop, solids, i, all_poses[0]) for i in range(loop.n)]
    for motion, poses in zip(motions, all_poses, strict=True):
        _add_animation(file, links, motion, poses)
    root = file.add_node(loop.name or "linkage", children=links, rotation=Z_TO_Y)
    return file.to_bytes(root)


def _add_solids(file: BinaryGltf, count: int) -> _Solids:
    """Meshes of a cylinder of radius and height 1, in the colours of links and
    joints."""
    positions, normals, triangles = _cylinder()
    arrays = (
        file.add_vertices(positions),
        file.add_vertices(normals),
        file.add_triangles(triangles),
    )
    rods = []
    for i in range(min(count, len(COLORS))):
        material = file.add_material(f"link {i + 1}", _linear(COLORS[i]))
        rods.append(file.add_mesh(f"rod {i + 1}", *arrays, material))
    material = file.add_material("joint", _linear(JOINT_COLOR))
    return _Solids(rods, file.add_mesh("joint", *arrays, material))


def _add_link(
    file: BinaryGltf, loop: Loop, solids: _Solids, i: int, poses: Poses
) -> int:
    """The node of link i, with its rods and the joint behind it, where a motion
    begins."""
    size = loop.characteristic_length
    mesh = solids.rods[i % len(solids.rods)]
    children = []
    for rod in _rods(link_corners(loop)[i], NOTHING * size):
        radius = ROD_RADIUS * size
        children.append(
            file.add_node(
                "rod",
                mesh=mesh,
                translation=rod.middle.tolist(),
                rotation=rod.rotation.tolist(),
                scale=[radius, radius, rod.length],
            )
        )
    joint = (i + 1) % loop.n
    seat = [0.0, 0.0, float(seat_heights(loop)[joint])]
    scale = [JOINT_RADIUS * size, JOINT_RADIUS * size, JOINT_HEIGHT * size]
    name = f"joint {joint + 1}"
    dash = "-" if loop.n > 9 else ""  # as in linkages.app.texts.link_name
    children.append(
        file.add_node(name, mesh=solids.joint, translation=seat, scale=scale)
    )
    return file.add_node(
        f"link {i + 1}{dash}{joint + 1}",
        children=children,
        translation=poses.translations[i, 0].tolist(),
        rotation=poses.rotations[i, 0].tolist(),
    )


def _add_animation(
    file: BinaryGltf, links: Sequence[int], motion: Motion, poses: Poses
) -> None:
    """The animation of all links but the last one, which stands still."""
    length = motion.arclength[-1]
    seconds = max(SECONDS * length / FULL_TURN / len(links) ** 0.5, SHORTEST)
    share = motion.arclength / length if length > 0 else np.zeros(1)
    times = file.add_floats(seconds * share)
    tracks = []
    for node, way, turns in zip(
        links[:-1], poses.translations, poses.rotations, strict=False
    ):
        tracks.append(Track(node, "translation", file.add_floats(way)))
        tracks.append(Track(node, "rotation", file.add_floats(turns)))
    file.add_animation(motion.name, times, tracks)


# --- shapes ---------------------------------------------------------------------------


def _rods(corners: np.ndarray, nothing: float) -> list[_Rod]:
    """The rods between the corners (4, 3) of a link."""
    from scipy.spatial.transform import Rotation

    rods = []
    for start, end in pairwise(corners):
        way = end - start
        length = float(np.linalg.norm(way))
        if length <= nothing:
            continue
        turn, _ = Rotation.align_vectors([way / length], [[0.0, 0.0, 1.0]])
        rods.append(_Rod((start + end) / 2, turn.as_quat(), length))
    return rods


def _cylinder() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (k, 3), normals (k, 3) and triangles (m, 3) of a closed cylinder about
    z, of radius and height 1."""
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
    return positions, normals, np.array(triangles)


def _linear(color: str) -> list[float]:
    """A colour "#rrggbb" as linear red, green and blue, which glTF asks for."""
    parts = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    return [((x + 0.055) / 1.055) ** 2.4 if x > 0.04045 else x / 12.92 for x in parts]
