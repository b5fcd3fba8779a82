"""An atlas of a linkage as one JSON document: angles in radians, joints numbered from
1."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np

from bifurc.atlas import Atlas, Form, Surface
from bifurc.torus import wrap

__all__ = ["make_document"]


def make_document(atlas: Atlas) -> dict[str, Any]:
    """The document that `bifurc map --json` prints; docs/results.md says what each key
    holds."""
    names = [form.name for form in atlas.forms]
    forms = [_form(atlas, i, form) for i, form in enumerate(atlas.forms)]
    surfaces = [_surface(atlas, k, surface) for k, surface in enumerate(atlas.surfaces)]
    sure = atlas.completeness
    return {
        "linkage": dict(atlas.subject),
        "forms": forms + surfaces,
        "bifurcations": [
            {
                "theta": _angles(atlas, point.point.u),
                "rank": point.point.rank,
                "forms": [names[i] for i, _ in point.passes],
                "tangents": point.tangents.tolist(),
                "error": point.point.error,
            }
            for point in atlas.bifurcations
        ],
        "rank_drops": [
            {
                "theta": _angles(atlas, point.point.u),
                "rank": point.point.rank,
                "form": names[point.passes[0][0]],
            }
            for point in atlas.rank_drops
        ],
        "near_misses": [
            {
                "theta": _angles(atlas, miss.u),
                "singular_value": miss.value,
                "form": names[miss.form],
            }
            for miss in atlas.near_misses
        ],
        "dead_points": [
            {
                "theta": _angles(atlas, dead.u),
                "joint": dead.index + 1,
                "form": names[dead.form],
            }
            for dead in atlas.dead_points
        ],
        "rigid_assemblies": [_angles(atlas, theta) for theta in atlas.rigid],
        "completeness": {
            "level": "complete slices"
            if sure.level in ("proved", "certified")
            else "estimated",
            "certainty": sure.level,
            "statement": sure.statement,
            "missed_probability": sure.missed_probability,
        },
        "seconds": atlas.provenance.seconds,
        "version": version("bifurc"),
        "seed": atlas.provenance.seed,
        "tolerance": atlas.provenance.settings.tracing.tolerance,
    }


def _form(atlas: Atlas, index: int, form: Form) -> dict[str, Any]:
    branch = form.branch
    return {
        "name": form.name,
        "dimension": 1,
        "closed": branch.closed,
        "length": branch.length,
        "winding": branch.winding.tolist(),
        "inactive_joints": list(form.labels["inactive_joints"]),
        "symmetry": form.labels["symmetry"],
        "sample": _angles(atlas, branch(_far_from_singular(atlas, index))),
        "max_residual": float(form.labels["max_residual"]),
        "min_singular_value": form.min_singular_value,
        "component": form.component,
    }


def _surface(atlas: Atlas, number: int, surface: Surface) -> dict[str, Any]:
    """A component of dimension 2 or more, shown by one configuration."""
    return {
        "name": f"surface {number + 1}",
        "dimension": surface.dimension,
        "closed": None,
        "length": None,
        "winding": None,
        "inactive_joints": [],
        "symmetry": "",
        "sample": _angles(atlas, surface.samples[0]),
        "max_residual": None,
        "min_singular_value": None,
        "component": atlas.components + number,
    }


def _far_from_singular(atlas: Atlas, index: int) -> float:
    """An arclength of a form: the middle of its longest stretch without singular
    points."""
    branch = atlas.forms[index].branch
    marks = sorted(s for point in atlas.points for i, s in point.passes if i == index)
    if not marks:
        return 0.5 * branch.length
    marks = (
        [*marks, marks[0] + branch.length]
        if branch.closed
        else [0.0, *marks, branch.length]
    )
    longest = int(np.argmax(np.diff(marks)))
    return 0.5 * (marks[longest] + marks[longest + 1])


def _angles(atlas: Atlas, theta: np.ndarray) -> list[float]:
    return [float(x) for x in wrap(theta, atlas.periods)]
