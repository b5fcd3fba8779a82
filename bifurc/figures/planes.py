"""Curves in a plane of two unknowns, a torus where these are angles: which plane shows
most, and where lines break."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import cast

import numpy as np

from bifurc import torus
from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.checks import UnknownName, name_of
from bifurc.errors import ProblemError
from bifurc.figures.quantities import shown_unit

MOST_COMPARED = 24  # unknowns of which any two are a plane that may be chosen
MOST_FORMS_COMPARED = 60  # forms of which any two are told apart
SAMPLES = 72  # points on each form by which planes are compared
PIECE_POINTS = 12  # points drawn on each piece of a branch, at least
BRANCH_POINTS = 400  # points drawn on each branch, at least
CELLS = 24  # of the grid that measures coverage, along each axis
ON_EDGE = 1e-6  # of half a period, within which a point lies on an edge of the frame
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@dataclass(frozen=True)
class Scale:
    """How an unknown is drawn: ``factor`` to the shown unit, ``half`` of the period
    shown (inf where there is none) about its ``middle``, and the ``window`` of it, the
    whole period where there is none."""

    factor: float
    half: float
    label: str
    middle: float = 0.0
    window: tuple[float, float] | None = None

    @property
    def is_periodic(self) -> bool:
        """Whether the frame ends where the period does."""
        return bool(np.isfinite(self.half))

    @property
    def limits(self) -> tuple[float, float]:
        """The first and the last value that are shown, of an unknown with a period."""
        return self.window or (self.middle - self.half, self.middle + self.half)

    @property
    def is_degrees(self) -> bool:
        """Whether it is an angle that is divided by right angles."""
        return self.half == 180.0


@dataclass(frozen=True)
class Plane:
    """Two unknowns by their indices, with their scales."""

    horizontal: int
    vertical: int
    scales: tuple[Scale, Scale]

    def project(self, points: np.ndarray) -> np.ndarray:
        """The two unknowns (k, 2) of points (k, n), in their own units."""
        columns = points[:, self.horizontal], points[:, self.vertical]
        return np.stack(columns, axis=1)

    def spot(self, point: np.ndarray) -> np.ndarray:
        """Where in the frame (2,) a point (n,) is shown."""
        shown = place_in_frame(self.project(point[None]), self.scales)
        return np.asarray(shown[0])

    def copies(self, point: np.ndarray) -> np.ndarray:
        """All places (k, 2) where a point (n,) is shown: more than one on an edge."""
        return copies_in_frame(self.spot(point), self.scales)


def indices_of(
    atlas: Atlas, name: str, unknowns: Sequence[UnknownName | int], count: int
) -> list[int]:
    """The indices of ``count`` unknowns from their names or their numbers, which the
    user gave as ``name``; raises `ProblemError`."""
    indices = [_index_of(atlas, unknown) for unknown in unknowns]
    known = [index for index in indices if index is not None]
    if not len(set(known)) == len(indices) == count:
        names = ", ".join(atlas.names)
        allowed = (
            f"{count} of the unknowns {names}, numbered from 1 to {len(atlas.names)}"
        )
        raise ProblemError(name, list(unknowns), allowed)
    return known


def _index_of(atlas: Atlas, unknown: UnknownName | int) -> int | None:
    """The index of an unknown from its name, its symbol or its number; None where there
    is none."""
    name = name_of(unknown)
    if isinstance(name, str):
        return atlas.names.index(name) if name in atlas.names else None
    is_number = isinstance(name, int | np.integer) and 1 <= name <= len(atlas.names)
    return int(cast(int, name)) - 1 if is_number else None


def plane_of(
    atlas: Atlas,
    horizontal: int,
    vertical: int,
    window: tuple[float, float] | None = None,
) -> Plane:
    """The plane of two unknowns, given by their indices; ``window`` are the first and
    the last angle that are shown, in degrees."""
    scales = scale_of(atlas, horizontal, window), scale_of(atlas, vertical, window)
    return Plane(horizontal, vertical, scales)


def scale_of(
    atlas: Atlas, index: int, window: tuple[float, float] | None = None
) -> Scale:
    """Angles are shown in degrees, between those of a ``window`` where they have a
    period, everything else in its `shown_unit`."""
    name = atlas.names[index]
    period = float(atlas.periods[index])
    if name.startswith("theta"):
        name = "θ" + name.removeprefix("theta").translate(SUBSCRIPTS)
    if atlas.units[index] == "rad":
        factor, half, label = 180.0 / np.pi, 90.0 * period / np.pi, f"{name} (deg)"
        if window is None or not np.isfinite(half):
            return Scale(factor, half, label)
        return Scale(factor, half, label, 0.5 * (window[0] + window[1]), window)
    factor, unit = shown_unit(atlas, index)
    return Scale(factor, 0.5 * factor * period, f"{name} ({unit})" if unit else name)


def shown_branches(atlas: Atlas) -> list[Branch]:
    """The curves that are drawn: those of the forms, then those of near motions."""
    forms = [form.branch for form in atlas.forms]
    return forms + [near.branch for near in atlas.near_motions if near.branch]


def curve_points(branch: Branch) -> np.ndarray:
    """Points (k, n) along a whole branch, dense where its pieces are short; a closed
    one comes back to its start."""
    if len(branch.breaks) < 2:
        return np.empty((0, branch.n))
    grids = [np.linspace(0.0, branch.length, BRANCH_POINTS)]
    for start, end in zip(branch.breaks[:-1], branch.breaks[1:], strict=True):
        grids.append(np.linspace(start, end, PIECE_POINTS, endpoint=False))
    return branch(np.unique(np.concatenate(grids)))


# --- the frame ------------------------------------------------------------------------


def place_in_frame(points: np.ndarray, scales: Sequence[Scale]) -> np.ndarray:
    """Shown coordinates (k, m) of points (k, m), periodic ones within (-half, half] of
    the middle.

    A point on the lower edge, but for errors of its location, goes to the upper one.
    """
    periods = np.array([2 * scale.half for scale in scales])
    middles = np.array([scale.middle for scale in scales])
    factors = np.array([scale.factor for scale in scales])
    shown = torus.wrap(points * factors - middles, periods)
    is_on_lower_edge = shown < -0.5 * periods * (1 - ON_EDGE)
    return np.asarray(np.where(is_on_lower_edge, shown + periods, shown) + middles)


def copies_in_frame(spot: np.ndarray, scales: Sequence[Scale]) -> np.ndarray:
    """A place (m,) in the frame and its copies (k, m) on the opposite edges, where it
    lies on an edge."""
    coordinates = [_copies(x, scale) for x, scale in zip(spot, scales, strict=True)]
    return np.array(list(product(*coordinates)))


def _copies(x: float, scale: Scale) -> list[float]:
    """A coordinate, or both ends of the frame where it lies on one."""
    if not scale.is_periodic:
        return [x]
    to_edge = abs(abs(x - scale.middle) - scale.half)
    if to_edge < ON_EDGE * scale.half:
        return [scale.middle + scale.half, scale.middle - scale.half]
    return [x]


def cut_to_frame(points: np.ndarray, scales: tuple[Scale, Scale]) -> np.ndarray:
    """The curve through points (k, 2), as rows of shown coordinates with a row of NaN
    wherever the line breaks.

    Copies of the curve shifted by whole periods are laid over the frame and cut at its
    edges, so that a line leaves at one edge exactly where it comes back at the other.
    ``points`` are unwrapped, in the unknowns' own units.
    """
    middles = np.array([scale.middle for scale in scales])
    shown = points * [scale.factor for scale in scales] - middles
    half = np.array([scale.half for scale in scales])
    parts = []
    for dx in _shifts(shown[:, 0], scales[0]):
        for dy in _shifts(shown[:, 1], scales[1]):
            parts.append(_inside(shown + np.array([dx, dy]), half))
    return np.asarray(np.concatenate(parts) + middles)


def _shifts(x: np.ndarray, scale: Scale) -> np.ndarray:
    """By how much the copies of a curve are shifted that may reach into the frame, from
    one of its coordinates."""
    if not scale.is_periodic:
        return np.zeros(1)
    period = 2 * scale.half
    low = np.ceil(x.min() / period - 0.5 - ON_EDGE)
    high = np.floor(x.max() / period + 0.5 + ON_EDGE)
    return np.asarray(-period * np.arange(low, high + 1))


def _inside(points: np.ndarray, half: np.ndarray) -> np.ndarray:
    """The parts of a polyline within [-half, half], separated by rows of NaN."""
    start = points[:-1]
    step = np.diff(points, axis=0)
    enter, leave = _crossings(start, step, half * (1 + 1e-9))
    # a copy that touches the frame in a point only is not drawn
    shortest = 1e-7 * np.where(np.isfinite(half), half, 0.0).min()
    lengths = np.maximum(leave - enter, 0.0) * np.linalg.norm(step, axis=1)
    drawn = np.flatnonzero(lengths > shortest)
    rows = np.full(
        (len(drawn), 3, 2), np.nan
    )  # a break, where it enters, where it ends
    rows[:, 1] = start[drawn] + enter[drawn, None] * step[drawn]
    rows[:, 2] = start[drawn] + leave[drawn, None] * step[drawn]
    begins = np.ones(len(drawn), dtype=bool)
    begins[1:] = (np.diff(drawn) > 1) | (enter[drawn[1:]] > 0)
    is_needed = np.stack([begins, begins, np.ones_like(begins)], axis=1)
    return np.asarray(rows[is_needed])


def _crossings(
    start: np.ndarray, step: np.ndarray, edge: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """At which fractions (k,) of each step a line comes into the frame [-edge, edge]
    and leaves it; outside the first is not below the second."""
    with np.errstate(divide="ignore", invalid="ignore"):
        low = (-edge - start) / step
        high = (edge - start) / step
    # a step along an edge of the frame crosses neither of the two edges beside it
    still = step == 0
    outside = still & (np.abs(start) > edge)
    never = np.where(outside, np.inf, -np.inf)
    enter = np.where(still, never, np.fmin(low, high)).max(axis=1)
    leave = np.where(still, -never, np.fmax(low, high)).min(axis=1)
    return enter.clip(0.0), leave.clip(max=1.0)


# --- the choice of a plane ------------------------------------------------------------


def choose_plane(atlas: Atlas) -> tuple[int, int]:
    """Indices of the two unknowns whose plane tells the forms apart best.

    Five things count, each with a limit beyond which more of it does not help: the mean
    distance between the two forms that are closest, the extent of the smallest form
    (none should shrink to a dot), the opening of the narrowest form (none should be a
    line that goes there and back), the distance between the two bifurcations that are
    closest, and how much of the frame the forms cover. Of many forms and unknowns some
    are looked at, from the first to the last, and the parameter of the diagram.
    """
    n = len(atlas.names)
    branches = shown_branches(atlas)
    if n < 2 or not branches:
        return 0, min(1, n - 1)
    branches = branches[:: -(-len(branches) // MOST_FORMS_COMPARED)]
    samples = np.array([branch.sample(SAMPLES) for branch in branches])
    points = np.array([point.point.u for point in atlas.bifurcations]).reshape(-1, n)
    periodic = np.isfinite(atlas.periods)
    ranges = np.ptp(samples.reshape(-1, n), axis=0)
    size = np.where(periodic, atlas.periods, np.where(ranges > 0, ranges, 1.0))
    periods = np.where(periodic, 1.0, np.inf)  # in units of ``size``
    curves = samples / size
    spots = points / size
    extents = np.minimum(np.ptp(samples, axis=1) / size, 1.0)  # (forms, n)
    merits = {}
    for plane in combinations(compared_unknowns(atlas), 2):
        pick = list(plane)
        smallest_form = extents[:, pick].max(axis=1).min()
        form_distance = _closest_forms(curves[..., pick], periods[pick])
        openings = [_opening(curve, periods[pick]) for curve in curves[..., pick]]
        point_distance = _closest_points(spots[:, pick], periods[pick])
        merits[plane] = (
            min(form_distance / 0.12, 1.0)
            + min(smallest_form / 0.3, 1.0)
            + min(min(openings) / 0.05, 1.0)
            + 0.5 * min(point_distance / 0.05, 1.0)
            + 0.5 * _coverage(curves[..., pick])
        )
    best = max(merits.values())
    return next(plane for plane, merit in merits.items() if merit > best - 1e-3)


def compared_unknowns(atlas: Atlas) -> list[int]:
    """The numbers, in order, of the unknowns of which planes are compared."""
    n = len(atlas.names)
    some = np.linspace(0, n - 1, min(n, MOST_COMPARED)).round().astype(int)
    numbers = set(some.tolist())
    if atlas.diagram is not None and atlas.diagram.parameter:
        numbers.add(list(atlas.names).index(atlas.diagram.parameter))
    return sorted(numbers)


def _distances(a: np.ndarray, b: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """Distances (p, q) between points (p, 2) and (q, 2), modulo ``periods`` (2,)."""
    gaps = torus.difference(a[:, None], b, periods)
    return np.asarray(np.linalg.norm(gaps, axis=-1))


def _closest_forms(curves: np.ndarray, periods: np.ndarray) -> float:
    """Smallest mean distance from one curve to another, of curves (forms, k, 2)."""
    means = []
    for a, b in combinations(curves, 2):
        distances = _distances(a, b, periods)
        means.append(distances.min(axis=0).mean())
        means.append(distances.min(axis=1).mean())
    return float(min(means, default=1.0))


def _opening(curve: np.ndarray, periods: np.ndarray) -> float:
    """How far a curve (k, 2) stays from itself where it comes back, at most 1: the mean
    distance of its way there, from one end of its longer extent to the other, and the
    rest of it. It is 0 of a line that is followed there and back."""
    across = curve[:, np.argmax(np.ptp(curve, axis=0))]
    first, last = sorted((int(across.argmin()), int(across.argmax())))
    there = curve[first : last + 1]
    back = np.concatenate([curve[last:], curve[: first + 1]])
    distances = _distances(there, back, periods)
    mean = max(distances.min(axis=0).mean(), distances.min(axis=1).mean())
    return float(min(mean, 1.0))


def _closest_points(points: np.ndarray, periods: np.ndarray) -> float:
    """Smallest distance between two of the points (k, 2), at most 1."""
    distances = _distances(points, points, periods)
    pairs = np.triu_indices(len(points), 1)
    return float(distances[pairs].min(initial=1.0))


def _coverage(curves: np.ndarray) -> float:
    """Share of the cells of a coarse grid that the curves pass, at most 1 by their
    number of points."""
    fractions = curves.reshape(-1, 2) % 1.0
    cells = np.unique(np.floor(CELLS * fractions), axis=0)
    return len(cells) / (len(curves) * SAMPLES)
