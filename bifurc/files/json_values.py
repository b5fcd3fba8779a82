"""Any nesting of plain values as JSON text, and back without loss."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, TypeAlias, cast

import numpy as np

JsonValue: TypeAlias = (
    "bool | int | float | str | list[JsonValue] | dict[str, JsonValue] | None"
)

# Marks what JSON has no word for: tuples, arrays, scalars of numpy, and mappings whose
# keys are not all text.
TAG = "__kind__"


def to_text(value: object) -> str:
    """``value`` as JSON text, which `from_text` turns into an equal value of the same
    type.

    Mappings, lists, tuples, strings, numbers, booleans, None, numpy scalars and arrays
    of numbers or text may be nested; raises `TypeError` for anything else. Floats keep
    every digit.
    """
    return json.dumps(_encode(value))


def from_text(text: str) -> object:
    """The value that `to_text` wrote; raises `ValueError` for any other text."""
    try:
        return _decode(json.loads(text))
    except (KeyError, TypeError, OverflowError, RecursionError) as error:
        raise ValueError(f"{text[:40]!r} is no text of a stored value") from error


def mapping_from_text(text: str) -> dict[str, Any]:
    """The mapping that `to_text` wrote; raises `ValueError` for any other text."""
    value = from_text(text)
    if not isinstance(value, dict):
        raise ValueError(f"{text[:40]!r} is no text of a stored mapping")
    return value


def _encode(value: object) -> JsonValue:
    if value is None or type(value) in (bool, int, float, str):
        return cast(JsonValue, value)
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
        return _encode_mapping(value)
    if isinstance(value, tuple):
        return {TAG: "tuple", "value": [_encode(item) for item in value]}
    if isinstance(value, list):
        return [_encode(item) for item in value]
    raise TypeError(
        f"{value!r} of type {type(value).__name__} cannot be stored; "
        "use numbers, text, arrays or mappings"
    )


def _encode_mapping(mapping: Mapping[object, object]) -> JsonValue:
    """An object of JSON where its keys allow, else a list of pairs."""
    texts = [key for key in mapping if type(key) is str]
    if len(texts) == len(mapping) and TAG not in mapping:
        return {key: _encode(mapping[key]) for key in texts}
    pairs: list[JsonValue] = []
    for key, item in mapping.items():
        pairs.append([_encode(key), _encode(item)])
    return {TAG: "mapping", "value": pairs}


def _decode(value: object) -> object:
    if isinstance(value, list):
        return [_decode(item) for item in value]
    if not isinstance(value, dict):
        return value
    kind = value.get(TAG)
    if kind is None:
        return {key: _decode(item) for key, item in value.items()}
    content = value["value"]
    if kind == "scalar":
        return np.dtype(value["dtype"]).type(content)
    if kind == "array":
        return np.array(content, dtype=value["dtype"]).reshape(value["shape"])
    if kind == "tuple":
        return tuple(_decode(item) for item in content)
    if kind == "mapping":
        return {_decode(key): _decode(item) for key, item in content}
    raise ValueError(f"{kind!r} is no kind of stored value")
