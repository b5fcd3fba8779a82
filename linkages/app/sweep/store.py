"""The dataset of a sweep: zarr arrays over the parameter grid, written block by
block."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bifurc.errors import PathError
from linkages.app.sweep.member import FIELDS, Field, Record, Status
from linkages.app.sweep.plan import Block, Plan
from linkages.app.sweep.subjects import JointName, Quantity

if TYPE_CHECKING:
    import xarray as xr
    import zarr


MADE_AGAIN = (
    "delete it, and the same command makes it again from the journal, without mapping"
)


class StoreError(PathError):
    """A place where the dataset of a sweep cannot be written: ``path`` and why."""


UNSETTLED = "is_being_made"  # an attribute while blocks of the journal may be missing


def open_sweep(path: Path | str) -> xr.Dataset:
    """The dataset of a sweep: one variable for each of `FIELDS`, over the varied
    quantities (rad for angles) or the members."""
    import xarray as xr

    dataset: xr.Dataset = xr.open_zarr(
        path, consolidated=False, chunks=None, mask_and_scale=False
    )
    return dataset


def count_status(path: Path | str) -> dict[str, int]:
    """How many members have each status that occurs; raises `StoreError` where the
    dataset is damaged."""
    try:
        statuses = open_sweep(path)["status"].values
        numbers, counts = np.unique(statuses, return_counts=True)
        names = [Status(number).name for number in numbers.tolist()]
    # zarr raises these for files that are not what they were
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise StoreError(Path(path), f"it is damaged ({error}); {MADE_AGAIN}") from None
    return dict(zip(names, counts.tolist(), strict=True))


def require_room(path: Path, plan: Plan) -> None:
    """Raise `StoreError` unless ``path`` is free, or holds the dataset of this plan."""
    import zarr

    if not path.exists() or (path.is_dir() and not any(path.iterdir())):
        return
    try:
        attributes = zarr.open_group(path, mode="r").attrs.asdict()
    except (OSError, ValueError, KeyError):
        raise StoreError(
            path, "it is not the dataset of a sweep; choose another --out"
        ) from None
    if attributes.get("plan") != _text(plan):
        why = "it belongs to another sweep; choose another --out or delete it"
        raise StoreError(path, why)


def _text(plan: Plan) -> str:
    """A plan as text, by which a dataset knows it again."""
    return json.dumps(plan.as_dict())


def _fields_without_joints() -> dict[str, Field]:
    """The variables of equations, whose lengths have the units of their unknowns; an
    array over no joints there cannot be."""
    return {
        name: replace(field, unit="" if field.unit == "rad" else field.unit)
        for name, field in FIELDS.items()
        if not field.per_joint
    }


class SweepStore:
    """Zarr arrays for the summaries of all members of a plan; values not yet written
    are missing.

    It ``is_new`` where arrays were missing, and all were made anew; it stays so,
    whatever interrupts who writes it, until `settle` says that all is in it which the
    journal says.
    """

    def __init__(self, path: Path, plan: Plan):
        import zarr

        self.plan = plan
        self.joints = len(plan.subject.joints)
        self.fields = FIELDS if self.joints else _fields_without_joints()
        # what is consolidated is of the arrays that were there before
        self._group: zarr.Group = zarr.open_group(
            path, mode="a", use_consolidated=False
        )
        is_whole = all(name in self._group for name in self.fields)
        self.is_new = not is_whole or UNSETTLED in self._group.attrs
        if self.is_new:
            self._create()

    def settle(self) -> None:
        """Say that every block that the journal tells of is in the dataset."""
        if UNSETTLED in self._group.attrs:
            del self._group.attrs[UNSETTLED]
            self._consolidate()

    def write(self, block: Block, records: Mapping[int, Record]) -> None:
        """Write the summaries of all members of a block, by index."""
        indices = block.indices.tolist()
        shape = tuple(along.stop - along.start for along in block.region)
        for name, kind in self.fields.items():
            missing = [kind.missing] * self.joints if kind.per_joint else kind.missing
            column = [records[index].get(name, missing) for index in indices]
            values = np.array(column, dtype=kind.dtype)
            self._array(name)[block.region] = values.reshape(*shape, *values.shape[1:])
        for name in self.plan.ranges:
            drawn = [self.plan.values(index)[name] for index in indices]
            self._array(name)[block.region] = np.array(drawn)

    def _array(self, name: str) -> zarr.Array[Any]:
        import zarr

        array = self._group[name]
        assert isinstance(array, zarr.Array)
        return array

    def _create(self) -> None:
        """Make all arrays; what an earlier attempt left half-made is replaced."""
        plan = self.plan
        attributes: dict[str, Any] = {
            **plan.subject.identity,
            "starts": plan.starts,
            "seed": plan.seed,
            "fixed": dict(plan.fixed),
            "plan": _text(plan),
            UNSETTLED: True,
        }
        self._group.attrs.update(attributes)
        for name, values in plan.axes.items():
            self._create_axis(plan.subject.quantity(name), values)
        if self.joints:
            self._create_joints(plan.subject.joints)
        for name in plan.ranges:
            quantity = plan.subject.quantity(name)
            field = Field("f8", quantity.unit, quantity.meaning)
            self._create_field(name, field)
        for name, kind in self.fields.items():
            self._create_field(name, kind)
        self._consolidate()

    def _consolidate(self) -> None:
        """Repeat the metadata of all arrays, which stay as they are, in one place:
        xarray looks there first."""
        import zarr

        with warnings.catch_warnings():
            # version 3 of the format names no such place; all readers know it
            warnings.filterwarnings("ignore", "Consolidated metadata")
            zarr.consolidate_metadata(self._group.store)

    def _create_axis(self, quantity: Quantity, values: Sequence[float]) -> None:
        """The values of a quantity along its dimension."""
        array = self._create_coordinates(quantity.name, values, "f8")
        array.attrs["long_name"] = quantity.meaning
        if quantity.unit:
            array.attrs["units"] = quantity.unit

    def _create_joints(self, joints: Sequence[JointName]) -> None:
        """The names or the numbers of the joints along their dimension."""
        are_names = any(isinstance(joint, str) for joint in joints)
        self._create_coordinates("joint", joints, "str" if are_names else "i8")

    def _create_coordinates(
        self, name: str, values: Sequence[JointName | float], dtype: str
    ) -> zarr.Array[Any]:
        """The array of the coordinates along one dimension."""
        array = self._group.create_array(
            name,
            shape=(len(values),),
            dtype=dtype,
            dimension_names=(name,),
            overwrite=True,
        )
        array[:] = np.array(values)
        return array

    def _create_field(self, name: str, kind: Field) -> None:
        """An array over all members, in chunks of a block, with missing values."""
        plan = self.plan
        shape, chunk, dims = plan.shape, plan.chunk, plan.dims
        if kind.per_joint:
            shape = (*shape, self.joints)
            chunk = (*chunk, self.joints)
            dims = (*dims, "joint")
        array = self._group.create_array(
            name,
            shape=shape,
            chunks=chunk,
            dtype=kind.dtype,
            fill_value=kind.missing,
            dimension_names=dims,
            overwrite=True,
        )
        array.attrs["long_name"] = kind.meaning
        if kind.unit:
            array.attrs["units"] = kind.unit
