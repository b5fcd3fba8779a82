"""Binary glTF 2.0 files (Khronos Group 2017, ISO/IEC 12113), put together piece by
piece."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

FLOAT, UNSIGNED_SHORT = 5126, 5123  # numbers that the format gives to types
ARRAY_BUFFER, INDEX_BUFFER = 34962, 34963  # and to what arrays are for
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}  # by the numbers of an entry
MAGIC, VERSION = b"glTF", 2
ALIGNMENT = 4  # bytes


class BinaryGltf:
    """A file in the making. Every method that adds a thing returns its index."""

    def __init__(self, generator: str):
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [],
            "nodes": [],
            "meshes": [],
            "materials": [],
            "accessors": [],
            "bufferViews": [],
            "buffers": [],
            "animations": [],
        }
        self._content = bytearray()

    def add(self, kind: str, **thing: Any) -> int:
        """One of the "nodes", "meshes", "materials" and so on, as the format has it."""
        self.document[kind].append(thing)
        return len(self.document[kind]) - 1

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
        number = self.add("bufferViews", **view)
        return self.add("accessors", bufferView=number, count=len(array), **accessor)

    def to_bytes(self, root: int) -> bytes:
        """The file whose scene is the node ``root``."""
        self.add("scenes", nodes=[root])
        self.add("buffers", byteLength=len(self._content))
        # the format has no empty lists
        filled = {key: value for key, value in self.document.items() if value != []}
        text = json.dumps(filled, allow_nan=False).encode("utf-8")
        json_chunk = _chunk(b"JSON", text, b" ")
        binary_chunk = _chunk(b"BIN\0", bytes(self._content), b"\0")
        length = 12 + len(json_chunk) + len(binary_chunk)
        header = MAGIC + struct.pack("<II", VERSION, length)
        return header + json_chunk + binary_chunk


def _chunk(kind: bytes, content: bytes, filler: bytes) -> bytes:
    padded = content + filler * (-len(content) % ALIGNMENT)
    return struct.pack("<I", len(padded)) + kind + padded
