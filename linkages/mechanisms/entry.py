"""What the catalogue keeps of a mechanism that is built by name."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from linkages.entry import Parameter, UnknownParameterError, WithParameters
from linkages.values import check_number

if TYPE_CHECKING:  # it imports networkx, which a loop does not need
    from linkages.mechanisms.mechanism import Mechanism


@dataclass(frozen=True)
class MechanismEntry(WithParameters, ABC):
    """A mechanism of many loops: its ``name``, ``title``, ``source`` and free
    ``parameters``."""

    name: str
    title: str
    source: str
    parameters: tuple[Parameter, ...]

    def complete(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters, those that are not given at their defaults. Raises
        `UnknownParameterError`, and `GeometryError` for what is no number or no count."""
        for name, value in values.items():
            if name not in self.defaults:
                raise UnknownParameterError(self.name, name, tuple(self.defaults))
            check_number(f"parameter {name} of {self.name}", value)
        complete = {**self.defaults, **values}
        for one in self.parameters:
            if one.is_count:
                one.require_in_range(complete[one.name])
        return complete

    @abstractmethod
    def build(self, **values: float) -> Mechanism:
        """The member with the given parameters (angles in rad), the others at their
        defaults. Raises as `complete`, and `GeometryError` for other values that make no
        mechanism."""
