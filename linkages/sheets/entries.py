"""What the catalogue keeps of sheets."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkages.entry_table import read_records
from linkages.mechanisms.entry import MechanismEntry
from linkages.sheets.pattern import Cell, CellCrease
from linkages.sheets.quad_mesh import QuadMesh, straight_mesh
from linkages.values import require

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

PERIOD = 20  # rows after which their ratios come again: neighbours differ little
TURN = 1.3  # rad from column to column


class SheetEntry(MechanismEntry):
    """One sheet."""

    @abstractmethod
    def fold_content(self, **values: float) -> dict[str, Any]:
        """The content of a FOLD file of the sheet. Raises as `complete`."""

    def build(self, triangulated: bool = False, /, **values: float) -> Mechanism:
        """What this content describes, panels bent along diagonals or not. Raises as
        `fold_content`."""
        # it imports networkx, which a loop does not need
        from linkages.files.fold import mechanism_of_fold

        return mechanism_of_fold(self.fold_content(**values), self.name, triangulated)


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
            one.require_in_range(complete[one.name])
        creases = [CellCrease(*crease) for crease in self.creases]
        cell = Cell(self.lattice, self.points, creases, complete)
        rows, columns = int(complete["rows"]), int(complete["columns"])
        return cell.fold_content(columns, rows, self.name)


MESHES = {
    fields["name"]: MeshEntry(**fields)
    for fields in read_records("linkages.sheets", "entries", "sheet")
}
PATTERNS = {
    fields["name"]: PatternEntry(**fields)
    for fields in read_records("linkages.sheets", "patterns", "pattern")
}
SHEETS: Mapping[str, SheetEntry] = {**MESHES, **PATTERNS}
