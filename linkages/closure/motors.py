"""Displacements as unit dual quaternions over numbers of any kind.

A motor (w, x, y, z; w', x', y', z') is the rotation w + x i + y j + z k, and w' to z'
half the translation times it. Numbers that are zero without depending on an unknown
stay so: the equations of planar and spherical chains come out short.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

Number: TypeAlias = Any
Quaternion: TypeAlias = tuple[Number, Number, Number, Number]
Point: TypeAlias = list[Number]


class Motor(NamedTuple):
    """A displacement: ``real`` is the rotation, ``dual`` half the translation times
    it."""

    real: Quaternion
    dual: Quaternion


NOTHING = (0.0, 0.0, 0.0, 0.0)
IDENTITY = Motor((1.0, 0.0, 0.0, 0.0), NOTHING)


def turn(
    direction: np.ndarray,
    moment: np.ndarray,
    cosine: Number,
    sine: Number,
    advance: Number = 0.0,
) -> Motor:
    """The turn about the line of unit ``direction`` (3,) and ``moment`` (3,) by an angle
    whose half has this ``cosine`` and ``sine``, with an ``advance`` along it."""
    half = 0.5 * advance
    real = (cosine, *(sine * float(d) for d in direction))
    if is_zero(half) and not np.any(moment):
        return Motor(real, NOTHING)
    dual = [-half * sine]
    for d, m in zip(direction, moment, strict=True):
        dual.append(sine * float(m) + half * cosine * float(d))
    return Motor(real, tuple(dual))


def slide(direction: np.ndarray, distance: Number) -> Motor:
    """The translation by a ``distance`` along the unit vector ``direction`` (3,)."""
    half = 0.5 * distance
    return Motor((1.0, 0.0, 0.0, 0.0), (0.0, *(half * float(d) for d in direction)))


def product(first: Motor, second: Motor) -> Motor:
    """The displacement that does the ``second`` one first, in fixed axes."""
    real = _quaternion_product(first.real, second.real)
    if all(map(is_zero, (*first.dual, *second.dual))):
        return Motor(real, NOTHING)
    one = _quaternion_product(first.real, second.dual)
    other = _quaternion_product(first.dual, second.real)
    dual = tuple(a + b for a, b in zip(one, other, strict=True))
    return Motor(real, dual)


def translation(motor: Motor) -> Point:
    """The translation (3,) of a displacement, after its rotation."""
    w, x, y, z = motor.real
    return [2 * part for part in _quaternion_product(motor.dual, (w, -x, -y, -z))[1:]]


def _quaternion_product(a: Quaternion, b: Quaternion) -> Quaternion:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def rotated_about(
    point: Point,
    direction: np.ndarray,
    center: np.ndarray,
    cosine: Number,
    sine: Number,
) -> Point:
    """A ``point`` (3,) turned about the axis through ``center`` (3,) along the unit
    vector ``direction`` (3,), by an angle with this ``cosine`` and ``sine``."""
    x, y, z = direction
    along = np.outer(direction, direction)
    across = np.eye(3) - along
    turned = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    offsets = [one - float(c) for one, c in zip(point, center, strict=True)]
    result = []
    for row in range(3):
        kept = combination(along[row], offsets)
        first = combination(across[row], offsets)
        second = combination(turned[row], offsets)
        result.append(float(center[row]) + kept + cosine * first + sine * second)
    return result


def is_zero(number: Number) -> bool:
    """Whether a number is zero without depending on an unknown."""
    return isinstance(number, float) and number == 0.0


def combination(weights: np.ndarray, numbers: Sequence[Number]) -> Number:
    """The sum of weights (k,) times numbers (k,), without those that are zero."""
    total: Number = 0.0
    for weight, number in zip(weights, numbers, strict=True):
        if weight != 0.0 and not is_zero(number):
            total = total + float(weight) * number
    return total
