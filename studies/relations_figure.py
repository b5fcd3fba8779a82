"""The relations between the linkages of the catalogue, drawn from the general (left) to
the special (right).

python -m studies.relations_figure --out out/relations
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import click
import networkx as nx
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch

from linkages.app.options import FOLDER
from linkages.entry import RelationKind
from linkages.relations import relation_graph
from studies.study import Study


class Line(NamedTuple):
    """How the arrows of one kind of relation look."""

    colour: str
    dashes: str


LINES = {
    RelationKind.SPECIAL_CASE: Line("#0072B2", "-"),
    RelationKind.ISOMER: Line("#D55E00", "--"),
    RelationKind.DEGENERATE: Line("#CC79A7", "-."),
    RelationKind.CONSTRUCTED: Line("#9ACD9A", "-"),
}
# How far arrows bend: those of degenerate cases run beside the straight line of what
# was constructed, those between boxes of one column around the boxes.
DEGENERATE_BEND = 0.15
COLUMN_BEND = 0.5

LETTERS = 28  # of a line in a box
ROW = 1.25  # distance of two rows
COLUMN = 4.2  # distance of two columns
HALF_BOX = 1.05  # half the width of a box
ROUNDS = 12  # of moving linkages towards their neighbours
TORI = "torus-5r (16 variants)"


def draw_relations() -> Figure:
    """A figure with every linkage that has a relation; those that are the same linkage
    stand in one box."""
    graph = _merged(relation_graph())
    places = _places(graph)
    columns, rows = np.array(list(places.values())).max(axis=0)
    size = (2.9 * (columns / COLUMN + 1), 0.42 * rows + 2)
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_axis_off()
    axes.set_xlim(-0.5 * COLUMN, columns + 0.5 * COLUMN)
    axes.set_ylim(rows + 1, -1)
    for first, second, kind in graph.edges(data="kind"):
        axes.add_patch(_arrow(places[first], places[second], kind))
    for name, place in places.items():
        _draw_box(axes, place, [name, *graph.nodes[name]["others"]])
    for kind, line in LINES.items():
        axes.plot([], [], color=line.colour, linestyle=line.dashes, label=kind.value)
    axes.legend(loc="upper center", ncols=len(LINES), frameon=False, fontsize=8)
    return figure


def _arrow(
    start: tuple[float, float], end: tuple[float, float], kind: RelationKind
) -> FancyArrowPatch:
    """An arrow from side to side of two boxes, in one column around them."""
    x, y = start
    u, v = end
    line = LINES[kind]
    side = float(np.sign(u - x))
    if side:
        ends = (x + side * HALF_BOX, y), (u - side * HALF_BOX, v)
        bend = DEGENERATE_BEND if kind is RelationKind.DEGENERATE else 0.0
    else:
        ends = (x + HALF_BOX, y), (u + HALF_BOX, v)
        bend = COLUMN_BEND
    return FancyArrowPatch(
        *ends,
        connectionstyle=f"arc3,rad={bend}",
        shrinkA=0,
        shrinkB=0,
        color=line.colour,
        arrowstyle="-|>",
        linestyle=line.dashes,
        mutation_scale=9,
        zorder=1,
    )


def _draw_box(axes: Axes, place: tuple[float, float], names: list[str]) -> None:
    """A linkage with its other names below its first."""
    paragraphs = []
    for i, name in enumerate(names):
        paragraphs.append(textwrap.fill(f"= {name}" if i else name, LETTERS))
    axes.text(
        *place,
        "\n".join(paragraphs),
        ha="center",
        va="center",
        fontsize=7,
        zorder=2,
        bbox={"boxstyle": "round", "facecolor": "white", "edgecolor": "#bbbbbb"},
    )


# --- linkages that are the same -------------------------------------------------------


def _merged(graph: nx.MultiDiGraph) -> nx.MultiDiGraph:
    """The graph with linkages that are the same in one node, whose ``others`` are their
    names."""
    first_names = _first_names(graph)
    merged = nx.MultiDiGraph()
    for first, second, key, data in graph.edges(keys=True, data=True):
        start = first_names.get(first, first)
        end = first_names.get(second, second)
        if start != end:
            merged.add_edge(start, end, key, **data)
        merged.add_node(end)
    for node in merged:
        others = [name for name, first in first_names.items() if first == node]
        # the name of all the tori says by itself how many they are
        merged.nodes[node]["others"] = [] if node == TORI else others
    return merged


def _first_names(graph: nx.MultiDiGraph) -> dict[str, str]:
    """The name in whose box a linkage stands, of those that do not stand in their
    own."""
    names = {}
    for first, second, kind in graph.edges(data="kind"):
        if kind is RelationKind.SAME:
            names[first] = second
    for name in graph:
        if name.startswith("torus-5r"):
            names[name] = TORI
    return names


# --- where they stand -----------------------------------------------------------------


def _places(graph: nx.MultiDiGraph) -> dict[str, tuple[float, float]]:
    """Columns by how many steps of specialisation or construction lie before a linkage;
    rows by its neighbours."""
    levels = _levels(graph)
    columns: dict[int, list[str]] = {}
    for part in sorted(nx.weakly_connected_components(graph), key=len, reverse=True):
        for name in sorted(part):
            columns.setdefault(levels[name], []).append(name)
    heights = _heights(graph, list(columns.values()))
    return {name: (COLUMN * levels[name], ROW * heights[name]) for name in graph}


def _levels(graph: nx.MultiDiGraph) -> dict[str, int]:
    """The column of every linkage. Constructions count where they do not contradict
    the special cases."""
    order = nx.DiGraph()
    order.add_nodes_from(graph)
    for kind in (RelationKind.SPECIAL_CASE, RelationKind.CONSTRUCTED):
        for first, second in _edges_of(graph, kind):
            if not nx.has_path(order, first, second):
                order.add_edge(second, first)
    levels = {}
    for level, names in enumerate(nx.topological_generations(order)):
        for name in names:
            levels[name] = level
    return levels


def _edges_of(graph: nx.MultiDiGraph, kind: RelationKind) -> Iterator[tuple[str, str]]:
    for first, second, own_kind in graph.edges(data="kind"):
        if own_kind is kind:
            yield first, second


def _heights(graph: nx.MultiDiGraph, columns: list[list[str]]) -> dict[str, float]:
    """Linkages move to the mean height of their neighbours, which gives their order in
    a column, and are spaced evenly in that order."""
    heights: dict[str, float] = {}
    for names in columns:
        for row, name in enumerate(names):
            heights[name] = float(row)
    tallest = max(len(names) for names in columns)
    for _ in range(ROUNDS):
        for names in columns:
            means = {name: _mean_height(graph, name, heights) for name in names}
            names.sort(key=means.__getitem__)
            for row, name in enumerate(names):
                heights[name] = (row + 0.5) * tallest / len(names)
    return heights


def _mean_height(graph: nx.MultiDiGraph, name: str, heights: dict[str, float]) -> float:
    """Mean height of a linkage and its neighbours."""
    neighbours = [heights[other] for other in nx.all_neighbors(graph, name)]
    return float(np.mean([heights[name], *neighbours]))


@click.command(cls=Study)
@click.option(
    "--out",
    type=FOLDER,
    default=Path("out/relations"),
)
def main(out: Path) -> None:
    """Draw the relations between the linkages of the catalogue into relations.svg and
    relations.png."""
    out.mkdir(parents=True, exist_ok=True)
    figure = draw_relations()
    for ending in ("svg", "png"):
        figure.savefig(out / f"relations.{ending}", dpi=110)
    click.echo(f"wrote relations.svg and relations.png to {out}")


if __name__ == "__main__":
    main()
