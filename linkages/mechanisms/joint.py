"""Joints of a mechanism: kinds as data, each a list of elementary motions.

A joint is given in one closed configuration of the mechanism, the reference
configuration, where all joint variables are 0. Lengths are in the user's unit, angles
in radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from linkages.decisions import is_one_direction
from linkages.mechanisms.couplings import Coupling
from linkages.values import (
    GeometryError,
    check_angle,
    check_direction,
    check_number,
    quoted,
)

Vector: TypeAlias = tuple[float, float, float]
# The least and the largest value of a variable.
Limits: TypeAlias = tuple[float, float]


class JointKind(StrEnum):
    """What a joint lets two bodies do to each other."""

    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"
    CYLINDRICAL = "cylindrical"
    HELICAL = "helical"
    UNIVERSAL = "universal"
    SPHERICAL = "spherical"
    PLANAR = "planar"
    RIGID = "rigid"

    @property
    def facets(self) -> KindFacets:
        """All that the kind is."""
        return _FACETS[self]


class Place(Enum):
    """Where the point of a joint may be chosen, without another joint coming of it."""

    # Nowhere else.
    FIXED = "fixed"
    # Along the axis of the joint.
    ALONG = "along"
    # Anywhere.
    ANYWHERE = "anywhere"


class Shape(Enum):
    """What stands for a joint in models."""

    CYLINDER = "cylinder"
    BOX = "box"
    PLATE = "plate"
    BALL = "ball"


LARGEST = 1e100  # coordinate
GEOMETRY = ("point", "direction", "second_direction", "pitch")


class Motion(NamedTuple):
    """An elementary motion: a turn about an axis through ``point`` (3,) along the unit
    vector ``direction`` (3,) that advances by so much a radian, or, without a turn, a
    slide along it."""

    is_turn: bool
    direction: np.ndarray
    point: np.ndarray
    advance: float = 0.0


@dataclass(frozen=True)
class Joint:
    """A joint between two bodies, or between more on one axis.

    The variables are those of every body after the first one with respect to the first
    one. ``point`` and ``direction`` give the axis, the direction of a slide, or the
    normal of a planar joint, ``second_direction`` the second axis of a universal joint
    or the first slide of a planar one, ``pitch`` the advance of a helical joint in a
    full turn. ``limits``, ``locked`` and ``coupled`` have one entry a variable, None
    where there is none, in radians and in the unit of length. Raises `GeometryError`
    for anything that is no joint.
    """

    name: str
    kind: JointKind
    bodies: tuple[str, ...]
    point: Vector | None = None
    direction: Vector | None = None
    second_direction: Vector | None = None
    pitch: float | None = None
    limits: tuple[Limits | None, ...] = ()
    locked: tuple[float | None, ...] = ()
    coupled: tuple[Coupling | None, ...] = ()

    def __post_init__(self) -> None:
        _check_name(self.name)
        object.__setattr__(self, "kind", _checked_kind(self))
        object.__setattr__(self, "bodies", _checked_bodies(self))
        for key in ("point", "direction", "second_direction"):
            value = getattr(self, key)
            if value is not None:
                vector = _checked_vector(f"{key} of joint {self.name}", value)
                object.__setattr__(self, key, vector)
        _check_size(self)
        _check_needs(self)
        for key in ("direction", "second_direction"):
            _check_direction(self, key)
        if self.pitch is not None:
            check_number(f"pitch of joint {self.name}", self.pitch)
        _check_second_direction(self)
        limits = _checked_limits(self)
        object.__setattr__(self, "limits", limits)
        object.__setattr__(self, "locked", _checked_locks(self, limits))
        object.__setattr__(self, "coupled", _checked_couplings(self))

    @property
    def place(self) -> np.ndarray:
        """Where the joint is (3,); the origin where no point is given."""
        return np.array(self.point or (0.0, 0.0, 0.0))

    @property
    def motions(self) -> tuple[Motion, ...]:
        """The elementary motions of one body with respect to the first one, in their
        order; those of a spherical joint are its own, and none stand here."""
        return self.kind.facets.motions(self)

    @property
    def parts(self) -> tuple[str, ...]:
        """What every variable is called within the joint, empty where it is the only
        one."""
        parts = self.kind.facets.parts
        if len(self.bodies) == 2:
            return parts
        return tuple(
            f"{body}.{part}" if part else body
            for body in self.bodies[1:]
            for part in parts
        )

    @property
    def labels(self) -> tuple[str, ...]:
        """What every variable is called in the mechanism."""
        return tuple(
            f"{self.name}.{part}" if part else self.name for part in self.parts
        )

    @property
    def names(self) -> tuple[str, ...]:
        """What the joint, its variables and its rotations are called in the
        mechanism."""
        own = [self.name, *self.labels]
        if self.kind is JointKind.SPHERICAL and len(self.bodies) > 2:
            own += [f"{self.name}.{body}" for body in self.bodies[1:]]
        return tuple(dict.fromkeys(own))

    @property
    def freedoms(self) -> int:
        """How many freedoms the joint has, with nothing locked."""
        if self.kind is JointKind.SPHERICAL:
            return 3 * (len(self.bodies) - 1)
        return len(self.parts)


# --- motions --------------------------------------------------------------------------


def _unit(vector: Sequence[float] | None) -> np.ndarray:
    array = np.array(vector, dtype=float)
    largest = np.abs(array).max()
    scaled = array / largest
    unit: np.ndarray = scaled / np.linalg.norm(scaled)
    return unit


def _turn(joint: Joint) -> tuple[Motion, ...]:
    return (Motion(True, _unit(joint.direction), joint.place),)


def _slide(joint: Joint) -> tuple[Motion, ...]:
    return (Motion(False, _unit(joint.direction), joint.place, 1.0),)


def _turn_and_slide(joint: Joint) -> tuple[Motion, ...]:
    return _turn(joint) + _slide(joint)


def _screw(joint: Joint) -> tuple[Motion, ...]:
    assert joint.pitch is not None
    advance = joint.pitch / (2 * math.pi)
    return (Motion(True, _unit(joint.direction), joint.place, advance),)


def _two_turns(joint: Joint) -> tuple[Motion, ...]:
    second = _unit(joint.second_direction)
    return (
        Motion(True, _unit(joint.direction), joint.place),
        Motion(True, second, joint.place),
    )


def _plane(joint: Joint) -> tuple[Motion, ...]:
    """Two slides and a turn: any motion in the plane, without a singular place."""
    normal = _unit(joint.direction)
    along = joint.second_direction
    if along is None:
        along = tuple(np.eye(3)[np.argmin(np.abs(normal))])
    inside = np.array(along) - (np.array(along) @ normal) * normal
    first = _unit(inside.tolist())
    second = np.cross(normal, first)
    return (
        Motion(False, first, joint.place, 1.0),
        Motion(False, second, joint.place, 1.0),
        Motion(True, normal, joint.place),
    )


def _nothing(joint: Joint) -> tuple[Motion, ...]:
    return ()


class KindFacets(NamedTuple):
    """All that a kind of joint is: the ``motions`` of one body with respect to another,
    and the ``parts`` that variables are called after; which keys it needs, and may
    have besides (``optional``); where its ``place`` may be, and whether its point is
    for drawing alone. It is drawn as a ``shape``, on a rail where it slides along its
    axis, one for all its bodies where they share it."""

    motions: Callable[[Joint], tuple[Motion, ...]]
    parts: tuple[str, ...]
    required: tuple[str, ...]
    optional: tuple[str, ...] = ()
    place: Place = Place.FIXED
    is_point_drawn_only: bool = False
    shape: Shape = Shape.CYLINDER
    has_rail: bool = False
    is_shared: bool = False


_FACETS = {
    JointKind.REVOLUTE: KindFacets(
        _turn,
        ("",),
        required=("point", "direction"),
        place=Place.ALONG,
        is_shared=True,
    ),
    JointKind.PRISMATIC: KindFacets(
        _slide,
        ("",),
        required=("direction",),
        optional=("point",),
        place=Place.ANYWHERE,
        is_point_drawn_only=True,
        shape=Shape.BOX,
        has_rail=True,
    ),
    JointKind.CYLINDRICAL: KindFacets(
        _turn_and_slide,
        ("turn", "slide"),
        required=("point", "direction"),
        place=Place.ALONG,
        has_rail=True,
    ),
    JointKind.HELICAL: KindFacets(
        _screw,
        ("",),
        required=("point", "direction", "pitch"),
        place=Place.ALONG,
        has_rail=True,
    ),
    JointKind.UNIVERSAL: KindFacets(
        _two_turns,
        ("first", "second"),
        required=("point", "direction", "second_direction"),
    ),
    JointKind.SPHERICAL: KindFacets(
        _nothing, (), required=("point",), shape=Shape.BALL, is_shared=True
    ),
    JointKind.PLANAR: KindFacets(
        _plane,
        ("x", "y", "turn"),
        required=("direction",),
        optional=("point", "second_direction"),
        place=Place.ANYWHERE,
        shape=Shape.PLATE,
    ),
    JointKind.RIGID: KindFacets(
        _nothing,
        (),
        required=(),
        optional=("point",),
        place=Place.ANYWHERE,
        is_point_drawn_only=True,
    ),
}


# kinds whose point is for drawing alone
DRAWN_ONLY = [kind for kind, facets in _FACETS.items() if facets.is_point_drawn_only]


# --- checks ---------------------------------------------------------------------------


def _check_name(name: object) -> None:
    if not isinstance(name, str) or not name.strip():
        raise GeometryError("name of a joint", quoted(name), "a text in quotes")


def _checked_kind(joint: Joint) -> JointKind:
    try:
        return JointKind(joint.kind)
    except ValueError:
        kinds = ", ".join(JointKind)
        what = f"kind of joint {joint.name}"
        raise GeometryError(what, quoted(joint.kind), f"one of {kinds}") from None


def _checked_bodies(joint: Joint) -> tuple[str, ...]:
    what = f"bodies of joint {joint.name}"
    given = joint.bodies
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise GeometryError(what, quoted(given), "a list of two names or more")
    bodies = tuple(given)
    for body in bodies:
        if not isinstance(body, str) or not body.strip():
            raise GeometryError(what, quoted(body), "names, texts in quotes")
    if len(bodies) < 2:
        raise GeometryError(what, list(bodies), "two names or more")
    for body in bodies:
        if bodies.count(body) > 1:
            raise GeometryError(what, list(bodies), f"different; {body} stands twice")
    return bodies


def _checked_vector(what: str, row: object) -> Vector:
    allowed = "a vector [x, y, z]"
    if isinstance(row, str) or not isinstance(row, Iterable):
        raise GeometryError(what, quoted(row), allowed)
    coordinates = list(row)
    if len(coordinates) != 3:
        raise GeometryError(what, coordinates, allowed)
    for k, coordinate in enumerate(coordinates, start=1):
        check_number(f"{what}[{k}]", coordinate)
    x, y, z = (float(coordinate) for coordinate in coordinates)
    return (x, y, z)


def _check_size(joint: Joint) -> None:
    """Refuse coordinates whose squares are beyond all numbers."""
    if joint.point is not None and np.abs(joint.point).max() > LARGEST:
        allowed = f"of coordinates up to {LARGEST:.0e}"
        raise GeometryError(f"point of joint {joint.name}", list(joint.point), allowed)


def _check_needs(joint: Joint) -> None:
    facets = joint.kind.facets
    required, optional = facets.required, facets.optional
    for key in required:
        if getattr(joint, key) is None:
            allowed = f"given, as joint {joint.name} is {joint.kind}"
            raise GeometryError(
                f"{key} of joint {joint.name}", "a missing key", allowed
            )
    for key in GEOMETRY:
        value = getattr(joint, key)
        if value is not None and key not in required + optional:
            allowed = f"left out, as joint {joint.name} is {joint.kind}"
            raise GeometryError(f"{key} of joint {joint.name}", value, allowed)


def _check_direction(joint: Joint, key: str) -> None:
    direction = getattr(joint, key)
    if direction is not None:
        check_direction(f"{key} of joint {joint.name}", direction)


def _check_second_direction(joint: Joint) -> None:
    if joint.direction is None or joint.second_direction is None:
        return
    across = np.cross(_unit(joint.direction), _unit(joint.second_direction))
    if is_one_direction(float(np.linalg.norm(across))):
        what = f"second_direction of joint {joint.name}"
        value = list(joint.second_direction)
        raise GeometryError(what, value, "not parallel to its direction")


def _checked_limits(joint: Joint) -> tuple[Limits | None, ...]:
    what = f"limits of joint {joint.name}"
    allowed = "a list with [low, high] or None for each variable"
    _listed(what, joint.limits, allowed)
    limits: list[Limits | None] = []
    for pair, motion in _by_variable(joint, "limits", f"number of {what}", ""):
        if pair is None:
            limits.append(None)
            continue
        ends = _listed(what, pair, allowed)
        if len(ends) != 2:
            raise GeometryError(what, list(ends), allowed)
        for value in ends:
            _check_value(what, value, motion)
        low, high = ends
        if not low < high:
            allowed = "a smaller number and a larger one"
            if low == high:
                allowed += f"; a joint that stands still has locked = {low}"
            raise GeometryError(what, list(ends), allowed)
        limits.append((low, high))
    return tuple(limits)


def _by_variable(
    joint: Joint, key: str, number: str, what_for: str = ", one for each variable"
) -> list[tuple[Any, Motion]]:
    """What a joint has under a ``key`` for each of its variables, None where nothing is
    given, and what the variable does; raises `GeometryError` for another ``number``."""
    motions = joint.motions * (len(joint.bodies) - 1)
    given = tuple(getattr(joint, key)) or (None,) * len(motions)
    if len(given) != len(motions):
        raise GeometryError(number, len(given), f"{len(motions)}{what_for}")
    return list(zip(given, motions, strict=True))


def _listed(what: str, given: object, allowed: str) -> tuple[Any, ...]:
    """What is given as a tuple; raises `GeometryError` where it is no list."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise GeometryError(what, quoted(given), allowed)
    return tuple(given)


