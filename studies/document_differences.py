"""What differs between two JSON documents of maps, but for what may.

Times, seeds, versions and the estimate from random starts belong to a run, not to the
linkage; so does the configuration that stands for a surface, which is a random one. The
bound of an error is known to its order of magnitude only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from bifurc import Scope
from linkages.app.answer.document import Document

Json: TypeAlias = Any  # a value that JSON can hold

OF_THE_RUN = frozenset(
    {"seconds", "seed", "version", "missed_probability", "error", "max_residual"}
)
ANGLES = frozenset({"theta", "sample"})  # compared modulo full turns
CLOSE = 1e-9  # of two numbers: their difference, over 1 or their size
# A minimum of height v is flat: its place is known to the root of what its value is.
NEAR_MISS = 1e-6
ERRORS = 4.0  # the places of one point agree to as many of their stated errors


def differences(one: Document, other: Document) -> list[str]:
    """Where two documents differ, one line for each place."""
    lines: list[str] = []
    for key in one:
        if key in OF_THE_RUN:
            continue
        left, right = _of_the_linkage(key, one), _of_the_linkage(key, other)
        lines += values_differ(key, left, right)
    return lines


def _of_the_linkage(key: str, document: Mapping[str, Json]) -> Json:
    """The value of a key without what belongs to the run."""
    value = document[key]
    if key == "completeness":
        claims = [one for one in value["claims"] if one["scope"] != Scope.STARTS]
        return {**value, "claims": claims, "statement": None}
    if key == "forms":
        return [_without_random_sample(form) for form in value]
    return value


def _without_random_sample(form: Mapping[str, Json]) -> Json:
    if form["dimension"] == 1:
        return form
    return {**form, "sample": None}


def values_differ(
    path: str, one: Json, other: Json, closeness: float = CLOSE
) -> list[str]:
    """Where two values at ``path`` differ by more than ``closeness``, one line for each
    place."""
    if path.rpartition(".")[2] == "near_misses":
        closeness = NEAR_MISS
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return _in_mappings(path, one, other, closeness)
    if _is_numbers(one) and _is_numbers(other) and len(one) == len(other):
        return _in_numbers(path, one, other, closeness)
    if isinstance(one, list) and isinstance(other, list):
        return _in_lists(path, one, other, closeness)
    if isinstance(one, float) and isinstance(other, float):
        return _in_numbers(path, [one], [other], closeness)
    return [] if one == other else [f"{path}: {one} and {other}"]


def _in_mappings(
    path: str, one: Mapping[str, Json], other: Mapping[str, Json], closeness: float
) -> list[str]:
    errors = (one.get("error", 0.0), other.get("error", 0.0))
    closeness = max(closeness, ERRORS * max(errors))
    lines: list[str] = []
    for key in sorted({*one, *other} - OF_THE_RUN):
        place = f"{path}.{key}"
        if key in one and key in other:
            lines += values_differ(place, one[key], other[key], closeness)
        else:
            lines.append(f"{place}: only in the {'first' if key in one else 'second'}")
    return lines


def _in_lists(
    path: str, one: Sequence[Json], other: Sequence[Json], closeness: float
) -> list[str]:
    if len(one) != len(other):
        return [f"{path}: {len(one)} and {len(other)} of them"]
    lines: list[str] = []
    for i, (left, right) in enumerate(zip(one, other, strict=True)):
        lines += values_differ(f"{path}[{i}]", left, right, closeness)
    return lines


def _in_numbers(
    path: str, one: Sequence[float], other: Sequence[float], closeness: float
) -> list[str]:
    left, right = np.array(one, dtype=float), np.array(other, dtype=float)
    with np.errstate(invalid="ignore"):  # infinite ones are equal or not
        gaps = left - right
    key = path.rpartition(".")[2]
    if key in ANGLES or path.startswith("rigid_assemblies"):
        gaps -= 2 * np.pi * np.round(gaps / (2 * np.pi))
    allowed = closeness * np.maximum(1.0, np.abs(left))
    if key == "singular_value":
        allowed = closeness * np.abs(left)
    are_the_same: np.ndarray = (np.abs(gaps) <= allowed) | (left == right)
    are_the_same |= np.isnan(left) & np.isnan(right)
    if np.all(are_the_same):
        return []
    return [f"{path}: off by {np.abs(gaps).max():.2g}"]


def _is_numbers(value: Json) -> bool:
    return isinstance(value, list) and all(isinstance(x, float | int) for x in value)
