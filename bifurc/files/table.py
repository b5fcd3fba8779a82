"""Tables of a dataset: which variables hold the records of one kind, to write, to check
and to read them.

A table has a row for each record and a column for each variable; ``variables.csv`` lists
them all. Where a record has several values in a column, those of all records are joined,
one behind the other (CF: contiguous ragged array), or padded with NaN. How many values
each record has stands in the variable ``..._count``; its attribute ``sample_dimension``
names what it counts. A dataset has the variables that its atlas fills: a table without
records, and a column without a single value, are left out of it, and read as empty.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

from bifurc.atlas import Atlas

if TYPE_CHECKING:
    import xarray as xr

Attribute: TypeAlias = str | int | float
Row: TypeAlias = Mapping[str, Any]  # what a record has in each column, by its name
Made = TypeVar("Made")

# What differs from atlas to atlas, as it is called in a column; see `Frame`.
JOINT = "joint"
UNIT = "unknown"  # the unit of the unknowns
PADDED = ("sample",)  # entries that are padded, and not joined
NOT_KNOWN = -1  # what a record has that lacks what a whole number is an attribute of
# The kinds of numpy's types that are read as the type of a column.
READABLE_KINDS = {float: "f", int: "iu", bool: "biu", str: "OTU"}


@dataclass(frozen=True, eq=False)
class Variable:
    """Values with the names of their ``dimensions``, one for each axis, and their
    ``attributes``, before they become a variable of xarray or part of a file."""

    dimensions: tuple[str, ...]
    values: np.ndarray
    attributes: Mapping[str, Attribute]


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
class Column:
    """One variable: the ``attribute`` of a record, such as "point.rank", or else what
    the function ``value`` gives; a member of an enum by its name. ``key`` is what the value
    is called in JSON, if it stands there.

    ``dimensions`` are those of a single value. With ``entries`` a record has any number
    of values, counted by that dimension. ``index_of`` names the dimension of which the
    values are indices.
    """

    name: str
    attribute: str
    key: str
    kind: type[Any]
    units: str = ""
    dimensions: tuple[str, ...] = ()
    entries: str = ""
    index_of: str = ""
    long_name: str = ""
    value: Callable[[Any], Any] | None = None

    @property
    def dtype(self) -> type:
        """The type of the values in a dataset."""
        return str if issubclass(self.kind, Enum) else self.kind

    @property
    def is_padded(self) -> bool:
        """Whether the values of a record stand in a row of their own."""
        return self.entries in PADDED

    def taken(self, record: Any) -> Any:
        """What a record has, as it is; None where it lacks what that is an attribute
        of."""
        if self.value:
            return self.value(record)
        for name in self.attribute.split("."):
            record = None if record is None else getattr(record, name)
        return record

    def cell(self, record: object, frame: Frame) -> np.ndarray:
        """What a record has: of the shape of a value, or (count, shape of a value).

        A value that is smaller than its dimensions is filled up with 0.
        """
        shape = self._shape(frame)
        taken = self.taken(record)
        if isinstance(taken, Enum):
            taken = taken.name
        if taken is None:
            taken = () if self.entries else NOT_KNOWN
        value: np.ndarray = np.asarray(taken, dtype=self.dtype)
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

    def split(self, values: np.ndarray, counts: np.ndarray) -> list[Any]:
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
        return list(values) if self.dimensions else list(map(self._plain, values))

    def no_values(self, frame: Frame) -> np.ndarray:
        """What a record without a single value has."""
        return np.empty((0, *self._shape(frame)), dtype=self.dtype)

    def _plain(self, value: object) -> Any:
        """A single value as Python's; raises `KeyError` for no member of an enum."""
        if issubclass(self.kind, Enum):
            return self.kind[str(value)]
        return self.kind(value)

    def _shape(self, frame: Frame) -> tuple[int, ...]:
        """Shape of a single value."""
        return tuple(frame.sizes[name] for name in self.dimensions)


@dataclass(frozen=True)
class Table:
    """The variables of the records of one kind, which the dimension ``owner`` counts.

    ``records`` takes them from an atlas.
    """

    owner: str
    records: Callable[[Atlas], Sequence[Any]]
    columns: tuple[Column, ...]

    def is_filled(self, column: Column, frame: Frame) -> bool:
        """Whether a dataset that is read has the variable of a column."""
        counting = column.entries or self.owner
        return {frame.name(self.owner), frame.name(counting)} <= frame.filled

    def dimensions(self, column: Column, frame: Frame) -> tuple[str, ...]:
        """Dimensions of the variable of a column."""
        names = [column.entries or self.owner, *column.dimensions]
        if column.is_padded:
            names = [self.owner, *names]
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

    # --- reading ----------------------------------------------------------------------

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

    def make(self, cls: type[Made], row: Row, place: str = "", **others: Any) -> Made:
        """The object of a dataclass that a record has at ``place``, or that it is: from
        the columns that are attributes of it, and from ``others``."""
        names = {field.name for field in fields(cls)}  # type: ignore[arg-type]
        values = {}
        for column in self.columns:
            head, _, name = column.attribute.rpartition(".")
            if head == place and name in names:
                values[name] = row[column.name]
        return cls(**(values | others))

    # --- checks -----------------------------------------------------------------------

    def missing(self, dataset: xr.Dataset, frame: Frame) -> list[str]:
        """Names of the variables that a dataset lacks."""
        columns = [column for column in self.columns if self.is_filled(column, frame)]
        counts = [count_name(column.entries) for column in columns if column.entries]
        names = [frame.name(column.name) for column in columns]
        names += dict.fromkeys(counts)
        return [name for name in names if name not in dataset.variables]

    def faults(self, dataset: xr.Dataset, frame: Frame) -> Iterator[str]:
        """What keeps the variables, none of which is missing, from being read.

        Dimensions and types must be those of the columns, counts must add up, and
        indices must be those of something.
        """
        columns = [column for column in self.columns if self.is_filled(column, frame)]
        for column in columns:
            variable = dataset.variables[frame.name(column.name)]
            dimensions = self.dimensions(column, frame)
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
        for entries in dict.fromkeys(one.entries for one in columns if one.entries):
            yield from _count_faults(self.owner, entries, dataset)


def _size_faults(column: Column, dataset: xr.Dataset, frame: Frame) -> Iterator[str]:
    for name in column.dimensions:
        size = dataset.sizes[frame.name(name)]
        expected = frame.sizes.get(name, size)
        if size != expected:
            yield f"{column.name} has {size} entries along {name} instead of {expected}"


def _index_faults(column: Column, dataset: xr.Dataset, frame: Frame) -> Iterator[str]:
    if not column.index_of:
        return
    count = dataset.sizes.get(frame.name(column.index_of), 0)
    indices = dataset[column.name].values
    if np.any((indices < 0) | (indices >= count)):
        yield f"{column.name} holds an index that none of {count} has"


def _count_faults(owner: str, dimension: str, dataset: xr.Dataset) -> Iterator[str]:
    name = count_name(dimension)
    counts = dataset.variables[name]
    if counts.dims != (owner,) or counts.dtype.kind not in READABLE_KINDS[int]:
        yield f"{name} is no count for each {owner}"
        return
    size = dataset.sizes[dimension]
    if np.any(counts.values < 0) or np.any(counts.values > size):
        yield f"{name} holds a number that is not from 0 to {size}"
    elif dimension not in PADDED and counts.values.sum() != size:
        yield f"{name} adds up to {counts.values.sum()} instead of {size}"


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
