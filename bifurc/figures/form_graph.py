"""The picture of the graph of forms."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field
from itertools import pairwise

import networkx as nx
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from bifurc.atlas import Atlas
from bifurc.figures.drawing import note_emptiness
from bifurc.figures.layout import Canvas, Size, figure_of, size_of
from bifurc.figures.rc import drawing_style, letter_size, line_style, size_of_user
from bifurc.figures.selection import EVERYTHING, Selection
from bifurc.figures.style import Properties, Style
from bifurc.graphs import transition_graph

SURFACE = Style("0.6", "-")
NAME_WIDTH = 16  # letters of a line in a box
PADDING = 0.5  # of a box, over the size of its letters
LINE = 1.25  # height of a line in it, over the same
EDGE = 0.12  # beside a box at the rim, in inches
CENTERED: Properties = {"ha": "center", "va": "center"}
BOX = {"boxstyle": f"round,pad={PADDING}", "facecolor": "white", "linewidth": 2.0}
EDGE_BOX = {"boxstyle": "square,pad=0.15", "facecolor": "white", "linewidth": 0}


def plot_form_graph(
    atlas: Atlas,
    figure: Canvas | None = None,
    *,
    ax: Axes | None = None,
    selection: Selection = EVERYTHING,
) -> Figure:
    """Forms as boxes, joined by a line for every bifurcation at which two of them meet;
    components stand apart.

    Surfaces that meet a form or another surface are grey boxes. It is drawn into
    ``ax``, or into a ``figure`` or a part of one, or into a new one.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> figure = bifurc.plot_form_graph(atlas)
    >>> sorted(text.get_text() for text in figure.axes[0].texts)[:3]
    ['B1', 'B2', 'B3']
    """
    with drawing_style():
        rim = _rim(atlas, selection)
        room = _room(figure, ax)
        layout = lay_out_graph(atlas, selection, room and room.width - 2 * rim[0])
        low, high = _corners(layout, rim)
        if ax is None:
            if figure is None:
                width, height = np.maximum(high - low, [3.2, 1.4])
                figure = Figure(figsize=(room.width if room else width, height))
            room = size_of(figure)
            ax = figure.add_axes((0, 0, 1, 1))
        # what has room is drawn to scale
        aside = 0.5 * np.maximum(np.array(room) - (high - low), 0.0)
        low, high = low - aside, high + aside
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        ax.set_axis_off()
        _draw_graph(ax, atlas, layout)
        if not layout.names:
            note_emptiness(ax, atlas)
    return figure_of(ax)


def _corners(layout: GraphLayout, rim: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lower left and the upper right corner (2,) of a graph whose boxes reach so
    far, width and height (2,), in inches."""
    if not layout.names:
        return -rim, rim
    low = layout.places.min(axis=0) - rim
    high = layout.places.max(axis=0) + rim
    for edge in layout.edges:
        low = np.minimum(low, edge.line.min(axis=0) - EDGE)
        high = np.maximum(high, edge.line.max(axis=0) + EDGE)
    return low, high


def _room(figure: Canvas | None, ax: Axes | None) -> Size | None:
    """The size of what the graph is drawn into; None where it takes what it needs."""
    part = ax or figure
    if part is not None:
        return size_of(part)
    of_user = size_of_user()
    return of_user and Size(*of_user)


def _rim(atlas: Atlas, selection: Selection) -> np.ndarray:
    """Half of the largest box, width and height (2,), with some room, in inches."""
    letter = letter_size()
    properties = FontProperties(size=72 * letter)
    half = np.zeros(2)
    for name in _names(atlas, selection):
        lines = textwrap.wrap(name, NAME_WIDTH)
        widths = [
            text_to_path.get_text_width_height_descent(line, properties, False)[0]
            for line in lines
        ]
        size = np.array([max(widths) / 72, LINE * letter * len(lines)])
        half = np.maximum(half, 0.5 * size + PADDING * letter)
    return half + EDGE


def _draw_graph(ax: Axes, atlas: Atlas, layout: GraphLayout) -> None:
    for edge in layout.edges:
        ax.plot(*edge.line.T, color="0.35", linewidth=1.2, zorder=1)
        x, y = edge.label.tolist()
        ax.text(x, y, edge.name, zorder=2, bbox=EDGE_BOX, **CENTERED)
    numbers = {form.name: number for number, form in enumerate(atlas.forms)}
    for name, place in zip(layout.names, layout.places, strict=True):
        style = line_style(numbers[name]) if name in numbers else SURFACE
        text = textwrap.fill(name, NAME_WIDTH)
        box = {"edgecolor": style.color, "linestyle": style.dashes, **BOX}
        x, y = place.tolist()
        ax.text(x, y, text, zorder=3, bbox=box, **CENTERED)


