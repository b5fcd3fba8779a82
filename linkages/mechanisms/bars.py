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
from linkages.loop import GeometryError, check_number, quoted
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism

__all__ = ["read_bars"]

Content: TypeAlias = Mapping[str, Any]

FRAME = "frame"


@dataclass(frozen=True)
class Bar:
    """A bar between two points, with the ``length`` that is given for it."""

    start: str
    end: str
    length: float | None = None

    @property
    def name(self) -> str:
        """What the body is called."""
        return f"{self.start}-{self.end}"


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
    points = _read_points(content)
    on_bars = _read_points_on_bars(content, points)
    known = [*points, *on_bars]
    fixed = _read_fixed(content, known)
    bars = _read_bars(content, known)
    system = _Bars(points, fixed, bars, on_bars)
    places = _assembled(system)
    joints = _joints(system, places)
    return Mechanism(tuple(joints), name, is_planar=True)


# --- keys -----------------------------------------------------------------------------


def _read_points(content: Content) -> dict[str, complex]:
    table = content.get("points")
    if not isinstance(table, Mapping) or not table:
        raise GeometryError("points", quoted(table), "a table of points [x, y]")
    return {name: _complex(f"point {name}", row) for name, row in table.items()}


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


def _read_fixed(content: Content, known: Sequence[str]) -> tuple[str, ...]:
    fixed = content.get("fixed", [])
    if not isinstance(fixed, list):
        raise GeometryError("fixed", quoted(fixed), "a list of names of points")
    for name in fixed:
        _check_point("fixed", name, known)
        if fixed.count(name) > 1:
            raise GeometryError("fixed", quoted(name), "named once")
    return tuple(fixed)


def _check_point(what: str, name: object, known: Sequence[str]) -> None:
    if name not in known:
        allowed = f"one of the points {', '.join(known)}"
        raise GeometryError(what, quoted(name), allowed)


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
            _check_point(what, name, known)
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
    if misfit == 0.0 or is_bar_assembled(float(misfit), size):
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
    from scipy.optimize import least_squares

    first = _places(system, system.points)
    lengths = np.array(
        [
            abs(first[bar.end] - first[bar.start]) if bar.length is None else bar.length
            for bar in system.bars
        ]
    )

    def places_at(values: np.ndarray) -> dict[str, complex]:
        moved = dict(system.points)
        for name, x, y in zip(free, values[::2], values[1::2], strict=True):
            moved[name] = complex(x, y)
        return _places(system, moved)

    def gaps(values: np.ndarray) -> np.ndarray:
        places = places_at(values)
        sizes = [abs(places[bar.end] - places[bar.start]) for bar in system.bars]
        differences: np.ndarray = np.array(sizes) - lengths
        return differences

    start = [c for name in free for c in (first[name].real, first[name].imag)]
    if not start:
        return first
    solution = least_squares(gaps, start, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    return places_at(solution.x)


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
    """The points on every body, the frame first.

    A bar between two points of one body is rigid with it, and no body of its own.
    """
    bodies: dict[str, list[str]] = {}
    if system.fixed:
        bodies[FRAME] = list(system.fixed)
    _add_points_on(bodies, system)
    for bar in system.bars:
        length = abs(places[bar.end] - places[bar.start])
        if length == 0.0:
            raise GeometryError(f"bar {bar.name}", "of length 0", "longer")
        if any({bar.start, bar.end} <= set(points) for points in bodies.values()):
            continue
        bodies[bar.name] = [bar.start, bar.end]
        _add_points_on(bodies, system)
    for name, one in system.on_bars.items():
        if not any(name in points for points in bodies.values()):
            ends = f"{one.start} and {one.end}"
            allowed = f"on a bar; there is none between {ends}"
            raise GeometryError(f"points_on_bars {name}", f"{ends}", allowed)
    return bodies


def _add_points_on(bodies: dict[str, list[str]], system: _Bars) -> None:
    """Add the points on bars to the body that holds both ends of their bar."""
    for name, one in system.on_bars.items():
        for points in bodies.values():
            if {one.start, one.end} <= set(points) and name not in points:
                points.append(name)
