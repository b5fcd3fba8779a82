"""Where configurations lie on surfaces, and the ways over surfaces as edges of a
graph."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from itertools import combinations
from typing import Any

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import tangent_planes
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.geodesic import entrances, path_length, shortest_path

__all__ = ["add_crossings", "charts_of", "foot_on", "measure_crossing", "middle_of"]

# spacing of the paths whose lengths are compared, over the median radius of the charts
FINE = 0.15


def charts_of(atlas: Atlas) -> dict[int, ChartAtlas]:
    """The charts of every surface that has some, by the index of the surface."""
    return {
        k: surface.charts
        for k, surface in enumerate(atlas.surfaces)
        if surface.charts is not None
    }


def middle_of(charts: ChartAtlas, points: Iterable[np.ndarray]) -> np.ndarray:
    """The centre (n,) of the chart farthest, from chart to chart, from all singular
    ``points`` (n,)."""
    graph = nx.Graph()
    graph.add_nodes_from(range(len(charts)))
    i, j = charts.neighbours.T
    weights = np.linalg.norm(charts.apart(charts.centers[i], charts.centers[j]), axis=1)
    graph.add_weighted_edges_from(
        zip(i.tolist(), j.tolist(), weights.tolist(), strict=True)
    )
    sources = {
        int(np.argmin(np.linalg.norm(charts.apart(charts.centers, u), axis=1)))
        for u in points
    }
    distance = (
        nx.multi_source_dijkstra_path_length(graph, sources) if sources else {0: 0.0}
    )
    return charts.centers[max(sorted(distance), key=lambda k: round(distance[k], 9))]


def foot_on(
    problem: Problem, charts: ChartAtlas, point: np.ndarray
) -> tuple[float, np.ndarray | None]:
    """Distance of a point (n,) from a surface and its foot (n,); from the charts, and
    None, where they do not reach."""
    gap = np.linalg.norm(charts.apart(charts.centers, point), axis=1)
    plane = charts.bases[np.argmin(gap / charts.radii)][None]
    for _ in range(4):
        foot, gaps = correct_normal(problem, point[None], plane)
        plane = tangent_planes(problem, foot, plane)
    if gaps[0] < 1e-9 and len(entrances(problem, charts, foot[0])):
        return float(np.linalg.norm(foot[0] - point)), foot[0]
    return float(np.maximum(gap - charts.radii, 0.1 * charts.radii).min()), None


def add_crossings(
    graph: nx.MultiGraph,
    atlas: Atlas,
    charts: dict[int, ChartAtlas],
    ends: dict[Hashable, dict[int, np.ndarray]],
) -> None:
    """Join all singular points on a surface, and those of the ``ends`` of a route (n,)
    that lie on it, by edges.

    Each has the index of the ``surface``, its ``ends``, and a ``length`` below that of
    any path: the way straight through space. `measure_crossing` replaces it.
    """
    for k in charts:
        members: list[tuple[Hashable, np.ndarray]] = [
            (p.name, p.point.u) for p in atlas.points if k in p.surfaces
        ]
        members += [(node, on[k]) for node, on in ends.items() if k in on]
        for (first, a), (last, b) in combinations(members, 2):
            straight = float(np.linalg.norm(charts[k].apart(a, b)))
            graph.add_edge(
                first,
                last,
                surface=k,
                ends=(a, b),
                length=straight,
                path=None,
                first=first,
                last=last,
            )


def measure_crossing(
    problem: Problem, charts: ChartAtlas, edge: dict[str, Any]
) -> None:
    """Give an edge over a surface its ``path`` (k, n), ``length`` and ``travel`` (n,),
    the turning of each unknown.

    Raises `ValueError` where there is no path.
    """
    start, goal = edge["ends"]
    path = shortest_path(
        problem, charts, start, goal, FINE * float(np.median(charts.radii))
    )
    edge |= {
        "path": path,
        "length": path_length(path),
        "travel": np.abs(np.diff(path, axis=0)).sum(axis=0),
    }
