"""The members of a family over ranges of some of its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bifurc.parametrised import ParametrisedProblem
from linkages.entry import Entry, Linkage, Parameter
from linkages.linkage import load_linkage
from linkages.loop import Loop
from linkages.parameters.parametrised_closure import parametrised_closure
from linkages.values import GeometryError

VALUES, HALVINGS = 100, 60  # of a parameter, to see how far there are members


@dataclass(frozen=True, eq=False)
class Members:
    """The members of a ``family`` with ``values`` of all parameters, of which some have
    ``ranges`` (low, high) that hold these values."""

    family: Entry
    values: Mapping[str, float]
    ranges: Mapping[str, tuple[float, float]]

    @property
    def free(self) -> tuple[Parameter, ...]:
        """The free parameters."""
        known = {parameter.name: parameter for parameter in self.family.parameters}
        return tuple(known[name] for name in self.ranges)

    @property
    def start(self) -> np.ndarray:
        """The values (q,) of the free parameters from which these move."""
        return np.array([self.values[name] for name in self.ranges])

    @cached_property
    def problem(self) -> ParametrisedProblem:
        """The closure equations with the free parameters among the unknowns."""
        return parametrised_closure(self.family, self.values, self.ranges)

    def with_values(self, p: np.ndarray) -> dict[str, float]:
        """All parameters where the free ones are ``p`` (q,)."""
        return {**self.values, **dict(zip(self.ranges, p.tolist(), strict=True))}

    def build(self, p: np.ndarray) -> Loop:
        """The member at ``p`` (q,); raises `GeometryError` where there is none."""
        return self.family.build(**self.with_values(p))

    def load(self, p: np.ndarray) -> Linkage:
        """The same with the names of its forms."""
        return load_linkage(self.family.name, **self.with_values(p))


@dataclass(frozen=True)
class MemberRange:
    """From where to where there are members, and why the constructor refuses others;
    empty where it does not."""

    low: float
    high: float
    refusal: str = ""


def range_of_members(
    family: Entry, values: Mapping[str, float], name: str, low: float, high: float
) -> MemberRange:
    """The part of a range of the parameter ``name``, about its value, in which the
    constructor of a ``family`` makes members."""
    refusals = []

    def is_refused(value: float) -> bool:
        try:
            family.build(**{**values, name: value})
        except GeometryError as error:
            refusals.append(str(error))
            return True
        return False

    ends = []
    for end in (low, high):
        inside = values[name]
        for value in np.linspace(inside, end, VALUES)[1:].tolist():
            if not is_refused(value):
                inside = value
                continue
            outside = value
            for _ in range(HALVINGS):
                middle = 0.5 * (inside + outside)
                inside, outside = (
                    (inside, middle) if is_refused(middle) else (middle, outside)
                )
            break
        ends.append(inside)
    return MemberRange(ends[0], ends[1], refusals[0] if refusals else "")
