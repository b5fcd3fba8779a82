"""The plane of two parameters, divided into regions of equal map.

Members over the plane are mapped. From each, the equations of a singular point with both
parameters among the unknowns lead to the boundaries, which are followed. What they leave of
the plane falls into regions, of which one member each is mapped; random members check that
all of a region have the same map, and where one does not the search goes on from there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.decisions import is_null, is_same_point
from bifurc.following.follow import FollowedPoint
from bifurc.following.places import PlaceKind
from bifurc.graphs import transition_graph
from bifurc.limits import CutOff, Deadline, current_deadline, cut_off_after, until
from bifurc.settings import SearchSettings
from linkages.parameters.member_search import MapShape, MemberSearch, TimeIsOver
from linkages.parameters.members import Members

GRID = 5  # members a side that are mapped at first
OFF_CENTRE = 0.35  # of their spacing, as members in the middle are special
CELLS = 240  # a side, by which regions are told apart
ALONG = 6000  # points of a boundary, nearer to each other than cells are wide
BESIDE = 1e-6  # of the ranges: so near to a boundary a member is on neither side
ROUNDS = 4  # of checks, each after the boundaries that the one before led to
REACH = 3  # cells, from which a member beside a boundary is told to be in a region
CROSSED = 1e-12  # of the ranges: how exactly two boundaries meet
NEWTON_STEPS = 20


class RegionMap(NamedTuple):
    """What the maps of one region have in common: their `MapShape`, without the joints
    that rest, and the hash of their transition graph (Weisfeiler and Lehman); None in
    place of the shape where there are no members."""

    shape: MapShape | None
    graph: str = ""


@dataclass(frozen=True, eq=False)
class Region:
    """A region of the plane, with the parameters ``p`` (2,) of the member by which it is
    known, far from its boundaries, its ``map``, and its ``share`` of the plane."""

    p: np.ndarray
    map: RegionMap
    share: float


@dataclass(frozen=True, eq=False)
class Codimension:
    """A point of the plane at which a boundary has a cusp, or two cross: the parameters
    ``p`` (2,), its ``kind`` and the numbers of the ``boundaries``."""

    p: np.ndarray
    kind: str
    boundaries: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Chart:
    """The ``boundaries`` and ``regions`` of a plane, with the ``labels`` (k, k) of its
    cells, -1 on a boundary, the first axis that of the first parameter; ``points`` of
    codimension two; of ``checked`` random members (m, 2) those that are so near to a
    boundary that they are ``beside``, and the ``disagreements``, whose maps differ from
    that of their region. It ``is_whole`` unless Ctrl-C or a deadline ended it."""

    members: Members
    boundaries: tuple[FollowedPoint, ...]
    regions: tuple[Region, ...]
    labels: np.ndarray
    points: tuple[Codimension, ...]
    checked: np.ndarray
    beside: int
    disagreements: np.ndarray
    is_whole: bool

    @property
    def maps(self) -> list[RegionMap]:
        """The different maps of the regions, in order."""
        return list(dict.fromkeys(region.map for region in self.regions))


def chart(
    members: Members,
    count: int,
    settings: SearchSettings | None = None,
    deadline: Deadline | None = None,
    progress: Callable[[str, int], None] | None = None,
) -> Chart:
    """The plane of the two free parameters of ``members``, checked by ``count`` random
    ones; ``progress`` is called with what was made and how many.

    >>> import linkages
    >>> from linkages.catalogue import entry
    >>> family = entry("four-bar")
    >>> ranges = {"a": (0.5, 1.5), "d": (2.9, 3.9)}
    >>> chart = linkages.chart(linkages.Members(family, family.defaults, ranges), 5)
    >>> [region.map.shape.components for region in chart.regions]
    [2, 1]
    """
    search = _ChartSearch(
        members,
        settings or SearchSettings(certify=False),
        deadline,
        progress=progress or (lambda what, number: None),
    )
    is_whole = True
    end = deadline or current_deadline()
    try:
        with until(end), cut_off_after(end):
            search.look_over_plane()
            search.check(count)
    except (KeyboardInterrupt, TimeIsOver, CutOff):
        is_whole = False
    return search.result(is_whole)


class _Plane:
    """The plane of the ``ranges`` (2, 2), from 0 to 1 a side, cut by ``lines`` (k, 2)."""

    def __init__(self, ranges: np.ndarray, lines: Sequence[np.ndarray]):
        self.ranges = ranges
        self.lines = [self.inside(line) for line in lines]
        self.walls = np.zeros((CELLS, CELLS), dtype=bool)
        for line in self.lines:
            self.walls[tuple(self.cells(line).T)] = True

    def inside(self, p: np.ndarray) -> np.ndarray:
        """Parameters (..., 2) in the unit square."""
        low, high = self.ranges.T
        inside: np.ndarray = (p - low) / (high - low)
        return inside

    def cells(self, unit: np.ndarray) -> np.ndarray:
        """The cells (..., 2) of places in the unit square."""
        whole: np.ndarray = np.clip((CELLS * unit).astype(int), 0, CELLS - 1)
        return whole

    @cached_property
    def labels(self) -> np.ndarray:
        """The numbers of the regions of all cells, -1 on a line."""
        from scipy.ndimage import label

        numbers, _ = label(~self.walls)
        labels: np.ndarray = numbers - 1
        return labels

    def middles(self) -> list[np.ndarray]:
        """The parameters (2,) of the place of each region that is farthest from lines and
        bounds."""
        from scipy.ndimage import distance_transform_edt

        framed = np.pad(~self.walls, 1)
        depth = distance_transform_edt(framed)[1:-1, 1:-1]
        low, high = self.ranges.T
        middles = []
        for number in range(self.labels.max() + 1):
            own = np.where(self.labels == number, depth, 0.0)
            cell = np.array(np.unravel_index(int(np.argmax(own)), own.shape))
            middles.append(low + (high - low) * (cell + 0.5) / CELLS)
        return middles

    def region(self, p: np.ndarray) -> int | None:
        """The number of the region of parameters (2,); None so near to a line that it is
        on neither side."""
        place = self.inside(p)
        row, column = self.cells(place).tolist()
        if not self.walls[row, column]:
            return int(self.labels[row, column])
        if any(_distance(place, line) < BESIDE for line in self.lines):
            return None
        steps = range(-REACH, REACH + 1)
        near = sorted(
            (i * i + j * j, row + i, column + j) for i in steps for j in steps
        )
        for _, i, j in near:
            is_cell = 0 <= i < CELLS and 0 <= j < CELLS
            if is_cell and not self.walls[i, j]:
                other = (np.array([i, j]) + 0.5) / CELLS
                if not any(_crosses(place, other, line) for line in self.lines):
                    return int(self.labels[i, j])
        return None


def _distance(place: np.ndarray, line: np.ndarray) -> float:
    """How far a place (2,) is from a line of points (k, 2)."""
    starts, along = line[:-1], np.diff(line, axis=0)
    squares = np.maximum(np.sum(along * along, axis=1), np.finfo(float).tiny)
    share = np.clip(np.sum((place - starts) * along, axis=1) / squares, 0.0, 1.0)
    feet = starts + share[:, None] * along
    return float(np.linalg.norm(feet - place, axis=1).min(initial=np.inf))


def _crosses(first: np.ndarray, last: np.ndarray, line: np.ndarray) -> bool:
    """Whether the segment between two places (2,) crosses a line of points (k, 2)."""
    return bool(len(_crossings(np.array([first, last]), line)))


def _crossings(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The places (j, 2) at which two lines of points cross, as numbers of points of
    each."""
    found = []
    steps = np.diff(other, axis=0)
    for number, (start, end) in enumerate(pairwise(one)):
        along, gaps = end - start, other[:-1] - start
        area = along[0] * steps[:, 1] - along[1] * steps[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (gaps[:, 0] * steps[:, 1] - gaps[:, 1] * steps[:, 0]) / area
            there = (gaps[:, 0] * along[1] - gaps[:, 1] * along[0]) / area
        is_met = (share >= 0.0) & (share < 1.0) & (there >= 0.0) & (there < 1.0)
        for k in np.flatnonzero(is_met):
            found.append((number + share[k], k + there[k]))
    return np.array(found).reshape(-1, 2)


@dataclass
class _ChartSearch(MemberSearch):
    """The ``maps`` that were made, by their parameters; the random members that were
    ``checked``."""

    maps: dict[tuple[float, float], RegionMap] = field(default_factory=dict)
    checked: list[np.ndarray] = field(default_factory=list)
    progress: Callable[[str, int], None] = lambda what, number: None

    @property
    def ranges(self) -> np.ndarray:
        """From where to where each parameter goes (2, 2)."""
        return self.members.problem.parameters.bounds

    def look_over_plane(self) -> None:
        """Look at members all over the plane."""
        low, high = self.ranges.T
        spacing = (high - low) / GRID
        for i in range(GRID):
            for j in range(GRID):
                self.look_at(low + spacing * (np.array([i, j]) + OFF_CENTRE))

    def look_at(self, p: np.ndarray) -> RegionMap:
        """The map of the member at ``p`` (2,), from which boundaries are looked for."""
        key = (float(p[0]), float(p[1]))
        if key not in self.maps:
            atlas = self.map_at(p)
            self.maps[key] = _region_map(self.shape(atlas), atlas)
            self.progress("maps", len(self.maps))
            if atlas is not None:
                for u, nullity in self.starts(atlas, closely=True):
                    solved = self.solve(u, p, nullity)
                    if solved is not None:
                        self.follow(solved)
        return self.maps[key]

    def check(self, count: int) -> None:
        """Compare random members with the maps of their regions; where one differs,
        boundaries were looked for from there, and all are compared once more."""
        low, high = self.ranges.T
        rng = np.random.default_rng(0)
        drawn = [rng.uniform(low, high) for _ in range(count)]
        known = -1
        for _ in range(ROUNDS):
            if known == len(self.curves):
                break
            known = len(self.curves)
            for p in (*drawn, *self.plane.middles()):
                self.look_at(p)
        while any(self._is_new(p) for p in self.plane.middles()):
            pass
        self.checked = drawn

    def _is_new(self, p: np.ndarray) -> bool:
        """Map the member at ``p`` (2,); whether a boundary was found from there."""
        known = len(self.curves)
        self.look_at(p)
        return len(self.curves) > known

    @property
    def plane(self) -> _Plane:
        """The plane with the boundaries that are known."""
        lines = [line_of(curve, ALONG) for curve in self.curves]
        return _Plane(self.ranges, lines)

    def result(self, is_whole: bool) -> Chart:
        """What was found."""
        plane = self.plane
        regions = self._regions(plane)
        places = [plane.region(p) for p in self.checked]
        wrong = [
            p
            for p, number in zip(self.checked, places, strict=True)
            if number is not None and self.look_at(p) != regions[number].map
        ]
        return Chart(
            members=self.members,
            boundaries=tuple(self.curves),
            regions=tuple(regions),
            labels=plane.labels,
            points=tuple(_points(self.curves, plane)),
            checked=np.array(self.checked).reshape(-1, 2),
            beside=places.count(None),
            disagreements=np.array(wrong).reshape(-1, 2),
            is_whole=is_whole,
        )

    def _regions(self, plane: _Plane) -> list[Region]:
        """The regions of the plane whose member was mapped: all of them, unless the search
        was ended."""
        sizes = np.bincount(plane.labels[plane.labels >= 0], minlength=1)
        regions = []
        for p, size in zip(plane.middles(), sizes.tolist(), strict=True):
            found = self.maps.get((float(p[0]), float(p[1])))
            if found is None:
                break
            regions.append(Region(p, found, size / CELLS**2))
        return regions


def line_of(curve: FollowedPoint, count: int) -> np.ndarray:
    """The parameters (count, 2) of so many places of a boundary."""
    return curve.parameters(np.linspace(0.0, curve.branch.length, count))


def _region_map(shape: MapShape | None, atlas: Atlas | None) -> RegionMap:
    """What a map is compared by."""
    if shape is None or atlas is None:
        return RegionMap(None)
    import networkx as nx

    graph = transition_graph(atlas)
    simple = nx.Graph(graph.subgraph(graph.nodes))
    for first, second in simple.edges:
        simple.edges[first, second]["count"] = str(graph.number_of_edges(first, second))
    text = nx.weisfeiler_lehman_graph_hash(simple, edge_attr="count")
    return RegionMap(shape._replace(at_rest=()), text)


# --- codimension two ------------------------------------------------------------------


def _points(curves: Sequence[FollowedPoint], plane: _Plane) -> list[Codimension]:
    """Where boundaries have cusps, and where they cross."""
    points = [
        Codimension(place.p, place.kind.value, (number,))
        for number, curve in enumerate(curves)
        for place in curve.places
        if place.kind is not PlaceKind.TURN
    ]
    crossings: list[Codimension] = []
    for i, j in combinations(range(len(curves)), 2):
        lines = [plane.lines[k][:: ALONG // CELLS] for k in (i, j)]
        for at in _crossings(*lines):
            shares = at / [len(line) - 1 for line in lines]
            p = _met(curves[i], curves[j], shares, plane)
            if p is not None:
                _add_crossing(crossings, p, {i, j}, plane)
    return points + crossings


def _add_crossing(
    crossings: list[Codimension], p: np.ndarray, both: set[int], plane: _Plane
) -> None:
    """Add the place (2,) at which two boundaries cross: at one that is known more than
    two do."""
    for number, one in enumerate(crossings):
        if is_same_point(
            float(np.abs(plane.inside(p) - plane.inside(one.p)).max()), 1.0
        ):
            boundaries = tuple(sorted({*one.boundaries, *both}))
            crossings[number] = replace(one, boundaries=boundaries)
            return
    crossings.append(Codimension(p, "crossing", tuple(sorted(both))))


def _met(
    one: FollowedPoint, other: FollowedPoint, shares: np.ndarray, plane: _Plane
) -> np.ndarray | None:
    """The parameters (2,) at which two boundaries cross near ``shares`` (2,) of their
    lengths; None where they do not, and where they run along each other."""
    curves = (one, other)
    lengths = np.array([curve.branch.length for curve in curves])
    s = np.clip(shares, 0.0, 1.0) * lengths
    for _ in range(NEWTON_STEPS):
        first, second = (
            plane.inside(c.parameters(x)) for c, x in zip(curves, s, strict=True)
        )
        rates = np.column_stack(
            [_rate(curve, x, plane) for curve, x in zip(curves, s, strict=True)]
        )
        sizes = np.linalg.norm(rates, axis=0)
        directions = rates / np.where(sizes > 0.0, sizes, 1.0)
        if is_null(float(np.linalg.svd(directions, compute_uv=False)[-1])):
            return None
        step = np.linalg.solve(rates * [1.0, -1.0], second - first)
        s = np.clip(s + step, 0.0, lengths)
        if np.abs(second - first).max() < CROSSED:
            return one.parameters(float(s[0]))
    return None


def _rate(curve: FollowedPoint, s: float, plane: _Plane) -> np.ndarray:
    """How fast the parameters (2,) move along a boundary at an arclength, over their
    ranges."""
    _, rate = curve.problem.place(curve.branch(s, derivative=1))
    over: np.ndarray = rate / np.diff(plane.ranges, axis=1)[:, 0]
    return over
