"""Where a route begins or ends: the place of a name or of a configuration in an
atlas."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.graphs import arc_graph
from bifurc.problem import Problem
from bifurc.routes.surface_legs import foot_on, middle_of
from bifurc.surfaces.chart_atlas import ChartAtlas

# Distance below which a configuration lies on a form or a surface.
ON = 1e-6


@dataclass(frozen=True)
class RouteSearch:
    """What routes are looked for in: the atlas, its graph of ``arcs``, the ``charts``
    of those surfaces that have some, by index, and the problem where it is given."""

    atlas: Atlas
    problem: Problem | None
    charts: dict[int, ChartAtlas]
    arcs: nx.MultiGraph

    def surface_problem(self, surface: int) -> Problem:
        """The problem, for a way over a surface; raises `RouteError` where it is not
        given."""
        if self.problem is None:
            raise RouteError(
                f"the route leads over {self.atlas.surfaces[surface].name!r}: the "
                "problem of the atlas is needed there, and an atlas does not hold it; "
                "give find_route the problem that was explored, as problem=..."
            )
        return self.problem


def begin_search(atlas: Atlas, problem: Problem | None) -> RouteSearch:
    """What routes through an atlas are looked for in."""
    charts = {
        k: surface.charts
        for k, surface in enumerate(atlas.surfaces)
        if surface.charts is not None
    }
    return RouteSearch(atlas, problem, charts, arc_graph(atlas))


@dataclass(frozen=True)
class Place:
    """A place of an atlas: the index of a ``form`` and the ``arclength`` there (None
    and 0 where it lies on no form), and the points (n,) ``on_surfaces`` by the indices
    of these."""

    form: int | None = None
    arclength: float = 0.0
    on_surfaces: dict[int, np.ndarray] = field(default_factory=dict)


def place_of(search: RouteSearch, where: str | np.ndarray) -> Place:
    """The place of a form or surface of that name, or of a configuration (n,).

    Raises `RouteError` for what is no place of the atlas.
    """
    if isinstance(where, str):
        return _place_of_name(search, where)
    n = len(search.atlas.names)
    try:
        point = np.asarray(where, dtype=float)
    except (TypeError, ValueError):
        allowed = f"the name of a form or a surface, or {n} finite numbers"
        raise RouteError(
            f"a place of type {type(where).__name__}: it must be {allowed}"
        ) from None
    if point.shape != (n,) or not np.all(np.isfinite(point)):
        raise RouteError(f"configuration {point}: it must be {n} finite numbers")
    return _place_of_configuration(search, point)


def sampled_components(atlas: Atlas) -> str:
    """A hint at components over which no route is looked for, empty where there are
    none."""
    names = []
    for surface in atlas.surfaces:
        if surface.charts is None:
            names.append(f"{surface.name} (dimension {surface.dimension})")
    if not names:
        return ""
    return f"; without charts no route goes over {', '.join(names)}: it is only sampled"


# --- names ----------------------------------------------------------------------------


def _place_of_name(search: RouteSearch, name: str) -> Place:
    """The middle of a form's longest arc, or of a surface."""
    full_name = search.atlas.full_name(name)
    for index, form in enumerate(search.atlas.forms):
        if form.name == full_name:
            return Place(index, _middle_of_longest_arc(search.arcs, index))
    surfaces = [surface.name for surface in search.atlas.surfaces]
    k = surfaces.index(full_name)
    if k not in search.charts:
        hint = sampled_components(search.atlas)
        raise RouteError(f"{full_name}: no route leads there{hint}")
    singular = [p.point.u for p in search.atlas.points if k in p.surfaces]
    middle = middle_of(search.charts[k], singular)
    return Place(on_surfaces={k: middle})


def _middle_of_longest_arc(arcs: nx.MultiGraph, form: int) -> float:
    """The arclength in the middle of a form's longest arc; of arcs as long but for
    rounding the first."""
    own = [arc for *_, arc in arcs.edges(data=True) if arc["form"] == form]
    longest = max(own, key=lambda arc: (round(arc["length"], 9), -arc["start"]))
    return float(0.5 * (longest["start"] + longest["end"]))


# --- configurations -------------------------------------------------------------------


def _place_of_configuration(search: RouteSearch, point: np.ndarray) -> Place:
    """The form and the surfaces on which a configuration (n,) lies."""
    atlas = search.atlas
    if not atlas.forms and not search.charts:
        raise RouteError(f"the atlas has no forms{sampled_components(atlas)}")
    form, arclength = None, 0.0
    misses: list[str] = []
    if atlas.forms:
        nearest = _nearest_on_forms(atlas, point)
        if nearest.distance <= ON:
            form, arclength = nearest.form, nearest.arclength
        name = repr(atlas.forms[nearest.form].name)
        misses.append(f"{nearest.distance:.2g} away from the nearest form, {name}")
    on_surfaces = {}
    for k in search.charts:
        foot, miss = _foot_or_miss(search, k, point)
        if foot is not None:
            on_surfaces[k] = foot
        misses.append(miss)
    if form is None and not on_surfaces:
        shown = np.array2string(point, precision=6)
        raise RouteError(
            f"configuration {shown}: it lies {' and '.join(misses)}"
            f"{sampled_components(atlas)}"
        )
    return Place(form, arclength, on_surfaces)


class _Nearest(NamedTuple):
    """The point of all forms nearest to a configuration: index of the form, the
    arclength there, and the distance."""

    form: int
    arclength: float
    distance: float


def _nearest_on_forms(atlas: Atlas, point: np.ndarray) -> _Nearest:
    """The point of all forms nearest to a configuration (n,)."""
    candidates = []
    for index, form in enumerate(atlas.forms):
        distance, arclength = form.branch.nearest(point)
        candidates.append(_Nearest(index, float(arclength[0]), float(distance[0])))
    return min(candidates, key=lambda candidate: candidate.distance)


def _foot_or_miss(
    search: RouteSearch, surface: int, point: np.ndarray
) -> tuple[np.ndarray | None, str]:
    """The foot (n,) of a configuration on a surface, or None where it does not lie on
    it, and how far it misses the surface."""
    name = repr(search.atlas.surfaces[surface].name)
    if search.problem is None:
        return None, (
            f"perhaps on {name}: only the problem of the atlas can tell; give "
            "find_route the problem that was explored, as problem=..."
        )
    charts = search.charts[surface]
    foot = foot_on(search.problem, charts, point)
    if foot.point is None:
        target = f"the charts of {name}"
        if not charts.complete:
            target += f" ({charts.outcome.value})"
    else:
        target = name
    miss = f"{foot.distance:.2g} away from {target}"
    if foot.distance > ON:
        return None, miss
    return foot.point, miss
