"""The picture of the graph of forms."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

import networkx as nx
import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.figures.drawing import note_emptiness
from bifurc.figures.rendering import RC
from bifurc.figures.style import Properties, Style, form_style
from bifurc.graphs import transition_graph

SURFACE = Style("0.6", "-")
MARGIN = 0.9  # around the forms, in inches
NAME_WIDTH = 16  # letters of a line in a box
CENTERED: Properties = {"ha": "center", "va": "center"}
BOX = {"boxstyle": "round,pad=0.5", "facecolor": "white", "linewidth": 2.0}
EDGE_BOX = {"boxstyle": "square,pad=0.15", "facecolor": "white", "linewidth": 0}


def plot_form_graph(atlas: Atlas, figure: Figure | None = None) -> Figure:
    """Forms as boxes, joined by a line for every bifurcation at which two of them meet;
    components stand apart.

    Surfaces that meet a form or another surface are grey boxes.
    """
    layout = lay_out_graph(atlas)
    low = np.zeros(2)
    high = np.full(2, 2.0)
    if layout.names:
        low = layout.places.min(axis=0) - MARGIN
        high = layout.places.max(axis=0) + MARGIN
    with rc_context(RC):
        figure = figure or Figure(figsize=tuple(np.maximum(high - low, [3.2, 1.6])))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.set_axis_off()
        for edge in layout.edges:
            axes.plot(*edge.line.T, color="0.35", linewidth=1.2, zorder=1)
            x, y = edge.label.tolist()
            style = {"fontsize": 8.5, "zorder": 2, "bbox": EDGE_BOX, **CENTERED}
            axes.text(x, y, edge.name, **style)
        for i, name in enumerate(layout.names):
            color, dashes = form_style(i) if i < len(atlas.forms) else SURFACE
            text = textwrap.fill(name, NAME_WIDTH)
            box = {"edgecolor": color, "linestyle": dashes, **BOX}
            x, y = layout.places[i].tolist()
            axes.text(x, y, text, fontsize=9, zorder=3, bbox=box, **CENTERED)
        if not layout.names:
            note_emptiness(axes, atlas)
    return figure


REACH = 1.9  # distance between neighbouring forms, in inches
BOW = 0.34  # between neighbouring edges of the same two forms, in inches
EDGE_POINTS = 41
LAYOUT_STEPS = 1000  # at most; a step of the layout of twelve forms takes 40 us
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


def lay_out_graph(atlas: Atlas) -> GraphLayout:
    """The graph of forms in the plane; every component is laid out by itself, side by
    side."""
    everything = transition_graph(atlas)
    names = [form.name for form in atlas.forms]
    for surface in atlas.surfaces:
        if everything.degree(surface.name):
            names.append(surface.name)
    graph = everything.subgraph(names)
    places = np.zeros((len(names), 2))
    left = 0.0
    for indices in _components(graph, names):
        members = [names[i] for i in indices]
        spots = _component_places(nx.Graph(graph.subgraph(members)), members)
        spots[:, 0] += left - spots[:, 0].min()
        left = spots[:, 0].max() + REACH
        places[indices] = spots
    return GraphLayout(tuple(names), places, _lay_out_edges(graph, names, places))


# --- places ---------------------------------------------------------------------------


def _components(graph: nx.MultiGraph, names: list[str]) -> list[list[int]]:
    """Indices of the ``names`` of each connected component, all in their order."""
    components = []
    for members in nx.connected_components(graph):
        components.append(sorted(names.index(name) for name in members))
    return sorted(components)


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
    for _ in range(LAYOUT_STEPS):
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
