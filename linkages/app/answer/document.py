"""An atlas of a linkage or a mechanism as one JSON document: angles in radians, joints
numbered from 1; for a mechanism also variables by the names of its joints. What goes by
the numbers of joints is that of the Denavit-Hartenberg table where there is one, also
for a mechanism that is a single loop."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, NearMotion
from bifurc.completeness import completeness_document
from bifurc.decisions import is_tied
from bifurc.release import installed_version
from bifurc.singular.point import Kind
from bifurc.surfaces.factor import values_of
from linkages.app.answer.verdict import is_without_gaps
from linkages.app.texts.configurations import numbers_at
from linkages.labels import FormLabels
from linkages.readout.dead_points import moving_dead_points
from linkages.subject import subject_at
from linkages.turns.translates import isolated_assemblies_of

# values that JSON can hold; docs/results.md says what each key does
Document: TypeAlias = dict[str, Any]


def make_document(atlas: Atlas) -> Document:
    """The document that `bifurc map --json` prints."""
    forms = [_form(atlas, i) for i in range(len(atlas.forms))]
    surfaces = [_surface(atlas, k) for k in range(len(atlas.surfaces))]
    return {
        "linkage": subject_at(atlas).table_values(),
        "mobility": atlas.mobility,
        "gruebler": subject_at(atlas).gruebler,
        "forms": forms + surfaces,
        "bifurcations": [_bifurcation(atlas, point) for point in atlas.bifurcations],
        "rank_drops": [_rank_drop(atlas, point) for point in atlas.rank_drops],
        "other_singular_points": [
            _singular_point(atlas, point)
            for point in atlas.points
            if point.kind not in (Kind.BIFURCATION, Kind.RANK_DROP)
        ],
        "near_misses": [_near_miss(atlas, event) for event in atlas.near_misses],
        "dead_points": [
            _dead_point(atlas, event) for event in moving_dead_points(atlas)
        ],
        "rigid_assemblies": [
            _assembly(atlas, theta) for theta in isolated_assemblies_of(atlas)
        ],
        "near_motions": [_near_motion(atlas, near) for near in atlas.near_motions],
        "completeness": _completeness(atlas),
        "seconds": atlas.provenance.seconds,
        "version": installed_version(),
        "seed": atlas.provenance.seed,
        "tolerance": atlas.provenance.settings.tracing.tolerance,
        **subject_at(atlas).document(atlas),
    }


def _place(atlas: Atlas, theta: NDArray[np.float64], key: str = "theta") -> Document:
    """A configuration (n,) behind its ``key``; of a mechanism also its variables."""
    return {key: numbers_at(atlas, theta), **subject_at(atlas).place(theta)}


def _assembly(atlas: Atlas, theta: NDArray[np.float64]) -> list[float] | Document:
    """A rigid assembly: of a loop the joint angles alone."""
    place = _place(atlas, theta)
    if len(place) == 1:
        return numbers_at(atlas, theta)
    readout = subject_at(atlas).readout
    if readout is None:
        return place
    # it imports networkx, which a loop does not need
    from linkages.readout.rigidity import held_document

    return {**place, **held_document(readout, theta)}


def _form(atlas: Atlas, index: int) -> Document:
    form = atlas.forms[index]
    labels = FormLabels.of(form)
    to_angles = subject_at(atlas).to_angles
    winding = to_angles.directions(form.branch.winding).astype(int)
    inactive = [to_angles.index(joint - 1) + 1 for joint in labels.inactive_joints]
    sample = form.branch(_clear_arclength(atlas, index))
    return {
        "name": form.name,
        "dimension": 1,
        "closed": form.branch.closed,
        "length": form.branch.length,
        "winding": winding.tolist(),
        "inactive_joints": sorted(inactive),
        "symmetry": labels.symmetry.value,
        **_place(atlas, sample, "sample"),
        "max_residual": labels.max_residual,
        "misclosure": form.misclosure,
        "min_singular_value": form.min_singular_value,
        "component": form.component,
        "certificate": _certificate(form),
        **subject_at(atlas).motion(atlas, index),
    }


def _certificate(form: Form) -> Document | None:
    certificate = form.certificate
    if certificate is None:
        return None
    return {
        "status": certificate.status.value,
        "refused": certificate.gaps.tolist(),
        "blurred": certificate.blurred.tolist(),
    }


def _surface(atlas: Atlas, index: int) -> Document:
    """A component of dimension 2 or more, shown by one configuration."""
    surface = atlas.surfaces[index]
    return {
        "name": f"surface {index + 1}",
        "dimension": surface.dimension,
        "closed": None,
        "length": None,
        "winding": None,
        "inactive_joints": [],
        "symmetry": "",
        **_place(atlas, surface.samples[0], "sample"),
        "max_residual": None,
        "misclosure": None,
        "min_singular_value": None,
        "component": atlas.components + index,
        "certificate": None,
        "charts": None if surface.charts is None else len(surface.charts),
        "complete": surface.complete,
        "note": surface.note,
        "factors": values_of(surface.factors, atlas.names),
    }


def _bifurcation(atlas: Atlas, point: MeetingPoint) -> Document:
    return {
        **_place(atlas, point.point.u),
        "rank": point.point.rank,
        "forms": [atlas.forms[index].name for index, _ in point.passes],
        "tangents": subject_at(atlas).to_angles.directions(point.tangents).tolist(),
        "error": point.point.error,
    }


def _rank_drop(atlas: Atlas, point: MeetingPoint) -> Document:
    index, _ = point.passes[0]
    return {
        **_place(atlas, point.point.u),
        "rank": point.point.rank,
        "form": atlas.forms[index].name,
    }


def _singular_point(atlas: Atlas, point: MeetingPoint) -> Document:
    return {
        **_place(atlas, point.point.u),
        "kind": point.kind.value,
        "rank": point.point.rank,
        "error": point.point.error,
        "forms": [atlas.forms[index].name for index, _ in point.passes],
    }


def _near_miss(atlas: Atlas, event: Event) -> Document:
    return {
        **_place(atlas, event.u),
        "singular_value": event.value,
        "error": event.error,
        "form": atlas.forms[event.form].name,
    }


def _near_motion(atlas: Atlas, near: NearMotion) -> Document:
    return {
        "name": near.name,
        "misclosure": near.misclosure,
        "length": near.length,
        "closed": near.is_closed,
        "mobility": near.mobility,
        **_place(atlas, near.sample, "sample"),
    }


def _dead_point(atlas: Atlas, event: Event) -> Document:
    return {
        **_place(atlas, event.u),
        "joint": subject_at(atlas).to_angles.index(event.index) + 1,
        "form": atlas.forms[event.form].name,
        **subject_at(atlas).variable(event.index),
    }


def _completeness(atlas: Atlas) -> Document:
    values = completeness_document(atlas.completeness)
    slices = is_without_gaps(atlas.completeness)
    level = "complete slices" if slices else "estimated"
    return {**values, "level": level, "certainty": values["level"]}


def _clear_arclength(atlas: Atlas, index: int) -> float:
    """An arclength of a form: the middle of its longest stretch without singular
    points."""
    branch = atlas.forms[index].branch
    passes = [one for point in atlas.points for one in point.passes]
    marks = sorted(s for form, s in passes if form == index)
    if not marks:
        return 0.5 * branch.length
    if branch.closed:
        marks.append(marks[0] + branch.length)
    else:
        marks = [0.0, *marks, branch.length]
    gaps = np.diff(marks)
    # of stretches as long as one another, which symmetry makes, the first
    longest = int(np.argmax(gaps > gaps.max() - is_tied.threshold * branch.length))
    return 0.5 * (marks[longest] + marks[longest + 1])
