"""How far rods and legs can carry what hangs on nothing else.

Bodies and points that only rods join to the rest have no limits of their own: the rods
hold them. Lengths are in the unit of the structure, at configurations that are closed
up to a misclosure.
"""

from __future__ import annotations

import numpy as np

from linkages.structure.free_points import FreePoint
from linkages.structure.rods import Rod
from linkages.structure.structure import FreePair, Structure


class RodReach:
    """The reach of the rods of a ``structure`` where residuals are at most
    ``misclosure``."""

    def __init__(self, structure: Structure, misclosure: float):
        self.structure = structure
        self.misclosure = misclosure

    def longest(self, rod: Rod) -> float:
        """How far apart the ends of a rod can be, its slide at a limit."""
        rest = rod.length / self.structure.unit
        length = rest
        if rod.leg is not None:
            length += self.structure.largest_value(rod.leg.variable)
        return float(np.sqrt(length**2 + 2.0 * rest * self.misclosure))

    def shift_of_body(self, pair: FreePair) -> float:
        """How far the center of a free pair can be from where it is in the reference
        configuration: the first of the rods that hold it ends there."""
        ends = {pair.base, pair.moved}
        first = next(rod for rod in self.structure.rods if set(rod.ends) == ends)
        return self._span(first)

    def shift_of_point(self, point: FreePoint) -> float:
        """How far a free point can be from where it is in the reference configuration:
        along the shortest chain of rods from the body that its place is measured
        from."""
        import networkx as nx  # it takes long to import

        graph = nx.Graph()
        held, numbers = set(), set()
        for rod in self.structure.rods:
            graph.add_edge(*rod.points, span=self._span(rod))
            for body, number in zip(rod.ends, rod.points, strict=True):
                if body == point.base:
                    held.add(number)
                if body == point.body:
                    numbers.add(number)
        spans = nx.multi_source_dijkstra_path_length(graph, held, weight="span")
        return float(min(spans[number] for number in numbers))

    def _span(self, rod: Rod) -> float:
        """How far one end of a rod can be, seen from the other one, from where it is in
        the reference configuration."""
        first, second = rod.centers
        distance = float(np.linalg.norm(second - first)) / self.structure.unit
        return self.longest(rod) + distance
