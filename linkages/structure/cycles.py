"""Which closed chains of pairs close a mechanism: a minimum cycle basis."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import networkx as nx

# times the largest weight of a pair: the weight up to which cycles are looked for first
FIRST_LIMIT = 6


class Step(NamedTuple):
    """One step of a chain: across the pair of this number, from its base to its moved
    body or, with the sign -1, the other way."""

    pair: int
    sign: int


Chain: TypeAlias = tuple[Step, ...]


class Ends(NamedTuple):
    """The bodies that a pair joins, by number, and how many unknowns it has."""

    base: int
    moved: int
    unknowns: int


def cycle_basis(bodies: int, pairs: dict[int, Ends]) -> list[Chain]:
    """A cycle basis of the graph of ``bodies`` and ``pairs`` with the fewest unknowns a
    cycle (Horton 1987); pairs that lie on no cycle stand in none.

    Every cycle of such a basis is made of two shortest paths from one body and a pair
    between their ends. Weights are unique, so that the paths and the basis are.
    """
    graph, weights = _weighted_graph(bodies, pairs)
    count = len(pairs) - bodies + nx.number_connected_components(graph)
    longest = FIRST_LIMIT * max(weights.values(), default=0)
    while True:
        # as many as a basis has are one, and lighter than any with a longer cycle
        rows: dict[int, int] = {}
        cycles = [
            cycle
            for cycle in _short_cycles(graph, bodies, pairs, weights, longest)
            if _adds_to(rows, sum(1 << pair for pair in cycle))
        ]
        if len(cycles) == count:
            return [_oriented(cycle, pairs) for cycle in cycles]
        longest *= 2


def _short_cycles(
    graph: nx.Graph,
    bodies: int,
    pairs: dict[int, Ends],
    weights: dict[int, int],
    longest: int,
) -> list[list[int]]:
    """The cycles of two shortest paths and a pair whose weight is ``longest`` at most,
    the lightest first.

    The ends of the pair are no farther from the root than half of that: so the search
    of a large mechanism stays near every root.
    """
    beginning: dict[int, list[int]] = {body: [] for body in range(bodies)}
    for number, ends in pairs.items():
        beginning[ends.base].append(number)
    candidates = []
    for root in range(bodies):
        # on the way across a pair its weight counts twice
        paths = nx.single_source_dijkstra_path(graph, root, cutoff=longest)
        near = sorted(
            number for body in paths if body < bodies for number in beginning[body]
        )
        for number in near:
            cycle = _cycle_across(bodies, paths, number, pairs[number])
            if cycle is None:
                continue
            weight = sum(weights[pair] for pair in cycle)
            if weight <= longest:
                candidates.append((weight, cycle))
    candidates.sort(key=lambda candidate: candidate[0])
    return [cycle for _, cycle in candidates]


def chain_between(
    bodies: int, pairs: dict[int, Ends], start: int, goal: int
) -> Chain | None:
    """The chain of pairs with the fewest unknowns from a body to another one; None
    where there is none."""
    graph, _ = _weighted_graph(bodies, pairs)
    try:
        nodes = nx.dijkstra_path(graph, start, goal)
    except nx.NetworkXNoPath:
        return None
    steps = []
    for body, node in zip(nodes[::2], nodes[1::2], strict=False):
        pair = node - bodies
        steps.append(Step(pair, 1 if pairs[pair].base == body else -1))
    return tuple(steps)


def _weighted_graph(
    bodies: int, pairs: dict[int, Ends]
) -> tuple[nx.Graph, dict[int, int]]:
    """The graph with a node for every body and, numbered after them, for every pair;
    and the weights of the pairs: no two sums of different pairs are equal."""
    most = max(pairs, default=0) + 1
    graph = nx.Graph()
    graph.add_nodes_from(range(bodies))
    weights = {}
    for number, ends in pairs.items():
        weights[number] = (ends.unknowns << most) + (1 << number)
        graph.add_edge(ends.base, bodies + number, weight=weights[number])
        graph.add_edge(bodies + number, ends.moved, weight=weights[number])
    return graph, weights


def _cycle_across(
    bodies: int, paths: dict[int, list[int]], number: int, ends: Ends
) -> list[int] | None:
    """The pairs of the cycle from a root to both ends of a pair and across it; None
    where the two paths share more than the root, or lead nowhere."""
    if ends.base not in paths or ends.moved not in paths:
        return None
    first, second = paths[ends.base], paths[ends.moved]
    shared = set(first) & set(second)
    if len(shared) > 1 or bodies + number in first or bodies + number in second:
        return None
    nodes = [*first, bodies + number, *reversed(second)]
    return [node - bodies for node in nodes if node >= bodies]


def _adds_to(rows: dict[int, int], cycle: int) -> bool:
    """Whether a cycle, a set of pairs as bits, is no sum of those before it; then it is
    added to the ``rows``, which are reduced, by their highest bit."""
    while cycle:
        highest = cycle.bit_length()
        if highest not in rows:
            rows[highest] = cycle
            return True
        cycle ^= rows[highest]
    return False


def _oriented(cycle: list[int], pairs: dict[int, Ends]) -> Chain:
    """The cycle as steps, from the base of its first pair on."""
    first = cycle.index(min(cycle))
    ordered = cycle[first:] + cycle[:first]
    steps = [Step(ordered[0], 1)]
    body = pairs[ordered[0]].moved
    if len(ordered) > 1 and body not in pairs[ordered[1]][:2]:
        ordered = [ordered[0], *reversed(ordered[1:])]
    for number in ordered[1:]:
        ends = pairs[number]
        sign = 1 if ends.base == body else -1
        steps.append(Step(number, sign))
        body = ends.moved if sign > 0 else ends.base
    return tuple(steps)