REACH = 1.9  # distance between neighbouring forms, in inches
ROW_REACH = 0.9  # between rows of components
BOW = 0.34  # between neighbouring edges of the same two forms, in inches
EDGE_POINTS = 41
LAYOUT_STEPS = 1000  # at most; a step of the layout of twelve forms takes 40 us
LAYOUT_STEPS_OF_ALL = 30_000  # places that all steps move
LAYOUT_STILL = 1e-5  # of the length of an edge: a step that moves nothing farther
TINY = 1e-12  # of the same: places that coincide
LABEL_PLACES = (20, 16, 24, 13, 27)  # along the points of an edge, the best first
CLEARANCE = 0.35  # between a name of an edge and other names, in inches


@dataclass(frozen=True, eq=False)
class GraphEdge:
    """A singular point that joins two forms or surfaces: its ``name``, the ``line``
    (k, 2) drawn for it, and the place ``label`` (2,) of its name."""

    name: str
    line: np.ndarray
    label: np.ndarray


@dataclass(frozen=True, eq=False)
class GraphLayout:
    """The ``names`` of all forms, then of the surfaces that meet something, the
    ``places`` (k, 2) where they stand, and the ``edges``."""

    names: tuple[str, ...]
    places: np.ndarray
    edges: tuple[GraphEdge, ...]


def lay_out_graph(
    atlas: Atlas, selection: Selection = EVERYTHING, width: float | None = None
) -> GraphLayout:
    """The graph of forms in the plane; every component is laid out by itself, side by
    side, or in rows where the ``width`` ends, inches."""
    names = _names(atlas, selection)
    graph = transition_graph(atlas).subgraph(names)
    places = np.zeros((len(names), 2))
    rows = [_Row()]
    for indices in _components(graph, names):
        spots = _component(graph, [names[i] for i in indices], width)
        end = rows[-1].right + np.ptp(spots[:, 0])
        if width is not None and rows[-1].indices and end > width:
            rows.append(_Row())
        spots[:, 0] += rows[-1].right - spots[:, 0].min()
        places[indices] = spots
        rows[-1].indices += indices
        rows[-1].right = spots[:, 0].max() + REACH
    for above, below in pairwise(rows):
        top = places[above.indices, 1].min() - ROW_REACH
        places[below.indices, 1] += top - places[below.indices, 1].max()
    return GraphLayout(tuple(names), places, _lay_out_edges(graph, names, places))


@dataclass
class _Row:
    """Components side by side: the ``indices`` of their names, and where the next one
    begins at the ``right``."""

    indices: list[int] = field(default_factory=list)
    right: float = 0.0


def _names(atlas: Atlas, selection: Selection) -> list[str]:
    """The names of the forms that are drawn, and of the surfaces that meet some of them
    or each other."""
    everything = transition_graph(atlas)
    chosen = selection.indices(atlas) if selection.forms else range(len(atlas.forms))
    names = [atlas.forms[i].name for i in chosen]
    for surface in atlas.surfaces:
        if everything.degree(surface.name):
            names.append(surface.name)
    return names


def shows_transitions(atlas: Atlas, selection: Selection) -> bool:
    """Whether the graph joins two boxes."""
    joined = transition_graph(atlas).subgraph(_names(atlas, selection))
    return any(one != other for one, other in joined.edges())


def _fitted(spots: np.ndarray, width: float | None) -> np.ndarray:
    """Places (k, 2), upright where they are wider than there is room, and narrower
    where they still are."""
    if width is None or np.ptp(spots[:, 0]) <= width:
        return spots
    if np.ptp(spots[:, 1]) < np.ptp(spots[:, 0]):
        spots = np.stack([spots[:, 1], -spots[:, 0]], axis=1)
    extent = np.ptp(spots[:, 0])
    spots[:, 0] *= min(1.0, width / extent) if extent > 0 else 1.0
    return spots


# --- places ---------------------------------------------------------------------------


def _components(graph: nx.MultiGraph, names: list[str]) -> list[list[int]]:
    """Indices of the ``names`` of each connected component, all in their order."""
    components = []
    for members in nx.connected_components(graph):
        components.append(sorted(names.index(name) for name in members))
    return sorted(components)


def _component(
    graph: nx.MultiGraph, names: list[str], width: float | None
) -> np.ndarray:
    """Places (k, 2) of the forms of one component, fitted into a width."""
    spots = _component_places(nx.Graph(graph.subgraph(names)), names)
    return _fitted(spots, width)


def _component_places(graph: nx.Graph, names: list[str]) -> np.ndarray:
    """Places (k, 2) of the forms of one component about the origin, neighbours `REACH`
    apart on average."""
    k = len(names)
    if k <= 2:
        return np.stack([REACH * np.arange(k), np.zeros(k)], axis=1)
    circle = _circle(graph, names[0])
    start = np.array([circle[name] for name in names])
    spots = _laid_flat(_majorized(start, _path_lengths(graph, names)))
    lengths = []
    for a, b in graph.edges:
        if a != b:
            lengths.append(
                np.linalg.norm(spots[names.index(a)] - spots[names.index(b)])
            )
    return np.asarray(spots * (REACH / np.mean(lengths)))


