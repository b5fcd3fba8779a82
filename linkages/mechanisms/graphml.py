"""A mechanism as a GraphML file: bodies are nodes, joints are edges."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import networkx as nx

from bifurc.files.atomic import replace_file
from linkages.mechanisms.mechanism import Mechanism, Variable


def write_mechanism_graph(mechanism: Mechanism, path: str | os.PathLike[str]) -> Path:
    """The path of the GraphML file just written; see `plain_mechanism_graph`.

    There is never a half-written file under ``path``. Raises `OSError` that names
    ``path`` where it cannot be written.
    """
    graph = plain_mechanism_graph(mechanism)
    return replace_file(path, lambda part: nx.write_graphml_xml(graph, part))


def plain_mechanism_graph(mechanism: Mechanism) -> nx.MultiGraph:
    """`Mechanism.graph` with attributes of plain types, in rad and the unit of length
    of the mechanism.

    A node says whether its body ``is_frame``. An edge has the ``joint``, its ``kind``,
    the ``base`` with respect to which the body ``moved`` moves, the ``pitch``, and, as
    JSON, ``point``, ``direction`` and ``second_direction``, lists of three numbers, and
    tables by the names of variables: ``locked`` (values), ``limits`` (low and high) and
    ``coupled`` (``to``, ``ratio``, ``offset``). What a joint does not have is left out.
    """
    graph = nx.MultiGraph(name=mechanism.name)
    for body in mechanism.bodies:
        graph.add_node(body, is_frame=body == mechanism.frame)
    for number, pair in enumerate(mechanism.pairs):
        joint = mechanism.joint(pair.joint)
        attributes: dict[str, str | float] = {
            "joint": joint.name,
            "kind": joint.kind.value,
            "base": pair.base,
            "moved": pair.moved,
        }
        for key in ("point", "direction", "second_direction"):
            vector = getattr(joint, key)
            if vector is not None:
                attributes[key] = json.dumps(list(vector))
        if joint.pitch is not None:
            attributes["pitch"] = joint.pitch
        variables = [mechanism.variables[one] for one in pair.variables]
        attributes |= _tables(mechanism, variables)
        graph.add_edge(pair.base, pair.moved, key=number, **attributes)
    return graph


def _tables(mechanism: Mechanism, variables: list[Variable]) -> Mapping[str, str]:
    """What holds the variables of a pair, as JSON tables by their names."""
    tables: dict[str, dict[str, Any]] = {"locked": {}, "limits": {}, "coupled": {}}
    for variable in variables:
        number, ratio, offset = variable.leader
        leader = mechanism.variables[number]
        tables["locked"][variable.label] = variable.locked
        tables["limits"][variable.label] = variable.limits
        if leader is not variable:
            values = {"to": leader.label, "ratio": ratio, "offset": offset}
            tables["coupled"][variable.label] = values
    texts = {}
    for key, table in tables.items():
        given = {label: value for label, value in table.items() if value is not None}
        if given:
            texts[key] = json.dumps(given)
    return texts