def _checked_locks(
    joint: Joint, limits: tuple[Limits | None, ...]
) -> tuple[float | None, ...]:
    what = f"locked of joint {joint.name}"
    rows = _by_variable(joint, "locked", f"number of values of {what}")
    for (value, motion), pair in zip(rows, limits, strict=True):
        if value is None:
            continue
        _check_value(what, value, motion)
        if pair is not None and not pair[0] <= value <= pair[1]:
            raise GeometryError(what, value, f"within the limits {list(pair)}")
    return tuple(value for value, _ in rows)


def _check_value(what: str, value: object, motion: Motion) -> None:
    check = check_angle if motion.is_turn else check_number
    check(what, value)


def _checked_couplings(joint: Joint) -> tuple[Coupling | None, ...]:
    what = f"coupled of joint {joint.name}"
    rows = _by_variable(joint, "coupled", f"number of values of {what}")
    for (coupling, _), value in zip(rows, joint.locked, strict=True):
        if coupling is None:
            continue
        if not isinstance(coupling, Coupling):
            raise GeometryError(what, quoted(coupling), "a `Coupling`")
        if value is not None:
            allowed = f"left out, as the variable is coupled to {coupling.to}"
            raise GeometryError(f"locked of joint {joint.name}", value, allowed)
    return tuple(coupling for coupling, _ in rows)
