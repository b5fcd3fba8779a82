"""The clearance of links along forms, as a command shows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict

from bifurc.atlas import Atlas, Form
from bifurc.torus import wrap
from linkages.app.texts import link_name
from linkages.labels import loop_of
from linkages.links.clearance import Approach, approaches_along

__all__ = ["FormClearance", "clearance_document", "clearance_of"]


@dataclass(frozen=True, eq=False)
class FormClearance:
    """Where links of some ``diameter`` are nearest along a form, the nearest first;
    distances are those of their middle lines."""

    form: Form
    diameter: float
    approaches: tuple[Approach, ...]

    def gap(self, approach: Approach) -> float:
        """What is left between two links; below zero they meet."""
        return approach.distance - self.diameter


class ApproachDocument(TypedDict):
    """Two links and where they are nearest, angles in rad."""

    links: list[str]
    clearance: float
    error: float
    arclength: float
    theta: list[float]


class FormClearanceDocument(TypedDict):
    """The clearance along a form."""

    form: str
    diameter: float
    approaches: list[ApproachDocument]


def clearance_of(atlas: Atlas, form: Form, diameter: float) -> FormClearance:
    """The clearance of links of a diameter along a form."""
    approaches = approaches_along(loop_of(atlas), form.branch)
    return FormClearance(form, diameter, tuple(approaches))


def clearance_document(
    atlas: Atlas, clearances: list[FormClearance]
) -> list[FormClearanceDocument]:
    """What `bifurc clearance --json` prints."""
    documents: list[FormClearanceDocument] = []
    n = len(atlas.names)
    for clearance in clearances:
        approaches: list[ApproachDocument] = []
        for approach in clearance.approaches:
            approaches.append(
                {
                    "links": [link_name(link, n) for link in approach.links],
                    "clearance": clearance.gap(approach),
                    "error": approach.error,
                    "arclength": approach.s,
                    "theta": wrap(approach.theta, atlas.periods).tolist(),
                }
            )
        documents.append(
            {
                "form": clearance.form.name,
                "diameter": clearance.diameter,
                "approaches": approaches,
            }
        )
    return documents
