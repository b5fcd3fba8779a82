"""A variable of a dataset, before it becomes one of xarray or part of a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

Attribute: TypeAlias = str | int | float


@dataclass(frozen=True, eq=False)
class Variable:
    """Values with the names of their ``dimensions``, one for each axis, and their
    ``attributes``."""

    dimensions: tuple[str, ...]
    values: np.ndarray
    attributes: Mapping[str, Attribute]
