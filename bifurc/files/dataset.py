"""An atlas as an `xarray.Dataset` and as a NetCDF file, and back without loss.

What comes in rows of different length (pieces of forms, passes of singular points,
samples of surfaces) is stored one behind the other, with the row sizes in a variable of
its own (CF: contiguous ragged array; the attribute ``sample_dimension`` of the sizes
names the dimension they count). Samples along the forms are padded with NaN.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Provenance
from bifurc.branch import Branch, Outcome
from bifurc.curves.certificate import Certificate
from bifurc.curves.continuation import TraceSettings
from bifurc.curves.monitor import Profile
from bifurc.errors import BifurcError
from bifurc.files.json_values import from_text, to_text
from bifurc.files.layout import Variable, atlas_variables, split_rows, variable
from bifurc.files.surface_layout import read_surfaces
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Completeness
from bifurc.singular.point import Kind, SingularPoint

__all__ = ["AtlasFileError", "from_dataset", "load_atlas", "save_atlas", "to_dataset"]

FORMAT, FORMAT_VERSION = "bifurc atlas", 3
LINKAGE_UNITS = {"twists": "rad"}


class AtlasFileError(BifurcError, ValueError):
    """A dataset or file that holds no atlas: ``source`` names it, ``missing`` what it
    lacks."""

    def __init__(self, source: str, reason: str, missing: Iterable[str] = ()):
        self.source, self.missing = source, tuple(missing)
        super().__init__(f"{source}: {reason}")


# --- files --------------------------------------------------------------------------------------------


def save_atlas(atlas: Atlas, path: str | os.PathLike[str]) -> Path:
    """The path of the NetCDF file just written; an older file is replaced.

    The file is written under a temporary name beside it and renamed, so that no
    half-written file is ever found under ``path``. Raises `OSError` where the folder
    cannot be written.
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise NotADirectoryError(f"{target.parent}: there is no such folder")
    dataset = to_dataset(atlas)
    now = datetime.now(UTC).isoformat(timespec="seconds")
    dataset.attrs |= {
        "date_created": now,
        "history": f"{now} written by {dataset.attrs['source']}",
    }
    with tempfile.TemporaryDirectory(
        prefix=f".{target.name}.", dir=target.parent
    ) as folder:
        part = Path(folder) / target.name
        dataset.to_netcdf(part, engine="netcdf4", format="NETCDF4")
        os.replace(part, target)
    return target


def load_atlas(path: str | os.PathLike[str]) -> Atlas:
    """The atlas that `save_atlas` wrote.

    Raises `FileNotFoundError`, and `AtlasFileError` for a file that is not NetCDF or
    holds no atlas.
    """
    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"{source}: there is no such file")
    try:
        with xr.open_dataset(source, engine="netcdf4", decode_times=False) as opened:
            dataset = opened.load()
    except (OSError, ValueError) as error:
        raise AtlasFileError(
            str(source), f"it cannot be read as NetCDF ({error})"
        ) from error
    return _read(dataset, str(source))


# --- writing ------------------------------------------------------------------------------------------


def to_dataset(atlas: Atlas) -> xr.Dataset:
    """The atlas as a dataset.

    Its dimensions are ``form``, ``sample``, ``joint`` (``unknown`` where the unknowns
    are not all angles), ``singular_value``, ``piece``, ``power``, ``point`` (singular
    points), ``pass`` and others named after what they count. ``sample`` runs over the
    points at which the singular values were taken, denser where the curve bends more.
    Entries of ``atlas.subject`` become variables along ``joint`` and attributes
    called ``linkage_...``.
    """
    joint = "joint" if all(unit == "rad" for unit in atlas.units) else "unknown"
    unit = atlas.units[0] if len(set(atlas.units)) == 1 and atlas.units[0] else "1"
    linkage_variables, linkage_attributes = _linkage(atlas, joint)
    coordinates = {
        joint: list(atlas.names),
        "form": np.array([form.name for form in atlas.forms], dtype=str),
        "point": np.array([point.name for point in atlas.points], dtype=str),
    }
    dataset = xr.Dataset(
        {**atlas_variables(atlas, joint, unit), **linkage_variables},
        coordinates,
        {**_attributes(atlas, joint), **linkage_attributes},
    )
    for name in dataset.variables:
        dataset[name].encoding["_FillValue"] = None
    return dataset


def _attributes(atlas: Atlas, joint: str) -> dict[str, Any]:
    """Attributes of the whole dataset: what it is and where it comes from."""
    try:
        release = version("bifurc")
    except PackageNotFoundError:
        release = "unknown"
    settings = atlas.provenance.settings
    plain = {
        "seed": atlas.provenance.seed,
        "starts": settings.starts,
        "budget": settings.budget,
        "interrupted": int(atlas.provenance.interrupted),
        "out_of_time": int(atlas.provenance.out_of_time),
        "derivatives": atlas.provenance.derivatives,
        "seconds": atlas.provenance.seconds,
    }
    tracing = asdict(settings.tracing)
    plain |= {f"settings_{name}": value for name, value in tracing.items()}
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
        "provenance": to_text(asdict(atlas.provenance)),
        "subject": to_text(dict(atlas.subject)),
    }


