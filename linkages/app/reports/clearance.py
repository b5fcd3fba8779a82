"""The clearance of links along forms, as a command shows it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypedDict

from bifurc.atlas import Atlas, Form
from linkages.app.answer.configurations import loop_angles_of, numbers_at, readout_of
from linkages.app.texts.numbers import link_name
from linkages.labels import loop_of
from linkages.links.clearance import Approach, approaches_along
from linkages.loop import Loop


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


class ApproachDocument(TypedDict):
    """Two links and where they are nearest, angles in rad, lengths in the user's
    unit."""

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
    readout = readout_of(atlas)
    if readout is None:
        loop = loop_of(atlas)
    elif readout.single_loop is not None:
        loop = readout.single_loop.loop
    else:
        from linkages.links.body_clearance import approaches_of_bodies

        bodies = readout.mechanism.bodies
        nearest = approaches_of_bodies(readout.structure, form.branch)
        return FormClearance(form, diameter, bodies, tuple(nearest))
    names = tuple(link_name(link, loop.n) for link in range(loop.n))
    approaches = _approaches_of_links(atlas, form, loop)
    return FormClearance(form, diameter, names, approaches)


def _approaches_of_links(atlas: Atlas, form: Form, loop: Loop) -> tuple[Approach, ...]:
    """Where the links of the loop that an atlas is of are nearest, in the unknowns of
    the atlas."""
    to_angles = loop_angles_of(atlas)
    return tuple(
        replace(approach, theta=to_angles.inverse.points(approach.theta))
        for approach in approaches_along(loop, to_angles.branch(form.branch))
    )


def clearance_document(
    atlas: Atlas, clearances: list[FormClearance]
) -> list[FormClearanceDocument]:
    """What `bifurc clearance --json` prints."""
    documents: list[FormClearanceDocument] = []
    for clearance in clearances:
        approaches: list[ApproachDocument] = []
        for approach in clearance.approaches:
            approaches.append(
                {
                    "links": clearance.links(approach),
                    "clearance": clearance.gap(approach),
                    "error": approach.error,
                    "arclength": approach.s,
                    "theta": numbers_at(atlas, approach.theta),
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
