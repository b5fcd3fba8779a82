"""The picture of a surface of solutions."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from bifurc.surfaces.chart_atlas import ChartAtlas

__all__ = ["plot_charts"]


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
        directions = np.linalg.svd(
            charts.centers - charts.centers.mean(axis=0), full_matrices=False
        )[2][:2]
    flat = charts.triangles @ np.asarray(directions, dtype=float).T  # (t, 3, 2)
    a, b = (flat[:, k] - flat[:, 0] for k in (1, 2))
    seen = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    shade = np.clip(seen / np.maximum(charts.triangle_areas, 1e-300), 0.0, 1.0)
    axes.add_collection(
        PolyCollection(
            flat, array=0.25 + 0.6 * shade, cmap="Blues", clim=(0.0, 1.4), alpha=0.6
        )
    )
    axes.add_collection(LineCollection(flat[:, 1:], colors="0.35", linewidths=0.4))
    axes.plot(
        *(charts.centers @ np.asarray(directions).T).T,
        ".",
        color="black",
        markersize=1.5,
    )
    axes.autoscale_view()
    axes.set(xlabel="along the first direction", ylabel="along the second direction")
    return figure
