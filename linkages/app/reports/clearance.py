"""The clearance of links along forms, as a command shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from bifurc.atlas import Atlas, Form
from bifurc.tables import section_of
from linkages.app.texts.configurations import (
    arclength_unit,
    numbers_at,
    show_configuration,
)
from linkages.links.clearance import Approach, approaches_along
from linkages.subject import subject_at


@dataclass(frozen=True, eq=False)
class FormClearance:
    """Where links of some ``diameter`` are nearest along a form, the nearest first;
    distances are those of their middle lines. ``names`` are those of all links, or of
    all bodies of a mechanism."""

    form: Form
    diameter: float
    names: Sequence[str]
    approaches: Sequence[Approach]

    def gap(self, approach: Approach) -> float:
        """What is left between two links; below zero they meet."""
        return approach.distance - self.diameter

    def links(self, approach: Approach) -> list[str]:
        """The names of two links."""
        return [self.names[link] for link in approach.links]


def clearance_of(atlas: Atlas, form: Form, diameter: float) -> FormClearance:
    """The clearance of links of a diameter along a form."""
    parts = subject_at(atlas).parts
    approaches = approaches_along(parts, form.branch)
    return FormClearance(form, diameter, parts.names, approaches)


def clearance_document(
    atlas: Atlas, clearances: list[FormClearance]
) -> list[dict[str, Any]]:
    """What `bifurc clearance --json` prints: angles in rad, lengths in the user's
    unit."""
    return [
        {
            "form": clearance.form.name,
            "diameter": clearance.diameter,
            "approaches": [
                {
                    "links": clearance.links(approach),
                    "clearance": clearance.gap(approach),
                    "error": approach.error,
                    "arclength": approach.s,
                    "theta": numbers_at(atlas, approach.theta),
                }
                for approach in clearance.approaches
            ],
        }
        for clearance in clearances
    ]


SHOWN = 1e-9  # in characteristic lengths: what is less comes out as 0


def describe_clearance(atlas: Atlas, clearances: list[FormClearance]) -> str:
    """A sentence and a table for every form."""
    parts = [_of_form(atlas, clearance) for clearance in clearances]
    links = subject_at(atlas).parts.word
    explanation = (
        f"Lengths are in the unit of the linkage; {links} that share a joint are left "
        "out."
    )
    if clearances[0].diameter:
        explanation += f" {links.capitalize()} overlap where the clearance is below 0."
    return "\n\n".join([*parts, explanation])


def _of_form(atlas: Atlas, clearance: FormClearance) -> str:
    if not clearance.approaches:
        return f"{clearance.form.name}: every two bodies share a joint"
    subject = subject_at(atlas)
    word = subject.parts.word
    smallest = SHOWN * subject.size
    unit = arclength_unit(atlas)
    rows = []
    for approach in clearance.approaches:
        gap = clearance.gap(approach)
        rows.append(
            {
                word: " and ".join(clearance.links(approach)),
                "clearance": "0" if abs(gap) < smallest else f"{gap:.6g}",
                "at most less by": f"{approach.error:.1g}",
                f"arclength ({unit.name})": f"{unit.factor * approach.s:.3f}",
                subject.heading(atlas): show_configuration(atlas, approach.theta),
            }
        )
    least = f"{rows[0]['clearance']} ({word} {rows[0][word]})"
    return section_of(f"{clearance.form.name}: the least clearance is {least}", rows)
