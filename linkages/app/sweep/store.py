"""The dataset of a sweep: zarr arrays over the parameter grid, written block by
block."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkages.app.sweep.member import FIELDS, Status
from linkages.app.sweep.plan import Block, Plan
from linkages.catalogue import entry

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SweepStore", "count_status", "open_sweep"]


def open_sweep(path: Path | str) -> xr.Dataset:
    """The dataset of a sweep: one variable for each of `FIELDS`, over the varied
    parameters (rad) or the members."""
    import xarray as xr

    return xr.open_zarr(path, consolidated=False, chunks=None, mask_and_scale=False)


class SweepStore:
    """Zarr arrays for the summaries of all members of a plan; values not yet written
    are missing."""

    def __init__(self, path: Path, plan: Plan):
        import zarr

        self.plan = plan
        self.joints = entry(plan.family).build().n
        self._group: Any = zarr.open_group(path, mode="a")
        if "status" not in self._group:
            self._create()

    def _create(self) -> None:
        plan, group = self.plan, self._group
        kinds = {p.name: p.kind for p in entry(plan.family).parameters}
        group.attrs.update(
            {
                "family": plan.family,
                "starts": plan.starts,
                "seed": plan.seed,
                "fixed": dict(plan.fixed),
            }
        )
        for name, values in plan.axes.items():
            self._array(
                name, np.array(values), (name,), "rad" if kinds[name] == "angle" else ""
            )
        for name in plan.ranges:
            self._array(
                name,
                None,
                ("member",),
                "rad" if kinds[name] == "angle" else "",
                np.nan,
                "f8",
            )
        self._array("joint", np.arange(1, self.joints + 1), ("joint",), "")
        for name, kind in FIELDS.items():
            dims = (*plan.dims, "joint") if kind.per_joint else plan.dims
            array = self._array(name, None, dims, kind.unit, kind.missing, kind.dtype)
            array.attrs["long_name"] = kind.meaning

    def _array(
        self,
        name: str,
        values: np.ndarray | None,
        dims: tuple[str, ...],
        unit: str,
        missing: float = 0,
        dtype: str = "f8",
    ) -> Any:
        """A new array: ``values`` whole, or missing values in chunks of a block."""
        plan = self.plan
        if values is not None:
            array = self._group.create_array(
                name, shape=values.shape, dtype=values.dtype, dimension_names=dims
            )
            array[:] = values
        else:
            joint = (self.joints,) if dims[-1] == "joint" else ()
            array = self._group.create_array(
                name,
                shape=(*plan.shape, *joint),
                chunks=(*plan.chunk, *joint),
                dtype=dtype,
                fill_value=missing,
                dimension_names=dims,
            )
        if unit:
            array.attrs["units"] = unit
        return array

    def write(self, block: Block, records: Mapping[int, Mapping[str, Any]]) -> None:
        """Write the summaries of all members of a block, by index."""
        shape = tuple(s.stop - s.start for s in block.region)
        for name, kind in FIELDS.items():
            missing: Any = (
                [kind.missing] * self.joints if kind.per_joint else kind.missing
            )
            column = [records[i].get(name, missing) for i in block.indices.tolist()]
            values = np.array(column, dtype=kind.dtype)
            self._group[name][block.region] = values.reshape(*shape, *values.shape[1:])
        for name in self.plan.ranges:
            drawn = [self.plan.parameters(i)[name] for i in block.indices.tolist()]
            self._group[name][block.region] = np.array(drawn)


def count_status(path: Path | str) -> dict[str, int]:
    """How many members have each status that occurs."""
    status, counts = np.unique(open_sweep(path)["status"].values, return_counts=True)
    return {Status(int(s)).name: int(c) for s, c in zip(status, counts, strict=True)}
