"""A dataset written as a NetCDF file, in the way xarray does, which reads it; and how a
damaged file is told from a whole one.

Written without xarray: that and pandas take longer to import than a map takes.

A file ends with a seal, a checksum of all its bytes: the libraries that read NetCDF may
crash on damaged files, and the seal is looked at before they are asked. They pass over
what stands behind the end of the data, and drop it when they write on the file. The
checksum of the values then tells whether one of them was edited.
"""

from __future__ import annotations

import errno
import struct
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from bifurc.files.table import Attribute, Variable

MARK = b"bifurc seal "
SEAL = struct.Struct(f"<{len(MARK)}sI")


def write_netcdf(
    path: Path, variables: Mapping[str, Variable], attributes: Mapping[str, Attribute]
) -> None:
    """Write variables by their names, and the attributes of the whole, to a new file.

    Raises `OSError` where it cannot be written.
    """
    try:
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            file.setncatts(attributes)
            for name, size in _sizes(variables).items():
                file.createDimension(name, size)
            for name, variable in variables.items():
                _write_variable(file, name, variable)
    except RuntimeError as error:  # the library's word for a full disk
        reason = f"it cannot be written ({error})"
        raise OSError(errno.EIO, reason) from error


def _sizes(variables: Mapping[str, Variable]) -> dict[str, int]:
    """The size of each dimension by its name."""
    sizes: dict[str, int] = {}
    for variable in variables.values():
        sizes |= zip(variable.dimensions, variable.values.shape, strict=True)
    return sizes


def _write_variable(file: netCDF4.Dataset, name: str, variable: Variable) -> None:
    """One variable; texts are texts of any length, and what is true or false is a small
    number that says so."""
    values = variable.values
    attributes = dict(variable.attributes)
    datatype: Any = values.dtype
    if values.dtype.kind == "U":
        datatype = str
        values = values.astype(object)
    elif values.dtype.kind == "b":
        datatype = np.dtype("i1")
        values = values.astype(datatype)
        attributes["dtype"] = "bool"
    stored = file.createVariable(name, datatype, variable.dimensions)
    stored.set_auto_maskandscale(False)
    stored.setncatts(attributes)
    stored[...] = values


# --- damage ---------------------------------------------------------------------------


def append_seal(path: Path) -> None:
    """Write the seal behind the bytes of the file ``path``."""
    content = path.read_bytes()
    with path.open("ab") as file:
        file.write(SEAL.pack(MARK, zlib.crc32(content)))


def is_seal_broken(path: Path) -> bool:
    """Whether the file ``path`` has a seal, and its bytes are not those that were
    sealed."""
    whole = path.read_bytes()
    content, end = whole[: -SEAL.size], whole[-SEAL.size :]
    if len(end) < SEAL.size:
        return False
    mark, expected = SEAL.unpack(end)
    has_seal = bool(mark == MARK)
    return has_seal and zlib.crc32(content) != expected


def checksum(
    values: Mapping[str, np.ndarray],
    attributes: Mapping[str, object],
    names: Iterable[str],
) -> int:
    """CRC-32 of the values of all variables and of the attributes called ``names``.

    It is the same before a dataset is written and after it is read.
    """
    total = 0
    for name in sorted(values):
        total = zlib.crc32(name.encode(), total)
        total = zlib.crc32(_content(values[name]), total)
    for name in names:
        total = zlib.crc32(str(attributes.get(name)).encode(), total)
    return total


def _content(values: np.ndarray) -> bytes:
    """Numbers as they are; texts, which change their type in a file, in UTF-8."""
    if values.dtype.kind in "biuf":
        return values.tobytes()
    return "\0".join(map(str, values.ravel().tolist())).encode()
