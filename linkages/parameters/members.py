"""What has free parameters, and the members of a family over ranges of some."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from bifurc.atlas import Atlas
from bifurc.parametrised import ParametrisedProblem
from bifurc.singular.point import Kind
from linkages.closure.system import ClosureSystem
from linkages.entry import Entry, Linkage, Parameter
from linkages.loop import Loop
from linkages.parameters.parametrised_closure import parametrised_closure
from linkages.values import GeometryError

VALUES, HALVINGS = 100, 60  # of a parameter, to see how far there are members


class PointToFollow(NamedTuple):
    """A singular point of an atlas: its ``name`` and ``kind``, the unknowns ``u`` (n,) and
    parameters ``p`` (q,) of the equations that are followed, and the ``nullity`` of their
    derivatives by u."""

    name: str
    kind: Kind
    u: np.ndarray
    p: np.ndarray
    nullity: int


class FreeParameters(Protocol):
    """What has free parameters: equations of which each choice of these is a member."""

    @property
    def title(self) -> str:
        """What it is called."""

    @property
    def free(self) -> tuple[Parameter, ...]:
        """The free parameters."""

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        """From where to where each of them goes."""

    @property
    def problem(self) -> ParametrisedProblem:
        """The equations with the free parameters among the unknowns."""

    def points(self, atlas: Atlas) -> list[PointToFollow]:
        """The points of the atlas of the member from which parameters move."""

    def anew(self, u: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """F (m,) and its derivatives (m, n) by the unknowns ``u`` (n,), of the member at
        ``p`` (q,) built anew; raises `BifurcError` where there is none."""


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
    def title(self) -> str:
        """What the family is called."""
        return self.family.title

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
        patterns = self.family.patterns
        named = () if patterns is None else patterns(**self.with_values(p))
        return Linkage(self.build(p), named)

    def points(self, atlas: Atlas) -> list[PointToFollow]:
        """The singular points of the atlas of the member from which parameters move."""
        return [
            PointToFollow(
                one.name,
                one.kind,
                one.point.u,
                self.start,
                self.problem.n - one.point.rank,
            )
            for one in atlas.points
        ]

    def anew(self, u: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The closure equations (m,) at joint angles ``u`` (n,) and their derivatives
        (m, n), of the member at ``p`` (q,)."""
        closure = ClosureSystem(self.build(p))
        return closure.residuals(u[None])[0], closure.jacobians(u[None])[0]


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
