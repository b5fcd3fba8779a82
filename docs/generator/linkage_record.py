"""What the pages say of the map of a linkage: plain values, which JSON can hold."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint
from bifurc.tables import count_of
from bifurc.torus import wrap
from linkages.app.answer.verdict import judge
from linkages.app.texts.numbers import in_degrees
from linkages.entry import Entry
from linkages.labels import FormLabels

SHOWN_SHARE = 0.5e-4 / 360  # of a turn, that four digits of a degree do not show


@dataclass(frozen=True)
class FormRow:
    """A form: joints from 1, the length in degrees, the rest as texts."""

    name: str
    length: float
    turns: str
    joints_at_rest: str
    symmetry: str


@dataclass(frozen=True)
class PointRow:
    """A singular point; ``angles`` in degrees, ``meeting`` names forms and surfaces."""

    name: str
    kind: str
    angles: str
    meeting: str


@dataclass(frozen=True)
class ClosedFormText:
    """A closed form: its name, who gives it, and its equations in LaTeX."""

    form: str
    source: str
    equations: tuple[str, ...]


@dataclass(frozen=True)
class LinkageRecord:
    """The map of a linkage at its default parameters, and its closed forms in LaTeX."""

    name: str
    joints: int
    form_count: int
    bifurcation_count: int
    counts: str
    verdict: str
    completeness: str
    forms: tuple[FormRow, ...]
    points: tuple[PointRow, ...]
    closed_forms: tuple[ClosedFormText, ...]

    def to_json(self) -> dict[str, Any]:
        """The record as values that JSON can hold."""
        return asdict(self)

    @classmethod
    def from_json(cls, values: dict[str, Any]) -> LinkageRecord:
        """The record that `to_json` gave."""
        lists: dict[str, Any] = {
            "forms": tuple(FormRow(**row) for row in values["forms"]),
            "points": tuple(PointRow(**row) for row in values["points"]),
            "closed_forms": tuple(
                ClosedFormText(row["form"], row["source"], tuple(row["equations"]))
                for row in values["closed_forms"]
            ),
        }
        return cls(**{**values, **lists})


def record_linkage(entry: Entry, atlas: Atlas) -> LinkageRecord:
    """What the page of a linkage says of its ``atlas``."""
    completeness = atlas.completeness
    return LinkageRecord(
        name=entry.name,
        joints=len(atlas.names),
        form_count=len(atlas.forms),
        bifurcation_count=len(atlas.bifurcations),
        counts=_counts(atlas),
        verdict=judge(atlas).sentence,
        completeness=f"{completeness.level}: {completeness.statement}.",
        forms=tuple(
            _form_row(form) for form in sorted(atlas.forms, key=lambda form: form.name)
        ),
        points=tuple(_point_row(atlas, point) for point in atlas.points),
        closed_forms=tuple(_closed_forms(entry)),
    )


def _counts(atlas: Atlas) -> str:
    """How many forms, bifurcations and components there are, and of the rarer things
    those that there are."""
    always = [
        count_of(len(atlas.forms), "form"),
        count_of(len(atlas.bifurcations), "bifurcation"),
        count_of(atlas.components, "component"),
    ]
    others = {
        "rank drop": len(atlas.rank_drops),
        "near miss": len(atlas.near_misses),
        "surface": len(atlas.surfaces),
        "rigid assembly": len(atlas.rigid),
    }
    present = [_count(number, noun) for noun, number in others.items() if number]
    return ", ".join(always + present)


def _count(number: int, noun: str) -> str:
    if noun.endswith("s") and number != 1:
        return f"{number} {noun}es"
    return count_of(number, noun)


def _form_row(form: Form) -> FormRow:
    labels = FormLabels.of(form)
    rests = zip(labels.inactive_joints, labels.inactive_angles, strict=True)
    branch = form.branch
    turns = " ".join(f"{turns:+d}" if turns else "0" for turns in branch.winding)
    if not branch.closed:
        turns = branch.outcome.name.lower().replace("_", " ")
    return FormRow(
        name=form.name,
        length=float(np.degrees(branch.length)),
        turns=turns,
        joints_at_rest=", ".join(f"{i} at {in_degrees(angle)}" for i, angle in rests),
        symmetry=labels.symmetry.value,
    )


def _point_row(atlas: Atlas, point: MeetingPoint) -> PointRow:
    angles = wrap(point.point.u, atlas.periods, within=SHOWN_SHARE)
    passing = Counter(atlas.forms[form].name for form, _ in point.passes)
    names = [_passes(name, times) for name, times in passing.items()]
    names += [atlas.surfaces[index].name for index in point.surfaces]
    return PointRow(
        name=point.name,
        kind=point.kind.value,
        angles=", ".join(in_degrees(angle) for angle in angles),
        meeting="; ".join(names),
    )


def _passes(name: str, times: int) -> str:
    return name if times == 1 else f"{name} ({times} times)"


def _closed_forms(entry: Entry) -> Iterable[ClosedFormText]:
    for form in entry.closed_forms:
        equations = form.latex().items()
        shown = tuple(f"{left} = {right}" for left, right in equations)
        yield ClosedFormText(form.form, form.source, shown)
