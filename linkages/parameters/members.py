"""What has free parameters, and the members of a family over ranges of some."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from bifurc.atlas import Atlas
from bifurc.equations.tape import Tape
from bifurc.parametrised import ParametrisedProblem
from bifurc.singular.point import Kind
from linkages.closure.system import ClosureSystem
from linkages.entry import Entry, Linkage, Parameter
from linkages.parameters.parametrised_closure import (
    closure_of_tables,
    parametrised_closure,
)
from linkages.values import GeometryError

if TYPE_CHECKING:
    # they import networkx, which a loop does not need
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.parameters.mechanism_family import MechanismFamily

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


class PreciseEquations(NamedTuple):
    """Closure equations on a ``tape`` of the unknowns and further numbers, and what these
    are of parameters (q,) in mpmath numbers."""

    tape: Tape
    numbers_of: Callable[[Sequence[Any]], list[Any]]


@dataclass(frozen=True, eq=False)
class Members:
    """The members of a ``family`` with ``values`` of all parameters, of which some have
    ``ranges`` (low, high) that hold these values. Those that ``are_precise`` have
    equations that can be solved to many digits."""

    family: Entry | MechanismFamily
    values: Mapping[str, float]
    ranges: Mapping[str, tuple[float, float]]
    are_precise: bool = False

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
        if isinstance(self.family, Entry):
            return parametrised_closure(self.family, self.values, self.ranges)
        return self.family.parametrised(
            self.values, self.ranges, is_precise=self.are_precise
        )

    @property
    def with_all_free(self) -> Members:
        """The same with all parameters free, anywhere, to many digits."""
        everywhere = dict.fromkeys(self.values, (-np.inf, np.inf))
        return replace(self, ranges=everywhere, are_precise=True)

    def with_values(self, p: np.ndarray) -> dict[str, float]:
        """All parameters where the free ones are ``p`` (q,)."""
        return {**self.values, **dict(zip(self.ranges, p.tolist(), strict=True))}

    def check(self, values: Mapping[str, float]) -> None:
        """Raise `GeometryError` where these values of all parameters make no member."""
        if isinstance(self.family, Entry):
            self.family.build(**values)
        else:
            self.family.offsets(values)

    def load(self, p: np.ndarray) -> Linkage | Mechanism:
        """The member at ``p`` (q,), with the names of its forms; raises `GeometryError`
        where there is none."""
        values = self.with_values(p)
        if not isinstance(self.family, Entry):
            return self.family.build(**values)
        loop, patterns = self.family.build(**values), self.family.patterns
        return Linkage(loop, () if patterns is None else patterns(**values))

    def in_equations(self, points: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Configurations (k, n) of the atlas of the member at ``p`` (q,) in the unknowns
        of `problem`."""
        if isinstance(self.family, Entry):
            return points
        return self.family.in_equations(points, self.with_values(p))

    def joint(self, unknown: int) -> str:
        """What the joint of an unknown, by index, is called."""
        if isinstance(self.family, Entry):
            return f"joint {unknown + 1}"
        return self.problem.domain.names[unknown]

    def precise_equations(self) -> PreciseEquations:
        """The closure equations for many digits, which no constant of a constructor
        limits."""
        family = self.family
        if not isinstance(family, Entry):
            tape, constants = family.precise_closure()
            return PreciseEquations(tape, lambda p: [*p, *constants])
        unit = family.build(**self.values).characteristic_length

        def table(p: Sequence[Any]) -> list[Any]:
            loop = family.build(
                **{**self.values, **dict(zip(self.ranges, p, strict=True))}
            )
            return [*loop.twists, *loop.lengths, *loop.offsets]

        return PreciseEquations(closure_of_tables(self.problem.n, unit), table)

    def points(self, atlas: Atlas) -> list[PointToFollow]:
        """The singular points of the atlas of the member from which parameters move."""
        return [
            PointToFollow(
                one.name,
                one.kind,
                self.in_equations(one.point.u[None], self.start)[0],
                self.start,
                self.problem.n - one.point.rank,
            )
            for one in atlas.points
        ]

    def anew(self, u: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The closure equations (m,) at unknowns ``u`` (n,) of `problem` and their
        derivatives (m, n) by these, of the member at ``p`` (q,)."""
        member = self.load(p)
        closure = ClosureSystem(member.loop if isinstance(member, Linkage) else member)
        # the unknowns of the member are these, shifted and in other units
        ends = self.in_equations(np.stack([np.zeros(len(u)), np.ones(len(u))]), p)
        rates = ends[1] - ends[0]
        point = (u - ends[0]) / rates
        return closure.residuals(point[None])[0], closure.jacobians(point[None])[
            0
        ] / rates


@dataclass(frozen=True)
class MemberRange:
    """From where to where there are members, and why the constructor refuses others;
    empty where it does not."""

    low: float
    high: float
    refusal: str = ""


def range_of_members(
    members: Members, name: str, low: float, high: float
) -> MemberRange:
    """The part of a range of the parameter ``name``, about its value, in which there are
    ``members``."""
    refusals = []

    def is_refused(value: float) -> bool:
        try:
            members.check({**members.values, name: value})
        except GeometryError as error:
            refusals.append(str(error))
            return True
        return False

    ends = []
    for end in (low, high):
        inside = members.values[name]
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