def _path_lengths(graph: nx.Graph, names: list[str]) -> np.ndarray:
    """Numbers of edges (k, k) between each two nodes of a connected graph."""
    lengths = dict(nx.all_pairs_shortest_path_length(graph))
    return np.array([[lengths[a][b] for b in names] for a in names], dtype=float)


def _majorized(places: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Places (k, 2) about the origin whose distances come as near to the ``lengths``
    (k, k) as they can, from ``places`` (k, 2) on.

    The squares of the relative differences are summed (Kamada and Kawai 1989). Each
    step solves the linear equations of Gansner, Koren and North (2004) and lessens
    that sum.
    """
    k = len(places)
    weights = 1.0 / (lengths + np.eye(k)) ** 2 * (1 - np.eye(k))
    inverse = np.linalg.pinv(np.diag(weights.sum(axis=1)) - weights)
    for _ in range(min(LAYOUT_STEPS, LAYOUT_STEPS_OF_ALL // k)):
        gaps = places[:, None] - places
        distances = np.linalg.norm(gaps, axis=-1) + np.eye(k)
        pulls = weights * lengths / np.maximum(distances, TINY)
        step = inverse @ np.sum(pulls[..., None] * gaps, axis=1) - places
        places = places + step
        if np.abs(step).max() < LAYOUT_STILL:
            break
    return np.asarray(places - places.mean(axis=0))


def _circle(graph: nx.Graph, first: str) -> dict[str, tuple[float, float]]:
    """Places on a circle, neighbours side by side, so that a cycle becomes a circle."""
    ring = list(nx.dfs_preorder_nodes(graph, first))
    k = len(ring)
    top = np.pi / 2 + (np.pi / k if k % 2 == 0 else 0.0)
    angles = top - 2 * np.pi * np.arange(k) / k
    places = zip(np.cos(angles), np.sin(angles), strict=True)
    return dict(zip(ring, places, strict=True))


def _laid_flat(spots: np.ndarray) -> np.ndarray:
    """Places (k, 2) about the origin turned so that the long way, if there is one, lies
    flat, with the first form at its left or upper end."""
    _, extent, axes = np.linalg.svd(spots, full_matrices=False)
    if extent[0] <= 1.2 * extent[1]:
        return spots
    turned = spots @ axes.T
    turned *= np.where(turned[0] * [1, -1] > 0, -1.0, 1.0)
    turned[:, 1] *= extent[1] > 0.05 * extent[0]  # a chain is drawn straight
    return np.asarray(turned)


# --- edges ----------------------------------------------------------------------------


def _lay_out_edges(
    graph: nx.MultiGraph, names: list[str], places: np.ndarray
) -> tuple[GraphEdge, ...]:
    """Edges between the same two forms bow apart; each carries its name where no other
    name is near."""
    labels = places  # where names stand, those of forms and then of edges too
    edges = []
    for (first, last), keys in _edges_between(graph, names).items():
        start = places[names.index(first)]
        end = places[names.index(last)]
        for number, key in enumerate(keys):
            line = _edge(start, end, number, len(keys))
            label = _label_place(line, labels)
            labels = np.vstack([labels, label])
            edges.append(GraphEdge(key, line, label))
    return tuple(edges)


def _edges_between(
    graph: nx.MultiGraph, names: list[str]
) -> dict[tuple[str, str], list[str]]:
    """The names of the edges between each two forms that have any, B2 before B10."""
    order = names.index
    between: dict[tuple[str, str], list[str]] = {}
    for a, b, key in graph.edges(keys=True):
        first, last = sorted((a, b), key=order)
        between.setdefault((first, last), []).append(key)
    for keys in between.values():
        keys.sort(key=lambda name: (len(name), name))
    return between


def _label_place(line: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """The point (2,) of a line at which a name stands, away from other ``labels`` (k,
    2) if there is one."""
    for i in LABEL_PLACES:
        if np.linalg.norm(labels - line[i], axis=1).min() > CLEARANCE:
            return np.asarray(line[i])
    return np.asarray(line[LABEL_PLACES[0]])


def _edge(start: np.ndarray, end: np.ndarray, number: int, count: int) -> np.ndarray:
    """Points (41, 2) of one of ``count`` edges between two places, a loop above where
    these are the same."""
    t = np.linspace(0.0, 1.0, EDGE_POINTS)[:, None]
    if np.array_equal(start, end):
        return _loop(start, 0.4 + 0.15 * number, t)
    step = end - start
    normal = np.array([step[1], -step[0]]) / np.linalg.norm(step)
    upward = np.sign(-normal[1] or -normal[0])
    bow = 2 * BOW * (number - (count - 1) / 2)
    bulge = 4 * t * (1 - t) * bow * upward * normal
    return np.asarray(start + t * step + bulge)


def _loop(place: np.ndarray, size: float, t: np.ndarray) -> np.ndarray:
    """Points (k, 2) at fractions ``t`` (k, 1) of a loop that stands on a place."""
    angle = 2 * np.pi * t - np.pi / 2
    ellipse = size * np.hstack([0.8 * np.cos(angle), np.sin(angle)])
    return np.asarray(place + np.array([0.0, size]) + ellipse)
