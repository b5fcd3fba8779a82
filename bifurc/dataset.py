"""An atlas as an `xarray.Dataset` and as a NetCDF file, and back without loss.

What comes in rows of different length (pieces of forms, passes of singular points, samples of surfaces) is
stored one behind the other, with the row sizes in a variable of its own (CF: contiguous ragged array; the
attribute ``sample_dimension`` of the sizes names the dimension they count). Samples along the forms are padded
with NaN.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Surface
from bifurc.branch import Branch, Outcome
from bifurc.monitor import Profile
from bifurc.plain import from_text, to_text
from bifurc.seeding import Completeness
from bifurc.singular import Kind, SingularPoint

__all__ = ["AtlasFileError", "from_dataset", "load_atlas", "save_atlas", "to_dataset"]

FORMAT, FORMAT_VERSION = "bifurc atlas", 1
LINKAGE_UNITS = {"twists": "rad"}

Variable = tuple[tuple[str, ...], np.ndarray, dict[str, str]]


class AtlasFileError(ValueError):
    """A dataset or file that holds no atlas: ``source`` names it, ``missing`` what it lacks."""

    def __init__(self, source: str, reason: str, missing: Iterable[str] = ()):
        self.source, self.missing = source, tuple(missing)
        super().__init__(f"{source}: {reason}")


# --- files --------------------------------------------------------------------------------------------


def save_atlas(atlas: Atlas, path: str | os.PathLike[str]) -> Path:
    """The path of the NetCDF file just written; an older file is replaced.

    The file is written under a temporary name beside it and renamed, so that no half-written file is ever
    found under ``path``. Raises `OSError` where the folder cannot be written.
    """
    target = Path(path)
    dataset = to_dataset(atlas)
    now = datetime.now(UTC).isoformat(timespec="seconds")
    dataset.attrs |= {"date_created": now, "history": f"{now} written by {dataset.attrs['source']}"}
    with tempfile.TemporaryDirectory(prefix=f".{target.name}.", dir=target.parent) as folder:
        part = Path(folder) / target.name
        dataset.to_netcdf(part, engine="netcdf4", format="NETCDF4")
        os.replace(part, target)
    return target


def load_atlas(path: str | os.PathLike[str]) -> Atlas:
    """The atlas that `save_atlas` wrote.

    Raises `FileNotFoundError`, and `AtlasFileError` for a file that is not NetCDF or holds no atlas.
    """
    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"{source}: there is no such file")
    try:
        with xr.open_dataset(source, engine="netcdf4", decode_times=False) as opened:
            dataset = opened.load()
    except (OSError, ValueError) as error:
        raise AtlasFileError(str(source), f"it cannot be read as NetCDF ({error})") from error
    return _read(dataset, str(source))


# --- writing ------------------------------------------------------------------------------------------


def to_dataset(atlas: Atlas) -> xr.Dataset:
    """The atlas as a dataset.

    Its dimensions are ``form``, ``sample``, ``joint`` (``unknown`` where the unknowns are not all angles),
    ``singular_value``, ``piece``, ``power``, ``point`` (singular points), ``pass`` and others named after what they
    count. ``sample`` runs over the points at which the singular values were taken, denser where the curve bends more.
    Entries of ``atlas.info["linkage"]`` become variables along ``joint`` and attributes called ``linkage_...``.
    """
    joint = "joint" if all(unit == "rad" for unit in atlas.units) else "unknown"
    unit = atlas.units[0] if len(set(atlas.units)) == 1 and atlas.units[0] else "1"
    variables: dict[str, Variable] = {
        "period": _variable(joint, atlas.periods, "period of the unknown, inf for none", unit),
        "unit": _variable(joint, _texts(atlas.units), "unit of the unknown"),
        **_form_variables(atlas.forms, len(atlas.names), joint, unit),
        **_point_variables(atlas.points, len(atlas.names), joint, unit),
        **_other_variables(atlas, joint, unit),
    }
    linkage_variables, linkage_attributes = _linkage(atlas, joint)
    coordinates = {
        joint: _texts(atlas.names),
        "form": _texts(form.name for form in atlas.forms),
        "point": _texts(point.name for point in atlas.points),
    }
    dataset = xr.Dataset({**variables, **linkage_variables}, coordinates, {**_attributes(atlas, joint), **linkage_attributes})
    for name in dataset.variables:
        dataset[name].encoding["_FillValue"] = None
    return dataset


def _attributes(atlas: Atlas, joint: str) -> dict[str, Any]:
    """Attributes of the whole dataset: what it is and where it comes from."""
    try:
        release = version("bifurc")
    except PackageNotFoundError:
        release = "unknown"
    plain: dict[str, Any] = {}
    for key, value in atlas.info.items():
        nested = {f"{key}_{k}": v for k, v in value.items()} if isinstance(value, dict) else {key: value}
        plain |= {k: v for k, v in nested.items() if type(v) in (int, float, str)}
        plain |= {k: int(v) for k, v in nested.items() if type(v) is bool}
    return plain | {
        "title": "Transition map: forms, singular points and what connects them",
        "Conventions": "CF-1.11",
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "source": f"bifurc {release}",
        "version": release,
        "unknown_dimension": joint,
        "closure_gap": float(atlas.closure_gap),
        "completeness_level": atlas.completeness.level,
        "completeness_statement": atlas.completeness.statement,
        "missed_probability": float(atlas.completeness.missed_probability),
        "info": to_text(dict(atlas.info)),
    }


def _linkage(atlas: Atlas, joint: str) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables and attributes of ``info["linkage"]``: one number for each unknown makes a variable."""
    variables: dict[str, Variable] = {}
    attributes: dict[str, Any] = {}
    for key, value in atlas.info.get("linkage", {}).items():
        if isinstance(value, str | int | float):
            attributes[f"linkage_{key}"] = value
        elif np.shape(value) == (len(atlas.names),):
            units = LINKAGE_UNITS.get(key, "")
            variables[f"linkage_{key}"] = _variable(joint, _floats(value), f"{key} of the linkage", units)
    return variables, attributes


