"""The clearance of links along forms, as a command shows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from bifurc.atlas import Atlas, Form
from linkages.app.answer.configurations import numbers_at
from linkages.app.subject import subject_at
from linkages.links.clearance import Approach


@dataclass(frozen=True, eq=False)
class FormClearance:
    """Where links of some ``diameter`` are nearest along a form, the nearest first;
    distances are those of their middle lines. ``names`` are those of all links, or of
    all bodies of a mechanism."""

    form: Form
    diameter: float
    names: tuple[str, ...]
    approaches: tuple[Approach, ...]

    def gap(self, approach: Approach) -> float:
        """What is left between two links; below zero they meet."""
        return approach.distance - self.diameter

    def links(self, approach: Approach) -> list[str]:
        """The names of two links."""
        return [self.names[link] for link in approach.links]


def clearance_of(atlas: Atlas, form: Form, diameter: float) -> FormClearance:
    """The clearance of links of a diameter along a form."""
    subject = subject_at(atlas)
    approaches = subject.approaches(form.branch)
    return FormClearance(form, diameter, subject.part_names, approaches)


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
