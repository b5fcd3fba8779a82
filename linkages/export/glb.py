"""A linkage as an animated model: one animation for each form or route, meshes of a size
of 1 about their middles for its rods and joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from bifurc.figures.style import COLORS
from linkages.export.gltf import ARRAY_BUFFER, BinaryGltf
from linkages.export.model import Body, LinkageModel, Motion, Poses
from linkages.mechanisms.joint import Shape
from linkages.values import require

ROD_RADIUS = 0.03  # in characteristic lengths, as the next three and `SCALES`
JOINT_RADIUS = 0.07
JOINT_HEIGHT = 0.24
LAYER = 0.12  # from one layer of a planar mechanism to the next: half a joint
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
Z_TO_Y = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]  # glTF has y upwards


def make_glb(model: LinkageModel, generator: str) -> bytes:
    """The model in binary glTF, with an animation for every motion.

    A node for each body by its name, the frame at rest; z axes of links of a loop are
    the axes of the joints behind them. Lengths are those of the linkage, times in
    seconds. Raises `GeometryError` for lengths beyond floats of 32 bits.
    """
    is_float = SMALLEST < model.size < LARGEST
    allowed = f"between {SMALLEST:g} and {LARGEST:g}, for a model of 32-bit floats"
    require(is_float, "characteristic length", model.size, allowed)
    file = BinaryGltf(generator)
    rods, joints = _add_meshes(file, model)
    first = model.motions[0][1]
    bodies = []
    for number, body in enumerate(model.bodies):
        children = _add_parts(file, body, rods[number % len(rods)], joints, model.size)
        # the format has no empty list of children
        parts = {"children": children} if children else {}
        node = file.add(
            "nodes",
            name=body.name,
            translation=first.translations[number, 0].tolist(),
            rotation=first.rotations[number, 0].tolist(),
            **parts,
        )
        bodies.append(node)
    for motion, poses in model.motions:
        _add_animation(file, bodies, model.frame, motion, poses)
    root = file.add("nodes", name=model.name, children=bodies, rotation=Z_TO_Y)
    return file.to_bytes(root)


def _add_meshes(
    file: BinaryGltf, model: LinkageModel
) -> tuple[list[int], dict[Shape, int]]:
    """Meshes of rods in the colours of bodies, and of the joints that there are by
    their shapes."""
    rod = _add_arrays(file, cylinder())
    rods = []
    for i, color in enumerate(COLORS[: len(model.bodies)]):
        material = _add_material(file, f"body {i + 1}", color)
        rods.append(_add_mesh(file, f"rod {i + 1}", rod, material))
    material = _add_material(file, "joint", JOINT_COLOR)
    shapes = {symbol.shape for body in model.bodies for symbol in body.symbols}
    joints = {}
    for shape in Shape:
        if shape in shapes:
            is_rod = shape is Shape.CYLINDER
            arrays = rod if is_rod else _add_arrays(file, MESHES[shape]())
            name = f"joint, {shape.value}"
            joints[shape] = _add_mesh(file, name, arrays, material)
    return rods, joints


def _add_arrays(file: BinaryGltf, mesh: Mesh) -> dict[str, Any]:
    """The arrays of a mesh, as the format wants them."""
    positions = file.add_floats(mesh.positions, ARRAY_BUFFER)
    normals = file.add_floats(mesh.normals, ARRAY_BUFFER)
    attributes = {"POSITION": positions, "NORMAL": normals}
    return {"attributes": attributes, "indices": file.add_triangles(mesh.triangles)}


def _add_mesh(file: BinaryGltf, name: str, arrays: dict[str, Any], color: int) -> int:
    return file.add("meshes", name=name, primitives=[{**arrays, "material": color}])


def _add_material(file: BinaryGltf, name: str, color: str) -> int:
    """A dull material of a colour "#rrggbb"."""
    surface = {
        "baseColorFactor": [*_linear(color), 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.8,
    }
    return file.add("materials", name=name, pbrMetallicRoughness=surface)


def _add_parts(
    file: BinaryGltf, body: Body, rod: int, joints: dict[Shape, int], size: float
) -> list[int]:
    """The rods and the joints of a body."""
    parts = []
    for start, end in body.rods:
        way = end - start
        length = float(np.linalg.norm(way))
        scale = np.array([ROD_RADIUS * size, ROD_RADIUS * size, length])
        middle = (start + end) / 2
        parts.append(_add_part(file, "rod", rod, middle, way / length, scale))
    for one in body.symbols:
        mesh, scale = joints[one.shape], size * np.array(SCALES[one.shape])
        part = _add_part(file, one.name, mesh, one.place, one.direction, scale)
        parts.append(part)
    return parts


def _add_part(
    file: BinaryGltf,
    name: str,
    mesh: int,
    place: np.ndarray,
    direction: np.ndarray,
    scale: np.ndarray,
) -> int:
    """A mesh of a ``scale`` (3,) about a ``place`` (3,), its z axis along a
    ``direction`` (3,)."""
    from scipy.spatial.transform import Rotation

    turn, _ = Rotation.align_vectors([direction], [[0.0, 0.0, 1.0]])
    return file.add(
        "nodes",
        name=name,
        mesh=mesh,
        translation=place.tolist(),
        rotation=turn.as_quat().tolist(),
        scale=scale.tolist(),
    )


def _add_animation(
    file: BinaryGltf, nodes: Sequence[int], frame: int, motion: Motion, poses: Poses
) -> None:
    """The animation of all bodies but the frame, which stands still."""
    length = motion.arclength[-1]
    seconds = max(SECONDS * length / FULL_TURN / len(nodes) ** 0.5, SHORTEST)
    share = motion.arclength / length if length > 0 else np.zeros(1)
    times = file.add_floats(seconds * share)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for number, node in enumerate(nodes):
        if number == frame:
            continue
        tracks = {
            "translation": poses.translations[number],
            "rotation": poses.rotations[number],
        }
        for path, values in tracks.items():
            target = {"node": node, "path": path}
            channels.append({"sampler": len(samplers), "target": target})
            output = {"output": file.add_floats(values), "interpolation": "LINEAR"}
            samplers.append({"input": times, **output})
    file.add("animations", name=motion.name, samplers=samplers, channels=channels)


def _linear(color: str) -> list[float]:
    """A colour "#rrggbb" as linear red, green and blue, which glTF asks for."""
    parts = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    return [((x + 0.055) / 1.055) ** 2.4 if x > 0.04045 else x / 12.92 for x in parts]
