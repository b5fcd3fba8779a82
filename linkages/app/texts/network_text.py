"""A network of Bennett loops as text, angles in degrees; what it becomes under its locks
as tables, Markdown and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from bifurc.tables import section
from linkages.app.texts.entry_text import list_below, parameter_table
from linkages.app.texts.numbers import in_degrees
from linkages.catalogue import entry
from linkages.networks.entries import NetworkEntry
from linkages.networks.mechanism import lock_network

if TYPE_CHECKING:
    from linkages.identification.locked_networks import LockedState


def describe_network(entry: NetworkEntry) -> str:
    """Everything that is kept of a network, its bars and joints at the defaults."""
    network = entry.build()
    mechanism = lock_network(network, {})
    plan = network.plan
    bars = []
    for bar, name in plan.bars.items():
        link = network.links[name]
        length, twist = float(link.length), float(link.twist)
        bars.append((bar, name, f"{length:.10g}", in_degrees(twist)))
    joints = [(axis, ", ".join(plan.bars_at(axis))) for axis in plan.axes]
    loops = [(cell.name, ", ".join(cell.axes)) for cell in plan.cells]
    facts = [
        f"outer loop, whose D-H angles locks hold: {', '.join(plan.ring)}",
        f"bodies: {len(mechanism.bodies)}; "
        f"independent loops: {mechanism.independent_loops}",
        f"mobility: {entry.mobility}; Grübler's count is {mechanism.gruebler}",
        "lengths b, c, d follow from the Bennett ratio, and are checked where they are "
        "given",
        *entry.remarks,
    ]
    parts = [
        f"{entry.name}\n{entry.title}\nSource: {entry.source}",
        parameter_table(entry.parameters),
        list_below("Conditions", [condition.text for condition in entry.conditions]),
        section("Bars", ("bar", "link", "length", "twist (deg)"), bars),
        section("Joints", ("joint", "bars"), joints),
        section("Bennett loops", ("loop", "joints"), loops),
        list_below("Facts", facts),
        list_below("Misprints in the source", entry.errata),
    ]
    return "\n\n".join(part for part in parts if part)


HEADS = (
    "locks",
    "kinks (deg)",
    "becomes",
    "mobility",
    "joints left",
    "stand still as well",
    "linkage",
)


def make_page(name: str, tables: Mapping[str, Sequence[LockedState]]) -> str:
    """A page in Markdown of the tables of a network, by their titles."""
    parts = [f"# {name}"]
    for title, states in tables.items():
        moving = sum(bool(state.mobility) for state in states)
        head = f"## {len(states)} {title} of locks, {moving} with a motion left"
        parts.append(f"{head}\n\n{as_markdown(states)}")
    return "\n\n".join(parts)


def as_markdown(states: Sequence[LockedState]) -> str:
    """A table of the states; the linkage by its name and its title."""
    lines = [HEADS, ("---",) * len(HEADS)]
    for state in states:
        cells = _cells(state)
        if state.linkages:
            title = entry(state.linkages[0]).title
            cells = (*cells[:-1], f"{state.linkages[0]} ({title})")
        lines.append(cells)
    rows = ["| " + " | ".join(cell or "-" for cell in line) + " |" for line in lines]
    return "\n".join(rows)


def as_csv(states: Sequence[LockedState]) -> str:
    """The states as comma-separated values, all names of the linkage in the last
    column."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADS)
    for state in states:
        writer.writerow((*_cells(state)[:-1], " ".join(state.linkages)))
    return text.getvalue()


def _cells(state: LockedState) -> tuple[str, ...]:
    kinks = " ".join(in_degrees(value, 2) for value in state.kinks.values())
    mobility = "" if state.mobility is None else str(state.mobility)
    return (
        "/".join(state.kinks),
        kinks,
        state.becomes,
        mobility,
        " ".join(state.left),
        " ".join(state.still) if state.mobility else "",
        state.linkages[0] if state.linkages else "",
    )
