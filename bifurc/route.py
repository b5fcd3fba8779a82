"""Routes: the shortest chain of arcs from one configuration to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

if TYPE_CHECKING:
    from bifurc.atlas import Atlas

__all__ = ["Leg", "Route", "RouteError", "find_route", "wrap"]

ON_FORM = 1e-6  # distance below which a configuration lies on a form
START, GOAL = ("start",), ("goal",)  # nodes of their own: those of the arcs are strings


class RouteError(LookupError):
    """There is no such form, or no route between two forms."""


@dataclass(frozen=True)
class Leg:
    """One stretch of a route: along ``form`` from arclength ``start`` to ``end``, backwards where end < start.

    On a closed form arclengths may exceed its length. The leg leaves at the singular point ``at`` (empty at the
    goal). ``travel`` (n,) is the total turning of each unknown.
    """

    form: str
    start: float
    end: float
    at: str
    travel: np.ndarray

    @property
    def length(self) -> float:
        """Arclength of the leg."""
        return abs(self.end - self.start)


@dataclass(frozen=True)
class Route:
    """A chain of legs from one configuration to another, and the path (k, n) along them, without jumps.

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
        return np.sum([leg.travel for leg in self.legs], axis=0) if self.legs else np.zeros(self.path.shape[1])


def wrap(point: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """``point`` with periodic unknowns taken into (-period / 2, period / 2]."""
    out = np.array(point, dtype=float)
    periodic = np.isfinite(periods)
    period = periods[periodic]
    turned = out[..., periodic] - period * np.round(out[..., periodic] / period)
    out[..., periodic] = np.where(turned <= -0.5 * period + 1e-9, turned + period, turned)
    return out


def find_route(atlas: Atlas, start: str | np.ndarray, goal: str | np.ndarray, count: int = 400) -> Route:
    """The shortest route from ``start`` to ``goal``; see `Atlas.route`."""
    graph = atlas.arcs.copy()
    for node, where in ((START, start), (GOAL, goal)):
        _insert(graph, atlas, node, *_place(atlas, where))
    try:
        chain = nx.shortest_path(graph, START, GOAL, weight="length")
    except nx.NetworkXNoPath:
        raise RouteError(_no_route(atlas, graph, start, goal)) from None
    legs = []
    for a, b in pairwise(chain):
        edge = min(graph[a][b].values(), key=lambda e: e["length"])
        ends = (edge["start"], edge["end"]) if edge["first"] == a else (edge["end"], edge["start"])
        legs.append(Leg(atlas.forms[edge["form"]].name, *ends, "" if b == GOAL else b, edge["travel"]))
    return Route(tuple(leg for leg in legs if leg.length > 1e-9), _path(atlas, legs, start, count))


def _place(atlas: Atlas, where: str | np.ndarray) -> tuple[int, float]:
    """(index of the form, arclength) of a form's name or of a configuration."""
    if isinstance(where, str):
        index = atlas.form(where)
        arcs = [arc for *_, arc in atlas.arcs.edges(data=True) if arc["form"] == index]
        longest = max(arcs, key=lambda arc: (round(arc["length"], 9), -arc["start"]))
        return index, 0.5 * (longest["start"] + longest["end"])
    point = np.asarray(where, dtype=float)
    if point.shape != (len(atlas.names),) or not np.all(np.isfinite(point)):
        raise RouteError(f"configuration {point}: it must be {len(atlas.names)} finite numbers")
    if not atlas.forms:
        raise RouteError("the atlas has no forms")
    distances, arclengths = np.array([form.branch.nearest(point) for form in atlas.forms])[..., 0].T
    index = int(np.argmin(distances))
    if distances[index] > ON_FORM:
        raise RouteError(
            f"configuration {_describe(point)}: it lies {distances[index]:.2g} away from the nearest form, "
            f"{atlas.forms[index].name!r}"
        )
    return index, float(arclengths[index])


def _insert(graph: nx.MultiGraph, atlas: Atlas, node: tuple[str], index: int, s: float) -> None:
    """Split the arc of a form that holds arclength ``s`` by a new ``node``."""
    branch = atlas.forms[index].branch
    arcs = [(a, b, key, arc) for a, b, key, arc in graph.edges(keys=True, data=True) if arc["form"] == index]
    if branch.closed:
        s = min(arc["start"] for *_, arc in arcs) + (s - min(arc["start"] for *_, arc in arcs)) % branch.length
    # the arcs of a form follow each other without gaps but for rounding: the nearest one holds s
    a, b, key, arc = min(arcs, key=lambda found: max(found[3]["start"] - s, s - found[3]["end"]))
    s = float(np.clip(s, arc["start"], arc["end"]))
    graph.remove_edge(a, b, key)
    for first, last, low, high in ((arc["first"], node, arc["start"], s), (node, arc["last"], s, arc["end"])):
        graph.add_edge(first, last, **atlas.arc(index, low, high, first, last))


def _path(atlas: Atlas, legs: Sequence[Leg], start: str | np.ndarray, count: int) -> np.ndarray:
    """About ``count`` samples along the legs, each leg shifted by whole periods to where the one before it ended."""
    total = sum(leg.length for leg in legs)
    periodic = np.isfinite(atlas.periods)
    period = atlas.periods[periodic]
    parts: list[np.ndarray] = []
    for leg in legs:
        share = max(2, 1 + round(count * leg.length / total)) if leg.length > 1e-9 else 1
        part = atlas.forms[atlas.form(leg.form)].branch(np.linspace(leg.start, leg.end, share))
        if parts:
            end = parts[-1][-1]
        else:
            end = wrap(part[0], atlas.periods) if isinstance(start, str) else np.asarray(start, dtype=float)
        part[:, periodic] += period * np.round((end[periodic] - part[0, periodic]) / period)
        parts.append(part[1:] if parts else part)
    return np.concatenate(parts)


def _no_route(atlas: Atlas, graph: nx.MultiGraph, start: str | np.ndarray, goal: str | np.ndarray) -> str:
    reached = nx.node_connected_component(graph, START)
    indices = sorted({arc["form"] for *_, arc in graph.edges(reached, data=True)})
    names = ", ".join(repr(atlas.forms[i].name) for i in indices)
    over = sorted({atlas.surfaces[k].name for p in atlas.points if p.name in reached for k in p.surfaces})
    hint = f"; {' and '.join(over)} can be entered from there: see the path of its charts" if over else ""
    return (
        f"there is no route from {_describe(start)} to {_describe(goal)} along forms: "
        f"only {names} can be reached from the start{hint}"
    )


def _describe(where: str | np.ndarray) -> str:
    return repr(where) if isinstance(where, str) else np.array2string(np.asarray(where), precision=6)
