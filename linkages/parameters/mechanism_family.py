"""Mechanisms as families, whose parameters are numbers of a first one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.domain import Domain
from bifurc.equations.recorded import Recorder
from bifurc.equations.tape import Tape
from bifurc.parametrised import ParametrisedProblem
from linkages.closure.changes import Changes
from linkages.closure.equations import domain_of, write_equations
from linkages.closure.motors import Number
from linkages.entry import Parameter, UnknownParameterError, WithParameters
from linkages.mechanisms.mechanism import Mechanism
from linkages.parameters.parametrised_closure import domain_of_parameters
from linkages.structure.structure import TURNS_REACH, Structure
from linkages.values import require

if TYPE_CHECKING:
    import mpmath

KEPT = 8  # members, that are asked for once more


class _Member(NamedTuple):
    """A member, and its unknowns (n,) in those of all: times ``scales``, plus
    ``offsets``."""

    mechanism: Mechanism
    offsets: np.ndarray
    scales: np.ndarray


class MechanismFamily(WithParameters, ABC):
    """The mechanisms that differ from a ``mechanism`` in the values of ``parameters``. No
    condition is kept.

    The equations of all have the unknowns of the first one, which are those of a member
    but for `offsets`: its variables are 0 where it is drawn.
    """

    patterns = None

    def __init__(self, mechanism: Mechanism, parameters: Sequence[Parameter]):
        self.mechanism = mechanism
        self.parameters = tuple(parameters)
        self.name = self.title = mechanism.name or "mechanism"
        self._members: dict[tuple[float, ...], _Member] = {}

    @cached_property
    def structure(self) -> Structure:
        """That of the first mechanism."""
        return Structure(self.mechanism)

    @abstractmethod
    def changes(self, values: Mapping[str, Number], structure: Structure) -> Changes:
        """What is otherwise where parameters have these ``values``, numbers of any
        kind, in the unit of a ``structure``."""

    @abstractmethod
    def offsets(self, values: Mapping[str, float]) -> np.ndarray:
        """The unknowns (n,) of the equations less those of the member with these values;
        raises `GeometryError` where it cannot be assembled."""

    @abstractmethod
    def drawn(self, values: Mapping[str, float]) -> Mechanism:
        """The member with these values of all parameters; raises `GeometryError`."""

    def complete(self, values: Mapping[str, float]) -> dict[str, float]:
        """``values`` completed by those of the first mechanism; raises
        `UnknownParameterError`."""
        defaults = self.defaults
        for name in values:
            if name not in defaults:
                raise UnknownParameterError(self.name, name, tuple(defaults))
        return {**defaults, **values}

    @cached_property
    def closure(self) -> ParametrisedProblem:
        """The closure of all members, in the unknowns of the first one and all
        parameters."""
        return self.parametrised({}, dict.fromkeys(self.defaults, (-np.inf, np.inf)))

    def build(self, **values: float) -> Mechanism:
        """The member with these parameters, the others at their defaults; raises
        `GeometryError` where there is none, and `UnknownParameterError`."""
        complete = self.complete(values)
        key = tuple(complete.values())
        if key not in self._members:
            while len(self._members) >= KEPT:
                self._members.pop(next(iter(self._members)))
            self._members[key] = self._build(complete)
        return self._members[key].mechanism

    def _build(self, values: Mapping[str, float]) -> _Member:
        member = self.drawn(values)
        structure = Structure(member)
        labels = [unknown.label for unknown in structure.unknowns]
        known = [unknown.label for unknown in self.structure.unknowns]
        allowed = f"as those of the first one: {', '.join(known)}"
        require(labels == known, f"unknowns of {self.name}", ", ".join(labels), allowed)
        scales = structure.scales / self.structure.scales
        return _Member(member, self.offsets(values), scales)

    def in_equations(
        self, points: np.ndarray, values: Mapping[str, float]
    ) -> np.ndarray:
        """Configurations (k, n) of the member with these values of all parameters in the
        unknowns of the equations of all."""
        self.build(**values)
        member = self._members[tuple(values.values())]
        recounted: np.ndarray = member.offsets + points * member.scales
        return recounted

    def parametrised(
        self,
        values: Mapping[str, float],
        ranges: Mapping[str, tuple[float, float]],
        *,
        is_precise: bool = False,
    ) -> ParametrisedProblem:
        """The closure in the unknowns of the first mechanism and the parameters that have
        ``ranges``; the others have their ``values``. One that ``is_precise`` is written as
        `precise_closure`."""
        parameters = domain_of_parameters(self.parameters, ranges)
        known = self.complete(values)
        structure = self._precise_structure if is_precise else self.structure
        tape, changes = self._written(known, tuple(ranges), structure)
        return ParametrisedProblem(tape, self._domain(changes), parameters)

    def precise_closure(self) -> tuple[Tape, list[mpmath.mpf]]:
        """The closure on a tape of the unknowns, all parameters and further constants, and
        these to the digits that are set."""
        constants = self.constants()
        free = (*self.defaults, *constants)
        tape, _ = self._written({}, free, self._precise_structure)
        return tape, list(constants.values())

    @property
    def _precise_structure(self) -> Structure:
        """That in whose coordinates equations hold to any digits."""
        return self.structure

    def constants(self) -> dict[str, mpmath.mpf]:
        """What doubles round in the equations, by names with which `changes` are given it;
        nothing unless a family says so."""
        return {}

    def _written(
        self, values: Mapping[str, float], free: Sequence[str], structure: Structure
    ) -> tuple[Tape, Changes]:
        """The closure on a tape of the unknowns and what is ``free``."""
        n = len(structure.unknowns)
        writer = Recorder(n + len(free))
        numbers = {
            name: writer.number(writer.unknown(k)) for k, name in enumerate(free, n)
        }
        changes = self.changes({**values, **numbers}, structure)
        return write_equations(structure, changes, writer).tape, changes

    def _domain(self, changes: Changes) -> Domain:
        """The unknowns; those that others follow come back after no period, as this hangs
        on the ratios."""
        domain = domain_of(self.structure)
        periods, bounds = domain.periods.copy(), domain.bounds.copy()
        for variable, column in self.structure.column_of.items():
            if changes.share(variable) is not None and np.isfinite(periods[column]):
                periods[column] = np.inf
                bounds[column] = [-TURNS_REACH, TURNS_REACH]
        return replace(domain, periods=periods, bounds=bounds)
