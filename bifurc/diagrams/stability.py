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
from bifurc.problem import Problem

__all__ = [
    "FormStability",
    "HopfPlace",
    "has_square_rest",
    "stability_along",
    "unknown_stability",
]

CLEAR_OF_CUTS = 1e-4  # of a stretch: nearer to its ends an eigenvalue may be about zero
INNER = np.linspace(0.1, 0.9, 9)  # places at which a short stretch is looked at as well
HALVINGS = 70  # of a bracket, down to rounding
ONE_CROSSING = 1e-6  # of a bracket: pairs that cross at less distance cross at once
MANY_UNKNOWNS = 60  # from here on eigenvalues are computed at fewer places
STRIDE = 5  # of the nodes of a piece, for many unknowns


class HopfPlace(NamedTuple):
    """An arclength at which a pair of eigenvalues +-i ``frequency`` is imaginary."""

    s: float
    frequency: float


@dataclass(frozen=True)
class FormStability:
    """The stretches of a form, in order, and its Hopf points."""

    stretches: list[Stretch]
    hopf_places: list[HopfPlace]


class _Counts(NamedTuple):
    """Of the eigenvalues at places (k,): how many are ``unstable`` (k,), and how many
    lie ``on_axis`` (k,), as far as rounding tells."""

    unstable: np.ndarray
    on_axis: np.ndarray


@dataclass(frozen=True)
class _Spectrum:
    """The eigenvalues along a branch, the unknown number ``parameter`` held."""

    problem: Problem
    branch: Branch
    parameter: int

    def eigenvalues(self, s: np.ndarray) -> np.ndarray:
        """Eigenvalues (k, n - 1) at arclengths (k,)."""
        jacobians = self.problem.jacobians(self.branch(s))
        rest = np.delete(jacobians, self.parameter, axis=2)
        return np.asarray(np.linalg.eigvals(rest))

    def counts(self, s: np.ndarray) -> _Counts:
        """How many are unstable at arclengths (k,), and how many on the axis."""
        values = self.eigenvalues(s)
        largest = np.abs(values).max(axis=1, keepdims=True)
        unit = np.broadcast_to(largest, values.shape)
        on_axis = is_on_axis(np.abs(values.real), unit) | (largest == 0.0)
        unstable = (values.real > 0.0) & ~on_axis
        return _Counts(unstable.sum(axis=1), on_axis.sum(axis=1))

    def numbers(self, s: np.ndarray) -> np.ndarray:
        """How many are unstable (k,) by their signs alone."""
        return np.asarray((self.eigenvalues(s).real > 0.0).sum(axis=1))


def has_square_rest(problem: Problem) -> bool:
    """Whether there are as many equations as unknowns besides a parameter."""
    middle = np.zeros((1, problem.n))
    return len(problem.residuals(middle)[0]) == problem.n - 1


def stability_along(
    problem: Problem, branch: Branch, form: int, parameter: int, cuts: Sequence[float]
) -> FormStability:
    """The stretches of a form and its Hopf points.

    ``cuts`` are the arclengths of its folds and singular points, ``parameter`` is the
    index of the unknown that is held.
    """
    spectrum = _Spectrum(problem, branch, parameter)
    ends = _ends(branch, cuts)
    nodes = _nodes(problem, branch)
    stretches: list[Stretch] = []
    places: list[HopfPlace] = []
    for start, end in pairwise(ends):
        inner = _places_between(start, end, nodes)
        counts = spectrum.counts(inner)
        is_clear = counts.on_axis == 0
        if 2 * np.count_nonzero(is_clear) < len(inner):
            number = int(np.median(counts.unstable))
            stability = Stability.UNSTABLE if number else Stability.NEUTRAL
            stretches.append(Stretch(form, start, end, stability, number))
            continue
        crossings = _crossings(spectrum, inner[is_clear], counts.unstable[is_clear])
        places += [_hopf_place(spectrum, s) for s in crossings]
        stretches += _between(spectrum, form, [start, *crossings, end])
    hopf_places = [place for place in places if place.frequency > 0.0]
    return FormStability(stretches, hopf_places)


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
    fractions = NODES if problem.n <= MANY_UNKNOWNS else NODES[::STRIDE]
    nodes = branch.places(fractions).ravel()
    return np.concatenate([nodes, nodes + branch.length]) if branch.closed else nodes


def _places_between(start: float, end: float, nodes: np.ndarray) -> np.ndarray:
    """Places (k,), in order, at which a stretch is looked at."""
    margin = CLEAR_OF_CUTS * (end - start)
    is_inside = (nodes > start + margin) & (nodes < end - margin)
    inner = start + INNER * (end - start)
    return np.unique(np.concatenate([nodes[is_inside], inner]))


class _Bracket(NamedTuple):
    """Two arclengths, and the different numbers of unstable eigenvalues there."""

    low: float
    high: float
    before: int
    after: int


def _crossings(
    spectrum: _Spectrum, places: np.ndarray, numbers: np.ndarray
) -> list[float]:
    """Arclengths, in order, at which the number of unstable eigenvalues changes, which
    is ``numbers`` (k,) at ``places`` (k,)."""
    crossings: list[float] = []
    for k in np.flatnonzero(np.diff(numbers)):
        bracket = _Bracket(places[k], places[k + 1], numbers[k], numbers[k + 1])
        while bracket.before != bracket.after and bracket.low < bracket.high:
            crossing = _first_change(spectrum, bracket)
            crossings.append(crossing)
            width = places[k + 1] - places[k]
            low = min(crossing + ONE_CROSSING * width, bracket.high)
            before = int(spectrum.numbers(np.array([low]))[0])
            bracket = bracket._replace(low=low, before=before)
    return crossings


def _first_change(spectrum: _Spectrum, bracket: _Bracket) -> float:
    """The arclength, to rounding, at which the number of unstable eigenvalues first is
    another than where a bracket begins."""
    low, high = bracket.low, bracket.high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if spectrum.numbers(np.array([middle]))[0] == bracket.before:
            low = middle
        else:
            high = middle
    return float(high)


def _hopf_place(spectrum: _Spectrum, s: float) -> HopfPlace:
    """The pair of eigenvalues that crosses the axis at ``s``; frequency 0 for a real
    one."""
    values = spectrum.eigenvalues(np.array([s]))[0]
    nearest = values[np.argmin(np.abs(values.real))]
    frequency = float(abs(nearest.imag))
    if is_real_crossing(frequency, float(np.abs(values).max())):
        frequency = 0.0
    return HopfPlace(s, frequency)


def _between(spectrum: _Spectrum, form: int, ends: Sequence[float]) -> list[Stretch]:
    """The stretches between consecutive ``ends``, on each of which the number of
    unstable eigenvalues does not change."""
    stretches = []
    for start, end in pairwise(ends):
        inner = start + INNER * (end - start)
        number = int(np.median(spectrum.counts(inner).unstable))
        stability = Stability.UNSTABLE if number else Stability.STABLE
        stretches.append(Stretch(form, start, end, stability, number))
    return stretches
