"""What `bifurc chart` says, as text and as plain values."""

from __future__ import annotations

from typing import Any

import numpy as np

from bifurc.tables import count_of, section_of
from linkages.app.texts.parameters_text import (
    SAMPLES,
    headline,
    row_of,
    shape_text,
    shown,
)
from linkages.parameters.chart import Chart, RegionMap, line_of

DIGITS = 13  # of a point of codimension two
MOST = 20  # disagreements that are listed


def describe_chart(chart: Chart) -> str:
    """The regions, the points of codimension two, and how the check went."""
    free = chart.members.free
    names = [one.name for one in free]
    lines = [headline(chart.members)]
    if not chart.is_whole:
        lines.append("The search was ended early: there may be more than is listed.")
    regions = [
        {
            "region": str(number),
            "share": f"{100 * region.share:.1f} %",
            **_shown_at(chart, region.p, 5),
            "map": map_text(region.map),
        }
        for number, region in enumerate(chart.regions, 1)
    ]
    points = [
        {
            "point": point.kind,
            **_shown_at(chart, point.p, DIGITS),
            "boundaries": ", ".join(str(k + 1) for k in point.boundaries),
        }
        for point in chart.points
    ]
    wrong = [_shown_at(chart, p, 8) for p in chart.disagreements]
    parts = [
        "\n".join(lines),
        section_of(
            f"Regions of equal map, each with a member {' and '.join(names)}", regions
        ),
        section_of("Points of codimension two", points),
        _check_text(chart),
        section_of("Members with another map than their region", wrong, MOST),
    ]
    return "\n\n".join(part for part in parts if part)


def _check_text(chart: Chart) -> str:
    count = len(chart.checked)
    text = (
        f"{count_of(len(chart.boundaries), 'boundary')} followed. Of "
        f"{count_of(count, 'random member')} {len(chart.disagreements)} have another map "
        "than their region"
    )
    if chart.beside:
        text += f"; {chart.beside} lie on no side of a boundary"
    return f"{text}."


def _shown_at(chart: Chart, p: np.ndarray, digits: int) -> dict[str, str]:
    free = chart.members.free
    return {
        one.name: shown(one, float(value), digits)
        for one, value in zip(free, p, strict=True)
    }


def map_text(found: RegionMap) -> str:
    """A map in words; regions may differ in their graphs alone."""
    return shape_text(found.shape)


def chart_document(chart: Chart) -> dict[str, Any]:
    """The same as plain values, angles in rad; boundaries by samples."""
    ranges = chart.members.ranges
    return {
        "parameters": list(ranges),
        "is_whole": chart.is_whole,
        "boundaries": [
            dict(zip(ranges, line_of(curve, SAMPLES).T.tolist(), strict=True))
            for curve in chart.boundaries
        ],
        "regions": [
            {
                "parameters": row_of(ranges, region.p),
                "share": region.share,
                "map": _map_row(region.map),
            }
            for region in chart.regions
        ],
        "points": [
            {
                "kind": point.kind,
                "parameters": row_of(ranges, point.p),
                "boundaries": list(point.boundaries),
            }
            for point in chart.points
        ],
        "checked": len(chart.checked),
        "beside": chart.beside,
        "disagreements": [row_of(ranges, p) for p in chart.disagreements],
    }


def _map_row(found: RegionMap) -> dict[str, Any] | None:
    if found.shape is None:
        return None
    row = found.shape._asdict()
    del row["at_rest"]
    return {**row, "graph": found.graph}
