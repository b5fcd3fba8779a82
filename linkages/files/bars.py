"""Planar mechanisms given as points and bars between them (`linkages.files.figures`)."""

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
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.origin import Coordinates, counted_from_near, origin_of
from linkages.values import checked_list, checked_number, require

Content: TypeAlias = Mapping[str, Any]
Bars: TypeAlias = Figure[complex, complex]

POLISHING_STEPS = 12
EPSILON = float(np.finfo(float).eps)
ROUNDING = 16 * EPSILON  # of a length, over the extent
NEAR_SINGULAR = 1e-3  # singular value, and way to the singular assembly, to look for it
TINY = 1e-300  # length of a bar that has none


def read_bars(content: Content, name: str) -> Mechanism:
    """The mechanism of the points and bars of a file.

    Where lengths are given that the points do not fit, the points are moved until they
    do (least squares). Raises `GeometryError` for anything wrong, and where bars of
    these lengths cannot be assembled next to the points.
    """
    assembly, near = assembled_bars(content)
    joints = joints_of_figure(
        assembly.figure,
        assembly.places,
        assembly.are_apart,
        lambda place: ((place.real, place.imag, 0.0), (0, 0, 1)),
    )
    return Mechanism(
        joints,
        name,
        is_planar=True,
        origin=origin_of(content, near.origin),
        rounding=near.rounding,
    )


def framework(
    points: Mapping[Hashable, Sequence[float]],
    bars: Iterable[tuple[Hashable, Hashable]],
    fixed: Iterable[Hashable] | None = None,
    name: str = "framework",
) -> Mechanism:
    """The planar mechanism of bars between points, by their labels, of which some are
    ``fixed``: the ends of the first bar, where nothing is said.

    Labels become names as texts, so that those of graphs and of PyRigi's frameworks do:
    ``framework(F.realization(numerical=True), F.graph.edges)``. Raises `GeometryError`
    as a file of points and bars does.

    >>> import linkages
    >>> square = {0: (0, 0), 1: (1, 0), 2: (1, 1), 3: (0, 1)}
    >>> linkages.framework(square, [(0, 1), (1, 2), (2, 3), (3, 0)]).gruebler
    1
    """
    pairs = [[str(end) for end in bar] for bar in bars]
    ends = (
        pairs[0] if fixed is None and pairs else [str(point) for point in fixed or ()]
    )
    content = {
        "fixed": ends,
        "bars": pairs,
        "points": {
            str(label): [float(number) for number in place]
            for label, place in points.items()
        },
    }
    return read_bars(content, name)


class BarAssembly(NamedTuple):
    """A ``figure`` of bars with the ``places`` of all its points where bars have their
    lengths."""

    figure: Bars
    places: dict[str, complex]

    def are_apart(self, points: Sequence[str]) -> bool:
        """Whether points are at different places."""
        return len({self.places[point] for point in points}) > 1


def assembled_bars(content: Content) -> tuple[BarAssembly, Coordinates]:
    """The bars of a file with the places of their points, and from where these are
    counted; raises `GeometryError` as `read_bars`."""
    table = table_of_points(content, "[x, y]")
    near = counted_from_near(list(table.values()))
    rows = zip(table, near.rows, strict=True)
    points = {point: _complex(f"point {point}", row) for point, row in rows}
    figure = read_figure(content, BARS, points)
    places = _assembled(figure)
    for bar in figure.pieces:
        is_longer = places[bar.end] != places[bar.start]
        require(is_longer, f"bar {bar.name}", "of length 0", "longer")
    return BarAssembly(figure, places), near


def _complex(what: str, row: object) -> complex:
    """Two numbers of a file: a place, or the ratio r of start + r (end - start)."""
    row = checked_list(what, row, "a list of two numbers", (2,))
    return complex(*(checked_number(what, value) for value in row))


def _length(what: str, value: Any) -> float:
    length = checked_number(what, value)
    require(length > 0, what, length, "positive")
    return length


BARS = FigureKind("bar", "a", "length", "[re, im]", _length, _complex)


# --- assembly -------------------------------------------------------------------------


