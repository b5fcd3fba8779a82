"""Eigenvalues along a form: how many are unstable, and where that changes.

The equations without the parameter are taken as the right-hand sides of u' = F(u), in
the order of the unknowns. Between folds and singular points no real eigenvalue passes
zero: the number of unstable ones changes at Hopf points only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
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
NARROW = 1e-6  # of a form: so near to where it crosses an eigenvalue moves straight
UNEVEN = (
    0.4631  # of the width between two places, where the next one is: on no symmetry
)
CLEARLY = 0.3  # of the distance to the next: an eigenvalue moved from where it was
NEAREST = 1e-14  # of a form: nearer to a Hopf point rounding of its place decides
FARTHEST = 0.1  # of a form: an eigenvalue hidden as far as that does not cross there
RATE = 1e-10  # of a form, over which it is seen how fast eigenvalues move
STRIDE = 5  # of the nodes of a piece at which those of a large problem are computed
RESIDUAL = 1e-12  # over F' along a form: how well F = 0 holds there
LARGEST_ERROR = 1e-6  # of the sizes: a double curve is known to half of the digits
PROBE = 1e-6  # of the sizes: how far off a form entries of F' are compared
PROBES = 2  # directions in which they are
ENTRIES = 100_000  # of F' at so many places at once
ENTRY_ERROR = 8.0 * np.finfo(float).eps  # of an entry of F'
SMALLEST = np.finfo(float).tiny
SEED = 1


class HopfPlace(NamedTuple):
    """An arclength at which a pair of eigenvalues +-i ``frequency`` is imaginary, to
    ``error``; from there on it is unstable where ``is_unstable_after``, and before that
    else."""

    s: float
    frequency: float
    is_unstable_after: bool
    error: float


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
    views = [
        _view(spectrum, start, end, _places_between(start, end, nodes, imaginary))
        for start, end in pairwise(ends)
    ]
    crossings = _crossings(spectrum, views)
    places = [place.s + turn * branch.length for place in crossings for turn in (-1, 0)]
    stretches: list[Stretch] = []
    for start, end in pairwise(ends):
        between = sorted({s for s in places if start < s < end})
        stretches += _between(spectrum, form, [start, *between, end])
    hopf_places = [place for place in crossings if place.frequency > 0.0]
    return FormStability(stretches, hopf_places)


def _imaginary_places(spectrum: Spectrum) -> np.ndarray:
    """Arclengths (k,), in order, at which a pair of eigenvalues may be imaginary, of one
    turn and, of a closed form, of the next."""
    branch = spectrum.branch
    if spectrum.problem.n <= 2 or spectrum.problem.domain.is_large:
        return np.empty(0)
    ratios = spectrum.pair_sums(branch.places(NODES).ravel())
    neutral = int(np.median(np.count_nonzero(ratios == 0.0, axis=1)))

    def product_of_others(s: np.ndarray) -> np.ndarray:
        sums = spectrum.pair_sums(s)
        order = np.argsort(np.abs(sums), axis=1)[:, neutral:]
        others = np.take_along_axis(sums, order, axis=1)
        return np.asarray(np.prod(others, axis=1).real)

    zeros = zeros_along(branch, product_of_others, is_measured=False)
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


class _View(NamedTuple):
    """What is seen of the eigenvalues along a stretch: so many are ``neutral``, on the
    imaginary axis, and at ``places`` (k,) no others; there so many are unstable as
    ``numbers`` (k,) says."""

    places: np.ndarray
    numbers: np.ndarray
    neutral: int


def _view(spectrum: Spectrum, start: float, end: float, places: np.ndarray) -> _View:
    """What is seen of a stretch at ``places`` (k,)."""
    even = spectrum.counts(start + INNER * (end - start))
    neutral = int(np.median(even.on_axis))
    counts = spectrum.counts(places)
    is_clear = counts.on_axis == neutral
    return _View(places[is_clear], counts.unstable[is_clear], neutral)


class _Row(NamedTuple):
    """Places (k,) of all stretches of a form in order, the numbers (k,) of unstable and
    of ``neutral`` eigenvalues there, and the number (k,) of each ``stretch``."""

    places: np.ndarray
    numbers: np.ndarray
    neutral: np.ndarray
    stretch: np.ndarray


def _in_a_row(branch: Branch, views: Sequence[_View]) -> _Row:
    """The places of the ``views`` of all stretches, of a closed form with the first of
    them once more after a turn."""
    views = [one for one in views if len(one.places)]
    if branch.closed and views:
        first = views[0]
        once_more = first.places[:1] + branch.length
        views.append(_View(once_more, first.numbers[:1], first.neutral))
    counts = [len(one.places) for one in views]
    return _Row(
        places=np.concatenate([one.places for one in views] or [np.empty(0)]),
        numbers=np.concatenate([one.numbers for one in views] or [np.empty(0)]),
        neutral=np.repeat([one.neutral for one in views], counts),
        stretch=np.repeat(np.arange(len(views)), counts),
    )


def _crossings(spectrum: Spectrum, views: Sequence[_View]) -> list[HopfPlace]:
    """Where eigenvalues cross the axis, in order, between the places of the ``views`` of
    all stretches of a form.

    Of a large problem only where the number of unstable ones changes, by more than the
    one that a fold or a crossing of forms makes: two that cross in opposite directions
    between two of the places leave it as it is.
    """
    row = _in_a_row(spectrum.branch, views)
    is_cut = np.diff(row.stretch) != 0
    is_asked = np.diff(row.neutral) == 0
    if spectrum.problem.domain.is_large:
        is_asked &= np.abs(np.diff(row.numbers)) > is_cut
    asked = np.flatnonzero(is_asked)
    numbers = np.union1d(asked, asked + 1)
    sets = spectrum.moving(row.places[numbers], row.neutral[numbers])
    known = dict(zip(numbers.tolist(), sets, strict=True))
    crossings: list[HopfPlace] = []
    for k in asked.tolist():
        found = _between_sets(spectrum, known[k], known[k + 1])
        # real ones cross at folds and singular points
        crossings += [one for one in found if one.frequency > 0.0 or not is_cut[k]]
    return crossings


class MovingSet(NamedTuple):
    """The eigenvalues (q,) at arclength ``s``, and their derivatives (q,) by it as seen
    ``before`` and ``after``; those that are ``neutral`` (q,) stay on the axis."""

    s: float
    values: np.ndarray
    before: np.ndarray
    after: np.ndarray
    neutral: np.ndarray


def _between_sets(
    spectrum: Spectrum, low: MovingSet, high: MovingSet
) -> list[HopfPlace]:
    """Where eigenvalues cross the axis between two places, in order: between places as
    near to each other as it takes."""
    width = high.s - low.s
    moved = _moved(low, high)
    if width > NARROW * spectrum.branch.length:
        if not np.any(moved.has_crossed) and not moved.is_open:
            return []
        count = np.count_nonzero(low.neutral)
        at = np.array([low.s + UNEVEN * width])
        (middle,) = spectrum.moving(at, np.array([count]))
        before = _between_sets(spectrum, low, middle)
        return [*before, *_between_sets(spectrum, middle, high)]
    places = []
    crossed = moved.values[moved.has_crossed]
    for k in np.flatnonzero(moved.has_crossed & (moved.values.imag >= 0.0)):
        if moved.values[k].conj() not in crossed:
            # a real one that meets another between the places
            continue
        slope = (moved.values[k] - low.values[k]) / width
        s = low.s - float(low.values[k].real / slope.real)
        value = low.values[k] + (s - low.s) * slope
        places.append(_hopf_place(spectrum, s, value, slope))
    return sorted(places)


class _Moved(NamedTuple):
    """What eigenvalues (q,) at a place are at the next one: their ``values`` (q,), which
    of them have ``has_crossed`` (q,) the axis, and whether that ``is_open``."""

    values: np.ndarray
    has_crossed: np.ndarray
    is_open: bool


def _moved(low: MovingSet, high: MovingSet) -> _Moved:
    """What the eigenvalues at one place are at another.

    As a set they move steadily: each is followed to the next place along its
    derivative, and back. Derivatives are those away from there: two eigenvalues may
    meet between the places.
    """
    width = high.s - low.s
    forth = low.values + width * low.before
    back = high.values - width * high.after
    distances = np.abs(forth[:, None] - high.values)
    distances += np.abs(low.values[:, None] - back)
    partners = _partners(distances)
    values = high.values[partners]
    has_crossed = (low.values.real > 0.0) != (values.real > 0.0)
    has_crossed &= ~(low.neutral & high.neutral[partners])
    # a neutral one is on no side
    side = np.where(high.neutral, 0.0, np.sign(high.values.real))
    return _Moved(values, has_crossed, _is_open(distances, partners, side))


def _partners(distances: np.ndarray) -> np.ndarray:
    """Which of the others (q,) each of some things is, so that the ``distances`` (q, q)
    are small together."""
    partners: np.ndarray = distances.argmin(axis=1)
    if len(set(partners.tolist())) < len(partners):
        from scipy.optimize import linear_sum_assignment  # it takes long to import

        partners = linear_sum_assignment(distances)[1]
    return partners


def _is_open(distances: np.ndarray, partners: np.ndarray, side: np.ndarray) -> bool:
    """Whether one of the eigenvalues may as well be one on the other ``side`` (q,) of
    the axis: it is at ``distances`` (q, q) from them, and is taken for that of its
    ``partners`` (q,)."""
    is_other = side[partners][:, None] * side < 0.0
    nearest = np.where(is_other, distances, np.inf).min(axis=1)
    own = distances[np.arange(len(partners)), partners]
    return bool(np.any(own > CLEARLY * nearest))


def _hopf_place(
    spectrum: Spectrum, s: float, value: complex, slope: complex
) -> HopfPlace:
    """Where the eigenvalue next to a ``value`` at ``s``, that grows by a ``slope``,
    crosses the axis; frequency 0 for a real one."""
    values, errors = spectrum.with_errors(np.array([s]))
    nearest = int(np.argmin(np.abs(values[0] - value)))
    frequency = float(abs(values[0, nearest].imag))
    if is_real_crossing(frequency, max(float(errors[0, nearest]), SMALLEST)):
        frequency = 0.0
    closer = s - float(values[0, nearest].real / slope.real)
    error = _hidden_about(spectrum, closer, value) if frequency else 0.0
    return HopfPlace(closer, frequency, bool(slope.real > 0.0), error)


def _hidden_about(spectrum: Spectrum, s: float, value: complex) -> float:
    """The arclength to either side of ``s`` within which rounding hides on which side
    of the axis the eigenvalue next to a ``value`` is; to a factor of 4."""
    length = spectrum.branch.length
    width = NEAREST * length
    while width < FARTHEST * length:
        beside = spectrum.with_errors(s + width * np.array([-1.0, 1.0]))
        nearest = np.abs(beside.values - value).argmin(axis=1)[:, None]
        if not np.any(np.take_along_axis(beside.is_on_axis, nearest, axis=1)):
            break
        width *= 4.0
    return 0.0 if width == NEAREST * length else width


def _between(spectrum: Spectrum, form: int, ends: Sequence[float]) -> list[Stretch]:
    """The stretches between consecutive ``ends``, on each of which the number of
    unstable eigenvalues does not change; where rounding hides it between two of them,
    these are one."""
    views = [spectrum.counts(a + INNER * (b - a)) for a, b in pairwise(ends)]
    neutral = min(int(np.median(view.on_axis)) for view in views)
    stretches: list[Stretch] = []
    start = ends[0]
    for view, end in zip(views, ends[1:], strict=True):
        on_axis, number = int(np.median(view.on_axis)), int(np.median(view.unstable))
        if on_axis > neutral:
            continue
        quiet = Stability.NEUTRAL if on_axis else Stability.STABLE
        stability = Stability.UNSTABLE if number else quiet
        stretches.append(Stretch(form, start, end, stability, number))
        start = end
    stretches[-1] = replace(stretches[-1], end=ends[-1])
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

    def moving(self, s: np.ndarray, neutral: np.ndarray) -> list[MovingSet]:
        """The eigenvalues at arclengths (k,) and how fast they move, as far as that is
        seen next to them; so many (k,) as are ``neutral`` are those next to the axis."""
        sets: list[MovingSet] = []
        at_once = max(1, ENTRIES // self.problem.n**2)
        for first in range(0, len(s), at_once):
            places = s[first : first + at_once]
            beside = self._step * np.array([-1.0, 0.0, 1.0])
            values = self.eigenvalues((places[:, None] + beside).ravel())
            triples = values.reshape(len(places), 3, -1)
            counts = neutral[first : first + at_once]
            sets += map(self._moving_set, places, counts, triples)
        return sets

    @property
    def _step(self) -> float:
        return RATE * self.branch.length

    def _moving_set(self, s: float, neutral: int, triple: np.ndarray) -> MovingSet:
        """The set at an arclength, of eigenvalues (3, q) before it, there and after."""
        former, here, later = triple
        is_neutral = np.zeros(len(here), dtype=bool)
        if neutral:
            values, errors = self.with_errors(np.array([s]))
            here = values[0]
            parts = np.abs(here.real) / np.maximum(errors[0], SMALLEST)
            is_neutral[np.argsort(parts)[:neutral]] = True
        before = here - former[_partners(np.abs(here[:, None] - former))]
        after = later[_partners(np.abs(here[:, None] - later))] - here
        return MovingSet(
            float(s), here, before / self._step, after / self._step, is_neutral
        )

    def pair_sums(self, s: np.ndarray) -> np.ndarray:
        """The sums of any two eigenvalues over their sizes (k, pairs): their product is
        zero where a pair is imaginary (Guckenheimer, Myers and Sturmfels 1997), or two
        real ones are opposite."""
        values, errors = self.with_errors(s)
        first, second = np.triu_indices(values.shape[1], k=1)
        sums = values[:, first] + values[:, second]
        sizes = np.abs(values[:, first]) + np.abs(values[:, second])
        units = np.maximum(errors[:, first] + errors[:, second], SMALLEST)
        sums[is_on_axis(np.abs(sums), units)] = 0.0
        ratios: np.ndarray = sums / np.maximum(sizes, SMALLEST)
        return ratios

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
        return RESIDUAL / np.maximum(smallest, RESIDUAL / LARGEST_ERROR)


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
