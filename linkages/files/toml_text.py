"""A mechanism as the text of a TOML file that `linkages.files.mechanism_file` reads."""

from __future__ import annotations

import json

from linkages.files.mechanism_file import FREE
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.subject import joint_values

# What stands for a variable without a value, by key: a TOML list has no null.
NOTHING: dict[str, object] = {"limits": [], "locked": FREE}


def mechanism_toml(mechanism: Mechanism) -> str:
    """The text of a TOML file that describes the mechanism, angles in rad."""
    lines = [f"name = {_quoted(mechanism.name)}", 'angles = "rad"']
    if mechanism.is_planar:
        lines.append("planar = true")
    if any(mechanism.origin):
        lines.append(f"origin = {json.dumps(mechanism.origin)}")
    if mechanism.rounding:
        lines.append(f"rounding = {json.dumps(mechanism.rounding)}")
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