def _form_variables(forms: Sequence[Form], n: int, joint: str, unit: str) -> dict[str, Variable]:
    branches = [form.branch for form in forms]
    order = max((b.pieces.shape[1] for b in branches), default=1)
    pieces = [np.pad(b.pieces, ((0, 0), (0, order - b.pieces.shape[1]), (0, 0))) for b in branches]
    s = [form.profile.arclength.ravel() for form in forms]
    values = [form.profile.values.reshape(-1, n) for form in forms]
    points = [branch(at) if len(branch.pieces) else np.empty((0, n)) for branch, at in zip(branches, s, strict=True)]
    along = ("form", "sample")
    return {
        "arclength": _variable(along, _padded(s, ()), "arclength along the form", unit),
        "configuration": _variable((*along, joint), _padded(points, (n,)), "unknowns along the form", unit),
        "singular_value": _variable(
            (*along, "singular_value"), _padded(values, (n,)), "singular values of F' over its magnitude, decreasing", "1"
        ),
        "sample_count": _sizes("form", s, "sample"),
        "sample_nodes": _variable("form", _ints(f.profile.arclength.shape[1] for f in forms), "samples on each piece"),
        "length": _variable("form", _floats(b.length for b in branches), "arclength of the whole form", unit),
        "closed": _variable("form", np.array([b.closed for b in branches], bool), "whether the form is a closed curve"),
        "winding": _variable(("form", joint), _rows([b.winding for b in branches], n, int), "turns along a closed form"),
        "max_residual": _variable("form", _floats(b.max_residual for b in branches), "largest relative residual", "1"),
        "min_singular_value": _variable(
            "form", _floats(f.min_singular_value for f in forms), "smallest regular singular value along the form", "1"
        ),
        "rank": _variable("form", _ints(f.rank for f in forms), "rank of F' along the form"),
        "component": _variable("form", _ints(f.component for f in forms), "number of the connected component"),
        "labels": _variable("form", _texts(to_text(dict(f.labels)) for f in forms), "what was recognised of the form, as JSON"),
        "outcome": _variable("form", _texts(b.outcome.name for b in branches), "why tracing ended"),
        "gap": _variable("form", _floats(b.gap for b in branches), "residual at a start that could not be corrected", "1"),
        "piece_count": _sizes("form", pieces, "piece"),
        "piece_order": _variable("form", _ints(b.pieces.shape[1] - 1 for b in branches), "degree of the pieces"),
        "coefficient": _variable(
            ("piece", "power", joint), _joined(pieces, (order, n)), "coefficients in (s - center) / radius", unit
        ),
        "center": _variable("piece", _joined([b.centers for b in branches]), "arclength at the centre of the piece", unit),
        "radius": _variable("piece", _joined([b.radii for b in branches]), "radius in which the piece is trusted", unit),
        "piece_residual": _variable("piece", _joined([b.residuals for b in branches]), "largest relative residual", "1"),
        "break_count": _sizes("form", [b.breaks for b in branches], "break"),
        "break_arclength": _variable("break", _joined([b.breaks for b in branches]), "where pieces hand over", unit),
    }  # fmt: skip


