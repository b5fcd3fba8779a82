"""Connected parts of a graph: scipy, which has them, takes longer to import than a small
problem to solve."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def connected_parts(count: int, groups: Iterable[Sequence[int]]) -> list[int]:
    """Number of the part that each of so many things belongs to, counted from 0 in the
    order of the things, where those of a group are connected."""
    parent = list(range(count))

    def root(thing: int) -> int:
        while parent[thing] != thing:
            parent[thing] = parent[parent[thing]]
            thing = parent[thing]
        return thing

    for group in groups:
        roots = [root(thing) for thing in group]
        for other in roots:
            parent[other] = min(roots)
    roots = [root(thing) for thing in range(count)]
    numbers = {first: number for number, first in enumerate(sorted(set(roots)))}
    return [numbers[one] for one in roots]
