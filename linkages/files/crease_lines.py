"""Crease patterns that are drawn as lines, as the content of a FOLD file.

Lines go in, each with its letter; vertices and edges come out. Ends that nearly meet are
one vertex, and a line is split where another one ends on it or crosses it.
"""

from __future__ import annotations

import logging
from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from linkages.decisions import is_same_vertex
from linkages.formats.assembly import listed
from linkages.values import GeometryError, require

Place: TypeAlias = tuple[float, float]
Edge: TypeAlias = tuple[int, int]

log = logging.getLogger(__name__)

FLAT, CUT, MOUNTAIN_AND_VALLEY = "F", "C", {"M", "V"}
FOLDS = {"U", *MOUNTAIN_AND_VALLEY}
RANKS = "FBCUMV"  # of lines that lie on each other that counts which stands later here
ROUNDING = 1e-9  # of the largest distance that is merged: below it none is said


class CreaseLine(NamedTuple):
    """A line from ``start`` to ``end`` with the ``letter`` that FOLD has for it, the
    ``place`` of the file where it stands, and its fold ``angle`` (degrees) where that is
    given."""

    start: Place
    end: Place
    letter: str
    place: str
    angle: float | None = None


class _Vertices(NamedTuple):
    """Vertices (v, 2), the one (k,) that each place became, and the largest distance
    between a place and its vertex."""

    points: np.ndarray
    of_places: np.ndarray
    moved: float


def fold_content(lines: Sequence[CreaseLine]) -> dict[str, Any]:
    """The vertices and edges of a FOLD file with these lines.

    What is merged and split is said in a warning, and where lines lie on each other: a
    fold counts more than a boundary, and what is a mountain and a valley is unassigned.
    Raises `GeometryError` where there is no line, and where a cut lies on a fold.
    """
    require(len(lines) > 0, "lines", "none", "the lines of a crease pattern")
    ends = np.array([[line.start, line.end] for line in lines])
    size = float(np.ptp(ends.reshape(-1, 2), axis=0).max())
    require(size > 0.0, "lines", "all in one point", "of a length other than zero")
    within = is_same_vertex.threshold * size
    crossings = _crossings(ends, within)
    vertices = _merged(np.concatenate([ends.reshape(-1, 2), crossings]), within)
    pairs = vertices.of_places[: 2 * len(lines)].reshape(-1, 2)
    edges = _edges(lines, pairs, vertices, within)
    content: dict[str, Any] = {
        "vertices_coords": vertices.points.tolist(),
        "edges_vertices": [list(edge) for edge in edges],
        "edges_assignment": [line.letter for line in edges.values()],
    }
    if any(line.angle is not None for line in lines):
        content["edges_foldAngle"] = [line.angle for line in edges.values()]
    return content


def _edges(
    lines: Sequence[CreaseLine], pairs: np.ndarray, vertices: _Vertices, within: float
) -> dict[Edge, CreaseLine]:
    """The edges between vertices with the line of each; the lines have their ends in
    ``pairs`` (l, 2) of them."""
    tree = KDTree(vertices.points)
    drawn: defaultdict[Edge, dict[str, CreaseLine]] = defaultdict(dict)
    split, beside = 0, 0.0
    for line, pair in zip(lines, pairs.tolist(), strict=True):
        chain, distance = _chain(tree, pair, within)
        split += len(chain) > 2
        beside = max(beside, distance)
        for edge in pairwise(chain):
            drawn[min(edge), max(edge)].setdefault(line.letter, line)
    empty = int(np.count_nonzero(pairs[:, 0] == pairs[:, 1]))
    _warn(vertices.moved, split, beside, empty, ROUNDING * within)
    return _one_each(drawn)


def _crossings(ends: np.ndarray, within: float) -> np.ndarray:
    """The places (k, 2) at which lines with these ends (l, 2, 2) cross each other, away
    from their ends."""
    starts, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    lengths = np.linalg.norm(along, axis=1)
    found = [np.empty((0, 2))]
    for number in range(len(ends) - 1):
        others = slice(number + 1, None)
        own, gaps = along[number], starts[others] - starts[number]
        sines = _cross(own, along[others])
        with np.errstate(divide="ignore", invalid="ignore"):
            here = _cross(gaps, along[others]) / sines
            there = _cross(gaps, own) / sines
            is_inside = _is_away(here, lengths[number], within)
            is_inside &= _is_away(there, lengths[others], within)
        found.append(starts[number] + here[is_inside, None] * own)
    return np.concatenate(found)


