"""The clearance of links along forms, as a command shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from bifurc.atlas import Atlas, Form
from bifurc.tables import section_of
from linkages.app.reports.layers import (
    describe_layers,
    layer_document,
    layers_of,
    length_text,
)
from linkages.app.texts.configurations import (
    arclength_unit,
    numbers_at,
    show_configuration,
)
from linkages.links.clearance import Approach, approaches_along
from linkages.links.layers import Layers, Widths
from linkages.links.parts import Parts
from linkages.subject import subject_at


@dataclass(frozen=True, eq=False)
class FormClearance:
    """Where links of some ``diameter`` are nearest along a form, the nearest first;
    distances are those of their middle lines. ``names`` are those of all links, or of
    all bodies of a mechanism, and in layers of the pins."""

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


@dataclass(frozen=True, eq=False)
class Clearance:
    """The clearances along some ``forms``, of a planar linkage in its ``layers``."""

    forms: list[FormClearance]
    layers: Layers | None


def clearance_of(atlas: Atlas, forms: Sequence[Form], diameter: float) -> Clearance:
    """The clearance of links of a diameter along forms."""
    parts = subject_at(atlas).parts
    if parts.normal is None:
        in_space = [
            FormClearance(
                form, diameter, parts.names, approaches_along(parts, form.branch)
            )
            for form in forms
        ]
        return Clearance(in_space, None)
    layers = layers_of(atlas, forms, Widths(diameter / 2, diameter / 2))
    names = [outline.name for outline in layers.plan.outlines]
    in_layers = [
        FormClearance(form, diameter, names, _approaches(layers, form, diameter))
        for form in forms
    ]
    return Clearance(in_layers, layers)


def _approaches(layers: Layers, form: Form, diameter: float) -> list[Approach]:
    """Where every two that share a layer are nearest along a form, the nearest first."""
    approaches = []
    for pair in layers.pairs():
        nearest = layers.plan.nearest(pair, form)
        distance = nearest.left + diameter
        place = nearest.theta
        approaches.append(Approach(pair, distance, nearest.s, place, nearest.error))
    return sorted(approaches, key=lambda approach: approach.distance)


def clearance_document(atlas: Atlas, clearance: Clearance) -> list[dict[str, Any]]:
    """What `bifurc clearance --json` prints: angles in rad, lengths in the user's
    unit."""
    layers = clearance.layers
    shared = {} if layers is None else {"layers": layer_document(atlas, layers)}
    return [
        {
            "form": one.form.name,
            "diameter": one.diameter,
            "approaches": [
                {
                    "links": one.links(approach),
                    "clearance": one.gap(approach),
                    "error": approach.error,
                    "arclength": approach.s,
                    "theta": numbers_at(atlas, approach.theta),
                }
                for approach in one.approaches
            ],
            **shared,
        }
        for one in clearance.forms
    ]


def describe_clearance(atlas: Atlas, clearance: Clearance) -> str:
    """The layers, where there are any, and a sentence and a table for every form."""
    layers = clearance.layers
    parts = [] if layers is None else [describe_layers(atlas, layers)]
    parts += [_of_form(atlas, one) for one in clearance.forms]
    links = _parts_of(atlas).word
    explanation = (
        f"Lengths are in the unit of the linkage; {links} that share a joint are left "
        "out"
    )
    if layers is not None:
        explanation += ", and what lies in different layers"
    explanation += "."
    if clearance.forms[0].diameter:
        explanation += f" {links.capitalize()} overlap where the clearance is below 0."
    return "\n\n".join([*parts, explanation])


def _parts_of(atlas: Atlas) -> Parts:
    """Those of which the clearance is shown."""
    subject = subject_at(atlas)
    return subject.parts if subject.parts.normal is None else subject.flat_parts


def _of_form(atlas: Atlas, clearance: FormClearance) -> str:
    subject = subject_at(atlas)
    if not clearance.approaches:
        left = "lie in different layers or " if subject.parts.normal is not None else ""
        return f"{clearance.form.name}: every two bodies {left}share a joint"
    word = _parts_of(atlas).word
    unit = arclength_unit(atlas)
    rows = []
    for approach in clearance.approaches:
        gap = clearance.gap(approach)
        rows.append(
            {
                word: " and ".join(clearance.links(approach)),
                "clearance": length_text(gap, subject.size),
                "at most less by": f"{approach.error:.1g}",
                f"arclength ({unit.name})": f"{unit.factor * approach.s:.3f}",
                subject.heading(atlas): show_configuration(atlas, approach.theta),
            }
        )
    least = f"{rows[0]['clearance']} ({word} {rows[0][word]})"
    return section_of(f"{clearance.form.name}: the least clearance is {least}", rows)
