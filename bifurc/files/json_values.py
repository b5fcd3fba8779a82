"""Any nesting of plain values as JSON text, and back without loss."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["from_text", "to_text"]

# marks what JSON has no word for: tuples, arrays, numpy's scalars, mappings with other
# keys
TAG = "__kind__"


def to_text(value: Any) -> str:
    """``value`` as JSON text that `from_text` turns into an equal value of the same
    type.

    Mappings, lists, tuples, strings, numbers, booleans, None, numpy scalars and arrays
    of numbers or text may be nested; raises `TypeError` for anything else. Floats keep
    every digit.
    """
    return json.dumps(_encode(value))


def from_text(text: str) -> Any:
    """The value that `to_text` wrote."""
    return _decode(json.loads(text))


def _encode(value: Any) -> Any:
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, np.generic):
        return {TAG: "scalar", "dtype": value.dtype.str, "value": value.item()}
    if isinstance(value, np.ndarray):
        return {
            TAG: "array",
            "dtype": value.dtype.str,
            "shape": list(value.shape),
            "value": value.ravel().tolist(),
        }
    if isinstance(value, Mapping):
        if all(type(key) is str for key in value) and TAG not in value:
            return {key: _encode(item) for key, item in value.items()}
        return {
            TAG: "mapping",
            "value": [[_encode(key), _encode(item)] for key, item in value.items()],
        }
    if isinstance(value, tuple):
        return {TAG: "tuple", "value": [_encode(item) for item in value]}
    if isinstance(value, list):
        return [_encode(item) for item in value]
    raise TypeError(
        f"{value!r} of type {type(value).__name__} cannot be stored; use numbers, text, arrays or mappings"
    )


def _decode(value: Any) -> Any:
    if isinstance(value, list):
        return [_decode(item) for item in value]
    if not isinstance(value, dict):
        return value
    kind = value.get(TAG)
    if kind is None:
        return {key: _decode(item) for key, item in value.items()}
    if kind == "scalar":
        return np.dtype(value["dtype"]).type(value["value"])
    if kind == "array":
        return np.array(value["value"], dtype=value["dtype"]).reshape(value["shape"])
    if kind == "tuple":
        return tuple(_decode(item) for item in value["value"])
    return {_decode(key): _decode(item) for key, item in value["value"]}
