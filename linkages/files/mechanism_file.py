"""Reading a mechanism from the content of a TOML file.

Four formats, told apart by their keys: ``[[joints]]``, axes in one closed
configuration, ``[[loops]]``, tables of Denavit and Hartenberg that share joints
(`linkages.files.loops`), ``bars`` between ``[points]`` of a plane
(`linkages.files.bars`), and ``arcs`` between ``[points]`` of a sphere
(`linkages.files.arcs`).
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from linkages.files.arcs import read_arcs
from linkages.files.bars import read_bars
from linkages.files.loops import read_loops
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import DRAWN_ONLY, Joint, Motion
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.origin import Coordinates, counted_from_near, origin_of
from linkages.structure.plane import normal_of_plane
from linkages.values import GeometryError, check_angle, check_keys, check_number, quoted

Content: TypeAlias = Mapping[str, Any]

OF_FILE = ("name", "angles", "planar", "origin", "rounding", "joints")
OF_BARS = ("name", "fixed", "bars", "points", "points_on_bars", "origin")
OF_ARCS = ("name", "angles", "fixed", "arcs", "points", "points_on_arcs")
OF_LOOPS = ("name", "angles", "loops")
OF_JOINT = (
    "name",
    "kind",
    "bodies",
    "point",
    "direction",
    "second_direction",
    "pitch",
    "limits",
    "locked",
    "coupled",
)
OF_VALUES = ("limits", "locked", "coupled")
OF_COUPLING = ("to", "ratio", "offset")
UNITS = {"deg": math.pi / 180, "rad": 1.0}
FREE = "free"  # in a list of locks: a variable that has none
MANY_TURNS = 4 * math.pi  # limits of a turn beyond it, rad, may be meant in degrees

log = logging.getLogger(__name__)


def read_mechanism(content: Content, name: str) -> Mechanism:
    """The mechanism that the content of a TOML file describes; without a name it gets
    this one. Raises `GeometryError` for anything wrong in it."""
    given = content.get("name", name)
    if not isinstance(given, str):
        raise GeometryError("name", quoted(given), "a text in quotes")
    if "loops" in content and "joints" not in content:
        check_keys("key", content, OF_LOOPS)
        return read_loops(content["loops"], given, _angle_unit(content))
    if "arcs" in content and "joints" not in content:
        check_keys("key", content, OF_ARCS)
        return read_arcs(content, given, _angle_unit(content))
    if "joints" not in content:
        check_keys("key", content, OF_BARS)
        return read_bars(content, given)
    check_keys("key", content, OF_FILE)
    unit = _angle_unit(content)
    tables = content["joints"]
    if not isinstance(tables, list):
        raise GeometryError("joints", quoted(tables), "tables [[joints]]")
    tables, near = _from_near(tables)
    joints = [_read_joint(k, table, unit) for k, table in enumerate(tables, start=1)]
    mechanism = Mechanism(tuple(joints), given)
    return replace(
        mechanism,
        is_planar=_read_planar(content, mechanism),
        origin=origin_of(content, near.origin),
        rounding=max(near.rounding, _read_rounding(content)),
    )


def _from_near(tables: Sequence[object]) -> tuple[list[object], Coordinates]:
    """The tables of joints with points that are counted from one of them, where they
    are far from the origin, and these points."""
    points = [
        table.get("point") if isinstance(table, Mapping) else None for table in tables
    ]
    are_anywhere = [
        isinstance(table, Mapping) and table.get("kind") in DRAWN_ONLY
        for table in tables
    ]
    near = counted_from_near(points, are_anywhere)
    moved: list[object] = []
    for table, row in zip(tables, near.rows, strict=True):
        if isinstance(table, Mapping) and row is not None:
            moved.append({**table, "point": row})
        else:
            moved.append(table)
    return moved, near


def _read_planar(content: Content, mechanism: Mechanism) -> bool:
    """Whether a body has three freedoms for Grübler's count, as the file says."""
    is_planar = content.get("planar", False)
    if not isinstance(is_planar, bool):
        raise GeometryError("planar", quoted(is_planar), "true or false")
    if is_planar and normal_of_plane(mechanism) is None:
        allowed = "false, as not all axes are parallel and all slides across them"
        raise GeometryError("planar", "true", allowed)
    return is_planar


