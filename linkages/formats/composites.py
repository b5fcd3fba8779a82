"""Joints that several joints one after the other make together, in MJCF and in SDF."""

from __future__ import annotations

import math
from collections.abc import Mapping, MutableMapping
from typing import NamedTuple

import numpy as np

from linkages.decisions import is_one_joint
from linkages.formats.assembly import frame_along, translation
from linkages.formats.xml_tree import Element
from linkages.mechanisms.joint import JointKind, Limits

TINY = 1e-300  # of coordinates that are all 0


class Axis(NamedTuple):
    """A joint of a body at qpos0: its ``kind``, "hinge", "slide" or "ball", and its
    ``point`` (3,) and ``direction`` (3,) in the world."""

    name: str
    kind: str
    point: np.ndarray
    direction: np.ndarray
    limits: Limits | None


class AxisCoupling(NamedTuple):
    """An axis that is ``ratio`` times the axis called ``to``, plus ``offset``, and the
    ``element`` that says so."""

    to: str
    ratio: float
    offset: float
    element: Element


class WorldJoint(NamedTuple):
    """A joint with the frames (4, 4) of both of its bodies, in the world at qpos0;
    ``axes`` are the names of the axes that its variables are."""

    name: str
    kind: JointKind
    first: np.ndarray
    second: np.ndarray
    limits: tuple[Limits | None, ...]
    locked: tuple[float | None, ...]
    axes: tuple[str, ...]
    pitch: float | None = None
    is_reversed: bool = False  # the first frame is in the body, not in its parent


def joints_of_axes(
    axes: list[Axis],
    couplings: MutableMapping[str, AxisCoupling],
    locks: Mapping[str, float],
) -> list[WorldJoint]:
    """The joints that the ``axes`` of a body make, one after the other.

    A coupling of a slide with a hinge on its axis makes a helical joint, and is taken
    out of ``couplings``.
    """
    kinds = [axis.kind for axis in axes]
    if kinds == ["hinge", "slide"] and _is_one_axis(axes[0], axes[1]):
        return [_turn_and_slide(axes[0], axes[1], couplings, locks)]
    if kinds == ["slide", "hinge"] and _is_one_axis(axes[1], axes[0]):
        return [_turn_and_slide(axes[1], axes[0], couplings, locks)]
    if kinds == ["hinge", "hinge"] and _is_universal(axes):
        return [_universal(axes, locks)]
    if kinds == ["slide", "slide", "hinge"] and _is_plane(axes):
        return [_plane(axes, locks)]
    if kinds == ["hinge", "slide", "slide"]:
        inverse = [_opposite(axis) for axis in reversed(axes)]
        if _is_plane(inverse):
            return [_plane(inverse, locks)._replace(is_reversed=True)]
    return [_single(axis, locks) for axis in axes]


def _unit(vector: np.ndarray) -> np.ndarray:
    unit: np.ndarray = vector / np.linalg.norm(vector)
    return unit


def _is_one_axis(turn: Axis, slide: Axis) -> bool:
    """Whether a slide is along the axis of a turn, in the same direction."""
    first, second = _unit(turn.direction), _unit(slide.direction)
    sine = np.linalg.norm(np.cross(first, second))
    return is_one_joint(float(sine)) and bool(first @ second > 0)


def _is_universal(axes: list[Axis]) -> bool:
    first, second = axes
    points = np.array([first.point, second.point])
    size = float(np.abs(points).max(initial=TINY))
    distance = float(np.linalg.norm(points[1] - points[0]))
    sine = np.linalg.norm(np.cross(_unit(first.direction), _unit(second.direction)))
    is_parallel = is_one_joint(float(sine))
    return is_one_joint(distance, size) and not is_parallel


def _opposite(axis: Axis) -> Axis:
    """The same joint the other way round: its variable keeps its value."""
    return axis._replace(direction=-axis.direction)


def _is_plane(axes: list[Axis]) -> bool:
    x, y, normal = (_unit(axis.direction) for axis in axes)
    return is_one_joint(float(np.linalg.norm(np.cross(normal, x) - y)))


def _name(axes: list[Axis]) -> str:
    """What the names of axes have in common before their last point: "J" of "J.turn"
    and "J.slide"; else all of them."""
    names = [axis.name for axis in axes]
    stems = {name.rpartition(".")[0] for name in names}
    if len(stems) == 1 and stems != {""}:
        return stems.pop()
    return "+".join(names)


def _names(axes: list[Axis]) -> tuple[str, ...]:
    return tuple(axis.name for axis in axes)


def _locked(axes: list[Axis], locks: Mapping[str, float]) -> tuple[float | None, ...]:
    return tuple(locks.get(axis.name) for axis in axes)


def _single(axis: Axis, locks: Mapping[str, float]) -> WorldJoint:
    if axis.kind == "ball":
        frame = translation(axis.point)
        return WorldJoint(axis.name, JointKind.SPHERICAL, frame, frame, (), (), ())
    kind = JointKind.REVOLUTE if axis.kind == "hinge" else JointKind.PRISMATIC
    frame = frame_along(axis.point, axis.direction)
    locked = _locked([axis], locks)
    limits, names = (axis.limits,), (axis.name,)
    return WorldJoint(axis.name, kind, frame, frame, limits, locked, names)


def _turn_and_slide(
    turn: Axis,
    slide: Axis,
    couplings: MutableMapping[str, AxisCoupling],
    locks: Mapping[str, float],
) -> WorldJoint:
    frame = frame_along(turn.point, turn.direction)
    coupling = couplings.get(slide.name)
    if coupling is not None and coupling.to == turn.name and not coupling.offset:
        del couplings[slide.name]
        locked = _locked([turn], locks)
        pitch = 2 * math.pi * coupling.ratio
        kind = JointKind.HELICAL
        limits: tuple[Limits | None, ...] = (turn.limits,)
        names: tuple[str, ...] = (turn.name,)
        return WorldJoint(turn.name, kind, frame, frame, limits, locked, names, pitch)
    axes = [turn, slide]
    limits = (turn.limits, slide.limits)
    name = _name(axes)
    kind = JointKind.CYLINDRICAL
    names = (turn.name, slide.name)
    return WorldJoint(name, kind, frame, frame, limits, _locked(axes, locks), names)


def _universal(axes: list[Axis], locks: Mapping[str, float]) -> WorldJoint:
    first, second = (frame_along(axis.point, axis.direction) for axis in axes)
    limits = (axes[0].limits, axes[1].limits)
    locked = _locked(axes, locks)
    kind = JointKind.UNIVERSAL
    return WorldJoint(_name(axes), kind, first, second, limits, locked, _names(axes))


def _plane(axes: list[Axis], locks: Mapping[str, float]) -> WorldJoint:
    x, _, normal = axes
    frame = frame_along(normal.point, normal.direction, x.direction)
    limits = tuple(axis.limits for axis in axes)
    kind = JointKind.PLANAR
    locked = _locked(axes, locks)
    return WorldJoint(_name(axes), kind, frame, frame, limits, locked, _names(axes))
