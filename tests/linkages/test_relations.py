"""The relations between linkages hold for random members."""

import networkx as nx
import numpy as np
import pytest

from linkages.catalogue import catalogue, entry
from linkages.entry import RelationKind
from linkages.identification.identify import identify
from linkages.loop import Loop
from linkages.relations import relation_graph, relations_of
from linkages.values import GeometryError
from tests.linkages.isomers import isomerize


def members(name, rng, count=2):
    """Random members, as many as asked for."""
    found = []
    while len(found) < count:
        try:
            found.append(entry(name).build(**entry(name).draw(rng)))
        except GeometryError:
            continue
    return found


def is_case(loop, name, tolerance=1e-8):
    return identify(loop, tolerance, [entry(name)], locking=False).names == (name,)


def stated_relations():
    """Every relation with the linkage that states it."""
    return [(name, r) for name, found in catalogue().items() for r in found.relations]


def of_kind(*kinds, tori=True):
    chosen = [
        (name, r)
        for name, r in stated_relations()
        if r.kind in kinds and (tori or not entry(name).is_other_view)
    ]
    ids = [f"{name}-{r.other}" for name, r in chosen]
    return pytest.mark.parametrize(("name", "relation"), chosen, ids=ids)


@of_kind(RelationKind.SPECIAL_CASE, RelationKind.SAME)
def test_members_of_the_special_linkage_are_members_of_the_general_one(name, relation):
    assert all(
        is_case(loop, relation.other)
        for loop in members(name, np.random.default_rng(11))
    )


@of_kind(
    RelationKind.SPECIAL_CASE, tori=False
)  # each of their variants has members of most shapes
def test_not_every_member_of_the_general_linkage_is_a_special_one(name, relation):
    (loop,) = members(relation.other, np.random.default_rng(12), 1)
    assert not is_case(loop, name)


@of_kind(RelationKind.SAME)
def test_linkages_that_are_the_same_are_so_both_ways(name, relation):
    assert all(
        is_case(loop, name)
        for loop in members(relation.other, np.random.default_rng(13))
    )


@of_kind(RelationKind.ISOMER)
def test_exchanging_the_links_at_the_joint_gives_the_isomer(name, relation):
    (loop,) = members(relation.other, np.random.default_rng(14), 1)
    assert is_case(isomerize(loop, relation.joint), name)


@of_kind(RelationKind.DEGENERATE)
def test_without_the_vanishing_link_the_smaller_linkage_is_left(name, relation):
    loop = entry(name).build(**{relation.vanishing: 1e-7})
    k = int(np.argmin(loop.lengths))
    lengths, twists, offsets = (
        v[:k] + v[k + 1 :] for v in (loop.lengths, loop.twists, loop.offsets)
    )
    assert loop.lengths[k] < 1e-6
    assert is_case(Loop(lengths, twists, offsets), relation.other, 1e-6)


def test_the_special_cases_make_no_circle():
    graph = relation_graph()
    kept = [
        (u, v)
        for u, v, data in graph.edges(data=True)
        if data["kind"] is RelationKind.SPECIAL_CASE
    ]
    assert nx.is_directed_acyclic_graph(nx.DiGraph(kept))


def test_the_graph_has_every_linkage_and_nothing_else():
    graph = relation_graph()
    assert set(graph) == set(catalogue())
    assert all(data["source"] for _, _, data in graph.edges(data=True))
    assert graph.number_of_edges() == len(stated_relations())


def test_a_linkage_knows_what_it_is_a_case_of():
    kinds = {
        (r.kind, r.other) for r in relations_of("special-double-subtractive-goldberg")
    }
    assert (RelationKind.SPECIAL_CASE, "double-subtractive-goldberg") in kinds


def test_the_same_linkage_knows_it_from_both_sides():
    for one, other in (("bennett", "bennett-lb-2"), ("bennett-lb-2", "bennett")):
        same = {r.other for r in relations_of(one) if r.kind is RelationKind.SAME}
        assert other in same


def test_every_relation_leads_to_a_linkage_of_the_catalogue():
    assert {r.other for _, r in stated_relations()} <= set(catalogue())