def _is_away(
    parts: np.ndarray, lengths: np.ndarray | float, within: float
) -> np.ndarray:
    """Whether parts (k,) of the way along lines of these lengths are ``within`` a
    distance of none of their ends."""
    way = parts * lengths
    is_away: np.ndarray = (way > within) & (lengths - way > within)
    return is_away


def _cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    product: np.ndarray = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
    return product


def _merged(places: np.ndarray, within: float) -> _Vertices:
    """Places (k, 2) as vertices, those that are ``within`` a distance as one: where
    most of them are. Vertices are counted in the order of their places."""
    _, first, number, count = np.unique(
        places, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    pairs = KDTree(places[first]).query_pairs(within, output_type="ndarray")
    cluster = _clusters(len(first), pairs)
    chosen: dict[int, int] = {}
    for one in np.argsort(first).tolist():
        known = chosen.setdefault(int(cluster[one]), one)
        if count[one] > count[known]:
            chosen[int(cluster[one])] = one
    order = np.empty(len(chosen), dtype=int)
    order[list(chosen)] = np.arange(len(chosen))
    of_places = order[cluster[number.ravel()]]
    points = places[first[list(chosen.values())]]
    moved = np.linalg.norm(places - points[of_places], axis=1)
    return _Vertices(points, of_places, float(moved.max()))


def _clusters(count: int, pairs: np.ndarray) -> np.ndarray:
    """The number (count,) of the cluster of each of some places, that pairs (k, 2) of
    them join."""
    links = (np.ones(len(pairs)), tuple(pairs.T))
    graph = csr_array(links, shape=(count, count))
    clusters: np.ndarray = connected_components(graph, directed=False)[1]
    return clusters


def _chain(tree: KDTree, pair: Sequence[int], within: float) -> tuple[list[int], float]:
    """The vertices on the line between a ``pair`` of them, in order, and how far beside
    it they are at most."""
    start, end = tree.data[pair]
    length = float(np.linalg.norm(end - start))
    if length == 0.0:
        return [], 0.0
    along = (end - start) / length
    near = tree.query_ball_point(0.5 * (start + end), 0.5 * length + within)
    gaps = tree.data[near] - start
    way, beside = gaps @ along, np.abs(_cross(along, gaps))
    is_between = (way > 0.0) & (way < length) & (beside <= within)
    is_between &= ~np.isin(near, pair)
    between = np.flatnonzero(is_between)
    between = between[np.argsort(way[between], kind="stable")]
    chain = [pair[0], *(near[k] for k in between), pair[1]]
    return chain, float(beside[between].max(initial=0.0))


def _one_each(
    drawn: Mapping[Edge, Mapping[str, CreaseLine]],
) -> dict[Edge, CreaseLine]:
    """The line of each edge, of the first ones of each letter that are ``drawn`` there;
    with a warning where there are several."""
    lines = {}
    several: dict[str, str] = {}
    for edge, by_letter in drawn.items():
        ranked = sorted(by_letter.values(), key=lambda one: RANKS.index(one.letter))
        line = ranked[-1]
        folds = FOLDS & by_letter.keys()
        if CUT in by_letter and folds:
            cut = by_letter[CUT]
            value = f"C, and {line.letter} of {line.place} lies on it"
            raise GeometryError(cut.place, value, "no cut where a fold is")
        if folds >= MOUNTAIN_AND_VALLEY:
            line = line._replace(letter="U", angle=None)
        lines[edge] = line
        places = [one.place for one in by_letter.values() if one.letter != FLAT]
        for place in places[1:]:
            several.setdefault(place, places[0])
    if several:
        log.warning(
            "lines lie on others of another letter; a fold counts, and is unassigned "
            "where it is a mountain and a valley: %s",
            listed([f"{one} on {other}" for one, other in several.items()]),
        )
    return lines


def _warn(moved: float, split: int, beside: float, empty: int, least: float) -> None:
    """Say what was changed, by the ``least`` distance or more."""
    said = []
    if moved > least:
        said.append(f"ends up to {moved:.3g} from each other are one vertex")
    if split:
        aside = f", up to {beside:.3g} beside them" if beside > least else ""
        said.append(f"split where others meet them: {split}{aside}")
    if empty:
        said.append(f"left out, of no length: {empty}")
    if said:
        log.warning("lines of the crease pattern: %s", "; ".join(said))
