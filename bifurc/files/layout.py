"""The variables of a dataset: tables of all that an atlas lists."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.files.diagram_layout import BRANCHINGS, DIAGRAM_POINTS, REMARKS, STRETCHES
from bifurc.files.form_layout import FORMS
from bifurc.files.near_motion_layout import NEAR_MOTIONS
from bifurc.files.point_layout import DEAD_POINTS, NEAR_MISSES, POINTS
from bifurc.files.surface_layout import SURFACES
from bifurc.files.table import JOINT, UNIT, Column, Frame, Table

if TYPE_CHECKING:
    import xarray as xr


class Unknown(NamedTuple):
    """One unknown of the problem."""

    name: str
    unit: str
    period: float


def _unknowns(atlas: Atlas) -> list[Unknown]:
    columns = zip(atlas.names, atlas.units, atlas.periods, strict=True)
    return [Unknown(name, unit, float(period)) for name, unit, period in columns]


UNKNOWNS: Table[Unknown] = Table(
    JOINT,
    _unknowns,
    (
        Column(JOINT, lambda u: u.name, "name of the unknown", dtype=str),
        Column(
            "period", lambda u: u.period, "period of the unknown, inf for none", UNIT
        ),
        Column("unit", lambda u: u.unit, "unit of the unknown", dtype=str),
    ),
)

ASSEMBLIES: Table[np.ndarray] = Table(
    "assembly",
    lambda atlas: list(atlas.rigid),
    (
        Column(
            "rigid_assembly",
            lambda u: u,
            "isolated solution",
            UNIT,
            dimensions=(JOINT,),
        ),
    ),
)

TABLES: tuple[Table[Any], ...] = (
    UNKNOWNS,
    FORMS,
    POINTS,
    NEAR_MISSES,
    DEAD_POINTS,
    ASSEMBLIES,
    NEAR_MOTIONS,
    SURFACES,
    DIAGRAM_POINTS,
    STRETCHES,
    BRANCHINGS,
    REMARKS,
)


def atlas_frame(atlas: Atlas) -> Frame:
    """How the dimensions of an atlas are called, their sizes, and the shared unit ("1"
    where there is none)."""
    angles = all(unit == "rad" for unit in atlas.units)
    shared = len(set(atlas.units)) == 1 and atlas.units[0] != ""
    orders = [form.branch.pieces.shape[1] for form in atlas.forms]
    return Frame(
        joint=JOINT if angles else "unknown",
        unit=atlas.units[0] if shared else "1",
        sizes=_sizes(len(atlas.names)) | {"power": max(orders, default=1)},
    )


def dataset_frame(dataset: xr.Dataset) -> Frame:
    """The same of a dataset that is read, but for the unit."""
    joint = str(dataset.attrs.get("unknown_dimension", JOINT))
    filled = frozenset(str(dataset.attrs.get("filled_dimensions", "")).split())
    sizes = _sizes(dataset.sizes.get(joint, 0))
    sizes |= {"power": dataset.sizes.get("power", 1)}
    return Frame(joint, "", sizes, filled)


def _sizes(n: int) -> dict[str, int]:
    """Sizes of the dimensions that single values have, with ``n`` unknowns."""
    return {JOINT: n, "singular_value": n, "axis": 2, "end": 2}
