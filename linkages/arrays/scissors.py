"""Scissors: pairs of rods that cross at a pivot, joined end to end, in a plane.

All pivots turn by the same angle, and the joints at the ends by as much as follows from
the angles of a quadrangle.
"""

from __future__ import annotations

from math import cos, pi, sin

from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import require

UPWARDS = (0.0, 0.0, 1.0)
Place = tuple[float, float]


def scissors(units: int, angle: float) -> Mechanism:
    """So many units in a row, of straight rods of length 2 which the ``angle`` (rad)
    parts, from 0 to pi: a lazy tongs, of two units or more."""
    x, y = cos(0.5 * angle), sin(0.5 * angle)
    joints = []
    for k in range(units):
        rising, falling = f"r{k + 1}", f"f{k + 1}"
        joints.append(_hinge(f"P{k + 1}", rising, falling, (2 * k * x, 0.0)))
        if k + 1 < units:
            end = (2 * k + 1) * x
            joints.append(_hinge(f"U{k + 1}", rising, f"f{k + 2}", (end, y)))
            joints.append(_hinge(f"L{k + 1}", falling, f"r{k + 2}", (end, -y)))
    return Mechanism(tuple(joints), "scissors", is_planar=True)


def angulated_ring(units: int, angle: float) -> Mechanism:
    """So many units in a ring, of rods with two arms of length 1 and a kink of 2 pi /
    units, such that each unit spans 2 pi / units at any ``angle`` (rad) between its rods
    (Hoberman 1990).

    On a radius are an inner and an outer joint, sin(angle/2) to both sides of the foot of
    the pivots next to it. Raises `GeometryError` for an angle at which the inner joints
    would be beyond the middle.
    """
    half = pi / units
    most = 180.0 - 360.0 / units
    value = f"{angle * 180 / pi:g} degrees"
    is_less = angle < (pi - 2 * half) * (1 - 1e-12)
    require(is_less, "angle", value, f"less than {most:g} degrees")
    pivot = cos(0.5 * angle) / sin(half)
    foot, reach = pivot * cos(half), sin(0.5 * angle)
    outer, inner = foot + reach, foot - reach
    joints = []
    for k in range(units):
        out, into = f"o{k + 1}", f"i{k + 1}"  # rods to the outer and to the inner joint
        before = (k - 1) % units + 1
        turn = 2 * half * k
        joints += [
            _hinge(f"P{k + 1}", out, into, _polar(pivot, turn + half)),
            _hinge(f"O{k + 1}", into, f"o{before}", _polar(outer, turn)),
            _hinge(f"I{k + 1}", out, f"i{before}", _polar(inner, turn)),
        ]
    return Mechanism(tuple(joints), "angulated-scissors", is_planar=True)


def _polar(distance: float, turn: float) -> Place:
    return distance * cos(turn), distance * sin(turn)


def _hinge(name: str, first: str, second: str, place: Place) -> Joint:
    """A hinge across the plane."""
    return Joint(name, JointKind.REVOLUTE, (first, second), (*place, 0.0), UPWARDS)
