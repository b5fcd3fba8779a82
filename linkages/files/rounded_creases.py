"""Flat crease patterns with rounded coordinates, made exact by the least change.

What nearly holds, as rounding lets it, is made to hold:

- about an inner vertex of an even number of creases every other sector adds up to 180
  degrees, as for a vertex that folds flat (Kawasaki 1989);
- two creases about a vertex that go on along a line do so;
- round a panel between vertices of four creases, each of which keeps the ratio of the
  half-angle tangents of its creases (Evans, Lang, Magleby and Howell 2015), the product
  of these ratios is 1.

With creases in directions t about a vertex of four that folds flat, in order, the ratio
of neighbours is either sin((t3 - t1) / 2) / cos((t4 - t2) / 2), where the first and the
third fold opposite ways, or cos((t3 - t1) / 2) / sin((t4 - t2) / 2), where the second and
the fourth do: that of the small angles u at which the sum of u_k d_k along unit vectors
d_k is 0. So all equations are sums of terms that hang on the difference of two
directions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from enum import IntEnum
from itertools import combinations, product
from typing import Any, NamedTuple

import numpy as np
from networkx.utils import UnionFind
from scipy.sparse import csr_array, eye_array
from scipy.sparse.linalg import splu

from linkages.coordinates import EPSILON, rounding_of_decimals, spread_of
from linkages.decisions import is_rounding_of_pattern

LARGEST_ROUNDING = 1e-3  # over the size: that of three digits
MOST_WAYS = 256  # of combining modes round a panel
LARGEST_MISFIT = 0.1  # rad, that is taken for rounding
# Of steps of Newton's method, over squares of singular values of rows of length 1: what
# rows say that depend on each other where all holds is heard last.
DAMPINGS = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, *[1e-15] * 15)
# how products of rows are factorised
SYMMETRIC: dict[str, Any] = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 0.0,
    "options": {"SymmetricMode": True},
}
GAIN = 0.5  # of a step, or it is the last


class Ray(NamedTuple):
    """A crease as it leaves the vertex ``at`` one of its ends ``to`` the other, with its
    ``letter`` and the ``body`` on its left."""

    at: int
    to: int
    letter: str
    body: str


class _Of(IntEnum):
    """What a term is of the difference of two directions: itself, or the logarithm of
    the sine or the cosine of its half."""

    ANGLE = 0
    SINE = 1
    COSINE = 2


class _Term(NamedTuple):
    """A ``sign`` times a function ``of`` the difference from direction ``start`` to
    ``end``, rays by number."""

    of: _Of
    start: int
    end: int
    sign: float = 1.0


class _Equation(NamedTuple):
    """That some ``terms`` add up to ``total``."""

    terms: tuple[_Term, ...]
    total: float = 0.0


class _Mode(NamedTuple):
    """A way in which a vertex of four creases leaves the flat state: the signs of their
    angles, ``folds`` (4,), and the terms of the logarithm of the ratio of the second to
    the first."""

    folds: tuple[int, int, int, int]
    terms: tuple[_Term, _Term]


class _Sheet:
    """The inner vertices of a flat sheet: their ``rays``, and the numbers of those
    ``around`` each, in order."""

    def __init__(
        self, points: np.ndarray, rays: Sequence[Ray], inner: Sequence[int]
    ) -> None:
        self.points = points
        self.rays = rays
        self.ends = np.array([(ray.at, ray.to) for ray in rays])
        self.around: dict[int, list[int]] = {vertex: [] for vertex in inner}
        directions = _directions(points, self.ends)
        for number in np.argsort(directions).tolist():
            if rays[number].at in self.around:
                self.around[rays[number].at].append(number)

    # --- equations --------------------------------------------------------------------

    def lines(self) -> list[_Equation]:
        """That any two rays about a vertex lie along a line."""
        return [
            _Equation((_Term(_Of.ANGLE, *pair),), np.pi)
            for numbers in self.around.values()
            for pair in combinations(numbers, 2)
        ]

    def flat_vertices(self, lines: Sequence[_Equation]) -> dict[int, _Equation]:
        """That every other sector adds up to 180 degrees, by vertex, but for those whose
        creases all lie along ``lines``."""
        on_lines = {one for line in lines for one in line.terms[0][1:3]}
        return {
            vertex: _Equation(
                tuple(
                    _Term(_Of.ANGLE, *pair)
                    for pair in zip(numbers[::2], numbers[1::2], strict=True)
                ),
                np.pi,
            )
            for vertex, numbers in self.around.items()
            if len(numbers) % 2 == 0 and not on_lines.issuperset(numbers)
        }

    def panels(
        self, flat: Sequence[int], lines: Sequence[_Equation]
    ) -> Iterator[_Equation]:
        """That the product of the ratios round a panel is 1, for all modes of its
        vertices, which are those that fold ``flat`` or on ``lines``."""
        on_lines = {frozenset(line.terms[0][1:3]) for line in lines}
        modes = {vertex: self._modes(vertex, on_lines) for vertex in flat}
        for corners in self._loops():
            if not all(modes.get(vertex) for vertex, _ in corners):
                continue
            chosen = [modes[vertex] for vertex, _ in corners]
            if np.prod([len(one) for one in chosen]) > MOST_WAYS:
                continue
            for ways in product(*chosen):
                places = [place for _, place in corners]
                signs = [_sense(*one) for one in zip(ways, places, strict=True)]
                if np.prod(signs) > 0:
                    yield _Equation(
                        tuple(
                            term._replace(sign=term.sign * (-1) ** place)
                            for way, place in zip(ways, places, strict=True)
                            for term in way.terms
                        )
                    )

    def _modes(self, vertex: int, lines: set[frozenset[int]]) -> list[_Mode]:
        """The modes of a vertex in which all four creases fold as they are assigned; a
        crease on the way along a line keeps its angle."""
        numbers = self.around[vertex]
        if len(numbers) != 4:
            return []
        one, two, three, four = numbers
        letters = [self.rays[number].letter for number in numbers]
        angles = _directions(self.points, self.ends[numbers])
        d = np.exp(1j * angles)
        modes = []
        for is_first in (True, False):
            own = -1 if is_first else 1
            pair = frozenset((two, four) if is_first else (one, three))
            if pair in lines:
                continue  # the others stay flat
            ratio = (d[0] + own * d[2]) * np.conj(d[1] - own * d[3])
            sign = -1 if ratio.real > 0 else 1
            folds = (1, sign, own, -own * sign)
            if _are_as_assigned(folds, letters):
                above, below = (
                    (_Of.SINE, _Of.COSINE) if is_first else (_Of.COSINE, _Of.SINE)
                )
                terms = (_Term(above, one, three), _Term(below, two, four, -1.0))
                modes.append(_Mode(folds, terms))
        return modes

    def _loops(self) -> Iterator[list[tuple[int, int]]]:
        """The corners round each panel between inner vertices: the vertex, and the place
        in its order of the first of the two rays."""
        joined = UnionFind()
        corners: dict[tuple[int, int], tuple[str, frozenset[int]]] = {}
        for vertex, numbers in self.around.items():
            for place, number in enumerate(numbers):
                following = self.rays[numbers[(place + 1) % len(numbers)]]
                ray = self.rays[number]
                sides = [(ray.body, frozenset(one[:2])) for one in (ray, following)]
                joined.union(*sides)
                corners[vertex, place] = sides[0]
        loops: defaultdict[object, list[tuple[int, int]]] = defaultdict(list)
        for corner, side in corners.items():
            loops[joined[side]].append(corner)
        sides_of: defaultdict[object, int] = defaultdict(int)
        for side in joined:
            sides_of[joined[side]] += 1
        yield from (loop for key, loop in loops.items() if len(loop) == sides_of[key])


def _sense(mode: _Mode, place: int) -> int:
    """The sign of the ratio across the corner at a place."""
    return mode.folds[place] * mode.folds[(place + 1) % 4]


def _are_as_assigned(folds: Sequence[int], letters: Sequence[str]) -> bool:
    """Whether creases fold as their letters say in one of the two senses of a mode."""
    wanted = [{"V": 1, "M": -1}.get(letter, 0) for letter in letters]
    products = [own * given for own, given in zip(folds, wanted, strict=True)]
    return min(products) >= 0 or max(products) <= 0


# --- values and derivatives -----------------------------------------------------------


def _directions(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """The directions (r,), rad, from the first to the second ``ends`` (r, 2)."""
    along = points[ends[:, 1]] - points[ends[:, 0]]
    return np.asarray(np.arctan2(along[:, 1], along[:, 0]))


class _System:
    """Equations of the directions of rays with ``ends`` (r, 2) between points."""

    def __init__(self, equations: Sequence[_Equation], ends: np.ndarray) -> None:
        terms = [term for one in equations for term in one.terms]
        self.count = len(equations)
        self.ends = ends
        self.rows = np.repeat(
            np.arange(self.count), [len(one.terms) for one in equations]
        )
        self.totals = np.array([one.total for one in equations])
        self.of = np.array([term.of for term in terms], dtype=int)
        self.pairs = np.array([term[1:3] for term in terms], dtype=int).reshape(-1, 2)
        self.signs = np.array([term.sign for term in terms])

    def values(self, points: np.ndarray) -> np.ndarray:
        """By how much the equations are missed (e,), rad or none, at points (v, 2)."""
        half = self._halves(points)
        with np.errstate(divide="ignore"):
            logarithms = [np.log(np.abs(one)) for one in (np.sin(half), np.cos(half))]
        parts = self.signs * np.choose(self.of, [2.0 * half, *logarithms])
        sums = np.bincount(self.rows, parts, minlength=self.count)
        return np.asarray(sums - self.totals)

    def jacobian(self, points: np.ndarray) -> csr_array:
        """Their derivatives (e, 2 v) by the coordinates."""
        half = self._halves(points)
        with np.errstate(divide="ignore"):
            slopes = [np.ones_like(half), 0.5 / np.tan(half), -0.5 * np.tan(half)]
        weights = self.signs * np.choose(self.of, slopes)
        by_ray = csr_array(
            (
                np.concatenate([-weights, weights]),
                (np.tile(self.rows, 2), self.pairs.T.ravel()),
            ),
            shape=(self.count, len(self.ends)),
        )
        slopes_of_all: csr_array = by_ray @ self._turns(points)
        return slopes_of_all

    def _halves(self, points: np.ndarray) -> np.ndarray:
        start, end = _directions(points, self.ends)[self.pairs].T
        return np.asarray(0.5 * np.remainder(end - start, 2 * np.pi))

    def _turns(self, points: np.ndarray) -> csr_array:
        """The derivatives (r, 2 v) of the directions by the coordinates."""
        start, end = self.ends.T
        along = points[end] - points[start]
        across = along[:, ::-1] * (-1.0, 1.0) / np.sum(along**2, axis=1)[:, None]
        rays = np.arange(len(start))
        columns = [2 * end, 2 * end + 1, 2 * start, 2 * start + 1]
        values = [across[:, 0], across[:, 1], -across[:, 0], -across[:, 1]]
        places = (np.tile(rays, 4), np.concatenate(columns))
        shape = (len(rays), points.size)
        return csr_array((np.concatenate(values), places), shape=shape)

    def explained(self, points: np.ndarray, rounding: float) -> np.ndarray:
        """Which equations (e,) hold to what a ``rounding`` of all coordinates makes."""
        sizes = abs(self.jacobian(points)).sum(axis=1)
        least = np.minimum(rounding * sizes, LARGEST_MISFIT)
        return np.asarray(np.abs(self.values(points)) <= least)

    def hold(self, points: np.ndarray) -> bool:
        """Whether all of them hold as far as doubles can tell."""
        unit = EPSILON * np.abs(points).max()
        sizes = abs(self.jacobian(points)).sum(axis=1)
        least = unit * sizes + np.bincount(self.rows, minlength=self.count) * EPSILON
        return bool(np.all(np.abs(self.values(points)) <= 8 * least))


# --- the least change -----------------------------------------------------------------


def exact_points(
    points: np.ndarray, rays: Sequence[Ray], inner: Sequence[int]
) -> np.ndarray:
    """The points (v, 3) of a flat sheet with some ``inner`` vertices, moved by the least
    change after which all holds that nearly does; the same ones where that is more than
    their rounding, or nothing."""
    flat = points[:, :2]
    size = spread_of(flat)
    rounding = rounding_of_decimals(flat)
    if rounding is None:
        rounding = is_rounding_of_pattern.threshold * size
    if not rays or rounding > LARGEST_ROUNDING * size:
        return points
    sheet = _Sheet(flat, rays, inner)
    if not np.all(np.any(flat[sheet.ends[:, 0]] != flat[sheet.ends[:, 1]], axis=1)):
        return points
    lines, vertices, panels = _nearly(sheet, rounding)
    # lines may be nearly straight, and panels nearly close, by chance
    tried = ([*lines, *vertices, *panels], [*vertices, *panels], [*lines, *vertices])
    for equations in tried:
        system = _System(equations, sheet.ends)
        if not equations or system.hold(flat):
            return points
        moved = _nearest(system, flat, 2 * rounding)
        if moved is not None:
            return np.column_stack([moved, points[:, 2]])
    return points


def _nearly(
    sheet: _Sheet, rounding: float
) -> tuple[list[_Equation], list[_Equation], list[_Equation]]:
    """The equations of lines, of vertices and of panels that hold to a rounding."""

    def near(equations: list[_Equation]) -> np.ndarray:
        system = _System(equations, sheet.ends)
        return np.flatnonzero(system.explained(sheet.points, rounding))

    given = sheet.lines()
    lines = [given[number] for number in near(given)]
    of_vertices = sheet.flat_vertices(lines)
    names, given = list(of_vertices), list(of_vertices.values())
    chosen = near(given)
    vertices = [given[number] for number in chosen]
    straight = sheet.around.keys() - of_vertices.keys()
    flat = [*(names[number] for number in chosen), *straight]
    given = list(sheet.panels(flat, lines))
    panels = [given[number] for number in near(given)]
    return lines, vertices, panels


def _nearest(system: _System, points: np.ndarray, most: float) -> np.ndarray | None:
    """The points (v, 2) nearest to given ones at which the equations hold, None where a
    coordinate changes by more than ``most``, or where none are found."""
    best, least = points, np.inf
    change = np.zeros(points.size)
    for damping in DAMPINGS:
        here = points + change.reshape(-1, 2)
        values = system.values(here)
        missed = float(np.abs(values).max())
        if not np.abs(change).max() <= most:
            return None
        if not missed < GAIN * least and system.hold(best):
            break
        best, least = here, missed
        change -= _step(system.jacobian(here), values, damping)
    return best if system.hold(best) else None


def _step(slopes: csr_array, values: np.ndarray, damping: float) -> np.ndarray:
    """The shortest vector (n,) that a matrix (e, n) takes to values (e,), with what rows
    that nearly depend on each other ask for held back by a ``damping``."""
    unit = 1.0 / np.sqrt((slopes**2).sum(axis=1))
    rows = slopes * unit[:, None]
    products = rows @ rows.T + damping * eye_array(len(values))
    return np.asarray(rows.T @ splu(products.tocsc(), **SYMMETRIC).solve(unit * values))
