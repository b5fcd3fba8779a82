"""Tables of a dataset: which variables hold the records of one kind, to write and to
read them.

A table has a row for each record and a column for each variable. Where a record has
several values in a column, those of all records are joined, one behind the other (CF:
contiguous ragged array), or padded with NaN. How many values each record has stands in
the variable ``..._count``; its attribute ``sample_dimension`` names what it counts.
A dataset has the variables that its atlas fills: a table without records, and a column
without a single value, are left out of it, and read as empty.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from bifurc.atlas import Atlas
from bifurc.files.variable import Variable

if TYPE_CHECKING:
    import xarray as xr

Record = TypeVar("Record")
Row = Mapping[str, np.ndarray]  # what a record has in each column, by its name

# What differs from atlas to atlas, as it is called in a column; see `Frame`.
JOINT = "joint"
UNIT = "unit of the unknowns"


@dataclass(frozen=True)
class Frame:
    """What all variables of one dataset share.

    ``joint`` is the name of the dimension of the unknowns, ``unit`` the unit that all
    of them have. ``sizes`` are those of the dimensions of single values, ``filled`` the
    dimensions of a dataset that is read.
    """

    joint: str
    unit: str
    sizes: Mapping[str, int]
    filled: frozenset[str] = frozenset()

    def name(self, name: str) -> str:
        """What a variable or dimension is called in this dataset."""
        return self.joint if name == JOINT else name


@dataclass(frozen=True)
class Column(Generic[Record]):
    """One variable. ``take`` gives what a record has in it.

    ``dimensions`` are those of a single value. With ``entries`` a record has any number
    of values, counted by that dimension; they are joined, or ``is_padded``.
    ``index_of`` names the dimension of which the values are indices.
    """

    name: str
    take: Callable[[Record], ArrayLike]
    long_name: str
    units: str = ""
    dtype: type = float
    dimensions: tuple[str, ...] = ()
    entries: str = ""
    is_padded: bool = False
    index_of: str = ""

    def cell(self, record: Record, frame: Frame) -> np.ndarray:
        """What a record has: of the shape of a value, or (count, shape of a value).

        A value that is smaller than its dimensions is filled up with 0.
        """
        shape = self._shape(frame)
        value: np.ndarray = np.asarray(self.take(record), dtype=self.dtype)
        if not self.entries:
            return value.reshape(shape)
        if not value.size:
            return np.empty((len(value), *shape), dtype=self.dtype)
        padding = np.subtract(shape, value.shape[1:])
        return np.pad(value, [(0, 0), *((0, int(width)) for width in padding)])

    def join(self, cells: Sequence[np.ndarray], frame: Frame) -> np.ndarray:
        """The values of the variable from what each record has."""
        shape = self._shape(frame)
        if self.is_padded:
            longest = max((len(cell) for cell in cells), default=0)
            out = np.full((len(cells), longest, *shape), np.nan)
            for row, cell in zip(out, cells, strict=True):
                row[: len(cell)] = cell
            return out
        if self.entries:
            return np.concatenate([self.no_values(frame), *cells])
        return np.array(cells, dtype=self.dtype).reshape(len(cells), *shape)

    def split(self, values: np.ndarray, counts: np.ndarray) -> list[np.ndarray]:
        """What each record has, from the ``values`` of the variable; reverses `join`.

        ``counts`` are the numbers of values of the records; not used where each record
        has one.
        """
        if self.dtype is not str:
            values = values.astype(self.dtype, copy=False)
        if self.is_padded:
            return [row[:count] for row, count in zip(values, counts, strict=True)]
        if self.entries:
            return np.split(values, np.cumsum(counts))[: len(counts)]
        return list(values)

    def no_values(self, frame: Frame) -> np.ndarray:
        """What a record without a single value has."""
        return np.empty((0, *self._shape(frame)), dtype=self.dtype)

    def _shape(self, frame: Frame) -> tuple[int, ...]:
        """Shape of a single value."""
        return tuple(frame.sizes[name] for name in self.dimensions)


@dataclass(frozen=True)
class Table(Generic[Record]):
    """The variables of the records of one kind, which the dimension ``owner`` counts.

    ``records`` takes them from an atlas.
    """

    owner: str
    records: Callable[[Atlas], Sequence[Record]]
    columns: tuple[Column[Record], ...]

    def is_filled(self, column: Column[Record], frame: Frame) -> bool:
        """Whether a dataset that is read has the variable of a column."""
        counting = column.entries or self.owner
        return {frame.name(self.owner), frame.name(counting)} <= frame.filled

    def names(self, frame: Frame) -> list[str]:
        """Names of all variables that a dataset has which is read."""
        columns = [column for column in self.columns if self.is_filled(column, frame)]
        counts = [count_name(column.entries) for column in columns if column.entries]
        names = [frame.name(column.name) for column in columns]
        return names + list(dict.fromkeys(counts))

    def dimensions(self, column: Column[Record], frame: Frame) -> tuple[str, ...]:
        """Dimensions of the variable of a column."""
        names = [self.owner, *column.dimensions]
        if column.is_padded:
            names = [self.owner, column.entries, *column.dimensions]
        elif column.entries:
            names = [column.entries, *column.dimensions]
        return tuple(frame.name(name) for name in names)

    def variables(self, atlas: Atlas, frame: Frame) -> dict[str, Variable]:
        """The variables of an atlas by their names, but for those without values."""
        records = self.records(atlas)
        variables: dict[str, Variable] = {}
        if not len(records):
            return variables
        for column in self.columns:
            cells = [column.cell(record, frame) for record in records]
            if column.entries and not any(map(len, cells)):
                continue
            units = frame.unit if column.units == UNIT else column.units
            variables[frame.name(column.name)] = make_variable(
                self.dimensions(column, frame),
                column.join(cells, frame),
                column.long_name,
                units,
            )
            if column.entries:
                counts = np.array([len(cell) for cell in cells], dtype=int)
                attributes = {
                    "long_name": f"number of {column.entries} entries",
                    "sample_dimension": column.entries,
                }
                variables[count_name(column.entries)] = Variable(
                    (self.owner,), counts, attributes
                )
        return variables

    def rows(self, dataset: xr.Dataset, frame: Frame) -> list[Row]:
        """What each record has, from a dataset whose variables fit the columns."""
        if frame.name(self.owner) not in frame.filled:
            return []
        count = dataset.sizes[frame.name(self.owner)]
        cells = {}
        for column in self.columns:
            name = frame.name(column.name)
            if not self.is_filled(column, frame):
                cells[column.name] = count * [column.no_values(frame)]
                continue
            counts = np.empty(0, dtype=int)
            if column.entries:
                counts = dataset[count_name(column.entries)].values
            cells[column.name] = column.split(dataset[name].values, counts)
        return [{name: cells[name][i] for name in cells} for i in range(count)]


def count_name(dimension: str) -> str:
    """Name of the variable that holds how many entries of a dimension each record
    has."""
    return f"{dimension}_count"


def make_variable(
    dimensions: tuple[str, ...], values: np.ndarray, long_name: str, units: str = ""
) -> Variable:
    """A variable with its long name and its units."""
    attributes = {"long_name": long_name}
    if units:
        attributes["units"] = units
    return Variable(dimensions, values, attributes)
