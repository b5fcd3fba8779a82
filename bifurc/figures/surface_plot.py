"""The picture of a surface of solutions."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from bifurc.surfaces.chart_atlas import ChartAtlas


def plot_charts(
    charts: ChartAtlas,
    directions: np.ndarray | None = None,
    figure: Figure | None = None,
) -> Figure:
    """The triangles of the charts in the plane of two ``directions`` (2, n), and the
    outlines of their polygons.

    Unless given, the directions are those in which the centres spread most. Shades say
    how steep a triangle stands.
    """
    figure = figure or Figure(figsize=(5.0, 4.5), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    if directions is None:
        directions = _widest_directions(charts.centers)
    projection = np.asarray(directions, dtype=float).T
    triangles = charts.triangles @ projection  # (t, 3, 2)
    centers = charts.centers @ projection
    shades = 0.25 + 0.6 * _flatness(charts, triangles)
    axes.add_collection(
        PolyCollection(
            triangles, array=shades, cmap="Blues", clim=(0.0, 1.4), alpha=0.6
        )
    )
    outlines = triangles[:, 1:]
    axes.add_collection(LineCollection(outlines, colors="0.35", linewidths=0.4))
    axes.plot(centers[:, 0], centers[:, 1], ".", color="black", markersize=1.5)
    axes.autoscale_view()
    axes.set(xlabel="along the first direction", ylabel="along the second direction")
    return figure


def _widest_directions(points: np.ndarray) -> np.ndarray:
    """The two directions (2, n) in which points (k, n) spread most."""
    _, _, directions = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    return np.asarray(directions[:2])


def _flatness(charts: ChartAtlas, triangles: np.ndarray) -> np.ndarray:
    """Area (t,) of each projected triangle (t, 3, 2) over its own: 0 where it stands
    upright."""
    a = triangles[:, 1] - triangles[:, 0]
    b = triangles[:, 2] - triangles[:, 0]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    share = area / np.maximum(charts.triangle_areas, 1e-300)
    return np.asarray(np.clip(share, 0.0, 1.0))
