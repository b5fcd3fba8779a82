"""The graphs of an atlas as a GraphML file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.diagrams.diagram import Stretch
from bifurc.files.atomic import replace_file
from bifurc.graphs import arc_graph, transition_graph


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
    for each unknown, such as ``travel_theta1``. With a diagram, points have their
    ``branching``, and arcs the ``stability`` of their stretches, one after the other,
    and the names of the ``points`` of the diagram on them.
    """
    out = nx.MultiGraph()
    forms = transition_graph(atlas)
    for name, data in forms.nodes(data=True):
        plain = _plain_attributes(data, atlas.names)
        out.add_node(f"form/{name}", label=name, layer="forms", **plain)
    for a, b, bifurcation in forms.edges(data="bifurcation"):
        out.add_edge(f"form/{a}", f"form/{b}", label=bifurcation, layer="forms")
    kinds = _branching_kinds(atlas)
    arcs = arc_graph(atlas)
    for name, data in arcs.nodes(data=True):
        plain = _plain_attributes(data, atlas.names)
        if name in kinds:
            plain["branching"] = kinds[name]
        out.add_node(f"point/{name}", label=name, layer="arcs", **plain)
    for a, b, data in arcs.edges(data=True):
        label = atlas.forms[data["form"]].name
        plain = _plain_attributes(data, atlas.names)
        plain |= _along_arc(atlas, data["form"], data["start"], data["end"])
        out.add_edge(f"point/{a}", f"point/{b}", label=label, layer="arcs", **plain)
    return out


def _branching_kinds(atlas: Atlas) -> dict[str, str]:
    """What singular points, by their names, are along the parameter."""
    if atlas.diagram is None:
        return {}
    branchings = atlas.diagram.branchings
    return {atlas.points[one.point].name: one.kind.value for one in branchings}


def _along_arc(atlas: Atlas, form: int, start: float, end: float) -> dict[str, object]:
    """What the diagram says of an arc: its stability, and the points on it."""
    diagram = atlas.diagram
    if diagram is None:
        return {}
    branch = atlas.forms[form].branch
    turn = branch.length if branch.closed else 0.0

    def is_on_arc(s: float) -> bool:
        return any(start <= place <= end for place in (s, s + turn, s - turn))

    stretches = [one for one in diagram.stretches if one.form == form]
    middles = [0.5 * (one.start + one.end) for one in stretches]
    words = [
        _stability_words(one)
        for one, middle in zip(stretches, middles, strict=True)
        if is_on_arc(middle)
    ]
    points = [one for one in diagram.points if one.form == form and is_on_arc(one.s)]
    return {
        "stability": ", ".join(words),
        "points": ", ".join(one.name for one in points),
    }


def _stability_words(stretch: Stretch) -> str:
    if stretch.unstable > 0:
        return f"{stretch.stability.value} ({stretch.unstable})"
    return stretch.stability.value


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
