"""What of an atlas goes into which variable of its dataset."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Sized
from typing import Any

import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint
from bifurc.files.json_values import to_text
from bifurc.files.surface_layout import surface_variables

__all__ = ["Variable", "atlas_variables", "split_rows", "variable"]

Variable = tuple[tuple[str, ...], np.ndarray, dict[str, str]]


def atlas_variables(atlas: Atlas, joint: str, unit: str) -> dict[str, Variable]:
    """Dimensions, values and attributes of every variable of the dataset.

    ``joint`` is the dimension of the unknowns, ``unit`` the unit they share.
    """
    n = len(atlas.names)
    return {
        "period": variable(
            joint, atlas.periods, "period of the unknown, inf for none", unit
        ),
        "unit": variable(joint, texts(atlas.units), "unit of the unknown"),
        **_form_variables(atlas.forms, n, joint, unit),
        **_point_variables(atlas.points, n, joint, unit),
        **_event_variables(atlas, joint, unit),
        **_solution_variables(atlas, joint, unit),
    }


def variable(
    dimensions: str | tuple[str, ...], values: Any, long_name: str, units: str = ""
) -> Variable:
    """One variable with its long name and units."""
    names = (dimensions,) if isinstance(dimensions, str) else dimensions
    return (
        names,
        np.asarray(values),
        {"long_name": long_name} | ({"units": units} if units else {}),
    )


def split_rows(values: np.ndarray, counts: np.ndarray) -> list[np.ndarray]:
    """The rows of a ragged array: parts of ``values`` with the given sizes."""
    return np.split(values, np.cumsum(counts))[: len(counts)]


def _certificate_text(form: Form) -> str:
    return "" if form.certificate is None else to_text(form.certificate.as_values())


def _form_variables(
    forms: Sequence[Form], n: int, joint: str, unit: str
) -> dict[str, Variable]:
    branches = [form.branch for form in forms]
    order = max((b.pieces.shape[1] for b in branches), default=1)
    pieces = [
        np.pad(b.pieces, ((0, 0), (0, order - b.pieces.shape[1]), (0, 0)))
        for b in branches
    ]
    s = [form.profile.arclength.ravel() for form in forms]
    values = [form.profile.values.reshape(-1, n) for form in forms]
    points = [
        branch(at) if len(branch.pieces) else np.empty((0, n))
        for branch, at in zip(branches, s, strict=True)
    ]
    along = ("form", "sample")
    return {
        "arclength": variable(along, _padded(s, ()), "arclength along the form", unit),
        "configuration": variable(
            (*along, joint), _padded(points, (n,)), "unknowns along the form", unit
        ),
        "singular_values": variable(
            (*along, "singular_value"),
            _padded(values, (n,)),
            "singular values of F' over its magnitude",
            "1",
        ),
        "sample_count": _sizes("form", s, "sample"),
        "sample_nodes": variable(
            "form",
            _ints(f.profile.arclength.shape[1] for f in forms),
            "samples on each piece",
        ),
        "length": variable(
            "form",
            _floats(b.length for b in branches),
            "arclength of the whole form",
            unit,
        ),
        "closed": variable(
            "form",
            np.array([b.closed for b in branches], bool),
            "whether the form is a closed curve",
        ),
        "winding": variable(
            ("form", joint),
            _rows([b.winding for b in branches], n, int),
            "turns along a closed form",
        ),
        "max_residual": variable(
            "form",
            _floats(b.max_residual for b in branches),
            "largest relative residual",
            "1",
        ),
        "min_singular_value": variable(
            "form",
            _floats(f.min_singular_value for f in forms),
            "smallest regular singular value along the form",
            "1",
        ),
        "rank": variable(
            "form", _ints(f.rank for f in forms), "rank of F' along the form"
        ),
        "component": variable(
            "form",
            _ints(f.component for f in forms),
            "number of the connected component",
        ),
        "labels": variable(
            "form",
            texts(to_text(dict(f.labels)) for f in forms),
            "what was recognised, as JSON",
        ),
        "certificate": variable(
            "form",
            texts(_certificate_text(f) for f in forms),
            "what is certified, as JSON; empty where nothing is",
        ),
        "outcome": variable(
            "form", texts(b.outcome.name for b in branches), "why tracing ended"
        ),
        "gap": variable(
            "form",
            _floats(b.gap for b in branches),
            "residual at an uncorrected start",
            "1",
        ),
        "piece_count": _sizes("form", pieces, "piece"),
        "piece_order": variable(
            "form",
            _ints(b.pieces.shape[1] - 1 for b in branches),
            "degree of the pieces",
        ),
        "coefficient": variable(
            ("piece", "power", joint),
            _joined(pieces, (order, n)),
            "coefficients in (s - center) / radius",
            unit,
        ),
        "center": variable(
            "piece",
            _joined([b.centers for b in branches]),
            "arclength at its centre",
            unit,
        ),
        "radius": variable(
            "piece",
            _joined([b.radii for b in branches]),
            "radius in which it is trusted",
            unit,
        ),
        "piece_residual": variable(
            "piece",
            _joined([b.residuals for b in branches]),
            "largest relative residual",
            "1",
        ),
        "break_count": _sizes("form", [b.breaks for b in branches], "break"),
        "break_arclength": variable(
            "break",
            _joined([b.breaks for b in branches]),
            "where pieces hand over",
            unit,
        ),
    }


def _point_variables(
    points: Sequence[MeetingPoint], n: int, joint: str, unit: str
) -> dict[str, Variable]:
    found = [point.point for point in points]
    passes = [np.array(point.passes, dtype=float).reshape(-1, 2) for point in points]
    joined = _joined(passes, (2,))
    vectors = {
        "pass_tangent": (
            "pass",
            [p.tangents for p in points],
            "unit tangent of the form that passes",
        ),
        "null_vector": (
            "null",
            [p.null_space.T for p in found],
            "orthonormal basis of the null space of F'",
        ),
        "half_branch": (
            "half",
            [p.half_branches for p in found],
            "unit direction in which solutions leave",
        ),
        "cone_tangent": (
            "cone",
            [p.tangents for p in found],
            "unit tangent from the second-order equations",
        ),
    }
    out = {
        "point_kind": variable(
            "point", texts(p.kind.name for p in points), "what the singular point is"
        ),
        "point_note": variable("point", texts(p.note for p in points), "remark"),
        "point_configuration": variable(
            ("point", joint), _rows([p.u for p in found], n), "singular point", unit
        ),
        "point_rank": variable(
            "point", _ints(p.rank for p in found), "rank of F' at the point"
        ),
        "point_error": variable(
            "point",
            _floats(p.error for p in found),
            "estimated error of the point",
            unit,
        ),
        "point_dimension": variable(
            "point",
            _ints(p.dimension for p in found),
            "dimension of the solutions nearby",
        ),
        "point_order": variable(
            "point",
            _ints(p.order for p in found),
            "order that decided; 0: the section alone",
        ),
        "point_radius": variable(
            "point", _floats(p.radius for p in found), "radius of the section", unit
        ),
        "met_surface": variable(
            "meeting",
            _ints(k for p in points for k in p.surfaces),
            "index of a surface it lies on",
        ),
        "meeting_count": _sizes("point", [p.surfaces for p in points], "meeting"),
        "pass_form": variable(
            "pass", joined[:, 0].astype(int), "index of the form that passes, from 0"
        ),
        "pass_arclength": variable(
            "pass", joined[:, 1], "arclength at which it passes", unit
        ),
    }
    for name, (dimension, rows, meaning) in vectors.items():
        out[f"{dimension}_count"] = _sizes("point", rows, dimension)
        out[name] = variable((dimension, joint), _joined(rows, (n,)), meaning, "1")
    return out


def _event_variables(atlas: Atlas, joint: str, unit: str) -> dict[str, Variable]:
    n, out = len(atlas.names), {}
    for name, events in (
        ("near_miss", atlas.near_misses),
        ("dead_point", atlas.dead_points),
    ):
        out[f"{name}_form"] = variable(
            name, _ints(e.form for e in events), "index of the form, from 0"
        )
        out[f"{name}_arclength"] = variable(
            name, _floats(e.s for e in events), "arclength along the form", unit
        )
        out[f"{name}_configuration"] = variable(
            (name, joint), _rows([e.u for e in events], n), "unknowns there", unit
        )
    return out | {
        "near_miss_value": variable(
            "near_miss",
            _floats(e.value for e in atlas.near_misses),
            "smallest regular singular value there",
            "1",
        ),
        "dead_point_index": variable(
            "dead_point",
            _ints(e.index for e in atlas.dead_points),
            f"index of the {joint} that turns back, from 0",
        ),
    }


def _solution_variables(atlas: Atlas, joint: str, unit: str) -> dict[str, Variable]:
    n, surfaces = len(atlas.names), [surface.samples for surface in atlas.surfaces]
    return {
        "rigid_assembly": variable(
            ("assembly", joint), _rows(atlas.rigid, n), "isolated solution", unit
        ),
        "surface_dimension": variable(
            "surface", _ints(s.dimension for s in atlas.surfaces), "dimension"
        ),
        **surface_variables(atlas.surfaces, n, joint, unit, variable),
        "surface_sample_count": _sizes("surface", surfaces, "surface_sample"),
        "surface_configuration": variable(
            ("surface_sample", joint),
            _joined(surfaces, (n,)),
            "solution on a surface",
            unit,
        ),
    }


def _sizes(owner: str, rows: Sequence[Sized], dimension: str) -> Variable:
    """Row sizes of a ragged array."""
    names, values, attributes = variable(
        owner, _ints(len(r) for r in rows), f"number of {dimension} entries"
    )
    return names, values, attributes | {"sample_dimension": dimension}


def _joined(rows: Sequence[np.ndarray], shape: tuple[int, ...] = ()) -> np.ndarray:
    """Arrays (k, *shape) one behind the other."""
    return np.concatenate([np.empty((0, *shape)), *rows])


def _padded(rows: Sequence[np.ndarray], shape: tuple[int, ...]) -> np.ndarray:
    """Arrays (k, *shape) of different k side by side, filled up with NaN."""
    out = np.full((len(rows), max((len(r) for r in rows), default=0), *shape), np.nan)
    for filled, row in zip(out, rows, strict=True):
        filled[: len(row)] = row
    return out


def _rows(rows: Any, n: int, dtype: type = float) -> np.ndarray:
    return np.array(rows, dtype=dtype).reshape(len(rows), n)


def _floats(values: Iterable[float]) -> np.ndarray:
    return np.array(list(values), dtype=float)


def _ints(values: Iterable[int]) -> np.ndarray:
    return np.array(list(values), dtype=int)


def texts(values: Iterable[str]) -> np.ndarray:
    """The values as an array of strings."""
    return np.array(list(values), dtype=str)
