"""What the catalogue keeps of sheets."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkages.entry import (
    Parameter,
    ParameterKind,
    UnknownParameterError,
    WithParameters,
)
from linkages.entry_table import read_records
from linkages.sheets.pattern import Cell, CellCrease
from linkages.sheets.quad_mesh import QuadMesh, straight_mesh
from linkages.values import check_number, require

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

MOST = 400  # rows and columns
PERIOD = 20  # rows after which their ratios come again: neighbours differ little
TURN = 1.3  # rad from column to column


@dataclass(frozen=True)
class SheetEntry(WithParameters, ABC):
    """One sheet: its ``name``, ``title``, ``source`` and free ``parameters``."""

    name: str
    title: str
    source: str
    parameters: tuple[Parameter, ...]

    def complete(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters, those that are not given at their defaults. Raises
        `UnknownParameterError`, and `GeometryError` for what makes no sheet."""
        for name, value in values.items():
            if name not in self.defaults:
                raise UnknownParameterError(self.name, name, tuple(self.defaults))
            check_number(f"parameter {name} of {self.name}", value)
        complete = {**self.defaults, **values}
        for name in ("rows", "columns"):
            value = complete[name]
            is_count = float(value).is_integer() and 1 <= value <= MOST
            require(is_count, name, value, f"a whole number from 1 to {MOST}")
        return complete

    @abstractmethod
    def fold_content(self, **values: float) -> dict[str, Any]:
        """The content of a FOLD file of the sheet. Raises as `complete`."""

    def build(self, **values: float) -> Mechanism:
        """The member with the given parameters (angles in rad), the others at their
        defaults. Raises as `fold_content`."""
        # it imports networkx, which a loop does not need
        from linkages.files.fold import mechanism_of_fold

        return mechanism_of_fold(self.fold_content(**values), self.name)


class MeshEntry(SheetEntry):
    """A mesh of quadrilaterals, folded by its closed form."""

    def mesh(self, **values: float) -> QuadMesh:
        """The flat sheet. Raises as `complete`, for other values that make no sheet, and
        as `QuadMesh`."""
        complete = {"variation": 0.0, **self.complete(values)}
        ends = {"angle": (0.0, 90.0), "fold": (0.0, 180.0)}
        for name, (low, high) in ends.items():
            degrees = float(np.degrees(complete[name]))
            allowed = f"between {low:g} and {high:g} degrees"
            require(low < degrees < high, name, f"{degrees:g}", allowed)
        variation = complete["variation"]
        require(0.0 <= variation < 1.0, "variation", variation, "from 0 to less than 1")
        j = np.arange(int(complete["rows"]))
        i = np.arange(int(complete["columns"]))
        rows = np.cos(complete["angle"]) * (
            1 + variation * np.cos(2 * np.pi * j / PERIOD)
        )
        columns = 1 + variation * np.cos(TURN * i)
        return straight_mesh((-1.0) ** j * rows, (-1.0) ** i * columns)

    def fold_content(self, **values: float) -> dict[str, Any]:
        """The content of a FOLD file of the sheet in the state that is given. Raises as
        `mesh`."""
        mesh = self.mesh(**values)
        fold = self.complete(values)["fold"]
        t = float(np.tan(0.5 * fold) / abs(mesh.columns[0]))
        step = self.complete(values).get("thickness")
        if step is None:
            return mesh.fold_content(t, self.name)
        require(step > 0.0, "thickness", f"{step:g}", "greater than 0")
        return mesh.thick_pattern(t, step, self.name)


@dataclass(frozen=True)
class PatternEntry(SheetEntry):
    """A flat pattern that repeats, see `linkages.sheets.pattern.Cell`."""

    lattice: Sequence[Sequence[str]]
    points: Mapping[str, Sequence[str]]
    creases: Sequence[Sequence[Any]]

    def fold_content(self, **values: float) -> dict[str, Any]:
        """The content of a FOLD file of the flat sheet, its creases assigned. Raises as
        `complete`, and for angles and sizes out of their ranges."""
        complete = self.complete(values)
        for one in self.parameters:
            if one.name not in ("rows", "columns"):
                require_within_range(one, complete[one.name])
        creases = [CellCrease(*crease) for crease in self.creases]
        cell = Cell(self.lattice, self.points, creases, complete)
        rows, columns = int(complete["rows"]), int(complete["columns"])
        return cell.fold_content(columns, rows, self.name)


def require_within_range(parameter: Parameter, value: float) -> None:
    """Raise `GeometryError` for a value of a parameter out of its range, in degrees."""
    is_angle = parameter.kind is ParameterKind.ANGLE
    unit, word = (np.radians(1.0), " degrees") if is_angle else (1.0, "")
    low, high = parameter.low / unit, parameter.high / unit
    allowed = f"from {low:g} to {high:g}{word}"
    is_within = parameter.low <= value <= parameter.high
    require(is_within, parameter.name, f"{value / unit:g}", allowed)


MESHES = {
    fields["name"]: MeshEntry(**fields)
    for fields in read_records("linkages.sheets", "entries", "sheet")
}
PATTERNS = {
    fields["name"]: PatternEntry(**fields)
    for fields in read_records("linkages.sheets", "patterns", "pattern")
}
SHEETS: Mapping[str, SheetEntry] = {**MESHES, **PATTERNS}
