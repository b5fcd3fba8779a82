"""A route of a linkage as text, degrees and joints numbered from 1; routes of a network
over its locks, read from a command line and shown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.atlas import Atlas
from bifurc.routes.route import Leg, Route
from bifurc.tables import count_of, table
from linkages.app.choice import read_kinks
from linkages.app.exit_codes import CommandError
from linkages.app.texts.configurations import (
    arclength_unit,
    show_configuration,
    show_travel,
)
from linkages.app.texts.mechanism_text import describe_outer_motions
from linkages.app.texts.numbers import in_degrees
from linkages.networks.lock_routes import (
    LockRoute,
    NetworkPlace,
    Switch,
    Travel,
    show_locks,
)
from linkages.networks.mechanism import NetworkMechanism
from linkages.readout.readout import Readout
from linkages.subject import subject_at


def describe_routes(
    atlas: Atlas, routes: Sequence[Route], start: str, goal: str
) -> str:
    """Routes as tables, one below the other."""
    if len(routes) == 1:
        return describe_route(atlas, routes[0], start, goal)
    texts = []
    for number, route in enumerate(routes, start=1):
        # forms may have several arcs between two points, which turn joints alike
        text = describe_route(atlas, route, start, goal, has_arclengths=True)
        texts.append(f"{number}. {text}")
    return "\n\n".join(texts)


def document_of_routes(routes: Sequence[Route]) -> dict[str, object]:
    """Routes in values that JSON can hold, the best first."""
    return {
        "routes": [
            {
                "length": route.length,
                "bifurcations": route.points,
                "travel": route.travel.tolist(),
                "legs": [_leg_values(leg) for leg in route.legs],
            }
            for route in routes
        ]
    }


def _leg_values(leg: Leg) -> dict[str, object]:
    return {
        "form": leg.form,
        "start": leg.start,
        "end": leg.end,
        "at": leg.at,
        "length": leg.length,
        "travel": leg.travel.tolist(),
    }


def describe_route(
    atlas: Atlas, route: Route, start: str, goal: str, has_arclengths: bool = False
) -> str:
    """A route as a table: along which form, to which singular point, how far each joint
    turns on the way; with the arclengths on each form, where that is asked for."""
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
    rows = _rows(atlas, route)
    if has_arclengths:
        heads = (*heads[:2], "arclength", *heads[2:])
        ways = [
            f"{unit.factor * leg.start:.6g} to {unit.factor * leg.end:.6g}"
            for leg in route.legs
        ]
        rows = [
            (*row[:2], way, *row[2:])
            for row, way in zip(rows, [*ways, ""], strict=True)
        ]
    if any(leg.dimension > 1 for leg in route.legs):
        explanation += " Over a surface the way is a geodesic."
    return (
        f"Route from {start} to {goal}: {count_of(len(route.legs), 'leg')}, "
        f"{length} in joint space\n"
        f"from {show_configuration(atlas, route.path[0])}\n\n"
        f"{table(heads, rows)}\n\n{explanation}"
    )


def _rows(atlas: Atlas, route: Route) -> list[tuple[str, ...]]:
    """A row for every leg, and one for the sum."""
    places = {point.name: point.point.u for point in atlas.points}
    rows: list[tuple[str, ...]] = []
    for number, leg in enumerate(route.legs, start=1):
        end = places[leg.at] if leg.at else route.path[-1]
        turns = show_travel(atlas, leg.travel, digits=2)
        reached = show_configuration(atlas, end)
        rows.append((str(number), leg.form, leg.at or "goal", *turns, reached))
    rows.append(("", "total", "", *show_travel(atlas, route.travel, digits=2), ""))
    return rows


def read_place(text: str, option: str, network: NetworkMechanism) -> NetworkPlace:
    """The place of "2=40,6=-75@p4=90": locks, and behind @ the angle at which another
    outer joint is; degrees, D-H angles, "p" may be left out.

    Raises `CommandError` and `GeometryError`.
    """
    locks, at, angles = text.partition("@")
    if not locks.strip():
        raise CommandError(f"{option} {text}: it must begin with locks, such as 2=40")
    if at and not angles.strip():
        raise CommandError(f"{option} {text}: behind @ there must be an angle, p4=90")
    ring = network.placed.network.plan.ring
    named = [_without_p(part, ring) for part in angles.split(",")] if at else []
    return NetworkPlace(
        read_kinks([part.strip() for part in locks.split(",")], option),
        read_kinks(named, option),
    )


def _without_p(text: str, ring: tuple[str, ...]) -> str:
    """ "4=90" for "p4=90"."""
    text = text.strip()
    name, _, _ = text.partition("=")
    is_known = name.strip() in ring
    return text if is_known else text.removeprefix("p")


def describe_lock_route(
    route: LockRoute, network: NetworkMechanism, last: Atlas
) -> str:
    """A route over locks as a table, and what the ``network`` with the last locks does,
    of which ``last`` is the map."""
    ring = network.placed.network.plan.ring
    rows: list[tuple[str, ...]] = [("", "start", "", *_angles(route.start))]
    reached = route.start
    for step in route.steps:
        number = str(len(rows))
        if isinstance(step, Switch):
            rows.append((number, _switch(step), "", *_angles(reached)))
            continue
        reached = step.end
        length = f"{np.degrees(step.length):.6g}"
        rows.append((number, _travel(step), length, *_angles(reached)))
    heads = ("", "", "length", *(f"joint {axis}" for axis in ring))
    length = np.degrees(route.length)
    parts = [
        f"Route from the locks {show_locks(route.before)} to "
        f"{show_locks(route.after)}: {count_of(route.switches, 'exchange')} of locks, "
        f"{length:.6g} deg in joint space",
        table(heads, rows),
        "All in degrees; D-H angles of the outer joints. Locks are exchanged where the "
        "network stands: one joint more is locked, and it is rigid, until another one "
        "is released.",
    ]
    if route.starts > 1:
        parts.append(
            f"{route.starts} places are such as the start: the route leaves from that "
            "from which it is shortest; name more angles behind @ for another one."
        )
    ranges = describe_outer_motions(last, Readout(network))
    parts.append(f"With the last locks\n{ranges}")
    return "\n\n".join(parts)


def _switch(step: Switch) -> str:
    locked, released = show_locks([step.locked]), show_locks([step.released])
    return f"lock {locked}, release {released}"


def _travel(step: Travel) -> str:
    """Along which forms, and over which bifurcations, a stretch leads."""
    names = []
    for leg in step.route.legs:
        names.append(f"{leg.form} to {leg.at}" if leg.at else leg.form)
    return f"with {show_locks(step.locks)} along {', '.join(names)}"


def _angles(angles: np.ndarray) -> list[str]:
    return [in_degrees(float(angle), 3) for angle in angles]
