"""The polygons of overlapping charts put together to one closed complex."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bifurc.numerics.corrector import correct_normal
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering

__all__ = ["assemble_charts"]

# corners of neighbouring polygons closer than this, over their charts' radius, are one
# vertex
MERGED = 0.15


def assemble_charts(
    problem: Problem,
    centers: np.ndarray,
    bases: np.ndarray,
    radii: np.ndarray,
    polygons: Sequence[np.ndarray],
    labels: Sequence[np.ndarray],
    outcome: Covering,
) -> ChartAtlas:
    """The atlas of charts with ``polygons`` in their tangent planes, ``labels`` naming
    the neighbour at each edge.

    Vertices are lifted onto the surface; those of neighbouring charts that nearly
    coincide become one, so that the polygons are the faces of a closed complex although
    each was cut in a plane of its own. Charts of whose polygons the others leave
    nothing are left out.
    """
    kept = np.array([len(p) > 0 for p in polygons], dtype=bool)
    if not np.all(kept):
        number = np.where(kept, np.cumsum(kept) - 1, -1)
        centers, bases, radii = centers[kept], bases[kept], radii[kept]
        polygons = [p for p in polygons if len(p)]
        labels = [np.where(own >= 0, number[own], own) for own in labels if len(own)]
    sizes = np.array([len(p) for p in polygons], dtype=int)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    y = np.concatenate([np.empty((0, 2)), *polygons])
    if len(y):
        y *= np.minimum(
            1.0, radii[owner] / np.maximum(np.linalg.norm(y, axis=1), 1e-300)
        )[:, None]
    flat = centers[owner] + np.einsum("kij,kj->ki", bases[owner], y)
    lifted, gaps = correct_normal(problem, flat, bases[owner])
    bad = (gaps > 1e-9) | (np.linalg.norm(lifted - flat, axis=1) > 0.5 * radii[owner])
    lifted[bad] = flat[bad]
    pairs = {
        (min(i, j), max(i, j))
        for i, others in enumerate(labels)
        for j in others.tolist()
        if j >= 0
    }
    neighbours = np.array(sorted(pairs), dtype=int).reshape(-1, 2)
    vertex = _merged(problem, lifted, owner, radii, neighbours)
    first = np.unique(vertex, return_index=True)[1]
    previous = np.roll(vertex, 1)
    starts = np.cumsum(sizes)[sizes > 0] - sizes[sizes > 0]
    previous[starts] = vertex[np.cumsum(sizes)[sizes > 0] - 1]
    distinct = vertex != previous
    return ChartAtlas(
        centers,
        bases,
        radii,
        neighbours,
        lifted[first],
        vertex[distinct],
        np.bincount(owner[distinct], minlength=len(sizes)),
        problem.periods,
        outcome,
    )


def _merged(
    problem: Problem,
    points: np.ndarray,
    owner: np.ndarray,
    radii: np.ndarray,
    neighbours: np.ndarray,
) -> np.ndarray:
    """Number (v,) of the vertex that each corner (v, n) of a polygon is: corners that
    nearly coincide are one."""
    if not len(points):
        return np.empty(0, dtype=int)
    box = np.where(np.isfinite(problem.periods), problem.periods, 0.0)
    wrapped = np.where(box > 0, points % np.where(box > 0, box, 1.0), points)
    wrapped = np.where((box > 0) & (wrapped >= box), 0.0, wrapped)
    i, j = (
        cKDTree(wrapped, boxsize=box)
        .query_pairs(MERGED * radii.max(), output_type="ndarray")
        .T
    )
    count = len(radii)
    adjacent = np.concatenate([neighbours @ [count, 1], np.arange(count) * (count + 1)])
    low, high = np.minimum(owner[i], owner[j]), np.maximum(owner[i], owner[j])
    distance = np.linalg.norm(problem.difference(points[i], points[j]), axis=1)
    same = np.isin(low * count + high, adjacent) & (
        distance < MERGED * np.minimum(radii[owner[i]], radii[owner[j]])
    )
    graph = csr_array(
        (np.ones(np.count_nonzero(same)), (i[same], j[same])), shape=(len(points),) * 2
    )
    return connected_components(graph, directed=False)[1]