def _point_variables(points: Sequence[MeetingPoint], n: int, joint: str, unit: str) -> dict[str, Variable]:
    found = [point.point for point in points]
    passes = [np.array(point.passes, dtype=float).reshape(-1, 2) for point in points]
    joined = _joined(passes, (2,))
    vectors = {
        "pass_tangent": ("pass", [p.tangents for p in points], "unit tangent of the form that passes"),
        "null_vector": ("null", [p.null_space.T for p in found], "orthonormal basis of the null space of F'"),
        "half_branch": ("half", [p.half_branches for p in found], "unit direction in which solutions leave"),
        "cone_tangent": ("cone", [p.tangents for p in found], "unit tangent from the second-order equations"),
    }
    out = {
        "point_kind": _variable("point", _texts(p.kind.name for p in points), "what the singular point is"),
        "point_note": _variable("point", _texts(p.note for p in points), "remark"),
        "point_configuration": _variable(("point", joint), _rows([p.u for p in found], n), "singular point", unit),
        "point_rank": _variable("point", _ints(p.rank for p in found), "rank of F' at the point"),
        "point_error": _variable("point", _floats(p.error for p in found), "estimated distance to the exact point", unit),
        "point_dimension": _variable("point", _ints(p.dimension for p in found), "dimension of the solutions nearby"),
        "point_order": _variable("point", _ints(p.order for p in found), "order that decided; 0: the section alone"),
        "point_radius": _variable("point", _floats(p.radius for p in found), "radius of the section", unit),
        "pass_form": _variable("pass", joined[:, 0].astype(int), "index of the form that passes, from 0"),
        "pass_arclength": _variable("pass", joined[:, 1], "arclength at which it passes", unit),
    }  # fmt: skip
    for name, (dimension, rows, meaning) in vectors.items():
        out[f"{dimension}_count"] = _sizes("point", rows, dimension)
        out[name] = _variable((dimension, joint), _joined(rows, (n,)), meaning, "1")
    return out


def _other_variables(atlas: Atlas, joint: str, unit: str) -> dict[str, Variable]:
    n, surfaces = len(atlas.names), [surface.samples for surface in atlas.surfaces]
    out = {
        "near_miss_value": _variable(
            "near_miss", _floats(e.value for e in atlas.near_misses), "smallest regular singular value there", "1"
        ),
        f"dead_point_{joint}": _variable(
            "dead_point", _ints(e.index for e in atlas.dead_points), f"index of the {joint} that turns back, from 0"
        ),
        "rigid_assembly": _variable(("assembly", joint), _rows(atlas.rigid, n), "isolated solution", unit),
        "surface_dimension": _variable("surface", _ints(s.dimension for s in atlas.surfaces), "dimension"),
        "surface_count": _sizes("surface", surfaces, "surface_sample"),
        "surface_configuration": _variable(
            ("surface_sample", joint), _joined(surfaces, (n,)), "solution on a surface", unit
        ),
    }
    for name, events in (("near_miss", atlas.near_misses), ("dead_point", atlas.dead_points)):
        out[f"{name}_form"] = _variable(name, _ints(e.form for e in events), "index of the form, from 0")
        out[f"{name}_arclength"] = _variable(name, _floats(e.s for e in events), "arclength along the form", unit)
        out[f"{name}_configuration"] = _variable((name, joint), _rows([e.u for e in events], n), "unknowns there", unit)
    return out


