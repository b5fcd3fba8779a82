"""A linkage as an animated model: one animation for each form or route."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bifurc.figures.style import COLORS
from linkages.export.gltf import BinaryGltf, Track
from linkages.export.meshes import Mesh, ball, box, cylinder
from linkages.export.model import Body, LinkageModel, Symbol
from linkages.export.motion import Motion, Poses
from linkages.mechanisms.joint import Shape
from linkages.values import GeometryError

ROD_RADIUS = 0.03  # in characteristic lengths, as all below
JOINT_RADIUS = 0.07
JOINT_HEIGHT = 0.24
SCALES = {
    Shape.CYLINDER: (JOINT_RADIUS, JOINT_RADIUS, JOINT_HEIGHT),
    Shape.BOX: (0.16, 0.16, JOINT_HEIGHT),
    Shape.PLATE: (0.4, 0.4, 0.03),
    Shape.BALL: (0.1, 0.1, 0.1),
}
MESHES = {
    Shape.CYLINDER: cylinder,
    Shape.BOX: box,
    Shape.PLATE: box,
    Shape.BALL: ball,
}
SECONDS = 8.0  # that an animation of one turn in joint space takes
SHORTEST = 3.0  # s
SMALLEST, LARGEST = 1e-12, 1e12  # characteristic lengths that floats of 32 bits hold
JOINT_COLOR = "#444444"
FULL_TURN = 2 * np.pi
Z_TO_Y = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]  # glTF has y upwards


class _Solids(NamedTuple):
    """The meshes of rods, one for each colour, and of joints by their shapes."""

    rods: list[int]
    joints: dict[Shape, int]


def make_glb(model: LinkageModel, generator: str) -> bytes:
    """The model in binary glTF, with an animation for every motion.

    A node for each body by its name, the frame at rest; z axes of links of a loop are
    the axes of the joints behind them. Lengths are those of the linkage, times in
    seconds. Raises `GeometryError` for lengths beyond floats of 32 bits.
    """
    if not SMALLEST < model.size < LARGEST:
        allowed = f"between {SMALLEST:g} and {LARGEST:g}, for a model of 32-bit floats"
        raise GeometryError("characteristic length", model.size, allowed)
    file = BinaryGltf(generator)
    solids = _add_solids(file, model)
    first = model.motions[0][1]
    bodies = [
        _add_body(file, body, number, solids, model.size, first)
        for number, body in enumerate(model.bodies)
    ]
    for motion, poses in model.motions:
        _add_animation(file, bodies, model.frame, motion, poses)
    root = file.add_node(model.name, children=bodies, rotation=Z_TO_Y)
    return file.to_bytes(root)


def _add_solids(file: BinaryGltf, model: LinkageModel) -> _Solids:
    """Meshes of rods in the colours of bodies, and of the joints that there are."""
    rod = _add_arrays(file, cylinder())
    rods = []
    for i, color in enumerate(COLORS[: len(model.bodies)]):
        material = file.add_material(f"body {i + 1}", _linear(color))
        rods.append(file.add_mesh(f"rod {i + 1}", *rod, material))
    material = file.add_material("joint", _linear(JOINT_COLOR))
    shapes = {symbol.shape for body in model.bodies for symbol in body.symbols}
    joints = {}
    for shape in Shape:
        if shape in shapes:
            arrays = (
                rod if shape is Shape.CYLINDER else _add_arrays(file, MESHES[shape]())
            )
            joints[shape] = file.add_mesh(f"joint, {shape.value}", *arrays, material)
    return _Solids(rods, joints)


def _add_arrays(file: BinaryGltf, mesh: Mesh) -> tuple[int, int, int]:
    return (
        file.add_vertices(mesh.positions),
        file.add_vertices(mesh.normals),
        file.add_triangles(mesh.triangles),
    )


def _add_body(
    file: BinaryGltf,
    body: Body,
    number: int,
    solids: _Solids,
    size: float,
    poses: Poses,
) -> int:
    """The node of a body, with its rods and its joints, where a motion begins."""
    mesh = solids.rods[number % len(solids.rods)]
    children = [_add_rod(file, mesh, start, end, size) for start, end in body.rods]
    children += [_add_symbol(file, solids, one, size) for one in body.symbols]
    # the format has no empty list of children
    parts = {"children": children} if children else {}
    return file.add_node(
        body.name,
        translation=poses.translations[number, 0].tolist(),
        rotation=poses.rotations[number, 0].tolist(),
        **parts,
    )


def _add_rod(
    file: BinaryGltf, mesh: int, start: np.ndarray, end: np.ndarray, size: float
) -> int:
    way = end - start
    length = float(np.linalg.norm(way))
    return file.add_node(
        "rod",
        mesh=mesh,
        translation=((start + end) / 2).tolist(),
        rotation=_rotation_from_z(way / length),
        scale=[ROD_RADIUS * size, ROD_RADIUS * size, length],
    )


def _add_symbol(file: BinaryGltf, solids: _Solids, symbol: Symbol, size: float) -> int:
    return file.add_node(
        symbol.name,
        mesh=solids.joints[symbol.shape],
        translation=symbol.place.tolist(),
        rotation=_rotation_from_z(symbol.direction),
        scale=[size * share for share in SCALES[symbol.shape]],
    )


def _add_animation(
    file: BinaryGltf, nodes: Sequence[int], frame: int, motion: Motion, poses: Poses
) -> None:
    """The animation of all bodies but the frame, which stands still."""
    length = motion.arclength[-1]
    seconds = max(SECONDS * length / FULL_TURN / len(nodes) ** 0.5, SHORTEST)
    share = motion.arclength / length if length > 0 else np.zeros(1)
    times = file.add_floats(seconds * share)
    tracks = []
    for number, node in enumerate(nodes):
        if number == frame:
            continue
        way = file.add_floats(poses.translations[number])
        turns = file.add_floats(poses.rotations[number])
        tracks.append(Track(node, "translation", way))
        tracks.append(Track(node, "rotation", turns))
    file.add_animation(motion.name, times, tracks)


def _rotation_from_z(direction: np.ndarray) -> list[float]:
    """The quaternion (4,) of a rotation from z to a unit vector (3,)."""
    from scipy.spatial.transform import Rotation

    turn, _ = Rotation.align_vectors([direction], [[0.0, 0.0, 1.0]])
    quaternion: list[float] = turn.as_quat().tolist()
    return quaternion


def _linear(color: str) -> list[float]:
    """A colour "#rrggbb" as linear red, green and blue, which glTF asks for."""
    parts = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    return [((x + 0.055) / 1.055) ** 2.4 if x > 0.04045 else x / 12.92 for x in parts]
