"""An atlas of equations as one JSON document."""

from __future__ import annotations

from importlib.metadata import version
from typing import TypeAlias, cast

import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint
from bifurc.completeness import completeness_document
from bifurc.diagrams.diagram import Diagram, DiagramPoint
from bifurc.singular.point import Invariants, Kind
from bifurc.systems.verdict import verdict_of

Json: TypeAlias = "str | float | bool | list[Json] | dict[str, Json] | None"


def make_document(atlas: Atlas) -> dict[str, Json]:
    """The document that `bifurc solve --json` prints; docs/equations.md says what each
    key holds."""
    provenance = atlas.provenance
    return {
        "name": str(atlas.subject.get("name", "")),
        "verdict": verdict_of(atlas),
        "equations": dict(atlas.subject.get("equations", {})),
        "parameters": dict(atlas.subject.get("parameters", {})),
        "unknowns": _unknowns(atlas),
        "forms": [_form(atlas, form) for form in atlas.forms],
        "surfaces": [
            {
                "name": one.name,
                "dimension": one.dimension,
                "complete": one.complete,
                "note": one.note,
            }
            for one in atlas.surfaces
        ],
        "singular_points": [_point(atlas, point) for point in atlas.points],
        "diagram": _diagram(atlas, atlas.diagram),
        "near_misses": [
            {
                "u": _values(atlas, miss.u),
                "singular_value": miss.value,
                "error": miss.error,
                "form": atlas.forms[miss.form].name,
            }
            for miss in atlas.near_misses
        ],
        "isolated_solutions": [_values(atlas, point) for point in atlas.rigid],
        "near_motions": [
            {
                "misclosure": near.misclosure,
                "length": near.length,
                "closed": near.is_closed,
                "dimension": near.mobility,
                "sample": _values(atlas, near.sample),
            }
            for near in atlas.near_motions
        ],
        "completeness": cast(Json, completeness_document(atlas.completeness)),
        "seconds": provenance.seconds,
        "version": version("bifurc"),
        "seed": provenance.seed,
        "tolerance": provenance.settings.tracing.tolerance,
    }


def _values(atlas: Atlas, point: np.ndarray) -> dict[str, Json]:
    """The unknowns by their names."""
    return dict(zip(atlas.names, point.tolist(), strict=True))


def _unknowns(atlas: Atlas) -> list[Json]:
    columns = zip(atlas.names, atlas.units, atlas.periods.tolist(), strict=True)
    return [
        {
            "name": name,
            "unit": unit,
            "period": period if np.isfinite(period) else None,
        }
        for name, unit, period in columns
    ]


def _form(atlas: Atlas, form: Form) -> dict[str, Json]:
    branch = form.branch
    certificate = form.certificate
    ends: list[Json] = []
    if not branch.closed:
        begin, end = branch(np.array([0.0, branch.length]))
        ends = [_values(atlas, begin), _values(atlas, end)]
    return {
        "name": form.name,
        "closed": branch.closed,
        "end": branch.outcome.name.lower().replace("_", " "),
        "ends": ends,
        "length": branch.length,
        "winding": branch.winding.tolist(),
        "component": form.component,
        "rank": form.rank,
        "sample": _values(atlas, branch(0.5 * branch.length)),
        "max_residual": branch.max_residual,
        "misclosure": form.misclosure,
        "min_singular_value": form.min_singular_value,
        "certificate": None if certificate is None else certificate.status.value,
        "rims": list(form.labels.get("rims", ())),
    }


def _point(atlas: Atlas, point: MeetingPoint) -> dict[str, Json]:
    passes: list[Json] = []
    for (form, s), tangent in zip(point.passes, point.tangents, strict=True):
        one: dict[str, Json] = {
            "form": atlas.forms[form].name,
            "arclength": s,
            "tangent": tangent.tolist(),
        }
        passes.append(one)
    return {
        "name": point.name,
        "kind": point.kind.value,
        "u": _values(atlas, point.point.u),
        "rank": point.point.rank,
        "error": point.point.error,
        "half_branches": len(point.point.half_branches),
        "invariants": _invariants(point.point.invariants),
        "passes": passes,
        "note": point.note,
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


def _diagram(atlas: Atlas, diagram: Diagram | None) -> dict[str, Json] | None:
    if diagram is None:
        return None
    return {
        "parameter": diagram.parameter,
        **{
            kind.plural.lower().replace(" ", "_"): [
                _diagram_point(atlas, one) for one in diagram.points if one.kind is kind
            ]
            for kind in Kind
            if kind.plural
        },
        "branchings": [
            {"point": atlas.points[one.point].name, "kind": one.kind.value}
            for one in diagram.branchings
        ],
        "stretches": [
            {
                "form": atlas.forms[one.form].name,
                "start": one.start,
                "end": one.end,
                "stability": one.stability.value,
                "unstable": one.unstable if one.unstable >= 0 else None,
            }
            for one in diagram.stretches
        ],
        "remarks": list(diagram.remarks),
    }


def _diagram_point(atlas: Atlas, point: DiagramPoint) -> dict[str, Json]:
    return {
        "name": point.name,
        "label": point.label,
        "form": atlas.forms[point.form].name,
        "arclength": point.s,
        "u": _values(atlas, point.u),
        "value": point.value,
        "error": point.error,
    }
