"""Joints of a mechanism: kinds as data, each a list of elementary motions.

A joint is given in one closed configuration of the mechanism, the reference
configuration, where all joint variables are 0. Lengths are in the user's unit, angles
in radians.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from linkages.decisions import is_one_direction
from linkages.mechanisms.couplings import Coupling
from linkages.values import (
    GeometryError,
    check_angle,
    check_direction,
    check_number,
    checked_vector,
    quoted,
    require,
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
        return FACETS[self]


class Place(Enum):
    """Where the point of a joint may be chosen, without another joint coming of it."""

    # Nowhere else.
    FIXED = "fixed"
    # Along the axis of the joint.
    ALONG = "along"
    # Anywhere.
    ANYWHERE = "anywhere"


class Move(Enum):
    """What a variable of a joint does in a frame whose third axis is its direction."""

    # Turns about the third axis, and goes on along it where the joint has a pitch.
    TURN = "turn"
    # Turns about the second direction of the joint.
    SECOND_TURN = "second turn"
    # Slides along the axis of this number.
    X = 0
    Y = 1
    Z = 2


class Fit(Enum):
    """What the frames of two bodies have in common at a joint."""

    # Their origins.
    POINT = "point"
    # The line along the third axis of the first one.
    LINE = "line"
    # The plane across the third axis of the first one.
    PLANE = "plane"
    # The angle between their third axes.
    ANGLE = "angle"
    # Their third axes.
    AXIS = "axis"
    # Their first axes.
    TURN = "turn"


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
        if not isinstance(self.name, str) or not self.name.strip():
            raise GeometryError(
                "name of a joint", quoted(self.name), "a text in quotes"
            )
        object.__setattr__(self, "kind", _checked_kind(self))
        object.__setattr__(self, "bodies", _checked_bodies(self))
        for key in ("point", "direction", "second_direction"):
            value = getattr(self, key)
            if value is not None:
                vector = checked_vector(f"{key} of joint {self.name}", value)
                object.__setattr__(self, key, vector)
        _check_geometry(self)
        object.__setattr__(self, "limits", _checked_limits(self))
        object.__setattr__(self, "locked", _checked_locks(self))
        object.__setattr__(self, "coupled", _checked_couplings(self))

    @property
    def place(self) -> np.ndarray:
        """Where the joint is (3,); the origin where no point is given."""
        return np.array(self.point or (0.0, 0.0, 0.0))

    @property
    def motions(self) -> tuple[Motion, ...]:
        """The elementary motions of one body with respect to the first one, in their
        order; those of a spherical joint are its own, and none stand here."""
        return tuple(_motion(self, move) for move in self.kind.facets.moves)

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


def unit_vector(vector: Sequence[float] | np.ndarray | None) -> np.ndarray:
    """The unit vector (3,) along a vector that is not 0, of whatever length."""
    array = np.array(vector, dtype=float)
    scaled = array / np.abs(array).max()
    unit: np.ndarray = scaled / np.linalg.norm(scaled)
    return unit


def _motion(joint: Joint, move: Move) -> Motion:
    """What a variable of a joint does; two slides and a turn are any motion in a plane,
    without a singular place."""
    third = unit_vector(joint.direction)
    if move is Move.TURN:
        advance = 0.0 if joint.pitch is None else joint.pitch / (2 * math.pi)
        return Motion(True, third, joint.place, advance)
    if move is Move.SECOND_TURN:
        return Motion(True, unit_vector(joint.second_direction), joint.place)
    along = np.array(joint.second_direction or np.eye(3)[np.argmin(np.abs(third))])
    first = unit_vector((along - (along @ third) * third).tolist())
    axes = (first, np.cross(third, first), third)
    return Motion(False, axes[move.value], joint.place, 1.0)


class KindFacets(NamedTuple):
    """All that a kind of joint is: the ``moves`` of one body with respect to another,
    and the ``parts`` that variables are called after; how the frames of both bodies
    ``fit``; which keys it needs, and may have besides (``optional``); where its
    ``place`` may be, and whether its point is for drawing alone. It is drawn as a
    ``shape``, on a rail where it slides along its axis, one for all its bodies where
    they share it. ``mjcf`` is what MJCF calls it, and ``sdf`` what SDF does, empty
    where they have no word."""

    moves: tuple[Move, ...]
    parts: tuple[str, ...]
    fit: tuple[Fit, ...]
    required: tuple[str, ...]
    optional: tuple[str, ...] = ()
    place: Place = Place.FIXED
    is_point_drawn_only: bool = False
    shape: Shape = Shape.CYLINDER
    has_rail: bool = False
    is_shared: bool = False
    mjcf: str = ""
    sdf: tuple[str, ...] = ()


def _read_facets() -> dict[JointKind, KindFacets]:
    """What every kind of joint is, from the table beside this module."""
    names = {"moves": Move, "fit": Fit, "place": Place, "shape": Shape}
    table = Path(__file__).with_name("joint_kinds.toml").read_text(encoding="utf-8")
    facets = {}
    for kind, fields in tomllib.loads(table).items():
        for key, value in fields.items():
            if isinstance(value, list):
                fields[key] = tuple(
                    names[key][one] if key in names else one for one in value
                )
            elif key in names:
                fields[key] = names[key][value]
        facets[JointKind(kind)] = KindFacets(**fields)
    return facets


FACETS = _read_facets()
# kinds whose point is for drawing alone
DRAWN_ONLY = [kind for kind, facets in FACETS.items() if facets.is_point_drawn_only]


# --- checks ---------------------------------------------------------------------------


def _checked_kind(joint: Joint) -> JointKind:
    try:
        return JointKind(joint.kind)
    except ValueError:
        allowed = f"one of {', '.join(JointKind)}"
        what = f"kind of joint {joint.name}"
        raise GeometryError(what, quoted(joint.kind), allowed) from None


def _checked_bodies(joint: Joint) -> tuple[str, ...]:
    what = f"bodies of joint {joint.name}"
    bodies = _listed(what, joint.bodies, "a list of two names or more")
    for body in bodies:
        if not isinstance(body, str) or not body.strip():
            raise GeometryError(what, quoted(body), "names, texts in quotes")
    require(len(bodies) >= 2, what, list(bodies), "two names or more")
    for body in bodies:
        is_once = bodies.count(body) == 1
        require(is_once, what, list(bodies), f"different; {body} stands twice")
    return bodies


def _listed(what: str, given: object, allowed: str) -> tuple[Any, ...]:
    """What is given as a tuple; raises `GeometryError` where it is no list."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise GeometryError(what, quoted(given), allowed)
    return tuple(given)


