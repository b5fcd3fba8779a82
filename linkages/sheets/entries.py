"""What the catalogue keeps of sheets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkages.entry import Parameter, UnknownParameterError, WithParameters
from linkages.entry_table import read_records
from linkages.sheets.quad_mesh import QuadMesh, straight_mesh
from linkages.values import check_number, require

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

MOST = 400  # rows and columns
PERIOD = 20  # rows after which their ratios come again: neighbours differ little
TURN = 1.3  # rad from column to column


@dataclass(frozen=True)
class SheetEntry(WithParameters):
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
        complete = {"variation": 0.0, **self.defaults, **values}
        for name in ("rows", "columns"):
            value = complete[name]
            is_count = float(value).is_integer() and 1 <= value <= MOST
            require(is_count, name, value, f"a whole number from 1 to {MOST}")
        ends = {"angle": (0.0, 90.0), "fold": (0.0, 180.0)}
        for name, (low, high) in ends.items():
            degrees = float(np.degrees(complete[name]))
            allowed = f"between {low:g} and {high:g} degrees"
            require(low < degrees < high, name, f"{degrees:g}", allowed)
        variation = complete["variation"]
        require(0.0 <= variation < 1.0, "variation", variation, "from 0 to less than 1")
        return complete

    def mesh(self, **values: float) -> QuadMesh:
        """The flat sheet. Raises as `complete`, and as `QuadMesh`."""
        complete = self.complete(values)
        j = np.arange(int(complete["rows"]))
        i = np.arange(int(complete["columns"]))
        variation = complete["variation"]
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
        return mesh.fold_content(t, self.name)

    def build(self, **values: float) -> Mechanism:
        """The member with the given parameters (angles in rad), the others at their
        defaults. Raises as `mesh`."""
        # it imports networkx, which a loop does not need
        from linkages.files.fold import mechanism_of_fold

        return mechanism_of_fold(self.fold_content(**values), self.name)


SHEETS: Mapping[str, SheetEntry] = {
    fields["name"]: SheetEntry(**fields)
    for fields in read_records("linkages.sheets", "entries", "sheet")
}
