"""The singular points about which no chart of a component fits: places go in, the point
that is the reason comes out, or none."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.curves.deflation import RankDeflated
from bifurc.problem import Problem
from bifurc.singular.locate import locate_singular_point
from bifurc.surfaces.crossing_sheets import is_on_singular_curve


class SingularPlace(NamedTuple):
    """A singular point ``u`` (n,), and whether others lie beside it."""

    u: np.ndarray
    is_on_curve: bool


class SingularPlaces:
    """The singular points of a component of a ``dimension`` that were looked for."""

    def __init__(self, problem: Problem, dimension: int):
        self._problem = problem
        self._nullity = dimension + 1
        self._known: list[SingularPlace] = []

    def next_to(self, place: np.ndarray, reach: float) -> SingularPlace | None:
        """The singular point next to a place (n,), at a distance up to ``reach``."""
        problem = self._problem
        for known in self._known:
            if np.linalg.norm(problem.domain.difference(known.u, place)) < reach:
                return known
        # of a surface of lower rank they are not looked for
        if problem.n < self._nullity or isinstance(problem, RankDeflated):
            return None
        located = locate_singular_point(problem, place, self._nullity, reach)
        if located is None:
            return None
        found = SingularPlace(located.u, is_on_singular_curve(problem, located))
        self._known.append(found)
        return found
