"""A dataset written as a NetCDF file, in the way xarray does, which reads it.

Written without xarray: that and pandas take longer to import than a map takes.
"""

from __future__ import annotations

import errno
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from bifurc.files.variable import Attribute, Variable


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
