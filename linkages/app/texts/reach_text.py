"""What joints reach along forms, as tables and as plain values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bifurc.atlas import Atlas
from bifurc.tables import count_of, section_of
from linkages.app.reports.reach import EndKind, JointReach, RangeEnd, Stretch
from linkages.app.texts.configurations import arclength_unit
from linkages.app.texts.numbers import in_degrees, in_lengths
from linkages.subject import subject_at

DIGITS = 4  # of a degree
# of a kind of end with a name behind it
WORDS = {EndKind.LIMIT: "limit of ", EndKind.SINGULAR_POINT: ""}


def describe_reach(atlas: Atlas, stretches: Sequence[Stretch]) -> str:
    """A table for every stretch: from where to where each joint goes, and what ends
    that."""
    size = subject_at(atlas).size
    unit = arclength_unit(atlas)
    parts = []
    for stretch in stretches:
        form = atlas.forms[stretch.form]
        title = form.name
        length = stretch.last - stretch.first
        if length < form.branch.length:
            title += f", {unit.factor * length:.4g} of {unit.factor * form.branch.length:.4g} {unit.name}"
        rows = [_row(reach, size) for reach in stretch.reaches]
        parts.append(section_of(title, rows))
    if not parts:
        return "No form has a part within these limits."
    return "\n\n".join(parts)


def _row(reach: JointReach, size: float) -> dict[str, str]:
    low, high = reach.low, reach.high
    row = {"joint": reach.label, "from": "", "ended by": "", "to": "", "and by": ""}
    if reach.value is not None:
        return {
            **row,
            "from": _shown(reach, reach.value, size),
            "ended by": "stands still",
        }
    if low is None or high is None:
        return {**row, "from": f"turns fully, {count_of(reach.turns, 'turn')}"}
    return {
        "joint": reach.label,
        "from": _shown(reach, low.value, size),
        "ended by": _why(low),
        "to": _shown(reach, high.value, size),
        "and by": _why(high),
    }


def _shown(reach: JointReach, value: float, size: float) -> str:
    if reach.is_angle:
        return f"{in_degrees(value, DIGITS)} deg"
    return in_lengths(value, size)


def _why(end: RangeEnd) -> str:
    if end.by and end.kind in WORDS:
        return WORDS[end.kind] + end.by
    return end.kind.value


def reach_document(atlas: Atlas, stretches: Sequence[Stretch]) -> dict[str, Any]:
    """The same as plain values, angles in rad: an entry for each stretch of a form, with
    one for each joint."""
    return {
        "stretches": [
            {
                "form": atlas.forms[one.form].name,
                "from_arclength": one.first,
                "to_arclength": one.last,
                "joints": [_values(reach) for reach in one.reaches],
            }
            for one in stretches
        ]
    }


def _values(reach: JointReach) -> dict[str, Any]:
    values: dict[str, Any] = {
        "joint": reach.label,
        "unit": "rad" if reach.is_angle else "length",
        "turns": reach.turns,
        "stands_still_at": reach.value,
    }
    for key, end in (("low", reach.low), ("high", reach.high)):
        values[key] = None
        if end is not None:
            kind = end.kind.name.lower()
            values[key] = {"value": end.value, "kind": kind, "by": end.by, "s": end.s}
    return values
