"""The graphs of an atlas as a GraphML file."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.graphs import arc_graph, transition_graph

__all__ = ["plain_graph", "write_graphml"]


def write_graphml(atlas: Atlas, path: str | os.PathLike[str]) -> Path:
    """The path of the GraphML file just written, with both graphs of the atlas; see
    `plain_graph`.

    Written under a temporary name beside it and renamed, so that no half-written file
    is ever found there.
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise NotADirectoryError(f"{target.parent}: there is no such folder")
    with tempfile.TemporaryDirectory(
        prefix=f".{target.name}.", dir=target.parent
    ) as folder:
        part = Path(folder) / target.name
        nx.write_graphml_xml(plain_graph(atlas), part)
        os.replace(part, target)
    return target


def plain_graph(atlas: Atlas) -> nx.MultiGraph:
    """The graph of forms and the graph of arcs side by side, with attributes of plain
    types.

    The attribute ``layer`` of nodes and edges is "forms" or "arcs", ``label`` the name.
    Nodes are called ``form/NAME`` and ``point/NAME``. A vector becomes one attribute
    for each unknown, such as ``travel_theta1``.
    """
    out = nx.MultiGraph()
    for name, data in transition_graph(atlas).nodes(data=True):
        out.add_node(f"form/{name}", label=name, layer="forms", **_plain(data, atlas))
    for a, b, data in transition_graph(atlas).edges(data=True):
        out.add_edge(f"form/{a}", f"form/{b}", label=data["bifurcation"], layer="forms")
    for name, data in arc_graph(atlas).nodes(data=True):
        out.add_node(f"point/{name}", label=name, layer="arcs", **_plain(data, atlas))
    for a, b, data in arc_graph(atlas).edges(data=True):
        form = atlas.forms[data["form"]].name
        out.add_edge(
            f"point/{a}", f"point/{b}", label=form, layer="arcs", **_plain(data, atlas)
        )
    return out


def _plain(data: dict[str, Any], atlas: Atlas) -> dict[str, Any]:
    """Attributes with vectors taken apart and numpy's numbers made Python's."""
    out: dict[str, Any] = {}
    for key, value in data.items():
        if isinstance(value, np.ndarray):
            out |= {
                f"{key}_{name}": float(x)
                for name, x in zip(atlas.names, value, strict=True)
            }
        else:
            out[key] = value.item() if isinstance(value, np.generic) else value
    return out
