"""Configurations evenly spread along a whole route."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.checks import check_whole
from bifurc.errors import RouteError
from bifurc.problem import Problem
from bifurc.routes.places import begin_search
from bifurc.routes.route import Leg, Route
from bifurc.surfaces.geodesic import place_at


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
