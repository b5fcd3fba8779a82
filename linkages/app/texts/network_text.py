"""A network of Bennett loops as text: angles in degrees."""

from __future__ import annotations

from bifurc.atlas import Atlas
from bifurc.tables import section, table
from linkages.app.texts.entry_text import list_below, parameter_table
from linkages.app.texts.form_names import listed_numbers
from linkages.app.texts.numbers import in_degrees
from linkages.networks.entries import NetworkEntry
from linkages.networks.mechanism import NetworkMechanism, lock_network
from linkages.readout.facts import form_facts
from linkages.readout.ranges import VariableRange
from linkages.readout.readout import Readout


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


def describe_kinks(network: NetworkMechanism) -> str:
    """At which D-H angles the outer joints are in the reference configuration, and
    which of them are locked there."""
    placed = network.placed
    rows = []
    for axis in placed.network.plan.ring:
        locked = "locked" if axis in placed.kinks else "-"
        angle = in_degrees(placed.turns[axis])
        rows.append((axis, placed.label(axis), angle, locked))
    heads = ("outer joint", "variable", "D-H angle where it is 0 (deg)", "lock")
    return "Outer loop\n" + table(heads, rows)


def describe_ring(atlas: Atlas, readout: Readout, network: NetworkMechanism) -> str:
    """The range of the D-H angle of every outer joint along each form."""
    placed = network.placed
    ring = placed.network.plan.ring
    rows = []
    for index in listed_numbers(atlas):
        ranges = {one.label: one for one in form_facts(atlas, index, readout).ranges}
        texts = [
            _range(ranges[placed.label(axis)], placed.turns[axis]) for axis in ring
        ]
        rows.append((atlas.forms[index].name, *texts))
    return section(
        "Outer loop along the forms (D-H angles, deg)", ("form", *ring), rows
    )


def _range(one: VariableRange, reference: float) -> str:
    if one.turns:
        return f"{one.turns:+d} turns" if abs(one.turns) > 1 else f"{one.turns:+d} turn"
    low, high = in_degrees(one.low + reference, 2), in_degrees(one.high + reference, 2)
    return low if low == high else f"{low} to {high}"
