"""The summary of a transition map: degrees, joints numbered from 1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas, MeetingPoint, Surface
from bifurc.branch import Branch, Outcome
from bifurc.singular.point import Kind
from bifurc.tables import section, section_of
from linkages.app.answer.verdict import judge
from linkages.app.texts.configurations import (
    arclength_unit,
    show_configuration,
    unit_of_arclengths,
)
from linkages.app.texts.entry_text import describe_geometry
from linkages.app.texts.form_names import listed_forms
from linkages.app.texts.numbers import in_degrees
from linkages.labels import FormLabels, loop_of
from linkages.subject import subject_at

SHOWN = 12  # near misses and rigid assemblies beyond this number are only counted


def make_summary(atlas: Atlas) -> str:
    """What `bifurc map` shows: verdict, geometry, forms, singular points, completeness
    and time."""
    completeness = atlas.completeness
    provenance = atlas.provenance
    geometry, motions = _tables(atlas)
    parts = [
        f"{atlas.subject.get('name')}\n{judge(atlas).sentence}",
        *geometry,
        _forms(atlas),
        _surfaces(atlas),
        *(_points(atlas, title) for title in dict.fromkeys(one.title for one in Kind)),
        _near_misses(atlas),
        _rigid_assemblies(atlas),
        _near_motions(atlas),
        _certificates(atlas),
        *motions,
        f"Completeness ({completeness.level}): {completeness.statement}.",
        f"Explored in {provenance.seconds:.3f} s, seed {provenance.seed}.",
    ]
    return "\n\n".join(part for part in parts if part)


def _tables(atlas: Atlas) -> tuple[list[str], list[str]]:
    """Tables of what was mapped, and of what it does along its forms."""
    readout = subject_at(atlas).readout
    if readout is None:
        return [describe_geometry(loop_of(atlas))], []
    from linkages.app.texts import mechanism_text

    geometry = [
        mechanism_text.describe_joints(readout),
        mechanism_text.describe_outer_joints(readout.mechanism),
        mechanism_text.describe_loops(atlas, readout),
    ]
    if not atlas.forms:
        return geometry, []
    return geometry, [
        mechanism_text.describe_motions(atlas, readout),
        mechanism_text.describe_dead_points(atlas, readout),
        mechanism_text.describe_outer_motions(atlas, readout),
    ]


def _forms(atlas: Atlas) -> str:
    rows = []
    unit = arclength_unit(atlas)
    for form in listed_forms(atlas):
        labels = FormLabels.of(form)
        rows.append(
            {
                "name": form.name,
                "closed": _closure(form.branch),
                f"length ({unit.name})": f"{unit.factor * form.branch.length:.6g}",
                "winding": _winding(atlas, form.branch),
                "inactive joints": _inactive_joints(atlas, labels),
                "symmetry": labels.symmetry.value or "-",
                "smallest s.v.": f"{form.min_singular_value:.3g}",
                "residual": f"{labels.max_residual:.1e}",
            }
        )
    return section_of("Forms", rows)


def _closure(branch: Branch) -> str:
    """Whether a branch is closed, or else how it ends."""
    if branch.closed:
        return "yes"
    if branch.outcome is Outcome.LEFT_REGION:
        return "leaves the limits"
    return branch.outcome.name.lower().replace("_", " ")


def _winding(atlas: Atlas, branch: Branch) -> str:
    """How often each joint turns round, with its sign; "-" for unknowns that do not
    turn."""
    words = []
    for turns, period in zip(branch.winding, atlas.periods, strict=True):
        if not np.isfinite(period):
            words.append("-")
        else:
            words.append(f"{turns:+d}" if turns else "0")
    return " ".join(words)


def _inactive_joints(atlas: Atlas, labels: FormLabels) -> str:
    """The joints that stand still, those of a mechanism by name; where, of a loop."""
    pairs = zip(labels.inactive_joints, labels.inactive_angles, strict=True)
    still = subject_at(atlas).still
    shown = [still(joint - 1, in_degrees(angle)) for joint, angle in pairs]
    return ", ".join(shown) or "-"


def _surfaces(atlas: Atlas) -> str:
    unit = "rad^2"
    if set(atlas.units) != {"rad"}:
        unit = f"squares of {arclength_unit(atlas).name}"
    heads = ("name", "dimension", "charts", f"area ({unit})", "covering", "remark")
    return section("Surfaces", heads, [_surface_row(s) for s in atlas.surfaces])


def _surface_row(surface: Surface) -> tuple[str, ...]:
    name, dimension = surface.name, str(surface.dimension)
    charts = surface.charts
    if charts is None:
        return (name, dimension, "-", "-", "none: only sampled", surface.note)
    count, area = str(len(charts)), f"{charts.area:.6g}"
    return (name, dimension, count, area, charts.outcome.value, surface.note)


def _points(atlas: Atlas, title: str) -> str:
    """The singular points of the kinds whose table has a ``title``."""
    rows = []
    for point in atlas.points:
        if point.kind.title != title:
            continue
        remark = f": {point.note}" if point.note else ""
        rows.append(
            {
                "name": point.name,
                subject_at(atlas).heading(atlas): show_configuration(
                    atlas, point.point.u
                ),
                "rank": str(point.point.rank),
                "error": f"{point.point.error:.0e}",
                "forms": ", ".join(_names_at(atlas, point)) or "-",
                "kind": point.kind.value + remark,
            }
        )
    return section_of(title, rows)


def _names_at(atlas: Atlas, point: MeetingPoint) -> list[str]:
    """Names of the forms, once for every pass, and the surfaces at a singular point."""
    forms = [atlas.forms[index].name for index, _ in point.passes]
    surfaces = [atlas.surfaces[index].name for index in point.surfaces]
    if point.kind is Kind.DIMENSION_CHANGE and not surfaces:
        # charts tell which surface is met; those that are only sampled have none
        sampled = [one.name for one in atlas.surfaces if one.charts is None]
        surfaces = [" or ".join(sampled)] if sampled else []
    return forms + surfaces


def _near_misses(atlas: Atlas) -> str:
    rows = []
    for miss in sorted(atlas.near_misses, key=lambda miss: miss.value):
        rows.append(
            {
                subject_at(atlas).heading(atlas): show_configuration(atlas, miss.u),
                "singular value": f"{miss.value:.6g}",
                "error": f"{miss.error:.0e}",
                "form": atlas.forms[miss.form].name,
            }
        )
    return section_of("Near misses (no bifurcation)", rows, SHOWN)


def _rigid_assemblies(atlas: Atlas) -> str:
    rows = [(show_configuration(atlas, theta),) for theta in atlas.rigid]
    return section("Rigid assemblies", (subject_at(atlas).heading(atlas),), rows, SHOWN)


def _near_motions(atlas: Atlas) -> str:
    rows = []
    unit = arclength_unit(atlas)
    for near in atlas.near_motions:
        closed = "yes" if near.is_closed else "no"
        length = f"{unit.factor * near.length:.4g}"
        if near.mobility > 1:
            closed, length = "-", "-"
        rows.append(
            {
                "name": near.name,
                subject_at(atlas).heading(atlas): show_configuration(
                    atlas, near.sample
                ),
                "mobility": str(near.mobility),
                "closed": closed,
                f"length ({unit.name})": length,
                "misclosure": f"{near.misclosure:.3g}",
            }
        )
    return section_of("Near motions (the loop nearly closes)", rows, SHOWN)


def _certificates(atlas: Atlas) -> str:
    rows = []
    unit = unit_of_arclengths(atlas)
    for form in listed_forms(atlas):
        certificate = form.certificate
        if certificate is None:
            continue
        rows.append(
            {
                "name": form.name,
                "status": certificate.status,
                "points": str(certificate.points),
                "bound K": f"{certificate.bound:.3g}",
                f"refused ({unit})": _show_intervals(certificate.gaps),
                f"blurred ({unit})": _show_intervals(certificate.blurred),
            }
        )
    return section_of("Certificates (each form is one arc of solutions)", rows)


def _show_intervals(intervals: NDArray[np.float64]) -> str:
    """The first interval of arclength, and how many more there are."""
    if not len(intervals):
        return "-"
    low, high = intervals[0]
    text = f"{low:.6g} to {high:.6g}"
    more = len(intervals) - 1
    return f"{text} and {more} more" if more else text
