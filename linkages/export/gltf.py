"""Binary glTF 2.0 files (Khronos Group 2017, ISO/IEC 12113): arrays, meshes, nodes and
animations, put together piece by piece."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

FLOAT, UNSIGNED_SHORT = 5126, 5123  # numbers that the format gives to types
ARRAY_BUFFER, INDEX_BUFFER = 34962, 34963  # and to what arrays are for
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}  # by the numbers of an entry
MAGIC, VERSION = b"glTF", 2
ALIGNMENT = 4  # bytes


class Track(NamedTuple):
    """What a ``node`` does in an animation: its "translation" or "rotation" (the
    ``path``), and the array of ``values`` that was added."""

    node: int
    path: str
    values: int


@dataclass
class BinaryGltf:
    """A file in the making. Every method that adds a thing returns its index."""

    generator: str
    _content: bytearray = field(default_factory=bytearray)
    _views: list[dict[str, Any]] = field(default_factory=list)
    _accessors: list[dict[str, Any]] = field(default_factory=list)
    _materials: list[dict[str, Any]] = field(default_factory=list)
    _meshes: list[dict[str, Any]] = field(default_factory=list)
    _nodes: list[dict[str, Any]] = field(default_factory=list)
    _animations: list[dict[str, Any]] = field(default_factory=list)

    # --- arrays -----------------------------------------------------------------------

    def add_floats(self, values: np.ndarray, target: int | None = None) -> int:
        """Floats of 32 bits, (k,) or (k, 3) or (k, 4)."""
        array = np.ascontiguousarray(values, dtype="<f4").reshape(len(values), -1)
        accessor = {
            "componentType": FLOAT,
            "type": TYPES[array.shape[1]],
            "min": array.min(axis=0).tolist(),
            "max": array.max(axis=0).tolist(),
        }
        return self._add_array(array, accessor, target)

    def add_vertices(self, values: np.ndarray) -> int:
        """Positions or normals (k, 3) of vertices."""
        return self.add_floats(values, ARRAY_BUFFER)

    def add_triangles(self, indices: np.ndarray) -> int:
        """Triangles (k, 3) by the numbers of their vertices."""
        array = np.ascontiguousarray(indices, dtype="<u2").ravel()
        accessor = {"componentType": UNSIGNED_SHORT, "type": "SCALAR"}
        return self._add_array(array, accessor, INDEX_BUFFER)

    def _add_array(
        self, array: np.ndarray, accessor: dict[str, Any], target: int | None
    ) -> int:
        self._content.extend(bytes(-len(self._content) % ALIGNMENT))
        view = {
            "buffer": 0,
            "byteOffset": len(self._content),
            "byteLength": array.nbytes,
        }
        if target is not None:
            view["target"] = target
        self._content.extend(array.tobytes())
        self._views.append(view)
        number = {"bufferView": len(self._views) - 1, "count": len(array)}
        self._accessors.append({**number, **accessor})
        return len(self._accessors) - 1

    # --- things -----------------------------------------------------------------------

    def add_material(self, name: str, color: Sequence[float]) -> int:
        """A dull material of a colour, red, green and blue from 0 to 1, linear."""
        surface = {
            "baseColorFactor": [*color, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.8,
        }
        self._materials.append({"name": name, "pbrMetallicRoughness": surface})
        return len(self._materials) - 1

    def add_mesh(
        self, name: str, positions: int, normals: int, triangles: int, material: int
    ) -> int:
        """A mesh of arrays that were added."""
        primitive = {
            "attributes": {"POSITION": positions, "NORMAL": normals},
            "indices": triangles,
            "material": material,
        }
        self._meshes.append({"name": name, "primitives": [primitive]})
        return len(self._meshes) - 1

    def add_node(self, name: str, **content: Any) -> int:
        """A node with what the format allows: children, mesh, translation, rotation
        (x, y, z, w), scale, extras."""
        self._nodes.append({"name": name, **content})
        return len(self._nodes) - 1

    def add_animation(self, name: str, times: int, tracks: Sequence[Track]) -> None:
        """An animation along ``tracks`` at ``times`` (s), an array that was added."""
        samplers: list[dict[str, Any]] = []
        channels: list[dict[str, Any]] = []
        for track in tracks:
            target = {"node": track.node, "path": track.path}
            channels.append({"sampler": len(samplers), "target": target})
            output = {"output": track.values, "interpolation": "LINEAR"}
            samplers.append({"input": times, **output})
        animation = {"name": name, "samplers": samplers, "channels": channels}
        self._animations.append(animation)

    # --- the file ---------------------------------------------------------------------

    def to_bytes(self, root: int) -> bytes:
        """The file whose scene is the node ``root``."""
        document = {
            "asset": {"version": "2.0", "generator": self.generator},
            "scene": 0,
            "scenes": [{"nodes": [root]}],
            "nodes": self._nodes,
            "meshes": self._meshes,
            "materials": self._materials,
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._content)}],
        }
        if self._animations:
            document["animations"] = self._animations
        text = json.dumps(document, allow_nan=False).encode("utf-8")
        json_chunk = _chunk(b"JSON", text, b" ")
        binary_chunk = _chunk(b"BIN\0", bytes(self._content), b"\0")
        length = 12 + len(json_chunk) + len(binary_chunk)
        header = MAGIC + struct.pack("<II", VERSION, length)
        return header + json_chunk + binary_chunk


def _chunk(kind: bytes, content: bytes, filler: bytes) -> bytes:
    padded = content + filler * (-len(content) % ALIGNMENT)
    return struct.pack("<I", len(padded)) + kind + padded
