"""The tables of a dataset, as ``variables.csv`` lists their columns, and the records that
their rows hold."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from enum import Enum
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, NearMotion, Surface
from bifurc.branch import Branch, Outcome
from bifurc.curves.certificate import Certificate, CertificateValues
from bifurc.curves.monitor import Profile
from bifurc.diagrams.diagram import (
    Branching,
    Diagram,
    DiagramPoint,
    Stability,
    Stretch,
)
from bifurc.files.json_values import from_text, mapping_from_text, to_text
from bifurc.files.table import JOINT, NOT_KNOWN, Column, Frame, Row, Table
from bifurc.singular.point import Invariants, Kind, SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.factor import Factor

if TYPE_CHECKING:
    import xarray as xr

NOTHING = Diagram("", (), (), ())

TYPES: dict[str, type] = {"float": float, "int": int, "bool": bool, "str": str}
for _enum in (Outcome, Kind, Stability):
    TYPES[_enum.__name__] = _enum


class Unknown(NamedTuple):
    """One unknown of the problem."""

    name: str
    unit: str
    period: float


def _unknowns(atlas: Atlas) -> list[Unknown]:
    columns = zip(atlas.names, atlas.units, atlas.periods, strict=True)
    return [Unknown(name, unit, float(period)) for name, unit, period in columns]


def _diagram(atlas: Atlas) -> Diagram:
    return atlas.diagram or NOTHING


# What an atlas has of each table.
RECORDS: dict[str, Callable[[Atlas], Sequence[Any]]] = {
    JOINT: _unknowns,
    "form": lambda atlas: atlas.forms,
    "point": lambda atlas: atlas.points,
    "near_miss": lambda atlas: atlas.near_misses,
    "dead_point": lambda atlas: atlas.dead_points,
    "assembly": lambda atlas: list(atlas.rigid),
    "near_motion": lambda atlas: atlas.near_motions,
    "surface": lambda atlas: atlas.surfaces,
    "diagram_point": lambda atlas: _diagram(atlas).points,
    "stretch": lambda atlas: _diagram(atlas).stretches,
    "branching": lambda atlas: _diagram(atlas).branchings,
    "diagram_remark": lambda atlas: _diagram(atlas).remarks,
}


def samples_of(form: Form) -> np.ndarray:
    """Points (k, n) at which the singular values were taken."""
    if not len(form.branch.pieces):
        return np.empty((0, form.branch.n))
    return form.branch(form.profile.arclength.ravel())


def _covering_name(surface: Surface) -> str:
    return "" if surface.charts is None else surface.charts.outcome.name


def _factors_text(surface: Surface) -> str:
    factors = [factor._asdict() for factor in surface.factors]
    return to_text(factors) if factors else ""


def _outcome_name(near: NearMotion) -> str:
    return "" if near.branch is None else near.branch.outcome.name


def _order_of(branch: Branch | None) -> int:
    """The degree of the pieces of a branch."""
    return -1 if branch is None else branch.pieces.shape[1] - 1


def _certificate_text(form: Form) -> str:
    return "" if form.certificate is None else to_text(form.certificate.as_values())


# What a record has in the variables that are no attribute of it as they stand.
VALUES: dict[str, Callable[[Any], Any]] = {
    "arclength": lambda form: form.profile.arclength.ravel(),
    "configuration": samples_of,
    "singular_values": lambda form: form.profile.values.reshape(-1, form.branch.n),
    "sample_nodes": lambda form: form.profile.arclength.shape[1],
    "piece_order": lambda form: _order_of(form.branch),
    "near_motion_outcome": _outcome_name,
    "near_motion_order": lambda near: _order_of(near.branch),
    "labels": lambda form: to_text(dict(form.labels)),
    "certificate": _certificate_text,
    "pass_form": lambda point: [form for form, _ in point.passes],
    "pass_arclength": lambda point: [s for _, s in point.passes],
    "null_vector": lambda point: point.point.null_space.T,
    "covering": _covering_name,
    "surface_factors": _factors_text,
    "rigid_assembly": lambda assembly: assembly,
    "diagram_remark": lambda remark: remark,
}


def _read_tables() -> dict[str, Table]:
    """The tables by their owners."""
    columns: dict[str, list[Column]] = {owner: [] for owner in RECORDS}
    text = files("bifurc.files").joinpath("variables.csv").read_text(encoding="utf-8")
    for line in csv.DictReader(text.splitlines()):
        owner, name = line.pop("table"), line.pop("variable")
        column = Column(
            name,
            kind=TYPES[line.pop("type")],
            dimensions=tuple(line.pop("dimensions").split()),
            value=None if line["attribute"] else VALUES[name],
            **line,
        )
        columns[owner].append(column)
    return {
        owner: Table(owner, records, tuple(columns[owner]))
        for owner, records in RECORDS.items()
    }


TABLES = _read_tables()

# --- JSON -----------------------------------------------------------------------------


def records_of(atlas: Atlas, owner: str) -> list[dict[str, Any]]:
    """What an atlas has of a table, as values of JSON by their keys."""
    columns = [column for column in TABLES[owner].columns if column.key]
    return [
        {column.key: _json_value(atlas, column, record) for column in columns}
        for record in RECORDS[owner](atlas)
    ]


def _json_value(atlas: Atlas, column: Column, record: object) -> Any:
    """Unknowns by their names, what an index is of by its name; None for what is not
    known or infinite."""
    value = column.taken(record)
    if column.index_of:
        return RECORDS[column.index_of](atlas)[value].name
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.ndarray):
        numbers = value.tolist()
        if column.kind is float and column.dimensions == (JOINT,):
            return dict(zip(atlas.names, numbers, strict=True))
        return numbers
    nothing = NOT_KNOWN if column.kind is int else np.inf
    return None if value == nothing else value


# --- frames ---------------------------------------------------------------------------


def atlas_frame(atlas: Atlas) -> Frame:
    """How the dimensions of an atlas are called, their sizes, and the shared unit ("1"
    where there is none)."""
    angles = all(unit == "rad" for unit in atlas.units)
    shared = len(set(atlas.units)) == 1 and atlas.units[0] != ""
    branches = [form.branch for form in atlas.forms]
    orders = map(_order_of, [*branches, *(near.branch for near in atlas.near_motions)])
    return Frame(
        joint=JOINT if angles else "unknown",
        unit=atlas.units[0] if shared else "1",
        sizes=_sizes(len(atlas.names))
        | {"power": max(orders, default=0) + 1, "axis": _most_axes(atlas.surfaces)},
    )


def dataset_frame(dataset: xr.Dataset) -> Frame:
    """The same of a dataset that is read, but for the unit."""
    joint = str(dataset.attrs.get("unknown_dimension", JOINT))
    filled = frozenset(str(dataset.attrs.get("filled_dimensions", "")).split())
    sizes = _sizes(dataset.sizes.get(joint, 0))
    sizes |= {name: dataset.sizes.get(name, sizes[name]) for name in ("power", "axis")}
    return Frame(joint, "", sizes, filled)


def _sizes(n: int) -> dict[str, int]:
    """Sizes of the dimensions that single values have, with ``n`` unknowns."""
    return {JOINT: n, "singular_value": n, "power": 1, "axis": 2, "end": 2}


def _most_axes(surfaces: Sequence[Surface]) -> int:
    """The largest dimension of a chart."""
    charts = (surface.charts for surface in surfaces)
    return max((one.dimension for one in charts if one is not None), default=2)


# --- reading --------------------------------------------------------------------------


def read_atlas(dataset: xr.Dataset, frame: Frame, **others: Any) -> Atlas:
    """The atlas of a dataset whose variables fit the tables, with ``others`` of its
    attributes.

    Raises `ValueError`, `TypeError` or `KeyError` where values do not fit together.
    """
    rows = {owner: table.rows(dataset, frame) for owner, table in TABLES.items()}
    unknowns = rows[JOINT]
    periods = dataset["period"].values
    rigid = [row["rigid_assembly"] for row in rows["assembly"]]
    return Atlas(
        names=tuple(row[JOINT] for row in unknowns),
        units=tuple(row["unit"] for row in unknowns),
        periods=periods,
        forms=tuple(_form(row, periods) for row in rows["form"]),
        points=tuple(map(_point, rows["point"])),
        near_misses=_records(Event, rows, "near_miss"),
        dead_points=_records(Event, rows, "dead_point"),
        rigid=np.array(rigid).reshape(-1, frame.sizes[JOINT]),
        surfaces=tuple(_surface(row, periods) for row in rows["surface"]),
        near_motions=tuple(_near_motion(row, periods) for row in rows["near_motion"]),
        diagram=_read_diagram(dataset, rows),
        **others,
    )


def _records(cls: type, rows: dict[str, list[Row]], owner: str) -> tuple[Any, ...]:
    """The records of a table whose columns are all that they have."""
    return tuple(TABLES[owner].make(cls, row) for row in rows[owner])


def _read_diagram(dataset: xr.Dataset, rows: dict[str, list[Row]]) -> Diagram | None:
    if not int(dataset.attrs["has_diagram"]):
        return None
    return Diagram(
        parameter=str(dataset.attrs["parameter"]),
        points=_records(DiagramPoint, rows, "diagram_point"),
        stretches=_records(Stretch, rows, "stretch"),
        branchings=_records(Branching, rows, "branching"),
        remarks=tuple(row["diagram_remark"] for row in rows["diagram_remark"]),
    )


def _near_motion(row: Row, periods: np.ndarray) -> NearMotion:
    """A near motion of unknowns with ``periods`` (n,)."""
    make = TABLES["near_motion"].make
    branch = None
    if row["near_motion_outcome"]:
        outcome = Outcome[row["near_motion_outcome"]]
        pieces = row["near_motion_coefficient"][:, : row["near_motion_order"] + 1]
        others = {"pieces": pieces, "periods": periods, "outcome": outcome}
        branch = make(Branch, row, "branch", **others)
    return make(NearMotion, row, branch=branch)


def _form(row: Row, periods: np.ndarray) -> Form:
    """A form of unknowns with ``periods`` (n,)."""
    make = TABLES["form"].make
    pieces = row["coefficient"][:, : row["piece_order"] + 1]
    branch = make(Branch, row, "branch", pieces=pieces, periods=periods)
    nodes = row["sample_nodes"]
    arclength = row["arclength"].reshape(-1, nodes)
    values = row["singular_values"].reshape(-1, nodes, branch.n)
    return make(
        Form,
        row,
        branch=branch,
        profile=Profile(arclength, values, row["rank"]),
        certificate=_read_certificate(row["certificate"]),
        labels=mapping_from_text(row["labels"]),
    )


def _read_certificate(text: str) -> Certificate | None:
    if not text:
        return None
    return Certificate.from_values(cast(CertificateValues, mapping_from_text(text)))


def _point(row: Row) -> MeetingPoint:
    make = TABLES["point"].make
    invariants = None
    if row["point_delta"] >= 0:
        contacts = tuple(row["contact"].tolist())
        invariants = make(Invariants, row, "point.invariants", contacts=contacts)
    null_space = row["null_vector"].T
    point = make(
        SingularPoint, row, "point", null_space=null_space, invariants=invariants
    )
    forms, arclengths = row["pass_form"].tolist(), row["pass_arclength"].tolist()
    passes = tuple(zip(forms, arclengths, strict=True))
    surfaces = tuple(row["met_surface"].tolist())
    return make(MeetingPoint, row, point=point, passes=passes, surfaces=surfaces)


def _surface(row: Row, periods: np.ndarray) -> Surface:
    """A surface of unknowns with ``periods`` (n,)."""
    make = TABLES["surface"].make
    charts = None
    if row["covering"]:
        _check_charts(row)
        outcome = Covering[row["covering"]]
        bases = row["chart_basis"][:, :, : row["surface_dimension"]]
        charts = make(
            ChartAtlas, row, "charts", bases=bases, periods=periods, outcome=outcome
        )
    return make(Surface, row, charts=charts, factors=_factors(row["surface_factors"]))


def _factors(text: str) -> tuple[Factor, ...]:
    """What a surface is the product of, from `_factors_text`."""
    factors = cast(list[dict[str, Any]], from_text(text)) if text else []
    return tuple(Factor(**values) for values in factors)


def _check_charts(row: Row) -> None:
    """Raise `ValueError` where an index is that of no chart or no vertex."""
    sizes, corners = row["polygon_size"], row["polygon_corner"]
    _check_indices("chart_pair", row["chart_pair"], len(row["chart_center"]))
    _check_indices("polygon_corner", corners, len(row["chart_vertex"]))
    if np.any(sizes < 0) or sizes.sum() != len(corners):
        raise ValueError(f"polygon_size does not add up to {len(corners)} corners")


def _check_indices(name: str, indices: np.ndarray, count: int) -> None:
    if np.any((indices < 0) | (indices >= count)):
        raise ValueError(f"{name} holds an index that none of {count} has")
