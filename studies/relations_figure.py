"""The relations between the linkages of the catalogue, drawn from the general (left) to
the special (right).

python -m studies.relations_figure --out out/relations
"""

from __future__ import annotations

import textwrap
from pathlib import Path

import click
import networkx as nx
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch

from linkages.relations import RelationKind, relation_graph

__all__ = ["draw_relations"]

STYLES = {
    RelationKind.SPECIAL_CASE: ("#0072B2", "-"),
    RelationKind.ISOMER: ("#D55E00", "--"),
    RelationKind.DEGENERATE: ("#CC79A7", "-."),
    RelationKind.CONSTRUCTED: ("#9ACD9A", "-"),
}
BENDS = {
    RelationKind.DEGENERATE: 0.15
}  # beside the straight line of what was constructed from it
WIDTH, ROW, COLUMN, HALF = (
    28,
    1.25,
    4.2,
    1.05,
)  # letters of a line; distances of nodes, half width of a box


def draw_relations() -> Figure:
    """A figure with every linkage that has a relation; those that are the same linkage
    stand in one box."""
    graph = _merged(relation_graph())
    places = _places(graph)
    columns, rows = (max(place[axis] for place in places.values()) for axis in (0, 1))
    figure = Figure(
        figsize=(2.9 * (columns / COLUMN + 1), 0.42 * rows + 2), layout="constrained"
    )
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_axis_off()
    axes.set_xlim(-0.5 * COLUMN, columns + 0.5 * COLUMN)
    axes.set_ylim(rows + 1, -1)
    for first, second, data in graph.edges(data=True):
        colour, line = STYLES[data["kind"]]
        (x, y), (u, v) = places[first], places[second]
        side = float(
            (u > x) - (u < x)
        )  # arrows go from side to side of the boxes, in one column around them
        start, end = (x + (side or 1) * HALF, y), (u - (side or -1) * HALF, v)
        bend = BENDS.get(data["kind"], 0.0) if side else 0.5
        axes.add_patch(
            FancyArrowPatch(
                start,
                end,
                connectionstyle=f"arc3,rad={bend}",
                shrinkA=0,
                shrinkB=0,
                color=colour,
                arrowstyle="-|>",
                linestyle=line,
                mutation_scale=9,
                zorder=1,
            )
        )
    for name, place in places.items():
        lines = [name, *(f"= {other}" for other in graph.nodes[name]["others"])]
        text = "\n".join(
            textwrap.fill(part, WIDTH, break_on_hyphens=True) for part in lines
        )
        axes.text(
            *place,
            text,
            ha="center",
            va="center",
            fontsize=7,
            zorder=2,
            bbox={"boxstyle": "round", "facecolor": "white", "edgecolor": "#bbbbbb"},
        )
    for kind, (colour, line) in STYLES.items():
        axes.plot([], [], color=colour, linestyle=line, label=kind.value)
    axes.legend(loc="upper center", ncols=len(STYLES), frameon=False, fontsize=8)
    return figure


def _merged(graph: nx.MultiDiGraph) -> nx.MultiDiGraph:
    """The graph with linkages that are the same in one node, whose ``others`` are their
    names."""
    same = {
        u: v
        for u, v, data in graph.edges(data=True)
        if data["kind"] is RelationKind.SAME
    }
    same |= {
        name: "torus-5r (16 variants)" for name in graph if name.startswith("torus-5r")
    }
    merged = nx.MultiDiGraph()
    for first, second, key, data in graph.edges(keys=True, data=True):
        ends = same.get(first, first), same.get(second, second)
        if ends[0] != ends[1]:
            merged.add_edge(*ends, key, **data)
        merged.add_node(ends[1])
    for name in merged:
        merged.nodes[name]["others"] = [
            u for u, v in same.items() if v == name and v in graph
        ]
    return merged


def _places(graph: nx.MultiDiGraph) -> dict[str, tuple[float, float]]:
    """Columns by how many steps of specialisation or construction lie before a linkage;
    rows by its neighbours."""
    order = nx.DiGraph()
    order.add_nodes_from(graph)
    for kind in (RelationKind.SPECIAL_CASE, RelationKind.CONSTRUCTED):
        for first, second, data in graph.edges(data=True):
            if data["kind"] is kind and not (
                first in order and nx.has_path(order, first, second)
            ):
                order.add_edge(second, first)
    level = {
        name: depth
        for depth, layer in enumerate(nx.topological_generations(order))
        for name in layer
    }
    columns: dict[int, list[str]] = {}
    for part in sorted(nx.weakly_connected_components(graph), key=len, reverse=True):
        for name in sorted(part):
            columns.setdefault(level[name], []).append(name)
    height = {
        name: float(row) for names in columns.values() for row, name in enumerate(names)
    }
    tallest = max(map(len, columns.values()))
    for _ in range(12):  # barycentres, then even spacing in the order they give
        for names in columns.values():
            mean = {
                n: np.mean(
                    [height[n], *(height[m] for m in nx.all_neighbors(graph, n))]
                )
                for n in names
            }
            names.sort(key=lambda n: mean[n])
            for row, name in enumerate(names):
                height[name] = (row + 0.5) * tallest / len(names)
    return {name: (COLUMN * level[name], ROW * height[name]) for name in graph}


@click.command()
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("out/relations"),
)
def main(out: Path) -> None:
    """Draw the relations between the linkages of the catalogue into relations.svg and
    relations.png."""
    out.mkdir(parents=True, exist_ok=True)
    figure = draw_relations()
    for kind in ("svg", "png"):
        figure.savefig(out / f"relations.{kind}", dpi=110)
    click.echo(f"wrote relations.svg and relations.png to {out}")


if __name__ == "__main__":
    main()
