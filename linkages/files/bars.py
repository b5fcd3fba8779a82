"""Planar mechanisms given as points and bars between them.

Every bar is a body, and so is the frame, which holds the fixed points. A point is a
revolute joint of all bodies that it lies on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from linkages.decisions import is_bar_assembled
from linkages.files.figure_bodies import (
    Piece,
    bodies_of_figure,
    check_held,
    check_point,
    read_fixed,
)
from linkages.files.joined_names import check_joined_names, joined_name
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.origin import Coordinates, counted_from_near, origin_of
from linkages.values import GeometryError, check_number, quoted

Content: TypeAlias = Mapping[str, Any]

POLISHING_STEPS = 12
EPSILON = float(np.finfo(float).eps)
ROUNDING = 16 * EPSILON  # of a length, over the extent
NEAR_SINGULAR = 1e-3  # singular value, and way to the singular assembly, to look for it
RANK = 1e-9  # singular value, over the largest, of a motion: no step along it
TINY = 1e-300  # length of a bar that has none


@dataclass(frozen=True)
class Bar:
    """A bar between two points, with the ``length`` that is given for it."""

    start: str
    end: str
    length: float | None = None

    @property
    def name(self) -> str:
        """What the body is called."""
        return joined_name(self.start, self.end)


@dataclass(frozen=True)
class PointOnBar:
    """A point start + ratio (end - start), as complex numbers."""

    start: str
    end: str
    ratio: complex


@dataclass(frozen=True)
class _Bars:
    """What a file says: places of ``points``, which of them are ``fixed``, ``bars``,
    and the points ``on_bars``, in an order in which each follows its bar's ends."""

    points: dict[str, complex]
    fixed: tuple[str, ...]
    bars: tuple[Bar, ...]
    on_bars: dict[str, PointOnBar]


def read_bars(content: Content, name: str) -> Mechanism:
    """The mechanism of the points and bars of a file.

    Where lengths are given that the points do not fit, the points are moved until they
    do (least squares). Raises `GeometryError` for anything wrong, and where bars of
    these lengths cannot be assembled next to the points.
    """
    points, near = _read_points(content)
    on_bars = _read_points_on_bars(content, points)
    known = [*points, *on_bars]
    fixed = read_fixed(content, known)
    bars = _read_bars(content, known)
    system = _Bars(points, fixed, bars, on_bars)
    places = _assembled(system)
    joints = _joints(system, places)
    check_held(fixed, joints)
    return Mechanism(
        tuple(joints),
        name,
        is_planar=True,
        origin=origin_of(content, near.origin),
        rounding=near.rounding,
    )


# --- keys -----------------------------------------------------------------------------


def _read_points(content: Content) -> tuple[dict[str, complex], Coordinates]:
    """The points, and their coordinates as they are counted from near."""
    table = content.get("points")
    if not isinstance(table, Mapping) or not table:
        raise GeometryError("points", quoted(table), "a table of points [x, y]")
    near = counted_from_near(list(table.values()))
    places = dict(zip(table, near.rows, strict=True))
    points = {name: _complex(f"point {name}", row) for name, row in places.items()}
    return points, near


def _complex(what: str, row: object) -> complex:
    if not isinstance(row, list) or len(row) != 2:
        raise GeometryError(what, quoted(row), "a list of two numbers")
    for value in row:
        check_number(what, value)
    return complex(float(row[0]), float(row[1]))


def _read_points_on_bars(
    content: Content, points: dict[str, complex]
) -> dict[str, PointOnBar]:
    table = content.get("points_on_bars", {})
    if not isinstance(table, Mapping):
        allowed = 'a table of points ["A", "B", [re, im]]'
        raise GeometryError("points_on_bars", quoted(table), allowed)
    on_bars: dict[str, PointOnBar] = {}
    for name, row in table.items():
        what = f"points_on_bars {name}"
        if name in points:
            raise GeometryError(what, quoted(name), "no name of a point in [points]")
        if not isinstance(row, list) or len(row) != 3:
            raise GeometryError(what, quoted(row), 'a list ["A", "B", [re, im]]')
        for end in row[:2]:
            if end not in points and end not in on_bars:
                raise GeometryError(what, quoted(end), "a point that stands before it")
        on_bars[name] = PointOnBar(row[0], row[1], _complex(what, row[2]))
    return on_bars


def _read_bars(content: Content, known: Sequence[str]) -> tuple[Bar, ...]:
    rows = content.get("bars")
    if not isinstance(rows, list) or not rows:
        raise GeometryError("bars", quoted(rows), 'a list of bars ["A", "B"]')
    bars: list[Bar] = []
    for number, row in enumerate(rows, start=1):
        what = f"bars[{number}]"
        if not isinstance(row, list) or len(row) not in (2, 3):
            raise GeometryError(what, quoted(row), '["A", "B"] or ["A", "B", length]')
        for name in row[:2]:
            check_point(what, name, known)
        if row[0] == row[1]:
            raise GeometryError(what, row[:2], "a bar between two points")
        if any({bar.start, bar.end} == set(row[:2]) for bar in bars):
            raise GeometryError(what, row[:2], "a bar that stands there once")
        length = None
        if len(row) == 3:
            check_number(f"length of {what}", row[2])
            length = float(row[2])
            if not length > 0:
                raise GeometryError(f"length of {what}", length, "positive")
        bars.append(Bar(row[0], row[1], length))
    check_joined_names("bar", [(bar.start, bar.end) for bar in bars])
    return tuple(bars)


