"""The equations of a file over ranges of some of its constants."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bifurc.atlas import Atlas
from bifurc.decisions import is_null
from bifurc.parametrised import ParametrisedProblem
from bifurc.singular.point import Kind
from bifurc.systems.equation_file import EquationSystem, read_equations
from linkages.entry import Parameter, ParameterKind
from linkages.parameters.members import PointToFollow


@dataclass(frozen=True, eq=False)
class EquationMembers:
    """The equations of the file ``path`` with ``values`` of its constants, of which some
    are free within ``bounds`` that hold these values.

    Where the file has a diagram, the parameter of that is free as well, within its own
    bounds, and the folds of the diagram are points that can be followed.
    """

    path: str
    values: Mapping[str, float]
    bounds: Mapping[str, tuple[float, float]]

    @cached_property
    def system(self) -> EquationSystem:
        """The equations of the member from which parameters move."""
        return read_equations(self.path, self.values)

    @property
    def title(self) -> str:
        """What the equations are called."""
        return self.system.name

    @cached_property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        """From where to where each free parameter goes, that of the diagram first."""
        domain = self.system.problem.domain
        own = {
            name: (low, high)
            for name, (low, high) in zip(
                domain.names, domain.bounds.tolist(), strict=True
            )
            if name == self.system.parameter
        }
        return {**own, **self.bounds}

    @property
    def free(self) -> tuple[Parameter, ...]:
        """The free parameters."""
        values = self.system.values
        return tuple(
            Parameter(name, values.get(name, low), ParameterKind.NUMBER, "", low, high)
            for name, (low, high) in self.ranges.items()
        )

    @cached_property
    def problem(self) -> ParametrisedProblem:
        """The equations with the free parameters among the unknowns."""
        system = read_equations(self.path, self.values, self.bounds)
        return ParametrisedProblem.of(system.problem, tuple(self.ranges))

    def points(self, atlas: Atlas) -> list[PointToFollow]:
        """The singular points of the atlas of the member from which parameters move, and
        the folds of its diagram."""
        places = [(one.name, one.kind, one.point.u) for one in atlas.points]
        if atlas.diagram is not None:
            places += [(one.name, one.kind, one.u) for one in atlas.diagram.folds]
        return [self._point(*place) for place in places]

    def _point(self, name: str, kind: Kind, place: np.ndarray) -> PointToFollow:
        """A point at a ``place`` (n,), among the unknowns of which is the parameter of
        the diagram."""
        values = {name: self.system.values[name] for name in self.bounds}
        values |= dict(
            zip(self.system.problem.domain.names, place.tolist(), strict=True)
        )
        u = np.array([values[name] for name in self.problem.domain.names])
        p = np.array([values[name] for name in self.ranges])
        sigma = np.linalg.svd(self.problem.jacobian(u, p), compute_uv=False)
        magnitude = self.system.problem.magnitude
        rank = len(sigma) - int(np.count_nonzero(is_null(sigma, magnitude)))
        return PointToFollow(name, kind, u, p, self.problem.n - rank)

    def anew(self, u: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """F (m,) at ``u`` (n,) and its derivatives (m, n), of the equations that are read
        anew with the values ``p`` (q,)."""
        values = dict(zip(self.ranges, p.tolist(), strict=True))
        constants = {name: values[name] for name in self.bounds}
        problem = read_equations(self.path, {**self.values, **constants}).problem
        values |= dict(zip(self.problem.domain.names, u.tolist(), strict=True))
        place = np.array([[values[name] for name in problem.domain.names]])
        own = [problem.domain.names.index(name) for name in self.problem.domain.names]
        return problem.residuals(place)[0], problem.jacobians(place)[0][:, own]
