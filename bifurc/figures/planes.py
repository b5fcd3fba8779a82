"""Curves in a plane of two unknowns, a torus where these are angles: which plane shows
most, where lines break."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch

__all__ = [
    "Scale",
    "choose_plane",
    "copies_in_frame",
    "curve_points",
    "cut_to_frame",
    "place_in_frame",
    "scale_of",
]

SAMPLES = 72  # points on each form by which planes are compared
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@dataclass(frozen=True)
class Scale:
    """How an unknown is drawn: ``factor`` to the shown unit, ``half`` of the period
    shown (inf where there is none)."""

    factor: float
    half: float
    label: str


def scale_of(atlas: Atlas, index: int) -> Scale:
    """Angles with a period are shown in degrees, everything else as it is."""
    name, unit, period = (
        atlas.names[index],
        atlas.units[index],
        float(atlas.periods[index]),
    )
    pretty = "θ" + name[5:].translate(SUBSCRIPTS) if name.startswith("theta") else name
    if unit == "rad" and np.isfinite(period):
        return Scale(180.0 / np.pi, 90.0 * period / np.pi, f"{pretty} (deg)")
    return Scale(1.0, 0.5 * period, f"{pretty} ({unit})" if unit else pretty)


def curve_points(branch: Branch) -> np.ndarray:
    """Points (k, n) along a whole branch, dense where its pieces are short; a closed
    one comes back to its start."""
    inner = [
        np.linspace(a, b, 12, endpoint=False)
        for a, b in zip(branch.breaks[:-1], branch.breaks[1:], strict=True)
    ]
    even = np.linspace(0.0, branch.length, 400)
    return (
        branch(np.union1d(np.concatenate(inner), even))
        if inner
        else np.empty((0, branch.n))
    )


# --- the frame ----------------------------------------------------------------------------------------


def place_in_frame(points: np.ndarray, scales: tuple[Scale, Scale]) -> np.ndarray:
    """Shown coordinates (k, 2) of points (k, 2), periodic ones within (-half, half]."""
    out = points * [scale.factor for scale in scales]
    for i, scale in enumerate(scales):
        if np.isfinite(scale.half):
            out[:, i] -= (
                2
                * scale.half
                * np.ceil((out[:, i] - scale.half) / (2 * scale.half) - 1e-9)
            )
    return out


def copies_in_frame(point: np.ndarray, scales: tuple[Scale, Scale]) -> np.ndarray:
    """A point (2,) of the frame and its copies (k, 2) on the opposite edges, where it
    lies on an edge."""
    choices = []
    for x, scale in zip(point, scales, strict=True):
        on_edge = (
            np.isfinite(scale.half) and abs(abs(x) - scale.half) < 1e-6 * scale.half
        )
        choices.append([scale.half, -scale.half] if on_edge else [x])
    return np.array([[x, y] for x in choices[0] for y in choices[1]])


def cut_to_frame(points: np.ndarray, scales: tuple[Scale, Scale]) -> np.ndarray:
    """The curve through points (k, 2), as rows of shown coordinates with a row of NaN
    wherever the line breaks.

    Copies of the curve shifted by whole periods are laid over the frame and cut at its
    edges, so that a line leaves at one edge exactly where it comes back at the other.
    ``points`` are unwrapped, in the unknowns' own units.
    """
    shown = points * [scale.factor for scale in scales]
    shifts: list[np.ndarray] = []
    for x, scale in zip(shown.T, scales, strict=True):
        if not np.isfinite(scale.half):
            shifts.append(np.zeros(1))
            continue
        low, high = (np.round(edge / (2 * scale.half)) for edge in (x.min(), x.max()))
        shifts.append(-2 * scale.half * np.arange(low - 1, high + 2))
    half = np.array([scale.half for scale in scales])
    parts = [
        _inside(shown + np.array([dx, dy]), half)
        for dx in shifts[0]
        for dy in shifts[1]
    ]
    return np.concatenate(parts)


def _inside(points: np.ndarray, half: np.ndarray) -> np.ndarray:
    """The parts of a polyline within [-half, half], separated by rows of NaN."""
    edge = half * (1 + 1e-9)
    start, step = points[:-1], np.diff(points, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        one, two = (-edge - start) / step, (edge - start) / step
    still = step == 0
    outside = still & (np.abs(start) > edge)
    enter = (
        np.where(still, np.where(outside, np.inf, -np.inf), np.fmin(one, two))
        .max(axis=1)
        .clip(0.0)
    )
    leave = (
        np.where(still, np.where(outside, -np.inf, np.inf), np.fmax(one, two))
        .min(axis=1)
        .clip(max=1.0)
    )
    shortest = (
        1e-7 * np.where(np.isfinite(half), half, 0.0).min()
    )  # drops copies that touch the frame in a point
    seen = np.flatnonzero(
        np.maximum(leave - enter, 0.0) * np.linalg.norm(step, axis=1) > shortest
    )
    rows: list[np.ndarray] = []
    last = -2
    for i in seen.tolist():
        if i != last + 1 or enter[i] > 0:
            rows += [np.full(2, np.nan), start[i] + enter[i] * step[i]]
        rows.append(start[i] + leave[i] * step[i])
        last = i
    return np.array(rows).reshape(-1, 2)


# --- the choice of a plane ----------------------------------------------------------------------------


def choose_plane(atlas: Atlas) -> tuple[int, int]:
    """Indices of the two unknowns whose plane tells the forms apart best.

    Four things count, each with a limit beyond which more of it does not help: the mean
    distance between the two forms that are closest, the extent of the smallest form
    (none should shrink to a dot), the distance between the two bifurcations that are
    closest, and how much of the frame the forms cover.
    """
    n = len(atlas.names)
    if n < 2 or not atlas.forms:
        return 0, min(1, n - 1)
    samples = np.array([form.branch.sample(SAMPLES) for form in atlas.forms])
    points = np.array([point.point.u for point in atlas.bifurcations]).reshape(-1, n)
    ranges = np.ptp(samples.reshape(-1, n), axis=0)
    size = np.where(
        np.isfinite(atlas.periods), atlas.periods, np.where(ranges > 0, ranges, 1.0)
    )
    extents = np.minimum(np.ptp(samples, axis=1) / size, 1.0)  # (forms, n)
    merits = {}
    for plane in combinations(range(n), 2):
        pick = list(plane)
        curves = samples[..., pick] / size[pick]
        wraps = np.isfinite(atlas.periods[pick])
        merits[plane] = (
            min(_closest_forms(curves, wraps) / 0.12, 1.0)
            + min(extents[:, pick].max(axis=1).min() / 0.3, 1.0)
            + 0.5
            * min(_closest_points(points[:, pick] / size[pick], wraps) / 0.05, 1.0)
            + 0.5 * _coverage(curves)
        )
    best = max(merits.values())
    return next(plane for plane, merit in merits.items() if merit > best - 1e-3)


def _gaps(a: np.ndarray, b: np.ndarray, wraps: np.ndarray) -> np.ndarray:
    """Distances (p, q) between points (p, 2) and (q, 2), modulo 1 where ``wraps`` says
    so."""
    gap = a[:, None] - b
    return np.linalg.norm(gap - wraps * np.round(gap), axis=-1)


def _closest_forms(curves: np.ndarray, wraps: np.ndarray) -> float:
    """Smallest mean distance from one curve to another."""
    means = []
    for a, b in combinations(curves, 2):
        gap = _gaps(a, b, wraps)
        means.append(min(gap.min(axis=0).mean(), gap.min(axis=1).mean()))
    return float(min(means, default=1.0))


def _closest_points(points: np.ndarray, wraps: np.ndarray) -> float:
    gap = _gaps(points, points, wraps)
    return float(gap[np.triu_indices(len(points), 1)].min(initial=1.0))


def _coverage(curves: np.ndarray) -> float:
    """Share of the cells of a coarse grid that the curves pass, at most 1 by their
    number of points."""
    cells = np.unique(np.floor(24 * (curves.reshape(-1, 2) % 1.0)), axis=0)
    return len(cells) / (len(curves) * SAMPLES)
