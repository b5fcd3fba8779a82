"""The layers of a planar linkage along forms, as commands show them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bifurc.atlas import Atlas, Form
from bifurc.tables import count_of, section_of
from linkages.app.texts.configurations import (
    arclength_unit,
    numbers_at,
    show_configuration,
)
from linkages.links.layers import Layers, Meeting, Plan, Widths
from linkages.links.parts import Bodies, Parts
from linkages.subject import subject_at

SHOWN = 1e-9  # in characteristic lengths: what is less comes out as 0


def length_text(value: float, size: float) -> str:
    """A length of a linkage of this ``size`` as text."""
    return "0" if abs(value) < SHOWN * size else f"{value:.6g}"


def layers_of(atlas: Atlas, forms: Sequence[Form], widths: Widths) -> Layers:
    """The layers of a planar linkage in which nothing meets along forms, those that its
    file gives kept."""
    parts = subject_at(atlas).flat_parts
    given = subject_at(atlas).given_layers
    numbers = {list(parts.names).index(name): layer for name, layer in given.items()}
    return Plan(parts, forms, widths).layers(numbers)


def parts_in_layers(atlas: Atlas, forms: Sequence[Form]) -> Parts:
    """The parts of an animated model: bodies of a planar mechanism one above the other,
    such that rods pass each other along forms; all others as they are."""
    from linkages.export.glb import JOINT_RADIUS, LAYER, ROD_RADIUS

    subject = subject_at(atlas)
    if subject.readout is None or subject.flat_parts.normal is None:
        return subject.parts
    widths = Widths(ROD_RADIUS * subject.size, JOINT_RADIUS * subject.size)
    numbers = layers_of(atlas, forms, widths).numbers
    heights = LAYER * subject.size * (numbers - numbers.min())
    return Bodies(subject.readout.structure, heights)


def layer_document(atlas: Atlas, layers: Layers) -> dict[str, Any]:
    """The layers in values that JSON can hold: angles in rad, lengths in the user's
    unit."""
    plan = layers.plan
    names = plan.parts.names
    return {
        "count": layers.count,
        "is_proven": layers.is_proven,
        "bodies": dict(zip(names, layers.numbers.tolist(), strict=True)),
        "pins": {pin.name: list(layers.span(pin)) for pin in plan.pins},
        "meetings": [
            {
                "parts": [plan.outlines[k].name for k in meeting.outlines],
                "clearance": meeting.left,
                "form": meeting.form.name,
                "arclength": meeting.s,
                "theta": numbers_at(atlas, meeting.theta),
            }
            for meeting in layers.meetings
        ],
    }


def describe_layers(atlas: Atlas, layers: Layers) -> str:
    """A table of the layers, the highest first, with the pins that reach into them; and
    one of what meets, where layers do not keep all apart."""
    plan = layers.plan
    rows = []
    for number in range(layers.count, 0, -1):
        own: list[str] = []
        through: list[str] = []
        for outline in plan.outlines:
            low, high = layers.span(outline)
            if low <= number <= high:
                (through if outline.is_pin else own).append(outline.name)
        pins = ", ".join(name.removeprefix("pin ") for name in through)
        words = {"layer": f"{number}", plan.parts.word: ", ".join(own), "pins": pins}
        rows.append(words)
    count = count_of(layers.count, "layer")
    given = subject_at(atlas).given_layers
    if layers.meetings:
        title = f"{count}, which do not keep all apart"
        return f"{section_of(title, rows)}\n\n{describe_meetings(atlas, layers)}"
    sure = "no fewer will do" if layers.is_proven else "fewer were not excluded in time"
    if given:
        sure = f"with the given ones of {', '.join(given)} {sure}"
    return section_of(f"{count}, {sure}", rows)


def describe_meetings(atlas: Atlas, layers: Layers) -> str:
    """A table of what meets whatever the layers are."""
    unit = arclength_unit(atlas)
    heading = subject_at(atlas).heading(atlas)
    rows = [
        {
            "parts": meeting_names(layers, meeting),
            "clearance": length_text(meeting.left, subject_at(atlas).size),
            "form": meeting.form.name,
            f"arclength ({unit.name})": f"{unit.factor * meeting.s:.3f}",
            heading: show_configuration(atlas, meeting.theta),
        }
        for meeting in sorted(layers.meetings, key=lambda one: one.left)
    ]
    is_given = bool(subject_at(atlas).given_layers)
    if is_given:
        title = "What meets in the given layers"
    elif layers.is_proven:
        title = "In no layers all are apart; in these meet"
    else:
        title = "No layers with all apart were found in time; in these meet"
    return section_of(title, rows)


def meeting_names(layers: Layers, meeting: Meeting) -> str:
    """The names of two that meet."""
    outlines = [layers.plan.outlines[k] for k in meeting.outlines]
    names = layers.plan.parts.full_names
    return " and ".join(
        one.name if one.is_pin else names[one.holder] for one in outlines
    )
