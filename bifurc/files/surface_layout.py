"""Surfaces and their charts as variables of a dataset, and back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bifurc.atlas import Surface
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering

__all__ = ["read_surfaces", "surface_variables"]

RAGGED = {
    "chart": "centers",
    "neighbour": "neighbours",
    "vertex": "vertices",
    "corner": "polygons",
}


def surface_variables(
    surfaces: Sequence[Surface],
    n: int,
    joint: str,
    unit: str,
    variable: Callable[..., Any],
) -> dict[str, Any]:
    """Names, coverings, charts and vertices of the surfaces; rows of different surfaces
    stand one behind the other."""
    charts = [surface.charts for surface in surfaces]

    def rows(name: str, shape: tuple[int, ...], dtype: type = float) -> np.ndarray:
        found: list[np.ndarray] = [
            np.asarray(getattr(c, name), dtype=dtype) for c in charts if c is not None
        ]
        return np.concatenate([np.empty((0, *shape), dtype=dtype), *found])

    outcomes = np.array(
        [c.outcome.name if c is not None else "" for c in charts], dtype=str
    )
    out = {
        "surface_name": variable(
            "surface",
            np.array([s.name for s in surfaces], dtype=str),
            "name of the surface",
        ),
        "surface_note": variable(
            "surface", np.array([s.note for s in surfaces], dtype=str), "remark"
        ),
        "covering": variable(
            "surface",
            outcomes,
            "why no more charts were made; empty where there are none",
        ),
        "chart_center": variable(
            ("chart", joint), rows("centers", (n,)), "centre of a chart", unit
        ),
        "chart_basis": variable(
            ("chart", joint, "axis"),
            rows("bases", (n, 2)),
            "basis of its tangent plane",
            "1",
        ),
        "chart_radius": variable(
            "chart", rows("radii", ()), "radius of its disk", unit
        ),
        "polygon_size": variable(
            "chart", rows("polygon_sizes", (), int), "number of corners of its polygon"
        ),
        "chart_pair": variable(
            ("neighbour", "end"),
            rows("neighbours", (2,), int),
            "charts with an edge in common",
        ),
        "chart_vertex": variable(
            ("vertex", joint), rows("vertices", (n,)), "vertex of the polygons", unit
        ),
        "polygon_corner": variable(
            "corner", rows("polygons", (), int), "number of the vertex at each corner"
        ),
    }
    for dimension, name in RAGGED.items():
        sizes = np.array(
            [len(getattr(c, name)) if c is not None else 0 for c in charts], dtype=int
        )
        names, values, attributes = variable(
            "surface", sizes, f"number of {dimension} entries"
        )
        out[f"{dimension}_count"] = (
            names,
            values,
            attributes | {"sample_dimension": dimension},
        )
    return out


def read_surfaces(
    get: dict[str, np.ndarray], samples: Sequence[np.ndarray]
) -> tuple[Surface, ...]:
    """The surfaces that `surface_variables` stored, with the solutions (k, n) seen on
    each."""

    def parts(name: str, dimension: str) -> list[np.ndarray]:
        counts = get[f"{dimension}_count"]
        return np.split(get[name], np.cumsum(counts))[: len(counts)]

    columns = [
        parts("chart_center", "chart"),
        parts("chart_basis", "chart"),
        parts("chart_radius", "chart"),
        parts("chart_pair", "neighbour"),
        parts("chart_vertex", "vertex"),
        parts("polygon_corner", "corner"),
        parts("polygon_size", "chart"),
    ]
    out = []
    for i, (dimension, seen) in enumerate(
        zip(get["surface_dimension"], samples, strict=True)
    ):
        outcome = str(get["covering"][i])
        charts = (
            _charts([c[i] for c in columns], get["period"], outcome)
            if outcome
            else None
        )
        out.append(
            Surface(
                int(dimension),
                seen,
                str(get["surface_name"][i]),
                charts,
                str(get["surface_note"][i]),
            )
        )
    return tuple(out)


def _charts(columns: list[np.ndarray], periods: np.ndarray, outcome: str) -> ChartAtlas:
    centers, bases, radii, neighbours, vertices, polygons, sizes = columns
    return ChartAtlas(
        centers,
        bases,
        radii,
        neighbours,
        vertices,
        polygons,
        sizes,
        periods,
        Covering[outcome],
    )
