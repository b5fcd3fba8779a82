"""An atlas of equations as one JSON document."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint, Surface
from bifurc.completeness import completeness_document
from bifurc.files.layout import records_of
from bifurc.release import installed_version
from bifurc.singular.point import Invariants, Kind
from bifurc.surfaces.factor import values_of
from bifurc.systems.verdict import verdict_of

Json: TypeAlias = Any  # a value that JSON can hold


def make_document(atlas: Atlas) -> dict[str, Json]:
    """The document that `bifurc solve --json` prints; docs/equations.md says what each
    key holds."""
    provenance = atlas.provenance
    of_forms = [_of_form(atlas, form) for form in atlas.forms]
    of_surfaces = [_of_surface(atlas, surface) for surface in atlas.surfaces]
    of_points = [_of_point(atlas, point) for point in atlas.points]
    return {
        "name": str(atlas.subject.get("name", "")),
        "verdict": verdict_of(atlas),
        "equations": dict(atlas.subject.get("equations", {})),
        "parameters": dict(atlas.subject.get("parameters", {})),
        "unknowns": records_of(atlas, "joint"),
        "forms": _with(records_of(atlas, "form"), of_forms),
        "surfaces": _with(records_of(atlas, "surface"), of_surfaces),
        "singular_points": _with(records_of(atlas, "point"), of_points),
        "diagram": _diagram(atlas),
        "near_misses": records_of(atlas, "near_miss"),
        "isolated_solutions": [_values(atlas, point) for point in atlas.rigid],
        "near_motions": records_of(atlas, "near_motion"),
        "completeness": completeness_document(atlas.completeness),
        "seconds": provenance.seconds,
        "version": installed_version(),
        "seed": provenance.seed,
        "tolerance": provenance.settings.tracing.tolerance,
    }


def _with(
    records: Sequence[dict[str, Json]], others: Sequence[dict[str, Json]]
) -> list[Json]:
    """The records, each with what else is said."""
    return [one | more for one, more in zip(records, others, strict=True)]


def _values(atlas: Atlas, point: np.ndarray) -> dict[str, Json]:
    """The unknowns by their names."""
    return dict(zip(atlas.names, point.tolist(), strict=True))


def _of_form(atlas: Atlas, form: Form) -> dict[str, Json]:
    """What is said of a form besides its record."""
    branch = form.branch
    certificate = form.certificate
    ends: list[Json] = []
    if not branch.closed:
        begin, end = branch(np.array([0.0, branch.length]))
        ends = [_values(atlas, begin), _values(atlas, end)]
    return {
        "end": branch.outcome.name.lower().replace("_", " "),
        "ends": ends,
        "sample": _values(atlas, branch(0.5 * branch.length)),
        "certificate": None if certificate is None else certificate.status.value,
        "rims": list(form.labels.get("rims", ())),
    }


def _of_surface(atlas: Atlas, surface: Surface) -> dict[str, Json]:
    factors = values_of(surface.factors, atlas.names)
    charts = None if surface.charts is None else len(surface.charts)
    return {"charts": charts, "complete": surface.complete, "factors": factors}


def _of_point(atlas: Atlas, point: MeetingPoint) -> dict[str, Json]:
    """What is said of a singular point besides its record."""
    passes: list[Json] = []
    for (form, s), tangent in zip(point.passes, point.tangents, strict=True):
        one: dict[str, Json] = {
            "form": atlas.forms[form].name,
            "arclength": s,
            "tangent": tangent.tolist(),
        }
        passes.append(one)
    return {
        "half_branches": len(point.point.half_branches),
        "invariants": _invariants(point.point.invariants),
        "passes": passes,
    }


def _invariants(invariants: Invariants | None) -> dict[str, Json] | None:
    if invariants is None:
        return None
    return {
        "multiplicity": invariants.multiplicity,
        "branches": invariants.branches,
        "delta": invariants.delta,
        "milnor_number": invariants.milnor_number,
        "contacts": list(invariants.contacts),
    }


def _diagram(atlas: Atlas) -> dict[str, Json] | None:
    diagram = atlas.diagram
    if diagram is None:
        return None
    points = list(zip(records_of(atlas, "diagram_point"), diagram.points, strict=True))
    return {
        "parameter": diagram.parameter,
        **{
            kind.plural.lower().replace(" ", "_"): [
                record for record, point in points if point.kind is kind
            ]
            for kind in Kind
            if kind.plural
        },
        "branchings": records_of(atlas, "branching"),
        "stretches": records_of(atlas, "stretch"),
        "remarks": list(diagram.remarks),
    }
