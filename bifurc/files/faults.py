"""What is wrong with the variables of a dataset, before anything is made of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from bifurc.files.table import Column, Frame, Record, Table, count_name

if TYPE_CHECKING:
    import xarray as xr

# The kinds of numpy's types that are read as the type of a column.
READABLE_KINDS = {float: "f", int: "iu", bool: "biu", str: "OTU"}


def missing_variables(
    table: Table[Record], dataset: xr.Dataset, frame: Frame
) -> list[str]:
    """Names of the variables of a table that a dataset lacks."""
    return [name for name in table.names(frame) if name not in dataset.variables]


def table_faults(
    table: Table[Record], dataset: xr.Dataset, frame: Frame
) -> Iterator[str]:
    """What keeps the variables of a table, none of which is missing, from being read.

    Dimensions and types must be those of the columns, counts must add up, and indices
    must be those of something.
    """
    columns = [one for one in table.columns if table.is_filled(one, frame)]
    for column in columns:
        variable = dataset.variables[frame.name(column.name)]
        dimensions = table.dimensions(column, frame)
        if variable.dims != dimensions:
            yield (
                f"{column.name} has the dimensions {variable.dims}; "
                f"they must be {dimensions}"
            )
        elif variable.dtype.kind not in READABLE_KINDS[column.dtype]:
            yield (
                f"{column.name} has values of type {variable.dtype}; "
                f"they must be {column.dtype.__name__}"
            )
        else:
            yield from _size_faults(column, dataset, frame)
            yield from _index_faults(column, dataset, frame)
    padded = {one.entries: one.is_padded for one in columns if one.entries}
    for dimension, is_padded in padded.items():
        yield from _count_faults(table.owner, dimension, is_padded, dataset)


def _size_faults(
    column: Column[Record], dataset: xr.Dataset, frame: Frame
) -> Iterator[str]:
    for name in column.dimensions:
        size = dataset.sizes[frame.name(name)]
        expected = frame.sizes.get(name, size)
        if size != expected:
            yield f"{column.name} has {size} entries along {name} instead of {expected}"


def _index_faults(
    column: Column[Record], dataset: xr.Dataset, frame: Frame
) -> Iterator[str]:
    if not column.index_of:
        return
    count = dataset.sizes.get(frame.name(column.index_of), 0)
    indices = dataset[column.name].values
    if np.any((indices < 0) | (indices >= count)):
        yield f"{column.name} holds an index that none of {count} has"


def _count_faults(
    owner: str, dimension: str, is_padded: bool, dataset: xr.Dataset
) -> Iterator[str]:
    name = count_name(dimension)
    counts = dataset.variables[name]
    if counts.dims != (owner,) or counts.dtype.kind not in READABLE_KINDS[int]:
        yield f"{name} is no count for each {owner}"
        return
    size = dataset.sizes[dimension]
    if np.any(counts.values < 0) or np.any(counts.values > size):
        yield f"{name} holds a number that is not from 0 to {size}"
    elif not is_padded and counts.values.sum() != size:
        yield f"{name} adds up to {counts.values.sum()} instead of {size}"
