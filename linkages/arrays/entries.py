"""What the catalogue keeps of arrays, and all mechanisms that it builds by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from linkages.entry_table import read_records
from linkages.mechanisms.entry import MechanismEntry
from linkages.sheets.entries import SHEETS

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

# where each is built: a function of the parameters, whole numbers as such
MODULES = {
    "scissors": ("scissors", "scissors"),
    "angulated-scissors": ("scissors", "angulated_ring"),
    "bennett-array": ("bennett_lattice", "locked_lattice"),
    "bricard-array": ("bricard_tiling", "bricard_tiling"),
}


@dataclass(frozen=True)
class ArrayEntry(MechanismEntry):
    """One array."""

    def build(self, **values: float) -> Mechanism:
        """The member with the given parameters (angles in rad), the others at their
        defaults. Raises as `complete`, and for angles out of their ranges."""
        complete = self.complete(values)
        for one in self.parameters:
            one.require_in_range(complete[one.name])
        module, name = MODULES[self.name]
        # they import networkx, which a loop does not need
        construct: Callable[..., Mechanism]
        construct = getattr(import_module(f"linkages.arrays.{module}"), name)
        return construct(
            **{
                one.name: int(complete[one.name])
                if one.is_count
                else complete[one.name]
                for one in self.parameters
            }
        )


ARRAYS = {
    fields["name"]: ArrayEntry(**fields)
    for fields in read_records("linkages.arrays", "entries", "array")
}
MECHANISMS: Mapping[str, MechanismEntry] = {**SHEETS, **ARRAYS}
