"""The tangents of all curves through a singular point of a large problem.

With t the tangent of the branch and v_j the q null vectors across it, a curve
u = e (x t + V y) + e^2 z + ... through the point has

    x L y + Q(y, y) = 0,   L = W F''(t, V),   Q = W F''(V, V) / 2,

in which there is no square of x, as the branch itself, y = 0, solves it. For q = 1 that
is one line besides. For q = 2 the lines y lie where L^-1 Q(y, y) is parallel to y, on
which a binary form of degree 3 vanishes. Where Q vanishes, as symmetry makes it, x is
of second order and

    x L y + K(y, y, y) = 0,   K = W (F''(V y, z) + F'''(V y, V y, V y) / 6),
    F' z = -F''(V y, V y) / 2:

L^-1 K(y, y, y) is parallel to y, a binary form of degree 4 (Golubitsky, Stewart and
Schaeffer 1988, chapter XIII). A line of more than multiplicity one is for higher order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_without_crossing_speed, is_without_quadratic_terms
from bifurc.large.locators import LocatedCrossing
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.numerics.binary_forms import lines_of_binary_form, monomials, unit_vectors
from bifurc.singular.second_order import lines_of_form

# Angles on a half circle at which a cubic map of the plane is taken.
ANGLES = np.pi * np.array([0.05, 0.3, 0.55, 0.8])


class CrossingTangents(NamedTuple):
    """Unit tangents (k, n), first that of the branch, and the ``order`` of the
    derivatives of F that give the others, 0 where they give none."""

    directions: np.ndarray
    order: int


def tangents_at(
    problem: ScaledProblem, located: LocatedCrossing, tangent: np.ndarray
) -> CrossingTangents:
    """The tangents of the curves through a singular point of a branch with the unit
    ``tangent`` (n,) there: up to multiplicity 2."""
    only_own = CrossingTangents(tangent[None], 0)
    if located.multiplicity == 1:
        return _of_simple_point(located, tangent) or only_own
    if located.multiplicity == 2:
        return _of_double_point(problem, located, tangent) or only_own
    return only_own


def null_vectors_across(located: LocatedCrossing, tangent: np.ndarray) -> np.ndarray:
    """Orthonormal null vectors (q, n) of F' at a singular point, square to the
    ``tangent`` (n,) of a branch."""
    across: np.ndarray = located.basis @ _turned_basis(located, tangent)[:, 1:]
    return across.T


def _turned_basis(located: LocatedCrossing, tangent: np.ndarray) -> np.ndarray:
    """Orthonormal coordinates (q + 1, q + 1) in the null space, the first column those
    of the ``tangent`` (n,)."""
    own = located.basis.T @ tangent
    matrix = np.column_stack([own, np.eye(len(own))])
    turned, _ = np.linalg.qr(matrix)
    turned[:, 0] *= np.sign(turned[:, 0] @ own)
    return turned


def _of_simple_point(
    located: LocatedCrossing, tangent: np.ndarray
) -> CrossingTangents | None:
    """The tangents of both curves; None where second order shows no other."""
    lines = [located.basis @ line for line in lines_of_form(located.forms[0])]
    if len(lines) < 2:
        return None
    lines.sort(key=lambda line: -abs(float(line @ tangent)))
    own = lines[0] * np.sign(lines[0] @ tangent)
    return CrossingTangents(np.stack([own, lines[1]]), 2)


def _of_double_point(
    problem: ScaledProblem, located: LocatedCrossing, tangent: np.ndarray
) -> CrossingTangents | None:
    """The tangents of all curves; None where neither second nor third order gives
    them."""
    turn = _turned_basis(located, tangent)
    forms = turn.T @ located.forms @ turn  # (2, 3, 3)
    speeds = forms[:, 0, 1:]
    largest, smallest = np.linalg.svd(speeds, compute_uv=False)
    if is_without_crossing_speed(float(smallest), float(largest)):
        return None
    inverse = np.linalg.inv(speeds)
    across = forms[:, 1:, 1:]
    terms = np.stack([across[:, 0, 0], 2.0 * across[:, 0, 1], across[:, 1, 1]], axis=1)
    quadratic = 0.5 * inverse @ terms  # (2, 3)
    basis = located.basis @ turn
    if not is_without_quadratic_terms(float(np.linalg.norm(quadratic))):
        return _of_parallel_lines(basis, quadratic, 2)
    cubic = inverse @ _cubic_terms(problem, located, basis[:, 1:])
    return _of_parallel_lines(basis, cubic, 3)


def _of_parallel_lines(
    basis: np.ndarray, terms: np.ndarray, order: int
) -> CrossingTangents | None:
    """The tangents where a map of the plane with ``terms`` (2, order + 1) is parallel to
    its argument; the ``basis`` (n, 3) is that of the null space, the branch first."""
    form = np.append(0.0, terms[0]) - np.append(terms[1], 0.0)
    lines = lines_of_binary_form(form, float(np.linalg.norm(terms)))
    if lines is None:
        return None
    shares = np.zeros(len(lines))
    if order == 2:
        powers = monomials(lines, order)
        shares = -np.sum((powers @ terms.T) * lines, axis=1)
    vectors = np.column_stack([shares, lines]) @ basis.T
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return CrossingTangents(np.concatenate([basis.T[:1], vectors / lengths]), order)


def _cubic_terms(
    problem: ScaledProblem, located: LocatedCrossing, plane: np.ndarray
) -> np.ndarray:
    """Coefficients (2, 4) of K(y, y, y) for y in the ``plane`` (n, 2)."""
    point, left = located.point, located.left
    system = problem.bordered(point, located.basis.T, left.T)
    vectors = unit_vectors(ANGLES)
    values = []
    for along in vectors @ plane.T:
        bend = -0.5 * problem.second_derivative(point, along, along)
        right = np.concatenate([bend, np.zeros(located.basis.shape[1])])
        curved = system.solve(right)[: problem.n]
        mixed = problem.second_derivative(point, along, curved)
        values.append(left @ (mixed + problem.third_derivative(point, along) / 6.0))
    return np.linalg.solve(monomials(vectors, 3), np.array(values)).T
