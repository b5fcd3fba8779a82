"""The graphs of an atlas as a GraphML file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.files.atomic import replace_file
from bifurc.graphs import arc_graph, transition_graph

__all__ = ["plain_graph", "write_graphml"]


def write_graphml(atlas: Atlas, path: str | os.PathLike[str]) -> Path:
    """The path of the GraphML file just written, with both graphs of the atlas; see
    `plain_graph`.

    There is never a half-written file under ``path``. Raises `OSError` that names
    ``path`` where it cannot be written.
    """
    graph = plain_graph(atlas)
    return replace_file(path, lambda part: nx.write_graphml_xml(graph, part))


def plain_graph(atlas: Atlas) -> nx.MultiGraph:
    """The graph of forms and the graph of arcs side by side, with attributes of plain
    types.

    The attribute ``layer`` of nodes and edges is "forms" or "arcs", ``label`` the name.
    Nodes are called ``form/NAME`` and ``point/NAME``. A vector becomes one attribute
    for each unknown, such as ``travel_theta1``.
    """
    out = nx.MultiGraph()
    forms = transition_graph(atlas)
    for name, data in forms.nodes(data=True):
        plain = _plain_attributes(data, atlas.names)
        out.add_node(f"form/{name}", label=name, layer="forms", **plain)
    for a, b, bifurcation in forms.edges(data="bifurcation"):
        out.add_edge(f"form/{a}", f"form/{b}", label=bifurcation, layer="forms")
    arcs = arc_graph(atlas)
    for name, data in arcs.nodes(data=True):
        plain = _plain_attributes(data, atlas.names)
        out.add_node(f"point/{name}", label=name, layer="arcs", **plain)
    for a, b, data in arcs.edges(data=True):
        label = atlas.forms[data["form"]].name
        plain = _plain_attributes(data, atlas.names)
        out.add_edge(f"point/{a}", f"point/{b}", label=label, layer="arcs", **plain)
    return out


def _plain_attributes(
    data: Mapping[str, object], names: tuple[str, ...]
) -> dict[str, object]:
    """Attributes with vectors taken apart and numpy's numbers made Python's."""
    out: dict[str, object] = {}
    for key, value in data.items():
        if isinstance(value, np.ndarray):
            for name, component in zip(names, value.tolist(), strict=True):
                out[f"{key}_{name}"] = component
        elif isinstance(value, np.generic):
            out[key] = value.item()
        else:
            out[key] = value
    return out