def _linkage(atlas: Atlas, joint: str) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables and attributes of the subject: one number for each unknown
    makes a variable."""
    variables: dict[str, Variable] = {}
    attributes: dict[str, Any] = {}
    for key, value in atlas.subject.items():
        if isinstance(value, str | int | float):
            attributes[f"linkage_{key}"] = value
        elif np.shape(value) == (len(atlas.names),):
            units = LINKAGE_UNITS.get(key, "")
            variables[f"linkage_{key}"] = variable(
                joint, np.array(value, dtype=float), f"{key} of the linkage", units
            )
    return variables, attributes


# --- reading ------------------------------------------------------------------------------------------


def from_dataset(dataset: xr.Dataset) -> Atlas:
    """The atlas that `to_dataset` stored; raises `AtlasFileError` that lists what is
    missing."""
    return _read(dataset, "dataset")


def _read(dataset: xr.Dataset, source: str) -> Atlas:
    _check(dataset, source)
    attributes = dataset.attrs
    get = {str(name): dataset[name].values for name in dataset.variables}
    surfaces = split_rows(get["surface_configuration"], get["surface_sample_count"])
    return Atlas(
        names=tuple(map(str, get[attributes["unknown_dimension"]])),
        units=tuple(map(str, get["unit"])),
        periods=get["period"],
        forms=tuple(_read_form(get, i) for i in range(dataset.sizes["form"])),
        points=tuple(_read_point(get, i) for i in range(dataset.sizes["point"])),
        near_misses=_read_events(get, "near_miss", "value"),
        dead_points=_read_events(get, "dead_point", "index"),
        rigid=get["rigid_assembly"],
        surfaces=read_surfaces(get, surfaces),
        completeness=Completeness(
            str(attributes["completeness_level"]),
            str(attributes["completeness_statement"]),
            float(attributes["missed_probability"]),
        ),
        closure_gap=float(attributes["closure_gap"]),
        provenance=_read_provenance(from_text(attributes["provenance"])),
        subject=from_text(attributes["subject"]),
    )


def _read_provenance(values: dict[str, Any]) -> Provenance:
    settings = values.pop("settings")
    tracing = TraceSettings(**settings.pop("tracing"))
    return Provenance(**values, settings=SearchSettings(**settings, tracing=tracing))


def _read_form(get: dict[str, np.ndarray], i: int) -> Form:
    def part(name: str, dimension: str) -> np.ndarray:
        return split_rows(get[name], get[f"{dimension}_count"])[i]

    branch = Branch(
        pieces=part("coefficient", "piece")[:, : get["piece_order"][i] + 1],
        centers=part("center", "piece"),
        radii=part("radius", "piece"),
        breaks=part("break_arclength", "break"),
        residuals=part("piece_residual", "piece"),
        periods=get["period"],
        outcome=Outcome[str(get["outcome"][i])],
        gap=float(get["gap"][i]),
    )
    count, nodes, n = int(get["sample_count"][i]), int(get["sample_nodes"][i]), branch.n
    profile = Profile(
        get["arclength"][i, :count].reshape(-1, nodes),
        get["singular_values"][i, :count].reshape(-1, nodes, n),
        int(get["rank"][i]),
    )
    return Form(
        str(get["form"][i]),
        branch,
        profile,
        float(get["min_singular_value"][i]),
        int(get["component"][i]),
        _read_certificate(str(get["certificate"][i])),
        from_text(str(get["labels"][i])),
    )


def _read_certificate(text: str) -> Certificate | None:
    return Certificate.from_values(from_text(text)) if text else None


def _read_point(get: dict[str, np.ndarray], i: int) -> MeetingPoint:
    def part(name: str, dimension: str) -> np.ndarray:
        return split_rows(get[name], get[f"{dimension}_count"])[i]

    point = SingularPoint(
        u=get["point_configuration"][i],
        rank=int(get["point_rank"][i]),
        null_space=part("null_vector", "null").T,
        error=float(get["point_error"][i]),
        half_branches=part("half_branch", "half"),
        tangents=part("cone_tangent", "cone"),
        dimension=int(get["point_dimension"][i]),
        order=int(get["point_order"][i]),
        radius=float(get["point_radius"][i]),
    )
    passes = zip(
        part("pass_form", "pass").tolist(),
        part("pass_arclength", "pass").tolist(),
        strict=True,
    )
    return MeetingPoint(
        name=str(get["point"][i]),
        kind=Kind[str(get["point_kind"][i])],
        point=point,
        passes=tuple(passes),
        tangents=part("pass_tangent", "pass"),
        note=str(get["point_note"][i]),
        surfaces=tuple(part("met_surface", "meeting").tolist()),
    )


def _read_events(get: dict[str, np.ndarray], name: str, what: str) -> tuple[Event, ...]:
    """Near misses with their "value", or dead points with the "index" of the
    unknown."""
    return tuple(
        Event(form, s, u, **{what: number})
        for form, s, u, number in zip(
            get[f"{name}_form"].tolist(),
            get[f"{name}_arclength"].tolist(),
            get[f"{name}_configuration"],
            get[f"{name}_{what}"].tolist(),
            strict=True,
        )
    )


def _check(dataset: xr.Dataset, source: str) -> None:
    """Raise `AtlasFileError` unless the dataset has everything an atlas needs."""
    kind = dataset.attrs.get("format")
    if kind != FORMAT:
        raise AtlasFileError(
            source,
            f"its attribute 'format' is {kind!r}; it must be {FORMAT!r}",
            ["format"],
        )
    found = int(dataset.attrs.get("format_version", 0))
    if found != FORMAT_VERSION:
        raise AtlasFileError(
            source,
            f"its format version is {found}; this release reads {FORMAT_VERSION}",
        )
    nothing = Atlas(
        (),
        (),
        np.empty(0),
        (),
        (),
        (),
        (),
        np.empty((0, 0)),
        (),
        Completeness("", "", 1.0),
    )
    model = to_dataset(nothing)
    needed = [str(name) for name in model.variables if name != "joint"]
    needed.append(str(dataset.attrs.get("unknown_dimension", "joint")))
    missing = [name for name in needed if name not in dataset.variables]
    missing += [name for name in model.attrs if name not in dataset.attrs]
    if missing:
        raise AtlasFileError(source, "it lacks " + ", ".join(missing), missing)
