"""Mechanisms given as points and bars between them (`linkages.files.figures`), in a plane
or in space."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from linkages.decisions import is_bar_assembled
from linkages.files.figures import (
    RANK,
    Figure,
    FigureKind,
    joints_of_figure,
    polished,
    read_figure,
    table_of_points,
)
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.origin import Coordinates, counted_from_near, origin_of
from linkages.values import GeometryError, checked_list, checked_number, require

Content: TypeAlias = Mapping[str, Any]
Bars: TypeAlias = Figure[np.ndarray, complex]

PLANE, SPACE = 2, 3  # coordinates of a point
FLAT = 1e-9  # singular value, over the largest distance, of points on one line

POLISHING_STEPS = 12
EPSILON = float(np.finfo(float).eps)
ROUNDING = 16 * EPSILON  # of a length, over the extent
NEAR_SINGULAR = 1e-3  # singular value, and way to the singular assembly, to look for it
TINY = 1e-300  # length of a bar that has none


def read_bars(content: Content, name: str) -> Mechanism:
    """The mechanism of the points and bars of a file: points with two coordinates are
    revolute joints in a plane, those with three spherical ones.

    Where lengths are given that the points do not fit, the points are moved until they
    do (least squares). Raises `GeometryError` for anything wrong, and where bars of
    these lengths cannot be assembled next to the points.
    """
    assembly, near = assembled_bars(content)
    joints = joints_of_figure(
        assembly.figure, assembly.places, assembly.hold_together, _joint_at
    )
    return Mechanism(
        joints,
        name,
        is_planar=assembly.is_planar,
        origin=origin_of(content, near.origin),
        rounding=near.rounding,
    )


def _joint_at(name: str, bodies: tuple[str, ...], place: np.ndarray) -> Joint:
    """The joint of bodies at a place (2,) or (3,)."""
    if len(place) == PLANE:
        point = (float(place[0]), float(place[1]), 0.0)
        return Joint(name, JointKind.REVOLUTE, bodies, point, (0, 0, 1))
    x, y, z = place.tolist()
    return Joint(name, JointKind.SPHERICAL, bodies, (x, y, z))


def framework(
    points: Mapping[Hashable, Sequence[float]],
    bars: Iterable[tuple[Hashable, Hashable]],
    fixed: Iterable[Hashable] | None = None,
    name: str = "framework",
) -> Mechanism:
    """The mechanism of bars between points in a plane or in space, by their labels, of
    which some are ``fixed``: the ends of the first bar, where nothing is said, and in
    space the corners of the first triangle of bars.

    Labels become names as texts, so that those of graphs and of PyRigi's frameworks do:
    ``framework(F.realization(numerical=True), F.graph.edges)``. Raises `GeometryError`
    as a file of points and bars does.

    >>> import linkages
    >>> square = {0: (0, 0), 1: (1, 0), 2: (1, 1), 3: (0, 1)}
    >>> linkages.framework(square, [(0, 1), (1, 2), (2, 3), (3, 0)]).gruebler
    1
    """
    pairs = [[str(end) for end in bar] for bar in bars]
    held = [str(point) for point in fixed or ()]
    if fixed is None and pairs:
        is_spatial = all(len(place) == SPACE for place in points.values())
        held = _first_triangle(pairs) if is_spatial else pairs[0]
    content = {
        "fixed": held,
        "bars": pairs,
        "points": {
            str(label): [float(number) for number in place]
            for label, place in points.items()
        },
    }
    return read_bars(content, name)


def _first_triangle(bars: Sequence[Sequence[str]]) -> list[str]:
    """Three points between which there are bars; raises `GeometryError`."""
    joined = {frozenset(bar) for bar in bars}
    for start, end in bars:
        for third in dict.fromkeys(point for bar in bars for point in bar):
            if {frozenset((start, third)), frozenset((end, third))} <= joined:
                return [start, end, third]
    allowed = "given, three points that hold the frame, as no three bars are a triangle"
    raise GeometryError("fixed", "a missing argument", allowed)


class BarAssembly(NamedTuple):
    """A ``figure`` of bars with the ``places`` (d,) of all its points where bars have
    their lengths."""

    figure: Bars
    places: dict[str, np.ndarray]

    @property
    def is_planar(self) -> bool:
        """Whether it lies in a plane, and not in space."""
        return all(len(place) == PLANE for place in self.places.values())

    def hold_together(self, first: Sequence[str], second: Sequence[str]) -> bool:
        """Whether the points that two bodies have in common make them one: as many
        directions lead from one to the others as it takes in the plane, or as there are
        in one of the bodies."""
        common = self._directions([point for point in first if point in second])
        if self.is_planar:
            return common > 0
        return 0 < common in (PLANE, self._directions(first), self._directions(second))

    def _directions(self, points: Sequence[str]) -> int:
        """How many independent directions there are between points, in space up to two
        of them."""
        if not points:
            return 0
        places = np.array([self.places[point] for point in points])
        apart = places - places[0]
        size = float(np.abs(apart).max())
        if size == 0.0:
            return 0
        return min(int(np.linalg.matrix_rank(apart / size, tol=FLAT)), PLANE)


def assembled_bars(content: Content) -> tuple[BarAssembly, Coordinates]:
    """The bars of a file with the places of their points, and from where these are
    counted; raises `GeometryError` as `read_bars`."""
    table = table_of_points(content, "[x, y] or [x, y, z]")
    near = counted_from_near(list(table.values()))
    first = near.rows[0]
    is_spatial = isinstance(first, list) and len(first) == SPACE
    size = SPACE if is_spatial else PLANE
    if is_spatial and content.get("points_on_bars"):
        # such a bar would turn about itself, which is no motion of a framework
        allowed = "left out: bars between points in space hold these alone"
        raise GeometryError("points_on_bars", "a table", allowed)
    points = {
        point: _place(f"point {point}", row, size)
        for point, row in zip(table, near.rows, strict=True)
    }
    figure = read_figure(content, BARS, points)
    places = _assembled(figure)
    for bar in figure.pieces:
        is_longer = bool(np.any(places[bar.end] != places[bar.start]))
        require(is_longer, f"bar {bar.name}", "of length 0", "longer")
    return BarAssembly(figure, places), near


def _place(what: str, row: object, size: int) -> np.ndarray:
    """The place of a point, of so many numbers."""
    count = "three" if size > PLANE else "two"
    row = checked_list(what, row, f"a list of {count} numbers", (size,))
    return np.array([checked_number(what, value) for value in row])


def _complex(what: str, row: object) -> complex:
    """The ratio r of start + r (end - start), of two numbers."""
    row = checked_list(what, row, "a list of two numbers", (2,))
    return complex(*(checked_number(what, value) for value in row))


def _length(what: str, value: Any) -> float:
    length = checked_number(what, value)
    require(length > 0, what, length, "positive")
    return length


BARS = FigureKind("bar", "a", "length", "[re, im]", _length, _complex)


# --- assembly -------------------------------------------------------------------------


def _places(figure: Bars, points: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The places of all points, those on bars among them."""
    places = dict(points)
    for name, one in figure.on_pieces.items():
        start, end = places[one.start], places[one.end]
        along = one.numbers * complex(*(end - start))
        places[name] = start + np.array([along.real, along.imag])
    return places


