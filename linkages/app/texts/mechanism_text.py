"""A mechanism, its loops, and what it does along its forms, as tables."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest
from typing import Any

import numpy as np

from bifurc.atlas import Atlas
from bifurc.form_order import listed_numbers
from bifurc.tables import section, section_of
from bifurc.torus import wrap
from linkages.app.texts.configurations import SHOWN_SHARE
from linkages.app.texts.crease_text import assigned_creases, describe_creases
from linkages.app.texts.hanging_text import describe_hanging, mobility_with_flaps
from linkages.app.texts.numbers import in_degrees, in_lengths, known_to
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.dead_points import driven_dead_points
from linkages.readout.facts import form_facts
from linkages.readout.mechanism_document import describe_mechanism
from linkages.readout.ranges import VariableRange
from linkages.readout.readout import Readout
from linkages.structure.plane import is_on_sphere, normal_of_plane

WIDTH = 72  # of a cell of a list, in characters
SHOWN = 20  # dead points beyond this number are only counted
COORDINATE_ROUNDING = 1e-14  # of the largest one: noise of a coordinate that is 0


def describe_joints(readout: Readout) -> str:
    """The joints of a mechanism, and the limits within which it is followed."""
    joints = readout.mechanism.joints
    size = max(float(np.abs(joint.place).max()) for joint in joints)
    rows = [_joint_row(joint, size) for joint in joints]
    text = section_of("Joints", rows) + _coordinates(readout)
    is_turn = {
        variable.label: variable.motion.is_turn
        for variable in readout.mechanism.variables
    }
    creases = assigned_creases(readout.mechanism)
    limits = [
        f"{label} from {_shown(low, is_turn[label])} to {_shown(high, is_turn[label])}"
        for label, (low, high) in readout.limits().items()
        if label not in creases
    ]
    if readout.mechanism.creases:
        text += f"\n\n{describe_creases(readout.structure)}"
    if limits:
        text += f"\n\nFollowed within limits: {', '.join(limits)}."
    coupled = _couplings(readout.mechanism)
    if coupled:
        text += f"\n\nCoupled: {', '.join(coupled)}."
    if readout.mechanism.motors:
        text += f"\n\nMotors: {', '.join(readout.mechanism.motors)}."
    idle = readout.structure.idle_bodies
    if idle:
        text += (
            f"\n\nLeft out: {', '.join(idle)} may turn about the line between its two "
            "spherical joints, which moves nothing else."
        )
    turns = readout.structure.idle_turns
    if turns:
        text += f"\n\nLeft out: {', '.join(turns)}, which turns but a body by itself."
    hanging = describe_hanging(readout.structure)
    return f"{text}\n\n{hanging}" if hanging else text


def _coordinates(readout: Readout) -> str:
    """From where the points are counted, and how well they are known, where that is
    not plain."""
    mechanism = readout.mechanism
    text = ""
    if any(mechanism.origin):
        place = " ".join(f"{coordinate:.10g}" for coordinate in mechanism.origin)
        text += f"\n\nPoints are counted from {place} of the file."
    if not mechanism.is_known_to_rounding:
        unit = readout.structure.unit
        text += "\n\n" + known_to(mechanism.coordinate_rounding, unit)
    if mechanism.moved:
        text += (
            f"\n\nVertices are up to {mechanism.moved:.2g} from where the file has them, "
            "as a rounding of a pattern that folds flat."
        )
    return text


def _couplings(mechanism: Mechanism) -> list[str]:
    """An equation for every coupled variable."""
    is_turn = {one.label: one.motion.is_turn for one in mechanism.variables}
    equations = []
    for joint in mechanism.joints:
        for label, coupling in zip(joint.labels, joint.coupled, strict=True):
            if coupling is None:
                continue
            equation = f"{label} = {coupling.ratio:.10g} {coupling.to}"
            if coupling.offset:
                equation += f" + {_shown(coupling.offset, is_turn[label])}"
            equations.append(equation)
    return equations


def _joint_row(joint: Joint, size: float) -> dict[str, str]:
    """A joint of a mechanism whose largest coordinate is ``size``."""
    motions = joint.motions * (len(joint.bodies) - 1)
    locks = [
        f"{part} {_shown(value, motion.is_turn)}".strip()
        for part, value, motion in zip(joint.parts, joint.locked, motions, strict=True)
        if value is not None
    ]
    longest = float(np.abs(joint.direction or 0.0).max())
    return {
        "name": joint.name,
        "kind": joint.kind.value,
        "bodies": ", ".join(joint.bodies),
        "point": _vector(joint.point, size),
        "direction": _vector(joint.direction, longest),
        "locked": ", ".join(locks) or "-",
    }


def _vector(vector: tuple[float, float, float] | None, size: float) -> str:
    """Coordinates, 0 for what is rounding beside the largest one, ``size``."""
    if vector is None:
        return "-"
    words = []
    for coordinate in vector:
        is_noise = abs(coordinate) <= COORDINATE_ROUNDING * size
        words.append(f"{0.0 if is_noise else coordinate:.6g}")
    return " ".join(words)


def _shown(value: float, is_turn: bool) -> str:
    """A variable as it is shown: degrees, or the user's unit."""
    return f"{in_degrees(value)} deg" if is_turn else f"{value:.6g}"


