"""Where configurations lie on surfaces, and the ways over surfaces between them."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import networkx as nx
import numpy as np

from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import tangent_planes
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.geodesic import (
    chart_graph,
    entrances,
    path_length,
    shortest_path,
)

# Spacing of the paths whose lengths are compared, over the median radius of the charts.
FINE = 0.11
# Relative residual above which a point has no foot on a surface.
SOLVED = 1e-9
# Where the charts do not reach, the distance from them is this share of a radius at
# least.
RIM = 0.1


@dataclass(frozen=True)
class Crossing:
    """A way over the surface of index ``surface`` between two nodes, ``first`` at
    ``start`` (n,) and ``last`` at ``goal`` (n,).

    Before it is measured it has no ``path`` (k, n), and its ``length`` is that of the
    way straight through space, below that of any path.
    """

    surface: int
    first: Hashable
    last: Hashable
    start: np.ndarray
    goal: np.ndarray
    length: float
    path: np.ndarray | None = None


def measure(problem: Problem, charts: ChartAtlas, crossing: Crossing) -> Crossing:
    """The crossing with its path and length; raises `SurfacePathError` where there is
    no path."""
    spacing = FINE * float(np.median(charts.radii))
    path = shortest_path(problem, charts, crossing.start, crossing.goal, spacing)
    return replace(crossing, path=path, length=path_length(path))


class Foot(NamedTuple):
    """The ``distance`` of a point from a surface and the nearest ``point`` (n,) on it;
    the distance from the charts, and None, where these do not reach."""

    distance: float
    point: np.ndarray | None


def foot_on(problem: Problem, charts: ChartAtlas, point: np.ndarray) -> Foot:
    """The foot of a point (n,) on a surface."""
    gap = _distances(charts, point)
    nearest = np.argmin(gap / charts.radii)
    plane = charts.bases[nearest][None]
    for _ in range(4):
        foot, residuals = correct_normal(problem, point[None], plane)
        plane = tangent_planes(problem, foot, plane)
    if residuals[0] < SOLVED and len(entrances(problem, charts, foot[0])):
        distance = np.linalg.norm(foot[0] - point)
        return Foot(float(distance), foot[0])
    beyond = np.maximum(gap - charts.radii, RIM * charts.radii)
    return Foot(float(beyond.min()), None)


def middle_of(charts: ChartAtlas, points: Iterable[np.ndarray]) -> np.ndarray:
    """The centre (n,) of the chart farthest, from chart to chart, from all singular
    ``points`` (n,); that of the first chart where there is none."""
    sources = set()
    for u in points:
        nearest = np.argmin(_distances(charts, u))
        sources.add(int(nearest))
    if not sources:
        first: np.ndarray = charts.centers[0]
        return first
    graph = chart_graph(charts)
    graph.add_nodes_from(range(len(charts)))
    distance = nx.multi_source_dijkstra_path_length(graph, sources)
    # of charts as far but for rounding the first: the same on every machine
    numbers = sorted(distance)
    farthest = max(numbers, key=lambda k: round(distance[k], 9))
    center: np.ndarray = charts.centers[farthest]
    return center


def _distances(charts: ChartAtlas, point: np.ndarray) -> np.ndarray:
    """Distances (c,) of the centres from a point (n,)."""
    gaps = charts.difference(charts.centers, point)
    distances: np.ndarray = np.linalg.norm(gaps, axis=1)
    return distances