def _assembled(figure: Bars) -> dict[str, np.ndarray]:
    """The places of all points where every bar has its length."""
    places = _places(figure, figure.points)
    first = next(iter(places.values()))
    size = max(float(np.linalg.norm(place - first)) for place in places.values())
    misfit = np.abs(_misfits(figure, places)).max(initial=0.0)
    if misfit == 0.0:
        return places
    places = _least_squares(figure)
    misfits = np.abs(_misfits(figure, places))
    given = [bar for bar in figure.pieces if bar.measure is not None]
    worst = given[int(np.argmax(misfits))]
    allowed = (
        "such that the bars can be assembled next to the points; as near as they "
        f"come, bar {worst.name} misses its length by {misfits.max():.3g}"
    )
    is_assembled = is_bar_assembled(float(misfits.max()), size)
    require(is_assembled, f"length of bar {worst.name}", worst.measure, allowed)
    return places


def _misfits(figure: Bars, places: Mapping[str, np.ndarray]) -> np.ndarray:
    """How much longer than given the bars (k,) are that have a length."""
    # the lengths of bars without one are those that they have at first
    given = [bar for bar in figure.pieces if bar.measure is not None]
    return np.array(
        [
            np.hypot.reduce(places[bar.end] - places[bar.start]) - (bar.measure or 0.0)
            for bar in given
        ]
    )


