"""How the linkages of the catalogue are related, as a graph.

Each entry states what it is to others. "special case of" and "same linkage as" hold up
to `linkages.identification.equivalence` and are checked by
`linkages.identification.identify` on random members; where no source states them, that
is where they come from. Of the special cases only the nearest are stated: the others
follow along the graph.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import networkx as nx

from linkages.catalogue import catalogue, entry
from linkages.entry import Relation, RelationKind


def relation_graph() -> nx.MultiDiGraph:
    """Every linkage as a node with its ``title``, every relation as an edge from the
    linkage that states it.

    Edges are keyed by the words of their kind and hold ``kind`` (`RelationKind`),
    ``source`` and ``detail``.
    """
    graph = nx.MultiDiGraph()
    for name, linkage in catalogue().items():
        graph.add_node(name, title=linkage.title)
    for kind in RelationKind:
        for name, linkage in catalogue().items():
            relations = [r for r in linkage.relations if r.kind is kind]
            _add_edges(graph, name, relations)
    return graph


def _add_edges(
    graph: nx.MultiDiGraph, name: str, relations: Iterable[Relation]
) -> None:
    for relation in relations:
        graph.add_edge(
            name,
            relation.other,
            relation.kind.value,
            kind=relation.kind,
            source=relation.source,
            detail=relation.detail,
        )


def relations_of(name: str) -> tuple[Relation, ...]:
    """What the linkage called ``name`` is to others, in the order of the kinds; the
    same linkages also where the other states it.

    Raises `linkages.catalogue.UnknownLinkageError`.
    """
    relations = list(entry(name).relations)
    for other, linkage in catalogue().items():
        for relation in linkage.relations:
            is_same = relation.kind is RelationKind.SAME
            if is_same and relation.other == name:
                relations.append(replace(relation, other=other))
    kinds = list(RelationKind)
    return tuple(sorted(relations, key=lambda relation: kinds.index(relation.kind)))