def _places(figure: Bars, points: Mapping[str, complex]) -> dict[str, complex]:
    """The places of all points, those on bars among them."""
    places = dict(points)
    for name, one in figure.on_pieces.items():
        start, end = places[one.start], places[one.end]
        places[name] = start + one.numbers * (end - start)
    return places


def _assembled(figure: Bars) -> dict[str, complex]:
    """The places of all points where every bar has its length."""
    places = _places(figure, figure.points)
    size = max(abs(place - next(iter(places.values()))) for place in places.values())
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


def _misfits(figure: Bars, places: Mapping[str, complex]) -> np.ndarray:
    """How much longer than given the bars (k,) are that have a length."""
    # the lengths of bars without one are those that they have at first
    given = [bar for bar in figure.pieces if bar.measure is not None]
    return np.array(
        [
            abs(places[bar.end] - places[bar.start]) - (bar.measure or 0.0)
            for bar in given
        ]
    )


def _least_squares(figure: Bars) -> dict[str, complex]:
    """The places of all points where the lengths of all bars are best fitted."""
    if not figure.free:
        return _places(figure, figure.points)
    from scipy.optimize import least_squares

    shape = _Shape(figure)
    start = np.array([figure.points[name] for name in figure.free]).view(float)
    exact = {"ftol": EPSILON, "xtol": EPSILON, "gtol": EPSILON}
    solution = least_squares(shape.gaps, start, shape.derivatives, **exact).x
    moved = zip(figure.free, _polished(shape, solution).view(complex), strict=True)
    points = figure.points | {name: complex(place) for name, place in moved}
    return _places(figure, points)


def _polished(shape: _Shape, solution: np.ndarray) -> np.ndarray:
    """The places (2 k,) with the gaps of a ``solution`` or with smaller ones.

    Newton's method closes gaps to rounding where the assembly is regular. Where it is
    singular, as with bars that are just long enough, gaps of 1e-16 leave points 1e-8
    beside it, and the bars would have a motion of that size: there the singular
    assembly itself is solved for.
    """
    solution = polished(shape.gaps, shape.derivatives, solution, POLISHING_STEPS)
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


class _Shape:
    """The lengths of all bars as functions of the places of the free points.

    Every vector along a bar is ``constant`` (b,) + ``factors`` (b, k) @ places (k,), in
    complex numbers.
    """

    def __init__(self, figure: Bars):
        at_rest = figure.points | dict.fromkeys(figure.free, 0j)
        self.constant = _vectors(figure, at_rest)
        columns = []
        for name in figure.free:
            moved = _vectors(figure, at_rest | {name: 1 + 0j})
            columns.append(moved - self.constant)
        self.factors = np.column_stack(columns)
        now = np.abs(_vectors(figure, figure.points))
        given = [
            np.nan if bar.measure is None else bar.measure for bar in figure.pieces
        ]
        self.lengths = np.where(np.isnan(given), now, given)

    def _along(self, values: np.ndarray) -> np.ndarray:
        along: np.ndarray = self.constant + self.factors @ values.view(complex)
        return along

    def gaps(self, values: np.ndarray) -> np.ndarray:
        """How much too long the bars (b,) are."""
        gaps: np.ndarray = np.abs(self._along(values)) - self.lengths
        return gaps

    def derivatives(self, values: np.ndarray) -> np.ndarray:
        """Derivatives (b, 2 k) of `gaps`."""
        along = self._along(values)
        directions = np.conj(along) / np.maximum(np.abs(along), TINY)
        return _by_coordinates(directions[:, None] * self.factors)

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
        rates = _by_coordinates((1j * np.conj(along) / lengths)[:, None] * self.factors)
        bending: np.ndarray = rates.T @ ((stress / lengths)[:, None] * rates)
        return bending


def _by_coordinates(rates: np.ndarray) -> np.ndarray:
    """The real parts (b, 2 k) of rates (b, k) by x + iy, as rates by all x and y."""
    by_coordinates: np.ndarray = np.conj(rates).view(float)
    return by_coordinates


def _vectors(figure: Bars, points: Mapping[str, complex]) -> np.ndarray:
    """The vectors (b,) along all bars, as complex numbers."""
    places = _places(figure, points)
    return np.array([places[bar.end] - places[bar.start] for bar in figure.pieces])