def _read_rounding(content: Content) -> float:
    """How far off coordinates of points may be, as the file says."""
    rounding = content.get("rounding", 0.0)
    check_number("rounding", rounding)
    if rounding < 0:
        raise GeometryError("rounding", rounding, "0 or more, a length")
    return float(rounding)


def _angle_unit(content: Content) -> float:
    unit = content.get("angles", "deg")
    if not isinstance(unit, str) or unit not in UNITS:
        allowed = '"deg", which it is where nothing is said, or "rad"'
        raise GeometryError("angles", quoted(unit), allowed)
    return UNITS[unit]


# --- one joint ------------------------------------------------------------------------


def _read_joint(number: int, table: object, unit: float) -> Joint:
    """A joint from its table; angles are in this ``unit``, in rad."""
    if not isinstance(table, Mapping):
        raise GeometryError(f"joints[{number}]", quoted(table), "a table")
    name = table.get("name")
    if name is None:
        raise GeometryError(f"name of joints[{number}]", "a missing key", "a text")
    check_keys(f"key of joint {name}", table, OF_JOINT)
    for key in ("kind", "bodies"):
        if key not in table:
            what = f"{key} of joint {name}"
            raise GeometryError(what, "a missing key", "given for every joint")
    geometry = {
        key: table[key] for key in OF_JOINT if key in table and key not in OF_VALUES
    }
    joint = Joint(**geometry)
    motions = joint.motions * (len(joint.bodies) - 1)
    limits = _read_limits(name, table.get("limits"), motions, unit)
    locked = _read_locked(name, table.get("locked"), motions, unit)
    _check_locked(name, locked, limits, motions, unit)
    coupled = _read_coupled(name, table.get("coupled"), motions, unit)
    _check_not_locked(name, locked, coupled, motions, unit)
    return replace(joint, limits=limits, locked=locked, coupled=coupled)


def _read_limits(
    name: str, given: object, motions: tuple[Motion, ...], unit: float
) -> tuple[tuple[float, float] | None, ...]:
    """The limits of all variables; an empty list stands for none in a joint of
    several."""
    if given is None:
        return ()
    what = f"limits of joint {name}"
    allowed = "a list [low, high], one for each variable"
    if len(motions) > 1:
        allowed += ", [] for those without limits"
    rows = list(given) if isinstance(given, list) else []
    if len(motions) == 1 and not any(isinstance(row, list) for row in rows):
        rows = [rows]
    if len(rows) != len(motions):
        raise GeometryError(what, quoted(given), allowed)
    limits: list[tuple[float, float] | None] = []
    for row, motion in zip(rows, motions, strict=True):
        if row == [] and len(motions) > 1:
            limits.append(None)
            continue
        if not isinstance(row, list) or len(row) != 2:
            raise GeometryError(what, quoted(given), allowed)
        low, high = _in_rad(what, row, motion, unit)
        if not low < high:
            allowed = "a smaller number and a larger one"
            if low == high:
                allowed += f"; a joint that stands still has locked = {row[0]}"
            raise GeometryError(what, row, allowed)
        if motion.is_turn and not motion.advance and unit == 1.0:
            _warn_of_degrees(what, (low, high))
        limits.append((low, high))
    return tuple(limits)


def _warn_of_degrees(what: str, limits: tuple[float, float]) -> None:
    """Say in the log that limits, rad, are so wide that degrees may be meant."""
    if max(map(abs, limits)) > MANY_TURNS:
        log.warning(
            '%s are [%g, %g] with angles = "rad", more than two turns; if they are in '
            'degrees, write angles = "deg"',
            what,
            *limits,
        )


