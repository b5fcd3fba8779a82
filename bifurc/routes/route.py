"""Routes: the shortest chain of arcs, and of paths over surfaces, from one
configuration to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.checks import check_type, check_whole
from bifurc.errors import RouteError
from bifurc.graphs import ArcAttributes
from bifurc.problem import Problem
from bifurc.routes.places import (
    RouteSearch,
    begin_search,
    place_of,
    sampled_components,
)
from bifurc.routes.surface_legs import Crossing
from bifurc.routes.ways import GOAL, START, Stage, WayGraph
from bifurc.routes.wishes import NONE, Wishes
from bifurc.surfaces.geodesic import place_at, spread
from bifurc.tables import count_of
from bifurc.torus import wrap

NO_WAY = 1e-9  # length below which a leg is none


@dataclass(frozen=True, eq=False)
class Leg:
    """One stretch of a route: along ``form`` from arclength ``start`` to ``end``,
    backwards where end < start.

    On a closed form arclengths may exceed its length. Over a surface (``dimension`` 2)
    ``form`` is its name, and the arclength is that of the leg itself, from 0 to its
    length. The leg leaves at the singular point ``at`` (empty at the goal). ``travel``
    (n,) is the total turning of each unknown, ``path`` (k, n) the leg's share of that
    of the route.
    """

    form: str
    start: float
    end: float
    at: str
    travel: np.ndarray
    dimension: int
    path: np.ndarray

    @property
    def length(self) -> float:
        """Arclength of the leg."""
        return abs(self.end - self.start)

    def __repr__(self) -> str:
        return (
            f"Leg({self.form} from {self.start:.6g} to {self.end:.6g}, "
            f"at {self.at or 'the goal'}, length {self.length:.6g})"
        )


@dataclass(frozen=True, eq=False)
class Route:
    """A chain of legs from one configuration to another, and the path (k, n) along
    them, without jumps.

    No legs and a path of one point, where start and goal are the same configuration.
    """

    legs: tuple[Leg, ...]
    path: np.ndarray

    @property
    def length(self) -> float:
        """Arclength of the whole route."""
        return float(sum(leg.length for leg in self.legs))

    @property
    def travel(self) -> np.ndarray:
        """Total turning (n,) of each unknown."""
        if not self.legs:
            return np.zeros(self.path.shape[1])
        travels = [leg.travel for leg in self.legs]
        total: np.ndarray = np.sum(travels, axis=0)
        return total

    @property
    def points(self) -> list[str]:
        """The names of the singular points on the way, in order."""
        return [leg.at for leg in self.legs[:-1]]

    def __repr__(self) -> str:
        head = (
            f"Route({count_of(len(self.legs), 'leg')}, length {self.length:.6g}, "
            f"{count_of(len(self.path), 'configuration')})"
        )
        return "\n".join([head, *(f"  {leg!r}" for leg in self.legs)])

    def _repr_html_(self) -> str:
        rows = [_html_row("th", ("form", "from", "to", "at", "length"))]
        for leg in self.legs:
            ends = (f"{leg.start:.6g}", f"{leg.end:.6g}")
            cells = (leg.form, *ends, leg.at or "goal", f"{leg.length:.6g}")
            rows.append(_html_row("td", cells))
        rows.append(_html_row("td", ("total", "", "", "", f"{self.length:.6g}")))
        return f"<table>\n{''.join(rows)}</table>"


def _html_row(tag: str, cells: Sequence[str]) -> str:
    """A row of a table, its cells escaped."""
    content = "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells)
    return f"<tr>{content}</tr>\n"


def find_route(
    atlas: Atlas,
    start: str | np.ndarray,
    goal: str | np.ndarray,
    *,
    count: int = 400,
    problem: Problem | None = None,
    wishes: Wishes = NONE,
) -> Route:
    """The best way from ``start`` to ``goal`` along forms and over surfaces: the
    shortest one, or the best by other ``wishes``.

    Either is a configuration (n,) on a form or a surface, or the name of one: it stands
    for the middle of a form's longest arc, or for the chart of a surface farthest from
    its singular points. Forms and surfaces are left at singular points. A leg over a
    surface is a geodesic near the shortest chain of charts; it needs the ``problem``
    that was explored, which an atlas does not hold. The path has about ``count`` points
    and no jumps; it begins at ``start`` (the point of a name is taken into half a
    period about zero). Raises `RouteError` for an unknown name, a configuration on no
    form or surface, a component that is only sampled, or where no route exists, and
    `ProblemError` for anything but an atlas, a problem and a count of at least 2.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> route = bifurc.find_route(atlas, "rhombus form", "joints 1,3")
    >>> [(leg.form, leg.at) for leg in route.legs], route.path.shape
    ([('rhombus form', 'B2'), ('folded form (joints 1,3 inactive)', '')], (401, 4))
    """
    routes = find_routes(
        atlas, start, goal, 1, count=count, problem=problem, wishes=wishes
    )
    return routes[0]


def find_routes(
    atlas: Atlas,
    start: str | np.ndarray,
    goal: str | np.ndarray,
    best: int,
    *,
    count: int = 400,
    problem: Problem | None = None,
    wishes: Wishes = NONE,
) -> list[Route]:
    """Up to ``best`` ways, the best first, all else as in `find_route`; they differ in
    the arcs that they take.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> for route in bifurc.find_routes(atlas, "rhombus form", "joints 1,3", best=2):
    ...     print(round(route.length, 6), [leg.at for leg in route.legs])
    5.363034 ['B2', '']
    9.805917 ['B1', 'B3', '']
    """
    check_type("atlas", atlas, Atlas)
    if problem is not None:
        check_type("problem", problem, Problem)
    check_whole("count", count, 2)
    check_whole("best", best, 1)
    wishes = wishes.resolved(atlas)
    search = begin_search(atlas, problem)
    places = {START: place_of(search, start), GOAL: place_of(search, goal)}
    ways = WayGraph(search)
    for node, place in places.items():
        ways.add_place(node, place)
    ways.add_crossings()
    chains = ways.best_chains(best, wishes)
    if not chains:
        raise RouteError(_no_route(atlas, ways, start, goal, wishes))
    return [_route(search, chain, start, count) for chain in chains]


def _route(
    search: RouteSearch, chain: Sequence[Stage], start: str | np.ndarray, count: int
) -> Route:
    """The route along a chain of ways."""
    periods = search.atlas.periods
    length = max(sum(stage.length for stage in chain), NO_WAY)
    legs: list[Leg] = []
    for stage in chain:
        leg = _make_leg(search, stage, count / length)
        passes_start = bool(legs) and not legs[-1].at
        legs = [*legs[:-1], _joined(legs[-1], leg)] if passes_start else [*legs, leg]
    origin = start
    if isinstance(origin, str):
        origin = wrap(legs[0].path[0], periods)
    return _join(legs, np.asarray(origin, dtype=float), periods)


# --- legs -----------------------------------------------------------------------------


def _make_leg(search: RouteSearch, stage: Stage, density: float) -> Leg:
    """The leg along a stage of the chain, with about so many samples a length on its
    path."""
    at = stage.target if isinstance(stage.target, str) else ""  # the goal is no string
    intervals = 0
    if stage.length > NO_WAY:
        intervals = max(1, round(density * stage.length))
    if isinstance(stage.way, Crossing):
        forwards = stage.way.first == stage.origin
        return _leg_over_surface(search, stage.way, forwards, at, intervals)
    forwards = stage.way["first"] == stage.origin
    return _leg_along_form(search.atlas, stage.way, forwards, at, intervals)


def _joined(first: Leg, last: Leg) -> Leg:
    """One leg of two along one form, between which the route comes past its start."""
    end = first.end + last.end - last.start
    travel = first.travel + last.travel
    path = np.concatenate([first.path, last.path[1:]])
    return replace(first, end=end, at=last.at, travel=travel, path=path)


def _leg_along_form(
    atlas: Atlas, arc: ArcAttributes, forwards: bool, at: str, intervals: int
) -> Leg:
    """The leg along an arc of a form."""
    start, end = arc["start"], arc["end"]
    if not forwards:
        start, end = end, start
    form = atlas.forms[arc["form"]]
    path = form.branch(np.linspace(start, end, intervals + 1))
    return Leg(form.name, start, end, at, arc["travel"], 1, path)


def _leg_over_surface(
    search: RouteSearch, crossing: Crossing, forwards: bool, at: str, intervals: int
) -> Leg:
    """The leg along a measured crossing of a surface."""
    assert crossing.path is not None, "a chain of ways has only measured crossings"
    k = crossing.surface
    steps = np.diff(crossing.path, axis=0)
    travel = np.abs(steps).sum(axis=0)
    way = crossing.path if forwards else crossing.path[::-1]
    path = way[:1]
    if intervals:
        path = spread(search.surface_problem(k), search.charts[k], way, intervals)
    name = search.atlas.surfaces[k].name
    return Leg(name, 0.0, crossing.length, at, travel, 2, path)


def _join(legs: Sequence[Leg], start: np.ndarray, periods: np.ndarray) -> Route:
    """The route from ``start`` (n,) along the legs, each shifted by whole periods to
    where the one before it ended; empty ones go."""
    periodic = np.isfinite(periods)
    period = periods[periodic]
    end = start
    legs_of_length: list[Leg] = []
    parts: list[np.ndarray] = []
    for leg in legs:
        path = leg.path.copy()
        turns = np.round((end[periodic] - path[0, periodic]) / period)
        path[:, periodic] += period * turns
        if parts:
            path[0] = end  # the same point but for rounding
        end = path[-1]
        parts.append(path[1:] if parts else path)
        if leg.length > NO_WAY:
            legs_of_length.append(replace(leg, path=path))
    return Route(tuple(legs_of_length), np.concatenate(parts))


# --- where there is no route ----------------------------------------------------------


def _no_route(
    atlas: Atlas,
    ways: WayGraph,
    start: str | np.ndarray,
    goal: str | np.ndarray,
    wishes: Wishes,
) -> str:
    """What is said where there is no route: what can be reached, and the obstacles."""
    if wishes.avoid or wishes.through:
        words = f"there is no route from {_describe(start)} to {_describe(goal)}"
        if wishes.avoid:
            words += f" that avoids {', '.join(map(repr, wishes.avoid))}"
        if wishes.through:
            words += f" through {', '.join(map(repr, wishes.through))}"
        return words
    names = ", ".join(repr(name) for name in ways.names_in_reach())
    sentence = (
        f"there is no route from {_describe(start)} to {_describe(goal)}: only {names} "
        f"can be reached from the start{sampled_components(atlas)}"
    )
    return "; ".join([sentence, *ways.obstacles])


def _describe(where: str | np.ndarray) -> str:
    """A name in quotes, or the numbers of a configuration."""
    if isinstance(where, str):
        return repr(where)
    return np.array2string(np.asarray(where), precision=6)


# --- at even distances ----------------------------------------------------------------


class SpreadRoute(NamedTuple):
    """Configurations (k, n) without jumps, at ``arclengths`` (k,) from 0 to the length
    of a route."""

    arclengths: np.ndarray
    configurations: np.ndarray


def spread_route(
    atlas: Atlas, route: Route, count: int, problem: Problem | None = None
) -> SpreadRoute:
    """``count`` solutions at even arclengths along a route of `find_route`, its begin
    and its end among them.

    Unlike `Route.path` these need not meet the points where the route changes from one
    form to another. Legs over surfaces need the ``problem`` that was explored. Raises
    `RouteError` for a route without length or where the problem is needed, and
    `ProblemError` for a count below 2.
    """
    check_whole("count", count, 2)
    if not route.legs:
        raise RouteError("the route has no length: it begins where it ends")
    lengths = [leg.length for leg in route.legs]
    ends = np.cumsum(lengths)
    arclengths = np.linspace(0.0, ends[-1], count)
    owners = np.searchsorted(ends, arclengths)
    parts = []
    for i, leg in enumerate(route.legs):
        along = arclengths[owners == i] - (ends[i] - lengths[i])
        if len(along):
            shares = np.clip(along / lengths[i], 0.0, 1.0)
            parts.append(_place_on_leg(atlas, leg, shares, problem))
    return SpreadRoute(arclengths, np.concatenate(parts))


def _place_on_leg(
    atlas: Atlas, leg: Leg, shares: np.ndarray, problem: Problem | None
) -> np.ndarray:
    """Solutions (k, n) at shares (k,) of the length of a leg, continuous with its
    path."""
    if leg.dimension > 1:
        search = begin_search(atlas, problem)
        names = [surface.name for surface in atlas.surfaces]
        k = names.index(leg.form)
        return place_at(search.surface_problem(k), search.charts[k], leg.path, shares)
    branch = atlas.forms[atlas.form(leg.form)].branch
    points = branch(leg.start + shares * (leg.end - leg.start))
    shift = leg.path[0] - branch(leg.start)
    is_periodic = np.isfinite(atlas.periods)
    periods = atlas.periods[is_periodic]
    points[:, is_periodic] += periods * np.round(shift[is_periodic] / periods)
    return points
