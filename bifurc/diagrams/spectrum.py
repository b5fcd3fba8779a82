"""Eigenvalues along a form, with what rounding makes of each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_on_axis
from bifurc.problem import Problem

RESIDUAL = 1e-12  # over F' along a form: how well F = 0 holds there
LARGEST_ERROR = 1e-6  # of the sizes: a double curve is known to half of the digits
PROBE = 1e-6  # of the sizes: how far off a form entries of F' are compared
PROBES = 2  # directions in which they are
ENTRY_ERROR = 8.0 * np.finfo(float).eps  # of an entry of F'
SMALLEST = np.finfo(float).tiny
SEED = 1


class Eigenvalues(NamedTuple):
    """Eigenvalues (k, q) at k places, and the ``errors`` (k, q) that rounding and the
    place make."""

    values: np.ndarray
    errors: np.ndarray

    @property
    def is_on_axis(self) -> np.ndarray:
        """Which of them (k, q) may have no real part."""
        units = np.maximum(self.errors, SMALLEST)
        on_axis: np.ndarray = is_on_axis(np.abs(self.values.real), units)
        return on_axis


class Counts(NamedTuple):
    """Of the eigenvalues at places (k,): how many are ``unstable`` (k,), and how many
    lie ``on_axis`` (k,), as far as rounding tells."""

    unstable: np.ndarray
    on_axis: np.ndarray


@dataclass(frozen=True)
class Spectrum:
    """The eigenvalues along a branch, the unknown number ``parameter`` held; ``sizes``
    (n,) are those of the unknowns."""

    problem: Problem
    branch: Branch
    parameter: int
    sizes: np.ndarray

    def eigenvalues(self, s: np.ndarray) -> np.ndarray:
        """Eigenvalues (k, n - 1) at arclengths (k,)."""
        matrices = self._rest(self.problem.jacobians(self.branch(s)))
        return np.asarray(np.linalg.eigvals(matrices))

    def with_errors(self, s: np.ndarray) -> Eigenvalues:
        """Eigenvalues at arclengths (k,).

        To first order an eigenvalue changes by w dA v, with its right and left vectors;
        by entries that does not depend on the units of the unknowns. Where it is
        multiple that says too much, and it changes by a root of what A does.
        """
        points = self.branch(s)
        jacobians = self.problem.jacobians(points)
        matrices = self._rest(jacobians)
        changes = self._changes(points, jacobians)
        values, right = np.linalg.eig(matrices)
        left = _inverses(right)
        with np.errstate(over="ignore", invalid="ignore"):
            errors = np.einsum(
                "kij,kjl,kli->ki", np.abs(left), changes, np.abs(right), optimize=True
            )
        errors = np.where(np.isfinite(errors), errors, np.inf)
        return Eigenvalues(
            values, np.minimum(errors, _roots(matrices, changes, values))
        )

    def counts(self, s: np.ndarray) -> Counts:
        """How many are unstable at arclengths (k,), and how many on the axis."""
        eigenvalues = self.with_errors(s)
        on_axis = eigenvalues.is_on_axis
        unstable = (eigenvalues.values.real > 0.0) & ~on_axis
        return Counts(unstable.sum(axis=1), on_axis.sum(axis=1))

    def numbers(self, s: np.ndarray) -> np.ndarray:
        """How many are unstable (k,) by their signs alone."""
        return np.asarray((self.eigenvalues(s).real > 0.0).sum(axis=1))

    def pair_product(self, s: np.ndarray) -> np.ndarray:
        """The product (k,) over all pairs of eigenvalues of their sum over their sizes:
        zero where a pair is imaginary (Guckenheimer, Myers and Sturmfels 1997), or two
        real ones are opposite."""
        values, errors = self.with_errors(s)
        first, second = np.triu_indices(values.shape[1], k=1)
        sums = values[:, first] + values[:, second]
        sizes = np.abs(values[:, first]) + np.abs(values[:, second])
        units = np.maximum(errors[:, first] + errors[:, second], SMALLEST)
        sums[is_on_axis(np.abs(sums), units)] = 0.0
        ratios = sums / np.maximum(sizes, SMALLEST)
        return np.asarray(np.prod(ratios, axis=1).real)

    def _rest(self, jacobians: np.ndarray) -> np.ndarray:
        """F' without the parameter (k, q, q)."""
        return np.delete(jacobians, self.parameter, axis=2)

    def _changes(self, points: np.ndarray, jacobians: np.ndarray) -> np.ndarray:
        """How much the entries of F' without the parameter (k, q, q) may be off."""
        rng = np.random.default_rng(SEED)
        matrices = self._rest(jacobians)
        changes: np.ndarray = ENTRY_ERROR * np.abs(matrices)
        share = (self._place_errors(jacobians) / PROBE)[:, None, None]
        for _ in range(PROBES):
            signs = rng.choice([-1.0, 1.0], size=len(self.sizes))
            beside = points + PROBE * self.sizes * signs
            difference = self._rest(self.problem.jacobians(beside)) - matrices
            change = np.abs(difference) * share
            changes += np.where(np.isfinite(change), change, 0.0)
        return changes

    def _place_errors(self, jacobians: np.ndarray) -> np.ndarray:
        """How far (k,) the form may be off, over the sizes of the unknowns: what is left
        of F over the smallest regular singular value."""
        scaled = jacobians * self.sizes
        rows = np.abs(scaled).max(axis=(0, 2), keepdims=True)
        scaled = scaled / np.maximum(rows, SMALLEST)
        values = np.linalg.svd(np.nan_to_num(scaled), compute_uv=False)
        smallest = np.minimum(values[:, -1], 1.0)
        errors: np.ndarray = RESIDUAL / np.maximum(smallest, RESIDUAL / LARGEST_ERROR)
        return errors


def _inverses(matrices: np.ndarray) -> np.ndarray:
    """Inverses (k, q, q), infinite where there is none."""
    try:
        return np.asarray(np.linalg.inv(matrices))
    except np.linalg.LinAlgError:
        inverses = np.full(matrices.shape, np.inf, dtype=complex)
        for k, matrix in enumerate(matrices):
            if np.linalg.matrix_rank(matrix) == len(matrix):
                inverses[k] = np.linalg.inv(matrix)
        return inverses


def _roots(matrices: np.ndarray, changes: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The most (k, q) by which multiple eigenvalues may be off: the root of the change
    of a matrix, over its size, of the order of its size."""
    q = matrices.shape[1]
    size = np.linalg.norm(matrices, axis=(1, 2))
    change = np.linalg.norm(changes, axis=(1, 2))
    share = change / np.maximum(size, SMALLEST)
    largest: np.ndarray = size * np.minimum(share, 1.0) ** (1.0 / q)
    return np.broadcast_to(largest[:, None], values.shape)