def describe_loops(atlas: Atlas, readout: Readout) -> str:
    """Grübler's count beside the mobility, and what is redundant in every loop."""
    document = describe_mechanism(atlas, readout)
    rows = []
    for loop in document["loops"]:
        dependent = ", ".join(loop["dependent_joints"]) or "-"
        rows.append(
            {
                "joints": ", ".join(loop["joints"]),
                "constraints": str(loop["constraints"]),
                "redundant": str(loop["redundant"]),
                "joints that follow from the others": dependent,
            }
        )
    mobility = mobility_with_flaps(atlas.mobility, readout.structure)
    count = f"{mobility}; Grübler's count is {readout.mechanism.gruebler}"
    count += f"{_special_count(readout.mechanism)}."
    for chain in document["loose_chains"]:
        count += f"\n{_of_loose_chain(chain)}"
    loops = section_of("Loops", rows)
    return f"{loops}\n\n{count}" if loops else count


def _of_loose_chain(chain: dict[str, Any]) -> str:
    """A sentence on a chain that moves by itself, and what to do about it."""
    ends = chain["between"]
    place = f"between {' and '.join(ends)}" if len(ends) > 1 else f"on {ends[0]}"
    return (
        f"{chain['freedoms']} of these freedoms {place} can be had by "
        f"{', '.join(chain['bodies'])} alone, whatever the rest does: left out, or with "
        "joints locked, a map shows the rest."
    )


def _special_count(mechanism: Mechanism) -> str:
    """Grübler's count with three freedoms a body, where that is all it has and the
    mechanism does not say so."""
    if mechanism.is_planar:
        return ""
    count = mechanism.count_of_freedoms(3)
    if normal_of_plane(mechanism) is not None:
        return f", and {count} in a plane"
    return f", and {count} on a sphere" if is_on_sphere(mechanism) else ""


def describe_motions(atlas: Atlas, readout: Readout) -> str:
    """What joints and bodies do along each form."""
    rows: list[tuple[str, ...]] = []
    is_turn = {
        variable.label: variable.motion.is_turn
        for variable in readout.mechanism.variables
        if variable.label not in readout.structure.held
    }
    for index in listed_numbers(atlas):
        facts = form_facts(atlas, index, readout)
        ranges = [
            _range(one, is_turn[one.label], readout.structure.unit)
            for one in facts.ranges
            if one.label in is_turn
        ]
        groups = [" = ".join(group) for group in facts.groups]
        columns = [
            [atlas.forms[index].name],
            _lines(ranges),
            _lines(facts.still),
            _lines(groups),
        ]
        rows += list(zip_longest(*columns, fillvalue=""))
    heads = ("form", "ranges", "joints that stand still", "bodies that move as one")
    return section("Motions (deg, lengths in the unit of the file)", heads, rows)