# --- assembly -------------------------------------------------------------------------


def _places(system: _Bars, points: Mapping[str, complex]) -> dict[str, complex]:
    """The places of all points, those on bars among them."""
    places = dict(points)
    for name, one in system.on_bars.items():
        start, end = places[one.start], places[one.end]
        places[name] = start + one.ratio * (end - start)
    return places


def _assembled(system: _Bars) -> dict[str, complex]:
    """The places of all points where every bar has its length."""
    places = _places(system, system.points)
    size = max(abs(place - next(iter(places.values()))) for place in places.values())
    misfit = np.abs(_misfits(system, places)).max(initial=0.0)
    if misfit == 0.0:
        return places
    free = [name for name in system.points if name not in system.fixed]
    places = _least_squares(system, free)
    misfits = np.abs(_misfits(system, places))
    if not is_bar_assembled(float(misfits.max()), size):
        given = [bar for bar in system.bars if bar.length is not None]
        worst = given[int(np.argmax(misfits))]
        allowed = (
            "such that the bars can be assembled next to the points; as near as they "
            f"come, bar {worst.name} misses its length by {misfits.max():.3g}"
        )
        raise GeometryError(f"length of bar {worst.name}", worst.length, allowed)
    return places


def _misfits(system: _Bars, places: Mapping[str, complex]) -> np.ndarray:
    """How much longer than given the bars (k,) are that have a length."""
    misfits = []
    for bar in system.bars:
        if bar.length is not None:
            misfits.append(abs(places[bar.end] - places[bar.start]) - bar.length)
    # the lengths of bars without one are those that they have at first
    return np.array(misfits)


def _least_squares(system: _Bars, free: Sequence[str]) -> dict[str, complex]:
    """The places of all points where the lengths of all bars are best fitted."""
    if not free:
        return _places(system, system.points)
    from scipy.optimize import least_squares

    shape = _Shape(system, free)
    start = _pairs(np.array([system.points[name] for name in free]))
    exact = {"ftol": EPSILON, "xtol": EPSILON, "gtol": EPSILON}
    solution = least_squares(shape.gaps, start, shape.derivatives, **exact).x
    solution = _polished(shape, solution)
    moved = zip(free, _complex_numbers(solution), strict=True)
    points = dict(system.points) | {name: complex(place) for name, place in moved}
    return _places(system, points)


def _polished(shape: _Shape, solution: np.ndarray) -> np.ndarray:
    """The places (2 k,) with the gaps of a ``solution`` or with smaller ones.

    Newton's method closes gaps to rounding where the assembly is regular. Where it is
    singular, as with bars that are just long enough, gaps of 1e-16 leave points 1e-8
    beside it, and the bars would have a motion of that size: there the singular
    assembly itself is solved for.
    """
    for _ in range(POLISHING_STEPS):
        slope = shape.derivatives(solution)
        gaps = shape.gaps(solution)
        trial = solution - np.linalg.lstsq(slope, gaps, rcond=RANK)[0]
        if not np.linalg.norm(shape.gaps(trial)) < np.linalg.norm(gaps):
            break
        solution = trial
    singular = _singular_assembly(shape, solution)
    return solution if singular is None else singular


def _singular_assembly(shape: _Shape, near: np.ndarray) -> np.ndarray | None:
    """The assembly (2 k,) next to ``near`` in which the bars carry a stress without
    load; None where there is none.

    Solves gaps = 0, J^T stress = 0, |stress| = 1 for places and stress: regular where
    the assembly is isolated, although J is singular.
    """
    left, sigma, _ = np.linalg.svd(shape.derivatives(near))
    if len(sigma) < len(left) or sigma[-1] > NEAR_SINGULAR * sigma[0]:
        return None
    count = len(near)
    unknowns = np.append(near, left[:, -1])
    for _ in range(POLISHING_STEPS):
        values, slope = shape.stressed(unknowns[:count], unknowns[count:])
        unknowns = unknowns - np.linalg.lstsq(slope, values, rcond=RANK)[0]
    places = unknowns[:count]
    size = float(np.abs(near).max() + shape.lengths.max())
    is_near = float(np.linalg.norm(places - near)) < NEAR_SINGULAR * size
    is_closed = float(np.abs(shape.gaps(places)).max()) < ROUNDING * size
    return places if is_near and is_closed else None


def _pairs(numbers: np.ndarray) -> np.ndarray:
    """Complex numbers (k,) as real ones (2 k,)."""
    return np.column_stack([numbers.real, numbers.imag]).ravel()


