"""The clearance of links as text: degrees, links by their joints."""

from __future__ import annotations

from bifurc.atlas import Atlas
from bifurc.text_tables import table
from linkages.app.answer.configurations import arclength_unit, show_configuration
from linkages.app.reports.clearance import FormClearance
from linkages.app.subject import subject_at

SHOWN = 1e-9  # in characteristic lengths: what is less comes out as 0
HEADS = ("clearance", "at most less by")


def describe_clearance(atlas: Atlas, clearances: list[FormClearance]) -> str:
    """A sentence and a table for every form."""
    parts = [_of_form(atlas, clearance) for clearance in clearances]
    links = subject_at(atlas).parts
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
    smallest = SHOWN * subject.size
    unit = arclength_unit(atlas)
    rows = []
    for approach in clearance.approaches:
        rows.append(
            (
                " and ".join(clearance.links(approach)),
                _length(clearance.gap(approach), smallest),
                f"{approach.error:.1g}",
                f"{unit.factor * approach.s:.3f}",
                show_configuration(atlas, approach.theta),
            )
        )
    links, least, *_ = rows[0]
    word = subject.parts
    title = f"{clearance.form.name}: the least clearance is {least} ({word} {links})"
    heads = (word, *HEADS, f"arclength ({unit.name})", subject.heading(atlas))
    return f"{title}\n{table(heads, rows)}"


def _length(length: float, smallest: float) -> str:
    """A length to six digits; what is below the smallest one shown comes out as 0."""
    return "0" if abs(length) < smallest else f"{length:.6g}"
