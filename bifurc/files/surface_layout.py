"""What of a surface and its charts goes into which variable of a dataset, and back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bifurc.atlas import Surface
from bifurc.files.table import JOINT, UNIT, Column, Row, Table
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering


def _of_charts(
    take: Callable[[ChartAtlas], np.ndarray],
) -> Callable[[Surface], np.ndarray]:
    """The same of the charts of a surface; nothing where it has none."""

    def values(surface: Surface) -> np.ndarray:
        return np.empty(0) if surface.charts is None else take(surface.charts)

    return values


def _covering(surface: Surface) -> str:
    return "" if surface.charts is None else surface.charts.outcome.name


SURFACES: Table[Surface] = Table(
    "surface",
    lambda atlas: atlas.surfaces,
    (
        Column("surface_dimension", lambda s: s.dimension, "dimension", dtype=int),
        Column("surface_name", lambda s: s.name, "name of the surface", dtype=str),
        Column("surface_note", lambda s: s.note, "remark", dtype=str),
        Column(
            "covering",
            _covering,
            "why no more charts were made; empty where there are none",
            dtype=str,
        ),
        Column(
            "surface_configuration",
            lambda s: s.samples,
            "solution on a surface",
            UNIT,
            dimensions=(JOINT,),
            entries="surface_sample",
        ),
        Column(
            "chart_center",
            _of_charts(lambda charts: charts.centers),
            "centre of a chart",
            UNIT,
            dimensions=(JOINT,),
            entries="chart",
        ),
        Column(
            "chart_basis",
            _of_charts(lambda charts: charts.bases),
            "basis of its tangent plane",
            "1",
            dimensions=(JOINT, "axis"),
            entries="chart",
        ),
        Column(
            "chart_radius",
            _of_charts(lambda charts: charts.radii),
            "radius of its disk",
            UNIT,
            entries="chart",
        ),
        Column(
            "polygon_size",
            _of_charts(lambda charts: charts.polygon_sizes),
            "number of corners of its polygon",
            dtype=int,
            entries="chart",
        ),
        Column(
            "chart_pair",
            _of_charts(lambda charts: charts.neighbours),
            "charts with an edge in common",
            dtype=int,
            dimensions=("end",),
            entries="neighbour",
        ),
        Column(
            "chart_vertex",
            _of_charts(lambda charts: charts.vertices),
            "vertex of the polygons",
            UNIT,
            dimensions=(JOINT,),
            entries="vertex",
        ),
        Column(
            "polygon_corner",
            _of_charts(lambda charts: charts.polygons),
            "number of the vertex at each corner",
            dtype=int,
            entries="corner",
        ),
    ),
)


def read_surface(row: Row, periods: np.ndarray) -> Surface:
    """The surface of a row of `SURFACES`, of unknowns with ``periods`` (n,)."""
    covering = str(row["covering"])
    return Surface(
        dimension=int(row["surface_dimension"]),
        samples=row["surface_configuration"],
        name=str(row["surface_name"]),
        charts=_read_charts(row, periods, covering) if covering else None,
        note=str(row["surface_note"]),
    )


def _read_charts(row: Row, periods: np.ndarray, covering: str) -> ChartAtlas:
    """Raises `ValueError` where an index is that of no chart or no vertex."""
    centers = row["chart_center"]
    neighbours = row["chart_pair"]
    vertices = row["chart_vertex"]
    polygons = row["polygon_corner"]
    sizes = row["polygon_size"]
    _check_indices("chart_pair", neighbours, len(centers))
    _check_indices("polygon_corner", polygons, len(vertices))
    if np.any(sizes < 0) or sizes.sum() != len(polygons):
        raise ValueError(f"polygon_size does not add up to {len(polygons)} corners")
    return ChartAtlas(
        centers=centers,
        bases=row["chart_basis"],
        radii=row["chart_radius"],
        neighbours=neighbours,
        vertices=vertices,
        polygons=polygons,
        polygon_sizes=sizes,
        periods=periods,
        outcome=Covering[covering],
    )


def _check_indices(name: str, indices: np.ndarray, count: int) -> None:
    if np.any((indices < 0) | (indices >= count)):
        raise ValueError(f"{name} holds an index that none of {count} has")