def _least_squares(figure: Bars) -> dict[str, np.ndarray]:
    """The places of all points where the lengths of all bars are best fitted."""
    if not figure.free:
        return _places(figure, figure.points)
    from scipy.optimize import least_squares

    shape = _Shape(figure)
    start = np.concatenate([figure.points[name] for name in figure.free])
    exact = {"ftol": EPSILON, "xtol": EPSILON, "gtol": EPSILON}
    solution = least_squares(shape.gaps, start, shape.derivatives, **exact).x
    rows = _polished(shape, solution).reshape(len(figure.free), -1)
    points = figure.points | dict(zip(figure.free, rows, strict=True))
    return _places(figure, points)


def _polished(shape: _Shape, solution: np.ndarray) -> np.ndarray:
    """The places (d k,) with the gaps of a ``solution`` or with smaller ones.

    Newton's method closes gaps to rounding where the assembly is regular. Where it is
    singular, as with bars that are just long enough, gaps of 1e-16 leave points 1e-8
    beside it, and the bars would have a motion of that size: there the singular
    assembly itself is solved for.
    """
    solution = polished(shape.gaps, shape.derivatives, solution, POLISHING_STEPS)
    singular = _singular_assembly(shape, solution)
    return solution if singular is None else singular


def _singular_assembly(shape: _Shape, near: np.ndarray) -> np.ndarray | None:
    """The assembly (d k,) next to ``near`` in which the bars carry a stress without
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


class _Shape:
    """The lengths of all bars as functions of the places of the free points.

    Every vector along a bar is ``constant`` (b, d) + ``factors`` (b, d, d k) @ places
    (d k,).
    """

    def __init__(self, figure: Bars):
        size = len(next(iter(figure.points.values())))
        at_rest = figure.points | dict.fromkeys(figure.free, np.zeros(size))
        self.constant = _vectors(figure, at_rest)
        columns = []
        for name in figure.free:
            for axis in np.eye(size):
                moved = _vectors(figure, at_rest | {name: axis})
                columns.append(moved - self.constant)
        self.factors = np.stack(columns, axis=-1)
        now = np.hypot.reduce(_vectors(figure, figure.points), axis=1)
        given = [
            np.nan if bar.measure is None else bar.measure for bar in figure.pieces
        ]
        self.lengths = np.where(np.isnan(given), now, given)

    def _along(self, values: np.ndarray) -> np.ndarray:
        along: np.ndarray = self.constant + self.factors @ values
        return along

    def gaps(self, values: np.ndarray) -> np.ndarray:
        """How much too long the bars (b,) are."""
        gaps: np.ndarray = np.hypot.reduce(self._along(values), axis=1) - self.lengths
        return gaps

    def derivatives(self, values: np.ndarray) -> np.ndarray:
        """Derivatives (b, d k) of `gaps`."""
        directions, _ = self._directions(values)
        rates: np.ndarray = np.einsum("bd,bdk->bk", directions, self.factors)
        return rates

    def _directions(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unit vectors (b, d) along the bars, and their lengths (b,)."""
        along = self._along(values)
        lengths = np.maximum(np.hypot.reduce(along, axis=1), TINY)
        return along / lengths[:, None], lengths

    def stressed(
        self, values: np.ndarray, stress: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The values (b + d k + 1,) of the gaps, J^T stress and |stress|^2 - 1, and
        their derivatives by the places (d k,) and the ``stress`` (b,)."""
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
        """The second derivatives (d k, d k) of the lengths, weighted with a ``stress``
        (b,): a length grows with the square of the motion across its bar."""
        directions, lengths = self._directions(values)
        along = np.einsum("bd,bdk->bk", directions, self.factors)
        across = self.factors - directions[:, :, None] * along[:, None, :]
        weights = stress / lengths
        bending: np.ndarray = np.einsum("b,bdj,bdk->jk", weights, across, across)
        return bending


def _vectors(figure: Bars, points: Mapping[str, np.ndarray]) -> np.ndarray:
    """The vectors (b, d) along all bars."""
    places = _places(figure, points)
    return np.array([places[bar.end] - places[bar.start] for bar in figure.pieces])
