"""The picture of the graph of forms."""

from __future__ import annotations

import textwrap

import networkx as nx
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.figures.drawing import SETTINGS, Style, form_style, note_emptiness
from bifurc.graphs import transition_graph

__all__ = ["plot_form_graph"]

SURFACE = Style("0.6", "-")
REACH = 1.9  # distance between neighbouring forms, in inches
LABEL_PLACES = (20, 16, 24, 13, 27)  # along the 41 points of an edge
# how far neighbouring edges between the same two forms bow apart, in the same unit
BOW = 0.34


def plot_form_graph(atlas: Atlas, figure: Figure | None = None) -> Figure:
    """Forms as boxes, joined by a line for every bifurcation at which two of them meet;
    components stand apart.

    Surfaces that meet a form or another surface are grey boxes.
    """
    places = _places(atlas)
    spots = np.array(list(places.values())).reshape(-1, 2)
    low, high = (
        (spots.min(axis=0) - 0.9, spots.max(axis=0) + 0.9)
        if len(spots)
        else (np.zeros(2), np.full(2, 2.0))
    )
    with rc_context(SETTINGS):
        figure = figure or Figure(figsize=tuple(np.maximum(high - low, [3.2, 1.6])))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.set_axis_off()
        _draw_edges(axes, atlas, places)
        for i, (name, place) in enumerate(
            sorted(places.items(), key=lambda item: _order(atlas).index(item[0]))
        ):
            style = form_style(i) if i < len(atlas.forms) else SURFACE
            axes.text(
                place[0],
                place[1],
                textwrap.fill(name, 16),
                ha="center",
                va="center",
                fontsize=9,
                zorder=3,
                bbox={
                    "boxstyle": "round,pad=0.5",
                    "facecolor": "white",
                    "edgecolor": style.color,
                    "linewidth": 2.0,
                    "linestyle": style.dashes,
                },
            )
        if not places:
            note_emptiness(axes, atlas)
    return figure


def _order(atlas: Atlas) -> list[str]:
    """Names of what is drawn: all forms, then the surfaces that meet something."""
    forms = [form.name for form in atlas.forms]
    return forms + [
        surface.name
        for surface in atlas.surfaces
        if transition_graph(atlas).degree(surface.name)
    ]


def _drawn(atlas: Atlas) -> nx.MultiGraph:
    """The graph of what is drawn."""
    return transition_graph(atlas).subgraph(_order(atlas))


def _places(atlas: Atlas) -> dict[str, np.ndarray]:
    """Where each form and surface stands: every component laid out by itself, side by
    side."""
    places: dict[str, np.ndarray] = {}
    order, left = _order(atlas), 0.0
    for members in sorted(
        nx.connected_components(_drawn(atlas)), key=lambda m: min(map(order.index, m))
    ):
        names = sorted(members, key=order.index)
        spots = _layout(nx.Graph(_drawn(atlas).subgraph(names)), names)
        spots[:, 0] += left - spots[:, 0].min()
        left = spots[:, 0].max() + REACH
        places |= dict(zip(names, spots, strict=True))
    return places


def _layout(graph: nx.Graph, names: list[str]) -> np.ndarray:
    """Places (k, 2) of the forms of one component about the origin, neighbours `REACH`
    apart on average."""
    k = len(names)
    if k <= 2:
        return np.stack([REACH * np.arange(k), np.zeros(k)], axis=1)
    around = list(
        nx.dfs_preorder_nodes(graph, names[0])
    )  # so that a cycle becomes a circle
    angles = (
        np.pi / 2 + (np.pi / k if k % 2 == 0 else 0.0) - 2 * np.pi * np.arange(k) / k
    )
    circle = {
        name: (np.cos(a), np.sin(a)) for name, a in zip(around, angles, strict=True)
    }
    found = nx.kamada_kawai_layout(graph, pos=circle)
    spots = np.array([found[name] for name in names])
    spots -= spots.mean(axis=0)
    _, extent, axes = np.linalg.svd(spots, full_matrices=False)
    if (
        extent[0] > 1.2 * extent[1]
    ):  # the long way lies flat, the first form at its left or upper end
        spots = spots @ axes.T
        spots *= np.where(spots[0] * [1, -1] > 0, -1.0, 1.0)
        spots[:, 1] *= extent[1] > 0.05 * extent[0]  # a chain is drawn straight
    lengths = [
        np.linalg.norm(spots[names.index(a)] - spots[names.index(b)])
        for a, b in graph.edges
        if a != b
    ]
    return spots * (REACH / np.mean(lengths))


def _draw_edges(axes: Axes, atlas: Atlas, places: dict[str, np.ndarray]) -> None:
    """Edges between the same two forms bow apart; each carries its name where no other
    name is near."""
    between: dict[tuple[str, str], list[str]] = {}
    order = _order(atlas)
    for a, b, key in _drawn(atlas).edges(keys=True):
        first, last = sorted((a, b), key=order.index)
        between.setdefault((first, last), []).append(key)
    named = np.array(list(places.values())).reshape(-1, 2)
    for (first, last), keys in between.items():
        for k, key in enumerate(sorted(keys, key=lambda name: (len(name), name))):
            line = _edge(places[first], places[last], k, len(keys))
            axes.plot(line[:, 0], line[:, 1], color="0.35", linewidth=1.2, zorder=1)
            free = [
                i
                for i in LABEL_PLACES
                if np.linalg.norm(named - line[i], axis=1).min() > 0.35
            ]
            middle = line[free[0] if free else LABEL_PLACES[0]]
            named = np.vstack([named, middle])
            axes.text(
                middle[0],
                middle[1],
                key,
                ha="center",
                va="center",
                fontsize=8.5,
                zorder=2,
                bbox={
                    "boxstyle": "square,pad=0.15",
                    "facecolor": "white",
                    "linewidth": 0,
                },
            )


def _edge(start: np.ndarray, end: np.ndarray, number: int, count: int) -> np.ndarray:
    """Points (41, 2) of one of ``count`` edges between two places, a loop above where
    these are the same."""
    t = np.linspace(0.0, 1.0, 41)[:, None]
    if np.array_equal(start, end):
        size, angle = 0.4 + 0.15 * number, 2 * np.pi * t - np.pi / 2
        return (
            start
            + np.array([0.0, size])
            + size * np.hstack([0.8 * np.cos(angle), np.sin(angle)])
        )
    step = end - start
    across = np.array([step[1], -step[0]]) / np.linalg.norm(step)
    bow = 2 * BOW * (number - (count - 1) / 2)
    return (
        start
        + t * step
        + 4 * t * (1 - t) * bow * np.sign(-across[1] or -across[0]) * across
    )
