"""Which joints to hold so that one joint drives a mechanism of higher mobility."""

from __future__ import annotations

import numpy as np

from linkages.decisions import is_dependent_constraint
from linkages.loop import GeometryError, quoted
from linkages.mechanisms.closure import MechanismClosure
from linkages.mechanisms.mechanism import Mechanism

__all__ = ["joints_to_hold"]


def joints_to_hold(mechanism: Mechanism, driver: str) -> dict[str, float]:
    """Variables, by label, with the values in the reference configuration at which they
    are held, so that the variable ``driver`` moves the rest with mobility 1.

    They are the first ones, in the order of the joints, that can be held. Nothing is
    held where the mobility is 1 already. Raises `GeometryError` for a driver that is no
    free variable or stands still.
    """
    problem = MechanismClosure(mechanism)
    unknowns = problem.structure.unknowns
    labels = [unknown.label for unknown in unknowns if unknown.variable >= 0]
    free = problem.structure.column_of
    columns = {mechanism.variables[number].label: free[number] for number in free}
    if driver not in columns:
        allowed = f"one of the joint variables {', '.join(columns)}"
        raise GeometryError("drive", quoted(driver), allowed)
    points, _ = problem.project(problem.reference[None])
    motions = _null_space(problem.jacobians(points)[0])
    row = columns[driver]
    if _stands_still(motions[row]):
        allowed = "a joint that moves in the reference configuration"
        raise GeometryError("drive", quoted(driver), allowed)
    held: dict[str, float] = {}
    for column, label in enumerate(labels):
        if motions.shape[1] == 1:
            break
        if column == row or _stands_still(motions[column]):
            continue
        left = motions @ _null_space(motions[column][None])
        if not _stands_still(left[row]):
            motions = left
            value = float(points[0, column] * problem.structure.scales[column])
            held[label] = value
    return held


def _null_space(matrix: np.ndarray) -> np.ndarray:
    """An orthonormal basis (n, k) of what a matrix (m, n) maps to zero."""
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(~is_dependent_constraint(values)))
    basis: np.ndarray = right[rank:].T
    return basis


def _stands_still(rates: np.ndarray) -> bool:
    return is_dependent_constraint(float(np.linalg.norm(rates)))