def _variable(dimensions: str | tuple[str, ...], values: np.ndarray, long_name: str, units: str = "") -> Variable:
    names = (dimensions,) if isinstance(dimensions, str) else dimensions
    return names, np.asarray(values), {"long_name": long_name} | ({"units": units} if units else {})


def _sizes(owner: str, rows: Sequence[np.ndarray], dimension: str) -> Variable:
    """Row sizes of a ragged array."""
    names, values, attributes = _variable(owner, _ints(len(r) for r in rows), f"number of {dimension} entries")
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
    return np.array(rows, dtype=dtype).reshape(-1, n)


def _floats(values: Iterable[float]) -> np.ndarray:
    return np.array(list(values), dtype=float)


def _ints(values: Iterable[int]) -> np.ndarray:
    return np.array(list(values), dtype=int)


def _texts(values: Iterable[str]) -> np.ndarray:
    return np.array(list(values), dtype=str)


# --- reading ------------------------------------------------------------------------------------------


def from_dataset(dataset: xr.Dataset) -> Atlas:
    """The atlas that `to_dataset` stored; raises `AtlasFileError` that lists what is missing."""
    return _read(dataset, "dataset")


def _read(dataset: xr.Dataset, source: str) -> Atlas:
    _check(dataset, source)
    joint = dataset.attrs["unknown_dimension"]
    get = {str(name): dataset[name].values for name in dataset.variables}
    attributes = dataset.attrs
    samples = np.split(get["surface_configuration"], np.cumsum(get["surface_count"])[:-1])
    return Atlas(
        names=_strings(get[joint]),
        units=_strings(get["unit"]),
        periods=get["period"],
        forms=_read_forms(get),
        points=_read_points(get),
        near_misses=_read_events(get, "near_miss", values=get["near_miss_value"]),
        dead_points=_read_events(get, "dead_point", indices=get[f"dead_point_{joint}"]),
        rigid=get["rigid_assembly"],
        surfaces=tuple(
            Surface(int(d), part) for d, part in zip(get["surface_dimension"], samples, strict=False)
        ),
        completeness=Completeness(
            attributes["completeness_level"],
            attributes["completeness_statement"],
            float(attributes["missed_probability"]),
        ),
        closure_gap=float(attributes["closure_gap"]),
        info=from_text(attributes["info"]),
    )


def _check(dataset: xr.Dataset, source: str) -> None:
    """Raise `AtlasFileError` unless the dataset has everything an atlas needs."""
    kind = dataset.attrs.get("format")
    if kind != FORMAT:
        raise AtlasFileError(source, f"its attribute 'format' is {kind!r}; it must be {FORMAT!r}", ["format"])
    found = int(dataset.attrs.get("format_version", 0))
    if found != FORMAT_VERSION:
        raise AtlasFileError(source, f"its format version is {found}; this release reads {FORMAT_VERSION}")
    joint = dataset.attrs.get("unknown_dimension", "joint")
    empty = Atlas((), (), np.empty(0), (), (), (), (), np.empty((0, 0)), (), Completeness("", "", 1.0))
    model = to_dataset(empty)
    needed = [str(name).replace("_joint", f"_{joint}") for name in model.variables if name != "joint"]
    missing = [name for name in (*needed, joint) if name not in dataset.variables]
    missing += [name for name in model.attrs if name not in dataset.attrs]
    if missing:
        raise AtlasFileError(source, "it lacks " + ", ".join(missing), missing)
