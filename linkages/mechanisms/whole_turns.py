"""Motions of helical joints that are a whole turn of one of them apart.

A helical joint that makes a whole turn more has advanced, and what closes the loop then
is another form, or none. Random starts reach such forms one by one; beside a known one
the others are found by turning each joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_start_solved
from bifurc.problem import Problem
from bifurc.seeds import Audit, Level
from linkages.mechanisms.dyads.slices import RANDOM_ASSEMBLIES
from linkages.mechanisms.structure import Structure

__all__ = ["WholeTurns", "helical_unknowns"]

MOST_FORMS = 120  # beyond, forms beside them are not looked for
PLACES = np.array([0.05, 0.35, 0.65, 0.95])  # on a form, of its length
FULL_TURN = 2 * np.pi


def helical_unknowns(structure: Structure) -> tuple[int, ...]:
    """The numbers of the unknowns that are turns with an advance."""
    variables = structure.mechanism.variables
    return tuple(
        number
        for number, unknown in enumerate(structure.unknowns)
        if unknown.variable >= 0 and variables[unknown.variable].motion.advance
        if unknown.is_angle
    )


@dataclass(frozen=True, eq=False)
class WholeTurns:
    """The forms of a ``problem`` whose ``helical`` unknowns, by number, turn and
    advance."""

    problem: Problem
    helical: tuple[int, ...]

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """Configurations a whole turn of a joint beside ``branches``, as starts; or, of
        many branches, that there may be more."""
        nowhere = np.empty((0, self.problem.n))
        if len(branches) > MOST_FORMS or seconds <= 0.0:
            text = (
                f"there are at least {len(branches)} forms: helical joints may stand "
                "whole turns away within their limits, and not all of that was tried"
            )
            return Audit(Level.ESTIMATED, text, nowhere)
        text = (
            "beside every form listed here all that are a whole turn of a helical joint "
            f"away, within the limits, are listed as well; {RANDOM_ASSEMBLIES}"
        )
        starts = [self._beside(branch) for branch in branches]
        return Audit(Level.ESTIMATED, text, np.concatenate([nowhere, *starts]))

    def _beside(self, branch: Branch) -> np.ndarray:
        """Closed configurations (k, n) within the limits, a whole turn beside a
        branch."""
        places = branch(PLACES * branch.length)
        turned = []
        for number in self.helical:
            for turn in (FULL_TURN, -FULL_TURN):
                beside = places.copy()
                beside[:, number] += turn
                turned.append(beside)
        points, gaps = self.problem.project(np.concatenate(turned))
        is_inside = self.problem.excess(points) <= 0.0
        inside: np.ndarray = points[is_start_solved(gaps) & is_inside]
        return inside
