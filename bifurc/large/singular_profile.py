"""The smallest singular values of F' along a curve of a large problem."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.smallest_singular_values import (
    SingularTriple,
    smallest_singular_triples,
)


@dataclass(frozen=True, eq=False)
class SingularProfile:
    """The smallest singular ``triples``, in increasing order, at each of the ``places``
    (k,) of a curve, by arclength."""

    places: np.ndarray
    triples: list[list[SingularTriple]]

    @property
    def values(self) -> np.ndarray:
        """The singular values (k, q), over the magnitude, nan where fewer are known."""
        count = max((len(row) for row in self.triples), default=0)
        values = np.full((len(self.triples), count), np.nan)
        for row, triples in zip(values, self.triples, strict=True):
            row[: len(triples)] = [triple.value for triple in triples]
        return values

    @property
    def smallest(self) -> np.ndarray:
        """The smallest singular value (k,) at each place."""
        return np.array([row[0].value if row else np.inf for row in self.triples])


def singular_profile(
    problem: ScaledProblem, branch: Branch, places: int, count: int
) -> SingularProfile:
    """The ``count`` smallest singular values at so many ``places`` of each piece."""
    if not count or not len(branch.pieces):
        return SingularProfile(np.empty(0), [])
    shares = (np.arange(places) + 0.5) / places
    arclengths = branch.places(shares).ravel()
    triples = [triples_at(problem, branch, s, count) for s in arclengths.tolist()]
    return SingularProfile(arclengths, triples)


def triples_at(
    problem: ScaledProblem, branch: Branch, s: float, count: int
) -> list[SingularTriple]:
    """The ``count`` smallest singular values at an arclength."""
    tangent = unit_tangent(branch, s)
    return smallest_singular_triples(problem, branch(s), tangent, count)


def unit_tangent(branch: Branch, s: float) -> np.ndarray:
    """The unit tangent (n,) of a curve at an arclength."""
    tangent = branch(s, 1)
    unit: np.ndarray = tangent / np.linalg.norm(tangent)
    return unit
