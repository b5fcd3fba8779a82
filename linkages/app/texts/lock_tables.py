"""Tables of what a network becomes under its locks, as Markdown and as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence

from linkages.app.texts.numbers import in_degrees
from linkages.catalogue import entry
from linkages.identification.locked_networks import LockedState

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
