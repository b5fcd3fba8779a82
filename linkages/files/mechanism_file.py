"""A mechanism from the content of a TOML file, and as the text of one.

Four formats, told apart by their keys: ``[[joints]]``, axes in one closed
configuration, ``[[loops]]``, tables of Denavit and Hartenberg that share joints
(`linkages.files.loops`), ``bars`` between ``[points]`` of a plane
(`linkages.files.bars`), and ``arcs`` between ``[points]`` of a sphere
(`linkages.files.arcs`).
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from linkages.files.arcs import read_arcs
from linkages.files.bars import read_bars
from linkages.files.loops import read_loops
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import (
    DRAWN_ONLY,
    GEOMETRY,
    Joint,
    Limits,
    Motion,
    check_order,
)
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.origin import Coordinates, counted_from_near, origin_of
from linkages.mechanisms.subject import joint_values
from linkages.structure.plane import normal_of_plane
from linkages.values import (
    GeometryError,
    check_angle,
    check_keys,
    check_number,
    checked_list,
    checked_number,
    checked_table,
    checked_text,
    quoted,
    require,
)

Content: TypeAlias = Mapping[str, Any]

OF_FILE = ("name", "angles", "planar", "origin", "rounding", "layers", "joints")
OF_BARS = ("name", "fixed", "bars", "points", "points_on_bars", "origin", "layers")
OF_ARCS = ("name", "angles", "fixed", "arcs", "points", "points_on_arcs")
OF_LOOPS = ("name", "angles", "loops")
OF_BODIES = ("name", "kind", "bodies")
OF_VALUES = ("limits", "locked", "coupled")
OF_JOINT = (*OF_BODIES, *GEOMETRY, *OF_VALUES)
OF_COUPLING = ("to", "ratio", "offset")
UNITS = {"deg": math.pi / 180, "rad": 1.0}
FREE = "free"  # in a list of locks: a variable that has none
# what stands for a variable without a value, by key: a TOML list has no null
NOTHING: dict[str, object] = {"limits": [], "locked": FREE}
MANY_TURNS = 4 * math.pi  # limits of a turn beyond it, rad, may be meant in degrees

log = logging.getLogger(__name__)


def read_mechanism(content: Content, name: str) -> Mechanism:
    """The mechanism that the content of a TOML file describes; without a name it gets
    this one. Raises `GeometryError` for anything wrong in it."""
    given = checked_text("name", content.get("name", name))
    if "loops" in content and "joints" not in content:
        check_keys("key", content, OF_LOOPS)
        return read_loops(content["loops"], given, angle_unit(content))
    if "arcs" in content and "joints" not in content:
        check_keys("key", content, OF_ARCS)
        return read_arcs(content, given, angle_unit(content))
    if "joints" not in content:
        check_keys("key", content, OF_BARS)
        return _with_layers(read_bars(content, given), content)
    check_keys("key", content, OF_FILE)
    return _with_layers(_read_joints(content, given), content)


def _read_joints(content: Content, name: str) -> Mechanism:
    """The mechanism of this ``name`` that the [[joints]] of a file describe."""
    unit = angle_unit(content)
    given_tables = checked_list("joints", content["joints"], "tables [[joints]]")
    tables, near = _from_near(given_tables)
    joints = [_read_joint(k, table, unit) for k, table in enumerate(tables, start=1)]
    mechanism = Mechanism(tuple(joints), name)
    is_planar = _read_planar(content, mechanism)
    origin = origin_of(content, near.origin)
    rounding = content.get("rounding", 0.0)
    check_number("rounding", rounding)
    require(rounding >= 0, "rounding", rounding, "0 or more, a length")
    rounding = max(near.rounding, float(rounding))
    return replace(mechanism, is_planar=is_planar, origin=origin, rounding=rounding)


def _with_layers(mechanism: Mechanism, content: Content) -> Mechanism:
    """The mechanism with the layers that the file gives its bodies, if any."""
    if "layers" not in content:
        return mechanism
    table = checked_table("layers", content["layers"], "a table, body = number")
    if normal_of_plane(mechanism) is None:
        allowed = "left out, as not all axes are parallel and all slides across them"
        raise GeometryError("layers", quoted(dict(table)), allowed)
    return replace(mechanism, layers=tuple(table.items()))


def _from_near(tables: Sequence[object]) -> tuple[list[object], Coordinates]:
    """The tables of joints with points that are counted from one of them, where they
    are far from the origin, and these points."""
    known = [table if isinstance(table, Mapping) else {} for table in tables]
    are_anywhere = [table.get("kind") in DRAWN_ONLY for table in known]
    near = counted_from_near([table.get("point") for table in known], are_anywhere)
    moved = [
        table if row is None else {**of_joint, "point": row}
        for table, of_joint, row in zip(tables, known, near.rows, strict=True)
    ]
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


def angle_unit(content: Content) -> float:
    """The unit of angles of a file, in rad; raises `GeometryError`."""
    unit = content.get("angles", "deg")
    if not isinstance(unit, str) or unit not in UNITS:
        allowed = '"deg", which it is where nothing is said, or "rad"'
        raise GeometryError("angles", quoted(unit), allowed)
    return UNITS[unit]


# --- one joint ------------------------------------------------------------------------


def _read_joint(number: int, table: object, unit: float) -> Joint:
    """A joint from its table; angles are in this ``unit``, in rad."""
    table = checked_table(f"joints[{number}]", table, "a table")
    name = table.get("name")
    is_named = name is not None
    require(is_named, f"name of joints[{number}]", "a missing key", "a text")
    check_keys(f"key of joint {name}", table, OF_JOINT)
    for key in ("kind", "bodies"):
        what, allowed = f"{key} of joint {name}", "given for every joint"
        require(key in table, what, "a missing key", allowed)
    joint = Joint(**{key: table[key] for key in table if key not in OF_VALUES})
    motions = joint.motions * (len(joint.bodies) - 1)
    variables = _Variables(str(name), motions, unit)
    limits = variables.limits(table.get("limits"))
    locked = variables.locked(table.get("locked"), limits)
    coupled = variables.coupled(table.get("coupled"), locked)
    return replace(joint, limits=limits, locked=locked, coupled=coupled)


@dataclass(frozen=True)
class _Variables:
    """The variables of a joint of a file, which gives their angles in a ``unit``, in
    rad. What is said of them is a list with an entry for each, or the only entry, and
    nothing where nothing is said."""

    joint: str
    motions: tuple[Motion, ...]
    unit: float

    def limits(self, given: object) -> tuple[Limits | None, ...]:
        """The limits of all variables; an empty list stands for none in a joint of
        several."""
        if given is None:
            return ()
        what = f"limits of joint {self.joint}"
        is_single = len(self.motions) == 1
        allowed = "a list [low, high], one for each variable"
        if len(self.motions) > 1:
            allowed += ", [] for those without limits"
        rows = list(given) if isinstance(given, list) else []
        if is_single and not any(isinstance(row, list) for row in rows):
            rows = [rows]
        require(len(rows) == len(self.motions), what, quoted(given), allowed)
        limits: list[Limits | None] = []
        for row, motion in zip(rows, self.motions, strict=True):
            if row == [] and not is_single:
                limits.append(None)
                continue
            if not isinstance(row, list) or len(row) != 2:
                raise GeometryError(what, quoted(given), allowed)
            low, high = (self._in_rad(what, value, motion) for value in row)
            check_order(what, row)
            is_in_rad = motion.is_turn and not motion.advance and self.unit == 1.0
            if is_in_rad and max(abs(low), abs(high)) > MANY_TURNS:
                log.warning(
                    '%s are [%g, %g] with angles = "rad", more than two turns; if they '
                    'are in degrees, write angles = "deg"',
                    what,
                    low,
                    high,
                )
            limits.append((low, high))
        return tuple(limits)

    def locked(
        self, given: object, limits: Sequence[Limits | None]
    ) -> tuple[float | None, ...]:
        """The locks of all variables, within their limits; "free" stands for none in a
        joint of several."""
        if given is None:
            return ()
        what = f"locked of joint {self.joint}"
        count = len(self.motions)
        values = given if isinstance(given, list) else [given]
        allowed = f'{count} numbers, "{FREE}" for a variable that is not'
        if count <= 1:
            allowed = "a number"
        require(len(values) == count, what, quoted(given), allowed)
        locked = [
            None if value == FREE and count > 1 else self._in_rad(what, value, motion)
            for value, motion in zip(values, self.motions, strict=True)
        ]
        for value, pair, motion in zip(locked, limits, self.motions, strict=False):
            if value is None or pair is None or pair[0] <= value <= pair[1]:
                continue
            factor = self.unit if motion.is_turn else 1.0
            low, high = (f"{end / factor:.10g}" for end in pair)
            shown = self._as_given(value, motion)
            raise GeometryError(what, shown, f"within the limits [{low}, {high}]")
        return tuple(locked)

    def coupled(
        self, given: object, locked: Sequence[float | None]
    ) -> tuple[Coupling | None, ...]:
        """The couplings of all variables, of which those are not ``locked``."""
        if given is None:
            return ()
        what = f"coupled of joint {self.joint}"
        tables = given if isinstance(given, list) else [given]
        count = len(self.motions)
        allowed = f"{count} tables" if count != 1 else "a table"
        allowed += " {to, ratio, offset}"
        require(len(tables) == count, what, quoted(given), allowed)
        pairs = zip(tables, self.motions, strict=True)
        coupled = [self._coupling(what, table, motion) for table, motion in pairs]
        for value, coupling, motion in zip(locked, coupled, self.motions, strict=False):
            if value is not None and coupling is not None:
                shown = self._as_given(value, motion)
                allowed = f"left out, as the variable is coupled to {coupling.to}"
                raise GeometryError(f"locked of joint {self.joint}", shown, allowed)
        return tuple(coupled)

    def _coupling(self, what: str, table: object, motion: Motion) -> Coupling | None:
        """A coupling from its table; None from an empty one."""
        table = checked_table(what, table, "a table {to, ratio, offset}")
        if not table:
            return None
        check_keys(f"key of {what}", table, OF_COUPLING)
        for key in ("to", "ratio"):
            require(key in table, f"{key} of {what}", "a missing key", "given")
        offset = self._in_rad(f"offset of {what}", table.get("offset", 0.0), motion)
        check_number(f"ratio of {what}", table["ratio"])
        allowed = "other than 0; a joint that stands still is locked"
        require(table["ratio"] != 0, f"ratio of {what}", 0, allowed)
        return Coupling(table["to"], table["ratio"], offset)

    def _in_rad(self, what: str, value: Any, motion: Motion) -> float:
        """A number of a file in rad, where the motion is a turn; a length as it is."""
        if not motion.is_turn:
            return checked_number(what, value)
        check_angle(what, value, in_degrees=self.unit != 1.0)
        return self.unit * float(value)

    def _as_given(self, value: float, motion: Motion) -> str:
        """A value of a variable as the file gives it, angles with their unit."""
        if not motion.is_turn:
            return f"{value:.10g}"
        word = "rad" if self.unit == 1.0 else "degrees"
        return f"{value / self.unit:.10g} {word}"


# --- writing --------------------------------------------------------------------------


def mechanism_toml(mechanism: Mechanism) -> str:
    """The text of a TOML file that describes the mechanism, angles in rad."""
    lines = [f"name = {_quoted(mechanism.name)}", 'angles = "rad"']
    if mechanism.is_planar:
        lines.append("planar = true")
    if any(mechanism.origin):
        lines.append(f"origin = {json.dumps(mechanism.origin)}")
    if mechanism.rounding:
        lines.append(f"rounding = {json.dumps(mechanism.rounding)}")
    if mechanism.layers:
        pairs = (f"{_quoted(body)} = {layer}" for body, layer in mechanism.layers)
        lines.append(f"layers = {{{', '.join(pairs)}}}")
    for joint in mechanism.joints:
        lines += ["", "[[joints]]", *_joint_lines(joint)]
    return "\n".join(lines) + "\n"


def _joint_lines(joint: Joint) -> list[str]:
    lines = []
    for key, value in joint_values(joint).items():
        if key == "coupled":
            lines.append(f"coupled = {_couplings(joint)}")
            continue
        if key in NOTHING:
            value = [NOTHING[key] if one is None else one for one in value]
        lines.append(f"{key} = {json.dumps(value, ensure_ascii=False)}")
    return lines


def _couplings(joint: Joint) -> str:
    """A list with an inline table for each variable, empty where it is free."""
    tables = []
    for coupling in joint.coupled:
        if coupling is None:
            tables.append("{}")
            continue
        numbers = f"ratio = {coupling.ratio!r}, offset = {coupling.offset!r}"
        tables.append(f"{{to = {_quoted(coupling.to)}, {numbers}}}")
    return f"[{', '.join(tables)}]"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
