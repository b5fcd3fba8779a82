"""An atlas as an `xarray.Dataset` and as a NetCDF file, and back without loss.

`bifurc.files.table` says how lists of different length are stored.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from bifurc.atlas import Atlas, Provenance
from bifurc.checks import check_type
from bifurc.completeness import Claim, Completeness, Doubt, Level, Scope
from bifurc.errors import BifurcError
from bifurc.files.atomic import replace_file
from bifurc.files.json_values import mapping_from_text, to_text
from bifurc.files.layout import TABLES, atlas_frame, dataset_frame, read_atlas
from bifurc.files.netcdf import append_seal, checksum, is_seal_broken, write_netcdf
from bifurc.files.table import Attribute, Frame, Variable, make_variable
from bifurc.release import installed_version
from bifurc.settings import SearchSettings, TraceSettings

if TYPE_CHECKING:
    import xarray as xr

FORMAT = "bifurc atlas"
FORMAT_VERSION = 11
CHECKSUM = "checksum"  # an attribute of files
LINKAGE_UNITS = {"twists": "rad"}

# Attributes of the dataset from which an atlas is read; the others are for the reader.
NEEDED_ATTRIBUTES = (
    "unknown_dimension",
    "filled_dimensions",
    "closure_gap",
    "completeness",
    "provenance",
    "subject",
    "has_diagram",
    "parameter",
)


class AtlasFileError(BifurcError, ValueError):
    """A dataset or file that holds no atlas.

    ``source`` names it, ``missing`` lists the variables and attributes that it lacks.
    """

    def __init__(self, source: str, reason: str, missing: Iterable[str] = ()):
        self.source = source
        self.missing = tuple(missing)
        super().__init__(f"{source}: {reason}")


# --- files ----------------------------------------------------------------------------


def save_atlas(
    atlas: Atlas,
    path: str | os.PathLike[str],
    more: Mapping[str, Variable] = MappingProxyType({}),
) -> Path:
    """The path of the NetCDF file just written; an older file is replaced.

    It holds ``more`` variables for the reader, from which no atlas is read.
    There is never a half-written file under ``path``. Raises `OSError` that names
    ``path`` where it cannot be written.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("bennett"))
    >>> path = bifurc.save_atlas(atlas, "bennett.nc")
    >>> bifurc.load_atlas("bennett.nc").forms[0].name
    'Bennett form'
    """
    check_type("atlas", atlas, Atlas)
    frame = atlas_frame(atlas)
    variables = _variables(atlas, frame)
    attributes = _attributes(atlas, frame, variables)
    twice = sorted(variables.keys() & more.keys())
    if twice:
        raise ValueError(f"more: {', '.join(twice)} are variables of the atlas")
    variables |= {name: one for name, one in more.items() if one.values.size}
    now = datetime.now(UTC).isoformat(timespec="seconds")
    attributes["date_created"] = now
    attributes["history"] = f"{now} written by {attributes['source']}"
    values = {name: variable.values for name, variable in variables.items()}
    attributes[CHECKSUM] = checksum(values, attributes, NEEDED_ATTRIBUTES)

    def write(part: Path) -> None:
        write_netcdf(part, variables, attributes)
        append_seal(part)

    return replace_file(path, write)


def load_atlas(path: str | os.PathLike[str]) -> Atlas:
    """The atlas that `save_atlas` wrote.

    Raises `FileNotFoundError`, and `AtlasFileError` for a file that is damaged, is not
    NetCDF or holds no atlas.

    >>> import bifurc, linkages
    >>> path = bifurc.save_atlas(linkages.map_linkage(linkages.load("kite")), "kite.nc")
    >>> [form.name for form in bifurc.load_atlas("kite.nc").forms]
    ['kite form', 'folded form (joints 1,3 inactive)']
    """
    import xarray as xr

    source = Path(path)
    if not source.exists():
        raise FileNotFoundError(f"{source}: there is no such file")
    if not source.is_file():
        raise AtlasFileError(str(source), "it is a folder or a device, not a file")
    if is_seal_broken(source):
        reason = "its bytes are not those that were written: the file is damaged"
        raise AtlasFileError(str(source), reason)
    try:
        with xr.open_dataset(source, engine="netcdf4", decode_times=False) as file:
            dataset = file.load()
    except Exception as error:  # the libraries raise whatever damage leads them to
        reason = f"it cannot be read as NetCDF ({error})"
        raise AtlasFileError(str(source), reason) from error
    _check_format(dataset, str(source))
    _check_sum(dataset, str(source))
    return _read(dataset, str(source))


def _check_sum(dataset: xr.Dataset, source: str) -> None:
    """Raise `AtlasFileError` where the values are not those for which the checksum was
    written, if one was."""
    expected = dataset.attrs.get(CHECKSUM)
    if expected is None:
        return
    values = {str(name): dataset[name].values for name in dataset.variables}
    found = checksum(values, dataset.attrs, NEEDED_ATTRIBUTES)
    if not np.array_equal(expected, found):
        raise AtlasFileError(
            source,
            "its values are not those that were written: the file is damaged, or was "
            f"edited (delete its attribute {CHECKSUM!r} to read it as it is)",
        )


# --- writing --------------------------------------------------------------------------


def to_dataset(atlas: Atlas) -> xr.Dataset:
    """The atlas as a dataset.

    Its dimensions are ``form``, ``sample``, ``joint`` (``unknown`` where the unknowns
    are not all angles), ``singular_value``, ``piece``, ``power``, ``point`` (singular
    points), ``pass`` and others named after what they count, those that the atlas fills. ``sample`` runs over the
    points at which the singular values were taken, denser where the curve bends more.
    Entries of ``atlas.subject`` become variables along ``joint`` and attributes
    called ``linkage_...``, or after the ``kind`` of the subject.

    >>> import bifurc, linkages
    >>> dataset = bifurc.to_dataset(linkages.map_linkage(linkages.load("bennett")))
    >>> dataset.sizes["form"], dataset.sizes["joint"]
    (1, 4)
    """
    import xarray as xr

    check_type("atlas", atlas, Atlas)
    frame = atlas_frame(atlas)
    no_value_is_missing = {"_FillValue": None}
    variables = _variables(atlas, frame)
    of_xarray = {
        name: xr.Variable(
            variable.dimensions,
            variable.values,
            variable.attributes,
            encoding=no_value_is_missing,
        )
        for name, variable in variables.items()
    }
    return xr.Dataset(of_xarray, attrs=_attributes(atlas, frame, variables))


def _variables(atlas: Atlas, frame: Frame) -> dict[str, Variable]:
    """All variables by their names."""
    variables: dict[str, Variable] = {}
    for table in TABLES.values():
        variables |= table.variables(atlas, frame)
    return variables | _subject_variables(atlas, frame)


def _attributes(
    atlas: Atlas, frame: Frame, variables: Mapping[str, Variable]
) -> dict[str, Attribute]:
    """Attributes of the whole dataset: what it is and where it comes from."""
    release = installed_version()
    filled = {name for one in variables.values() for name in one.dimensions}
    provenance = atlas.provenance
    settings = provenance.settings
    attributes: dict[str, Attribute] = {
        "seed": provenance.seed,
        "starts": settings.starts,
        "budget": settings.budget,
        "interrupted": int(provenance.interrupted),
        "out_of_time": int(provenance.out_of_time),
        "derivatives": provenance.derivatives,
        "equations": provenance.equations,
        "seconds": provenance.seconds,
    }
    for name, value in asdict(settings.tracing).items():
        attributes[f"settings_{name}"] = value
    return attributes | {
        "title": "Transition map: forms, singular points and what connects them",
        "Conventions": "CF-1.11",
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "source": f"bifurc {release}",
        "version": release,
        "unknown_dimension": frame.joint,
        "filled_dimensions": " ".join(sorted(filled)),
        "closure_gap": float(atlas.closure_gap),
        "completeness_level": atlas.completeness.level.value,
        "completeness_statement": atlas.completeness.statement,
        "missed_probability": float(atlas.completeness.missed_probability),
        "completeness": to_text(_completeness_values(atlas.completeness)),
        "provenance": to_text(asdict(provenance)),
        "subject": to_text(dict(atlas.subject)),
        **_subject_attributes(atlas),
        "has_diagram": int(atlas.diagram is not None),
        "parameter": atlas.diagram.parameter if atlas.diagram else "",
    }


def _subject_attributes(atlas: Atlas) -> dict[str, Attribute]:
    """What the subject says in one word or number."""
    kind = _kind_of_subject(atlas)
    return {
        f"{kind}_{key}": value
        for key, value in atlas.subject.items()
        if isinstance(value, str | int | float)
    }


def _kind_of_subject(atlas: Atlas) -> str:
    """What was mapped, in a word: a linkage where nothing is said."""
    return str(atlas.subject.get("kind", "linkage"))


def _subject_variables(atlas: Atlas, frame: Frame) -> dict[str, Variable]:
    """What the subject says with one number for each unknown."""
    variables = {}
    kind = _kind_of_subject(atlas)
    for key, value in atlas.subject.items():
        if np.shape(value) == (len(atlas.names),):
            variables[f"{kind}_{key}"] = make_variable(
                (frame.joint,),
                np.array(value, dtype=float),
                f"{key} of the {kind}",
                LINKAGE_UNITS.get(key, ""),
            )
    return variables


# --- reading --------------------------------------------------------------------------


def from_dataset(dataset: xr.Dataset) -> Atlas:
    """The atlas that `to_dataset` stored; raises `AtlasFileError` that says what is
    missing or wrong.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("bennett"))
    >>> bifurc.from_dataset(bifurc.to_dataset(atlas)).forms[0].name
    'Bennett form'
    """
    import xarray as xr

    check_type("dataset", dataset, xr.Dataset)
    _check_format(dataset, "dataset")
    return _read(dataset, "dataset")


def _read(dataset: xr.Dataset, source: str) -> Atlas:
    frame = dataset_frame(dataset)
    _check_content(dataset, frame, source)
    try:
        return read_atlas(
            dataset,
            frame,
            completeness=_read_completeness(str(dataset.attrs["completeness"])),
            closure_gap=float(dataset.attrs["closure_gap"]),
            provenance=_read_provenance(str(dataset.attrs["provenance"])),
            subject=mapping_from_text(str(dataset.attrs["subject"])),
        )
    except (ValueError, TypeError, KeyError) as error:
        reason = f"what it holds does not fit together ({error})"
        raise AtlasFileError(source, reason) from error


def _check_format(dataset: xr.Dataset, source: str) -> None:
    """Raise `AtlasFileError` unless the dataset is an atlas in the format of this
    release."""
    kind = dataset.attrs.get("format")
    if not isinstance(kind, str) or kind != FORMAT:
        reason = f"its attribute 'format' is {kind!r}; it must be {FORMAT!r}"
        raise AtlasFileError(source, reason, ["format"])
    number = dataset.attrs.get("format_version", 0)
    if not np.array_equal(number, FORMAT_VERSION):
        reason = f"its format version is {number}; this release reads {FORMAT_VERSION}"
        raise AtlasFileError(source, reason)


def _check_content(dataset: xr.Dataset, frame: Frame, source: str) -> None:
    """Raise `AtlasFileError` unless the dataset has everything that an atlas needs, in
    variables that can be read."""
    tables = TABLES.values()
    missing = [name for table in tables for name in table.missing(dataset, frame)]
    missing += [name for name in NEEDED_ATTRIBUTES if name not in dataset.attrs]
    if missing:
        raise AtlasFileError(source, "it lacks " + ", ".join(missing), missing)
    for table in tables:
        for fault in table.faults(dataset, frame):
            raise AtlasFileError(source, fault)
        for column in table.columns:
            name = frame.name(column.name)
            if name in dataset.variables and not table.is_filled(column, frame):
                reason = f"its attribute 'filled_dimensions' leaves out those of {name}"
                raise AtlasFileError(source, reason, ["filled_dimensions"])


def _completeness_values(completeness: Completeness) -> dict[str, Any]:
    """Claims and doubts in plain values."""
    values = asdict(completeness)
    for claim in values["claims"]:
        claim["scope"] = claim["scope"].value
        claim["level"] = None if claim["level"] is None else claim["level"].value
    return values


def _read_completeness(text: str) -> Completeness:
    values = mapping_from_text(text)
    claims = []
    for claim in values["claims"]:
        level = None if claim["level"] is None else Level(claim["level"])
        claims.append(
            Claim(**{**claim, "scope": Scope(claim["scope"]), "level": level})
        )
    doubts = tuple(
        Doubt(**{**doubt, "forms": tuple(doubt.get("forms", ()))})
        for doubt in values["doubts"]
    )
    missed = float(values["missed_probability"])
    return Completeness(tuple(claims), doubts, missed)


def _read_provenance(text: str) -> Provenance:
    values = mapping_from_text(text)
    settings = dict(values.pop("settings"))
    if "prove" in settings:  # what it was called in older files
        settings["count"] = settings.pop("prove")
    tracing = TraceSettings(**dict(settings.pop("tracing")))
    return Provenance(**values, settings=SearchSettings(**settings, tracing=tracing))
