"""A route of a linkage as text: degrees, joints numbered from 1."""

from __future__ import annotations

import numpy as np

from bifurc.atlas import Atlas
from bifurc.routes.route import Route
from bifurc.text_tables import count_of, table
from linkages.app.answer.configurations import (
    arclength_unit,
    show_configuration,
    show_travel,
)
from linkages.app.subject import subject_at


def describe_route(atlas: Atlas, route: Route, start: str, goal: str) -> str:
    """A route as a table: along which form, to which singular point, how far each joint
    turns on the way."""
    unit = arclength_unit(atlas)
    length = f"{unit.factor * route.length:.6g} {unit.name}"
    if unit.name != "deg":
        length = f"{unit.factor * route.length:.6g} ({unit.name})"
    turns = [f"turn {name}" for name in subject_at(atlas).labels]
    heads = ("", "along", "to", *turns, "configuration reached")
    explanation = "All in degrees; a turn is the sum of a joint's movements both ways."
    if set(atlas.units) != {"rad"}:
        explanation = (
            "Angles in degrees, slides in the unit of the file; a turn is the sum of a "
            "joint's movements both ways."
        )
    if any(leg.dimension > 1 for leg in route.legs):
        explanation += " Over a surface the way is a geodesic."
    return (
        f"Route from {start} to {goal}: {count_of(len(route.legs), 'leg')}, "
        f"{length} in joint space\n"
        f"from {show_configuration(atlas, route.path[0])}\n\n"
        f"{table(heads, _rows(atlas, route))}\n\n{explanation}"
    )


def _rows(atlas: Atlas, route: Route) -> list[tuple[str, ...]]:
    """A row for every leg, and one for the sum."""
    places = {point.name: point.point.u for point in atlas.points}
    rows: list[tuple[str, ...]] = []
    for number, leg in enumerate(route.legs, start=1):
        end = places[leg.at] if leg.at else route.path[-1]
        turns = _turns(atlas, leg.travel)
        reached = show_configuration(atlas, end)
        rows.append((str(number), leg.form, leg.at or "goal", *turns, reached))
    rows.append(("", "total", "", *_turns(atlas, route.travel), ""))
    return rows


def _turns(atlas: Atlas, travel: np.ndarray) -> list[str]:
    return show_travel(atlas, travel, digits=2)