def _complex_numbers(pairs: np.ndarray) -> np.ndarray:
    """Real numbers (2 k,) as complex ones (k,)."""
    numbers: np.ndarray = pairs[::2] + 1j * pairs[1::2]
    return numbers


class _Shape:
    """The lengths of all bars as functions of the places of the ``free`` points.

    Every vector along a bar is ``constant`` (b,) + ``factors`` (b, k) @ places (k,), in
    complex numbers.
    """

    def __init__(self, system: _Bars, free: Sequence[str]):
        at_rest = dict(system.points) | dict.fromkeys(free, 0j)
        self.constant = _vectors(system, at_rest)
        columns = []
        for name in free:
            moved = _vectors(system, at_rest | {name: 1 + 0j})
            columns.append(moved - self.constant)
        self.factors = np.column_stack(columns)
        now = np.abs(_vectors(system, system.points))
        given = [np.nan if bar.length is None else bar.length for bar in system.bars]
        self.lengths = np.where(np.isnan(given), now, given)

    def _along(self, values: np.ndarray) -> np.ndarray:
        along: np.ndarray = self.constant + self.factors @ _complex_numbers(values)
        return along

    def gaps(self, values: np.ndarray) -> np.ndarray:
        """How much too long the bars (b,) are."""
        gaps: np.ndarray = np.abs(self._along(values)) - self.lengths
        return gaps

    def derivatives(self, values: np.ndarray) -> np.ndarray:
        """Derivatives (b, 2 k) of `gaps`."""
        along = self._along(values)
        directions = np.conj(along) / np.maximum(np.abs(along), TINY)
        rates = directions[:, None] * self.factors
        derivatives = np.empty((len(along), 2 * self.factors.shape[1]))
        derivatives[:, ::2] = rates.real
        derivatives[:, 1::2] = -rates.imag
        return derivatives

    def stressed(
        self, values: np.ndarray, stress: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The values (b + 2 k + 1,) of the gaps, J^T stress and |stress|^2 - 1, and
        their derivatives by the places (2 k,) and the ``stress`` (b,)."""
        slope = self.derivatives(values)
        residuals = [self.gaps(values), slope.T @ stress, [stress @ stress - 1.0]]
        bars, count = slope.shape
        derivatives = np.zeros((bars + count + 1, count + bars))
        derivatives[:bars, :count] = slope
        derivatives[bars:-1, :count] = self._bending(values, stress)
        derivatives[bars:-1, count:] = slope.T
        derivatives[-1, count:] = 2.0 * stress
        return np.concatenate(residuals), derivatives

    def _bending(self, values: np.ndarray, stress: np.ndarray) -> np.ndarray:
        """The second derivatives (2 k, 2 k) of the lengths, weighted with a ``stress``
        (b,): a length grows with the square of the motion across its bar."""
        along = self._along(values)
        lengths = np.maximum(np.abs(along), TINY)
        across = (1j * np.conj(along) / lengths)[:, None] * self.factors
        rates = np.empty((len(along), 2 * self.factors.shape[1]))
        rates[:, ::2] = across.real
        rates[:, 1::2] = -across.imag
        bending: np.ndarray = rates.T @ ((stress / lengths)[:, None] * rates)
        return bending


def _vectors(system: _Bars, points: Mapping[str, complex]) -> np.ndarray:
    """The vectors (b,) along all bars, as complex numbers."""
    places = _places(system, points)
    return np.array([places[bar.end] - places[bar.start] for bar in system.bars])


# --- bodies and joints ----------------------------------------------------------------


def _joints(system: _Bars, places: Mapping[str, complex]) -> list[Joint]:
    """A revolute joint at every point on two bodies or more."""
    bodies = _bodies(system, places)
    joints = []
    for name, place in places.items():
        here = [body for body, points in bodies.items() if name in points]
        if not here and name not in system.on_bars:
            raise GeometryError(f"point {name}", "on no bar", "the end of a bar")
        if len(here) < 2:
            continue
        point = (place.real, place.imag, 0.0)
        joint = Joint(
            name, JointKind.REVOLUTE, tuple(here), point=point, direction=(0, 0, 1)
        )
        joints.append(joint)
    return joints


def _bodies(system: _Bars, places: Mapping[str, complex]) -> dict[str, list[str]]:
    """The points on every body, the frame first."""
    bars = {bar.name: Piece(bar.start, bar.end) for bar in system.bars}
    for name, bar in bars.items():
        if places[bar.end] == places[bar.start]:
            raise GeometryError(f"bar {name}", "of length 0", "longer")
    on_bars = {name: Piece(one.start, one.end) for name, one in system.on_bars.items()}

    def are_apart(points: Sequence[str]) -> bool:
        return len({places[point] for point in points}) > 1

    bodies = bodies_of_figure(system.fixed, bars, on_bars, are_apart)
    for name, one in system.on_bars.items():
        if not any(name in points for points in bodies.values()):
            ends = f"{one.start} and {one.end}"
            allowed = f"on a bar; there is none between {ends}"
            raise GeometryError(f"points_on_bars {name}", f"{ends}", allowed)
    return bodies
