"""The clearance of links as text: degrees, links by their joints."""

from __future__ import annotations

import numpy as np

from bifurc.atlas import Atlas
from linkages.app.clearance import FormClearance
from linkages.app.configurations import show_configuration
from linkages.app.texts import link_name, table
from linkages.labels import loop_of

__all__ = ["describe_clearance"]

SHOWN = 1e-9  # in characteristic lengths: what is less comes out as 0
HEADS = (
    "links",
    "clearance",
    "at most less by",
    "arclength (deg)",
    "joint angles (deg)",
)


def describe_clearance(atlas: Atlas, clearances: list[FormClearance]) -> str:
    """A sentence and a table for every form."""
    parts = [_of_form(atlas, clearance) for clearance in clearances]
    explanation = (
        "Lengths are in the unit of the linkage; links that share a joint are left out."
    )
    if clearances[0].diameter:
        explanation += " Links overlap where the clearance is below 0."
    return "\n\n".join([*parts, explanation])


def _of_form(atlas: Atlas, clearance: FormClearance) -> str:
    smallest = SHOWN * loop_of(atlas).characteristic_length
    rows = []
    for approach in clearance.approaches:
        rows.append(
            (
                _links(atlas, approach.links),
                _length(clearance.gap(approach), smallest),
                f"{approach.error:.1g}",
                f"{np.degrees(approach.s):.3f}",
                show_configuration(atlas, approach.theta),
            )
        )
    links, least, *_ = rows[0]
    title = f"{clearance.form.name}: the least clearance is {least} (links {links})"
    return f"{title}\n{table(HEADS, rows)}"


def _length(length: float, smallest: float) -> str:
    """A length to six digits; what is below the smallest one shown comes out as 0."""
    return "0" if abs(length) < smallest else f"{length:.6g}"


def _links(atlas: Atlas, links: tuple[int, int]) -> str:
    n = len(atlas.names)
    return " and ".join(link_name(link, n) for link in links)
