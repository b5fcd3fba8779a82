"""Which joints to hold so that one joint drives a mechanism of higher mobility."""

from __future__ import annotations

import numpy as np

from bifurc.decisions import is_start_solved
from linkages.closure.system import ClosureSystem
from linkages.decisions import is_dependent_constraint, is_stopped
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import GeometryError, quoted

STARTS = 20  # next to the reference configuration
NEARBY = 0.1  # rad or characteristic lengths


def joints_to_hold(mechanism: Mechanism, driver: str) -> dict[str, float]:
    """Variables, by label, with the values in the reference configuration at which they
    are held, so that the variable ``driver`` moves the rest with mobility 1.

    They are the first ones that can be held, those with motors before the others, in the
    order of the joints. Nothing is held where the mobility is 1 already. What moves is seen at a regular configuration,
    next to the reference configuration where that is singular. Raises `GeometryError` for a driver that is no
    free variable or stands still.
    """
    problem = ClosureSystem(mechanism)
    unknowns = problem.structure.unknowns
    labels = [unknown.label for unknown in unknowns if unknown.variable >= 0]
    free = problem.structure.column_of
    columns = {mechanism.variables[number].label: free[number] for number in free}
    if driver not in columns:
        allowed = f"one of the joint variables {', '.join(columns)}"
        raise GeometryError("drive", quoted(driver), allowed)
    points, _ = problem.project(problem.reference[None])
    motions = _null_space(problem.jacobians(points)[0])
    regular = _motions_near(problem, points[0])
    is_singular = regular.shape[1] < motions.shape[1]
    motions = regular
    row = columns[driver]
    if _stands_still(motions[row]):
        allowed = "a joint that moves next to the reference configuration"
        raise GeometryError("drive", quoted(driver), allowed)
    held: dict[str, float] = {}
    motors = mechanism.motors
    columns_in_order = sorted(enumerate(labels), key=lambda one: one[1] not in motors)
    for column, label in columns_in_order:
        if motions.shape[1] == 1:
            break
        if column == row or _stands_still(motions[column]):
            continue
        left = motions @ _null_space(motions[column][None])
        if _stands_still(left[row]):
            continue
        value = float(points[0, column] * problem.structure.scales[column])
        if is_singular and not _moves(mechanism, held | {label: value}, driver):
            continue
        motions = left
        held[label] = value
    return held


def _motions_near(problem: ClosureSystem, point: np.ndarray) -> np.ndarray:
    """An orthonormal basis (n, k) of the motions at a regular configuration: ``point``
    (n,) where it is one, else a configuration next to it.

    A singular one has motions to first order that lead nowhere: fewer motions next to
    it tell it.
    """
    ends = _next_to(problem, point)
    motions = _null_space(problem.jacobians(point[None])[0])
    for jacobian in problem.jacobians(ends):
        others = _null_space(jacobian)
        if 0 < others.shape[1] < motions.shape[1]:
            motions = others
    return motions


def _next_to(problem: ClosureSystem, point: np.ndarray) -> np.ndarray:
    """Closed configurations (k, n) next to a point (n,)."""
    rng = np.random.default_rng(0)
    starts = point + NEARBY * rng.normal(size=(STARTS, problem.n))
    ends, gaps = problem.project(starts)
    return ends[is_start_solved(gaps) & (problem.domain.excess(ends) <= 0.0)]


def _moves(mechanism: Mechanism, held: dict[str, float], driver: str) -> bool:
    """Whether a driver leaves the reference configuration with these variables held: at
    a singular one a joint may be held where it stops the others."""
    problem = ClosureSystem(mechanism.with_locks(held))
    column = [unknown.label for unknown in problem.structure.unknowns].index(driver)
    points, _ = problem.project(problem.reference[None])
    ends = _next_to(problem, points[0])
    way = np.abs(problem.domain.difference(ends, points[0]))[:, column]
    return not is_stopped(float(way.max(initial=0.0)))


def _null_space(matrix: np.ndarray) -> np.ndarray:
    """An orthonormal basis (n, k) of what a matrix (m, n) maps to zero."""
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(~is_dependent_constraint(values)))
    return right[rank:].T


def _stands_still(rates: np.ndarray) -> bool:
    return is_dependent_constraint(float(np.linalg.norm(rates)))
