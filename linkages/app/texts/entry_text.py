"""An entry of the catalogue as text: degrees, joints numbered from 1."""

from __future__ import annotations

import math
from collections.abc import Sequence

from bifurc.tables import count_of, table
from linkages.app.texts.numbers import known_to
from linkages.entry import Entry, Parameter, ParameterKind
from linkages.geometry_table import geometry_rows, geometry_text
from linkages.loop import Loop
from linkages.mechanisms.entry import MechanismEntry


def describe_entry(entry: Entry) -> str:
    """Everything that the catalogue says of a linkage, angles in degrees."""
    facts = [f"{key}: {value}" for key, value in entry.facts.items()]
    parts = [
        f"{entry.name}\n{entry.title}\nSource: {entry.source}",
        parameter_table(entry.parameters),
        list_below("Conditions", [condition.text for condition in entry.conditions]),
        describe_geometry(entry.build()),
        list_below("Published facts", facts),
        list_below("Misprints in the source", entry.errata),
    ]
    return "\n\n".join(part for part in parts if part)


def parameter_table(parameters: Sequence[Parameter]) -> str:
    """The parameters with their defaults."""
    rows = [(p.name, _default(p), p.kind, p.meaning) for p in parameters]
    return "Parameters\n" + table(("name", "default", "kind", "meaning"), rows)


def describe_geometry(loop: Loop) -> str:
    """The Denavit-Hartenberg table of a loop, twists in degrees."""
    rows = geometry_rows(loop.lengths, loop.twists, loop.offsets)
    text = f"Geometry\n{geometry_text(rows)}"
    if loop.rounding:
        text += "\n\n" + known_to(loop.rounding, loop.characteristic_length)
    return text


def _default(parameter: Parameter) -> str:
    if parameter.kind is ParameterKind.ANGLE:
        return f"{math.degrees(parameter.default):.6g} deg"
    return f"{parameter.default:.6g}"


def list_below(title: str, lines: Sequence[str]) -> str:
    """Lines below their title; empty where there are none."""
    if not lines:
        return ""
    return "\n".join([title, *(f"  {line}" for line in lines)])


def describe_mechanism(entry: MechanismEntry) -> str:
    """Everything that is kept of a sheet or an array."""
    mechanism = entry.build()
    counts = (
        count_of(len(mechanism.bodies), "body"),
        count_of(len(mechanism.joints), "joint"),
        count_of(mechanism.independent_loops, "loop"),
    )
    facts = ["at the defaults: " + ", ".join(counts)]
    parts = [
        f"{entry.name}\n{entry.title}\nSource: {entry.source}",
        parameter_table(entry.parameters),
        list_below("Facts", facts),
    ]
    return "\n\n".join(parts)