def _check_geometry(joint: Joint) -> None:
    """Raise `GeometryError` for coordinates whose squares are beyond all numbers, for
    keys that are missing or too many, and for directions that are none."""
    facets = joint.kind.facets
    owner = f"of joint {joint.name}"
    if joint.point is not None:
        allowed = f"of coordinates up to {LARGEST:.0e}"
        is_small = bool(np.abs(joint.point).max() <= LARGEST)
        require(is_small, f"point {owner}", list(joint.point), allowed)
    for key in facets.required:
        allowed = f"given, as joint {joint.name} is {joint.kind}"
        is_given = getattr(joint, key) is not None
        require(is_given, f"{key} {owner}", "a missing key", allowed)
    for key in GEOMETRY:
        value = getattr(joint, key)
        allowed = f"left out, as joint {joint.name} is {joint.kind}"
        is_left_out = value is None or key in facets.required + facets.optional
        require(is_left_out, f"{key} {owner}", value, allowed)
    for key in ("direction", "second_direction"):
        if getattr(joint, key) is not None:
            check_direction(f"{key} {owner}", getattr(joint, key))
    if joint.pitch is not None:
        check_number(f"pitch {owner}", joint.pitch)
    if joint.direction is not None and joint.second_direction is not None:
        across = np.cross(
            unit_vector(joint.direction), unit_vector(joint.second_direction)
        )
        is_along = is_one_direction(float(np.linalg.norm(across)))
        value = list(joint.second_direction)
        allowed = "not parallel to its direction"
        require(not is_along, f"second_direction {owner}", value, allowed)


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
        require(len(ends) == 2, what, list(ends), allowed)
        for value in ends:
            check_value(what, value, motion)
        check_order(what, list(ends))
        limits.append((ends[0], ends[1]))
    return tuple(limits)


def check_order(what: str, ends: list[Any]) -> None:
    """Raise `GeometryError` unless the first one of limits is smaller than the other."""
    allowed = "a smaller number and a larger one"
    if ends[0] == ends[1]:
        allowed += f"; a joint that stands still has locked = {ends[0]}"
    require(bool(ends[0] < ends[1]), what, ends, allowed)


def _by_variable(
    joint: Joint, key: str, number: str, what_for: str = ", one for each variable"
) -> list[tuple[Any, Motion]]:
    """What a joint has under a ``key`` for each of its variables, None where nothing is
    given, and what the variable does; raises `GeometryError` for another ``number``."""
    motions = joint.motions * (len(joint.bodies) - 1)
    given = tuple(getattr(joint, key)) or (None,) * len(motions)
    is_whole = len(given) == len(motions)
    require(is_whole, number, len(given), f"{len(motions)}{what_for}")
    return list(zip(given, motions, strict=True))


def _checked_locks(joint: Joint) -> tuple[float | None, ...]:
    what = f"locked of joint {joint.name}"
    rows = _by_variable(joint, "locked", f"number of values of {what}")
    for (value, motion), pair in zip(rows, joint.limits, strict=True):
        if value is not None:
            check_value(what, value, motion)
            low, high = pair or (-math.inf, math.inf)
            is_within = bool(low <= value <= high)
            require(is_within, what, value, f"within the limits {[low, high]}")
    return tuple(value for value, _ in rows)


def check_value(what: str, value: object, motion: Motion) -> None:
    """Raise `GeometryError` for what is no value of a variable with this motion."""
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
        allowed = f"left out, as the variable is coupled to {coupling.to}"
        require(value is None, f"locked of joint {joint.name}", value, allowed)
    return tuple(coupling for coupling, _ in rows)


# --- displacements --------------------------------------------------------------------


def transforms(motion: Motion, values: np.ndarray) -> np.ndarray:
    """The transforms (k, 4, 4) of an elementary motion by ``values`` (k,), in rad or
    the user's unit."""
    result = np.tile(np.eye(4), (len(values), 1, 1))
    if not motion.is_turn:
        result[:, :3, 3] = values[:, None] * motion.direction
        return result
    rotation = turns(motion.direction, values)
    result[:, :3, :3] = rotation
    advance = (motion.advance * values)[:, None] * motion.direction
    result[:, :3, 3] = motion.point - rotation @ motion.point + advance
    return result


def turns(direction: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Rotations (k, 3, 3) about a unit vector (3,) by ``angles`` (k,)."""
    x, y, z = direction
    turned = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    along = np.outer(direction, direction)
    cosines, sines = np.cos(angles)[:, None, None], np.sin(angles)[:, None, None]
    rotations: np.ndarray = along + cosines * (np.eye(3) - along) + sines * turned
    return rotations