def _read_locked(
    name: str, given: object, motions: tuple[Motion, ...], unit: float
) -> tuple[float | None, ...]:
    """The locks of all variables; "free" stands for none in a joint of several."""
    if given is None:
        return ()
    what = f"locked of joint {name}"
    values = given if isinstance(given, list) else [given]
    if len(values) != len(motions):
        allowed = "a number"
        if len(motions) > 1:
            allowed = f'{len(motions)} numbers, "{FREE}" for a variable that is not'
        raise GeometryError(what, quoted(given), allowed)
    locked: list[float | None] = []
    for value, motion in zip(values, motions, strict=True):
        if value == FREE and len(motions) > 1:
            locked.append(None)
            continue
        locked += _in_rad(what, [value], motion, unit)
    return tuple(locked)


def _check_locked(
    name: str,
    locked: Sequence[float | None],
    limits: Sequence[tuple[float, float] | None],
    motions: Sequence[Motion],
    unit: float,
) -> None:
    """Raise `GeometryError`, in the units of the file, for a lock outside limits."""
    for value, pair, motion in zip(locked, limits, motions, strict=False):
        if value is None or pair is None or pair[0] <= value <= pair[1]:
            continue
        factor = unit if motion.is_turn else 1.0
        low, high = (f"{end / factor:.10g}" for end in pair)
        given = _as_given(value, motion, unit)
        allowed = f"within the limits [{low}, {high}]"
        raise GeometryError(f"locked of joint {name}", given, allowed)


def _as_given(value: float, motion: Motion, unit: float) -> str:
    """A value of a variable as the file gives it, angles with their unit."""
    if not motion.is_turn:
        return f"{value:.10g}"
    word = "rad" if unit == 1.0 else "degrees"
    return f"{value / unit:.10g} {word}"


def _check_not_locked(
    name: str,
    locked: Sequence[float | None],
    coupled: Sequence[Coupling | None],
    motions: Sequence[Motion],
    unit: float,
) -> None:
    """Raise `GeometryError`, in the units of the file, for a lock of what is coupled."""
    for value, coupling, motion in zip(locked, coupled, motions, strict=False):
        if value is not None and coupling is not None:
            given = _as_given(value, motion, unit)
            allowed = f"left out, as the variable is coupled to {coupling.to}"
            raise GeometryError(f"locked of joint {name}", given, allowed)


def _read_coupled(
    name: str, given: object, motions: tuple[Motion, ...], unit: float
) -> tuple[Coupling | None, ...]:
    if given is None:
        return ()
    what = f"coupled of joint {name}"
    tables = given if isinstance(given, list) else [given]
    if len(tables) != len(motions):
        allowed = f"{len(motions)} tables" if len(motions) != 1 else "a table"
        raise GeometryError(what, quoted(given), f"{allowed} {{to, ratio, offset}}")
    pairs = zip(tables, motions, strict=True)
    return tuple(_read_coupling(what, table, motion, unit) for table, motion in pairs)


def _read_coupling(
    what: str, table: object, motion: Motion, unit: float
) -> Coupling | None:
    """A coupling from its table; None from an empty one."""
    if not isinstance(table, Mapping):
        raise GeometryError(what, quoted(table), "a table {to, ratio, offset}")
    if not table:
        return None
    check_keys(f"key of {what}", table, OF_COUPLING)
    for key in ("to", "ratio"):
        if key not in table:
            raise GeometryError(f"{key} of {what}", "a missing key", "given")
    (offset,) = _in_rad(f"offset of {what}", [table.get("offset", 0.0)], motion, unit)
    check_number(f"ratio of {what}", table["ratio"])
    if table["ratio"] == 0:
        allowed = "other than 0; a joint that stands still is locked"
        raise GeometryError(f"ratio of {what}", 0, allowed)
    return Coupling(table["to"], table["ratio"], offset)


def _in_rad(
    what: str, values: Iterable[object], motion: Motion, unit: float
) -> list[float]:
    """Numbers of a file in rad, where the motion is a turn; lengths as they are."""
    numbers = []
    for value in values:
        if motion.is_turn:
            check_angle(what, value, in_degrees=unit != 1.0)
        else:
            check_number(what, value)
        factor = unit if motion.is_turn else 1.0
        numbers.append(factor * float(value))  # type: ignore[arg-type]
    return numbers
