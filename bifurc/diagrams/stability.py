"""Eigenvalues along a form: how many are unstable, and where that changes.

The equations without the parameter are taken as the right-hand sides of u' = F(u), in
the order of the unknowns. Between folds and singular points no real eigenvalue passes
zero: the number of unstable ones changes at Hopf points only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import NODES
from bifurc.decisions import is_on_axis, is_real_crossing
from bifurc.diagrams.diagram import Stability, Stretch
from bifurc.diagrams.zeros import zeros_along
from bifurc.problem import Problem

CLEAR_OF_CUTS = 1e-4  # of a stretch: nearer to its ends an eigenvalue may be about zero
INNER = np.linspace(0.1, 0.9, 9)  # places at which a short stretch is looked at as well
HALVINGS = 70  # of a bracket, down to rounding
ONE_CROSSING = 1e-6  # of a bracket: pairs that cross at less distance cross at once
STRIDE = 5  # of the nodes of a piece at which those of a large problem are computed
RESIDUAL = 1e-12  # over F' along a form: how well F = 0 holds there
LARGEST_ERROR = 1e-6  # of the sizes: a double curve is known to half of the digits
PROBE = 1e-6  # of the sizes: how far off a form entries of F' are compared
PROBES = 2  # directions in which they are
ENTRY_ERROR = 8.0 * np.finfo(float).eps  # of an entry of F'
SMALLEST = np.finfo(float).tiny
SEED = 1


class HopfPlace(NamedTuple):
    """An arclength at which a pair of eigenvalues +-i ``frequency`` is imaginary."""

    s: float
    frequency: float


@dataclass(frozen=True)
class FormStability:
    """The stretches of a form, in order, and its Hopf points."""

    stretches: list[Stretch]
    hopf_places: list[HopfPlace]


def has_square_rest(problem: Problem) -> bool:
    """Whether there are as many equations as unknowns besides a parameter."""
    middle = np.zeros((1, problem.n))
    return len(problem.residuals(middle)[0]) == problem.n - 1


def stability_along(
    spectrum: Spectrum, form: int, cuts: Sequence[float]
) -> FormStability:
    """The stretches of a form and its Hopf points.

    ``cuts`` are the arclengths of its folds and singular points.
    """
    branch = spectrum.branch
    ends = _ends(branch, cuts)
    nodes = _nodes(spectrum.problem, branch)
    imaginary = _imaginary_places(spectrum)
    stretches: list[Stretch] = []
    places: list[HopfPlace] = []
    for start, end in pairwise(ends):
        inner = _places_between(start, end, nodes, imaginary)
        counts = spectrum.counts(inner)
        is_clear = counts.on_axis == 0
        even = spectrum.counts(start + INNER * (end - start))
        if 2 * np.count_nonzero(even.on_axis) > len(INNER):
            number = int(np.median(even.unstable))
            stability = Stability.UNSTABLE if number else Stability.NEUTRAL
            stretches.append(Stretch(form, start, end, stability, number))
            continue
        crossings = _crossings(spectrum, inner[is_clear], counts.unstable[is_clear])
        places += [_hopf_place(spectrum, s) for s in crossings]
        stretches += _between(spectrum, form, [start, *crossings, end])
    hopf_places = [place for place in places if place.frequency > 0.0]
    return FormStability(stretches, hopf_places)


def _imaginary_places(spectrum: Spectrum) -> np.ndarray:
    """Arclengths (k,), in order, at which a pair of eigenvalues may be imaginary, of one
    turn and, of a closed form, of the next."""
    branch = spectrum.branch
    if spectrum.problem.n <= 2 or spectrum.problem.domain.is_large:
        return np.empty(0)
    zeros = zeros_along(branch, spectrum.pair_product, is_measured=False)
    places = np.array([s for zero in zeros.zeros for s in (zero.low, zero.high)])
    if branch.closed:
        places = np.concatenate([places, places + branch.length])
    return np.sort(places)


def unknown_stability(
    branch: Branch, form: int, cuts: Sequence[float]
) -> FormStability:
    """The stretches of a form of which no stability is defined."""
    pairs = pairwise(_ends(branch, cuts))
    stretches = [Stretch(form, *pair, Stability.UNKNOWN, -1) for pair in pairs]
    return FormStability(stretches, [])


def _ends(branch: Branch, cuts: Sequence[float]) -> list[float]:
    """Where stretches begin and end: at the cuts, and at the ends of an open form."""
    inner = sorted(float(s) for s in cuts if 0.0 <= s <= branch.length)
    if not branch.closed:
        inner = [0.0, *inner, branch.length]
    elif inner:
        inner.append(inner[0] + branch.length)
    else:
        inner = [0.0, branch.length]
    return [s for k, s in enumerate(inner) if k == 0 or s > inner[k - 1]]


def _nodes(problem: Problem, branch: Branch) -> np.ndarray:
    """Arclengths (k,), in order, of one turn and, of a closed form, of the next."""
    fractions = NODES[::STRIDE] if problem.domain.is_large else NODES
    nodes = branch.places(fractions).ravel()
    return np.concatenate([nodes, nodes + branch.length]) if branch.closed else nodes


def _places_between(
    start: float, end: float, nodes: np.ndarray, imaginary: np.ndarray
) -> np.ndarray:
    """Places (k,), in order, at which a stretch is looked at: between any two places at
    which a pair of eigenvalues may be ``imaginary`` (k,) there is one."""
    margin = CLEAR_OF_CUTS * (end - start)
    is_inside = (nodes > start + margin) & (nodes < end - margin)
    inner = start + INNER * (end - start)
    between = imaginary[(imaginary > start) & (imaginary < end)]
    marks = np.concatenate([[start], between, [end]])
    middles = 0.5 * (marks[:-1] + marks[1:])
    return np.unique(np.concatenate([nodes[is_inside], inner, middles]))


def _crossings(
    spectrum: Spectrum, places: np.ndarray, numbers: np.ndarray
) -> list[float]:
    """Arclengths, in order, at which the number of unstable eigenvalues changes, which
    is ``numbers`` (k,) at ``places`` (k,)."""
    crossings: list[float] = []
    for k in np.flatnonzero(np.diff(numbers)):
        low, high = places[k : k + 2]
        near = ONE_CROSSING * (high - low)
        before = numbers[k]
        while before != numbers[k + 1] and low < high:
            crossing = _first_change(spectrum, low, high, before)
            crossings.append(crossing)
            low = min(crossing + near, high)
            before = spectrum.numbers(np.array([low]))[0]
    return crossings


def _first_change(spectrum: Spectrum, low: float, high: float, before: int) -> float:
    """The first arclength between two, to rounding, at which the number of unstable
    eigenvalues is another than ``before``, which it is at ``low``."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if spectrum.numbers(np.array([middle]))[0] == before:
            low = middle
        else:
            high = middle
    return float(high)


def _hopf_place(spectrum: Spectrum, s: float) -> HopfPlace:
    """The pair of eigenvalues that crosses the axis at ``s``; frequency 0 for a real
    one."""
    values, errors = spectrum.with_errors(np.array([s]))
    nearest = int(np.argmin(np.abs(values[0].real)))
    frequency = float(abs(values[0, nearest].imag))
    if is_real_crossing(frequency, max(float(errors[0, nearest]), SMALLEST)):
        frequency = 0.0
    return HopfPlace(s, frequency)


def _between(spectrum: Spectrum, form: int, ends: Sequence[float]) -> list[Stretch]:
    """The stretches between consecutive ``ends``, on each of which the number of
    unstable eigenvalues does not change."""
    stretches = []
    for start, end in pairwise(ends):
        inner = start + INNER * (end - start)
        number = int(np.median(spectrum.counts(inner).unstable))
        stability = Stability.UNSTABLE if number else Stability.STABLE
        stretches.append(Stretch(form, start, end, stability, number))
    return stretches


# --- eigenvalues ----------------------------------------------------------------------


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