def _lines(items: Sequence[str]) -> list[str]:
    """A list as lines of a cell, "-" for none."""
    lines: list[str] = []
    for item in items:
        if lines and len(lines[-1]) + 2 + len(item) <= WIDTH:
            lines[-1] += f", {item}"
        else:
            if lines:
                lines[-1] += ","
            lines.append(item)
    return lines or ["-"]


def describe_dead_points(atlas: Atlas, readout: Readout) -> str:
    """The values at which the joint that drives, and those with limits, stand still for
    a moment, by form; of more than `SHOWN` dead points how many there are."""
    labels = readout.labels()
    places: dict[tuple[str, str], list[str]] = {}
    count = 0
    by_form = {number: k for k, number in enumerate(listed_numbers(atlas))}
    for event in sorted(
        driven_dead_points(atlas), key=lambda one: (one.index, by_form[one.form])
    ):
        label = atlas.names[event.index]
        if label not in labels:  # an entry of a rotation matrix, or a coordinate
            continue
        number = labels.index(label)
        values = readout.values(event.u[None])[0]
        value = wrap(values, readout.periods, within=SHOWN_SHARE)[number]
        if readout.mechanism.variables[number].motion.is_turn:
            shown = in_degrees(value)
        else:
            shown = in_lengths(value, readout.structure.unit)
        places.setdefault((label, atlas.forms[event.form].name), []).append(shown)
        count += 1
    if count > SHOWN:
        return f"Dead points: {count}, listed with --json, with those of other joints."
    rows: list[tuple[str, ...]] = []
    for (label, form), shown_values in places.items():
        columns = [[label], _lines(shown_values), [form]]
        rows += list(zip_longest(*columns, fillvalue=""))
    title = "Dead points (deg, lengths in the unit of the file)"
    return section(title, ("variable", "where it stands still", "form"), rows)


def _range(one: VariableRange, is_turn: bool, unit: float) -> str:
    if one.turns:
        times = "once" if abs(one.turns) == 1 else f"{abs(one.turns)} times"
        return f"{one.label} turns {times}"
    if is_turn:
        low, high = in_degrees(one.low, 2), in_degrees(one.high, 2)
    else:
        low, high = in_lengths(one.low, unit, 5), in_lengths(one.high, unit, 5)
    return f"{one.label} at {low}" if low == high else f"{one.label} {low} to {high}"


# --- the outer loop of a network ------------------------------------------------------


def describe_outer_joints(mechanism: Mechanism) -> str:
    """At which D-H angles the outer joints are in the reference configuration, and
    which of them are locked there; empty where there are none."""
    rows = []
    for joint in mechanism.outer_joints:
        lock = "locked" if joint.is_locked else "-"
        rows.append((joint.name, joint.label, in_degrees(joint.reference), lock))
    heads = ("outer joint", "variable", "D-H angle where it is 0 (deg)", "lock")
    return section("Outer loop", heads, rows)


def describe_outer_motions(atlas: Atlas, readout: Readout) -> str:
    """The range of the D-H angle of every outer joint along each form; empty where there
    are none."""
    outer = readout.mechanism.outer_joints
    if not outer:
        return ""
    rows = []
    for index in listed_numbers(atlas):
        ranges = {one.label: one for one in form_facts(atlas, index, readout).ranges}
        texts = [_outer_range(ranges[one.label], one.reference) for one in outer]
        rows.append((atlas.forms[index].name, *texts))
    heads = ("form", *(joint.name for joint in outer))
    return section("Outer loop along the forms (D-H angles, deg)", heads, rows)


def _outer_range(one: VariableRange, reference: float) -> str:
    if one.turns:
        return f"{one.turns:+d} turns" if abs(one.turns) > 1 else f"{one.turns:+d} turn"
    low, high = in_degrees(one.low + reference, 2), in_degrees(one.high + reference, 2)
    return low if low == high else f"{low} to {high}"
