"""The transition map: forms, singular points, and the graphs between them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import networkx as nx
import numpy as np

from bifurc.branch import Branch
from bifurc.monitor import Profile
from bifurc.problem import ProblemError
from bifurc.seeding import Completeness
from bifurc.singular import Kind, SingularPoint

__all__ = ["Atlas", "Event", "Form", "Leg", "MeetingPoint", "Route", "Surface", "wrap"]


def wrap(point: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """``point`` with periodic unknowns taken into (-period / 2, period / 2]."""
    out = np.array(point, dtype=float)
    periodic = np.isfinite(periods)
    period = periods[periodic]
    turned = out[..., periodic] - period * np.round(out[..., periodic] / period)
    out[..., periodic] = np.where(turned <= -0.5 * period + 1e-9, turned + period, turned)
    return out


@dataclass(frozen=True)
class Form:
    """A smooth motion branch with its name, the singular values along it, the smallest regular one of them, minima
    included, and the number of the component it belongs to. ``labels`` holds what a recogniser said of it."""

    name: str
    branch: Branch
    profile: Profile
    min_singular_value: float
    component: int = 0
    labels: Mapping[str, Any] = field(default_factory=dict)

    @property
    def rank(self) -> int:
        """The rank that F' has along the form, but for single points."""
        return self.profile.rank


@dataclass(frozen=True)
class MeetingPoint:
    """A singular point with its name, its ``kind`` once all forms are known, and the ``passes``: (index of the
    form, arclength) for every time a form goes through it. ``tangents`` (p, n) are those of the passes."""

    name: str
    kind: Kind
    point: SingularPoint
    passes: tuple[tuple[int, float], ...]
    tangents: np.ndarray
    note: str = ""


@dataclass(frozen=True)
class Event:
    """Something at one arclength of a form: a near miss with its ``value``, or a dead point of unknown ``index``."""

    form: int
    s: float
    u: np.ndarray
    value: float = 0.0
    index: int = -1


@dataclass(frozen=True)
class Surface:
    """Solutions (k, n) seen on components of ``dimension`` 2 or more."""

    dimension: int
    samples: np.ndarray


@dataclass(frozen=True)
class Leg:
    """One stretch of a route: along ``form`` from arclength ``start`` to ``end`` (backwards where end < start), leaving
    at the singular point ``at`` (empty at the goal). ``travel`` (n,) is the total turning of each unknown."""

    form: str
    start: float
    end: float
    at: str
    travel: np.ndarray


@dataclass(frozen=True)
class Route:
    """A chain of legs from one configuration to another, and the path (k, n) along them, without jumps."""

    legs: tuple[Leg, ...]
    path: np.ndarray

    @property
    def length(self) -> float:
        """Arclength of the whole route."""
        return float(sum(abs(leg.end - leg.start) for leg in self.legs))

    @property
    def travel(self) -> np.ndarray:
        """Total turning (n,) of each unknown."""
        return np.sum([leg.travel for leg in self.legs], axis=0)


class RouteError(LookupError):
    """There is no such form, or no route between two forms."""


@dataclass(frozen=True)
class Atlas:
    """All that `bifurc.explore.explore` found of a problem.

    ``closure_gap``: where there is no form, the median relative residual along the valley in which the system is
    nearly solved (0 where there are forms).
    ``info`` keeps provenance: settings, seed, seconds, whether the run was interrupted.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    periods: np.ndarray
    forms: tuple[Form, ...]
    points: tuple[MeetingPoint, ...]
    near_misses: tuple[Event, ...]
    dead_points: tuple[Event, ...]
    rigid: np.ndarray
    surfaces: tuple[Surface, ...]
    completeness: Completeness
    closure_gap: float = 0.0
    info: Mapping[str, Any] = field(default_factory=dict)

    # --- queries --------------------------------------------------------------------------------------

    @property
    def bifurcations(self) -> tuple[MeetingPoint, ...]:
        """Singular points where two or more branches meet."""
        return tuple(p for p in self.points if p.kind is Kind.BIFURCATION)

    @property
    def rank_drops(self) -> tuple[MeetingPoint, ...]:
        """Singular points that a single smooth branch passes."""
        return tuple(p for p in self.points if p.kind is Kind.RANK_DROP)

    @property
    def components(self) -> int:
        """Number of connected components made of forms."""
        return len({form.component for form in self.forms})

    def form(self, name: str) -> int:
        """Index of the form called ``name``, in full or by an unambiguous beginning; raises `RouteError`."""
        exact = [i for i, f in enumerate(self.forms) if f.name == name]
        lowered = name.lower()
        begins = [
            i for i, f in enumerate(self.forms)
            if f.name.lower().startswith(lowered) and not f.name[len(name) : len(name) + 1].isalnum()
        ]  # fmt: skip
        contains = [i for i, f in enumerate(self.forms) if lowered in f.name.lower()]
        for found in (exact, begins, contains):
            if len(found) == 1:
                return found[0]
        known = ", ".join(repr(f.name) for f in self.forms)
        raise RouteError(f"form {name!r}: it must be one of {known}")

    def renamed(self, names: Sequence[str], labels: Sequence[Mapping[str, Any]] | None = None) -> Atlas:
        """The same atlas with other names for its forms, and labels."""
        if len(set(names)) != len(names) or len(names) != len(self.forms):
            raise ProblemError("names of the forms", list(names), f"{len(self.forms)} different names")
        extra = labels if labels is not None else [f.labels for f in self.forms]
        forms = tuple(
            replace(f, name=name, labels=dict(label)) for f, name, label in zip(self.forms, names, extra, strict=True)
        )
        return replace(self, forms=forms)

    # --- graphs ---------------------------------------------------------------------------------------

    @cached_property
    def arcs(self) -> nx.MultiGraph:
        """Graph of arcs: nodes are singular points (and ends of open forms), edges the arcs between them.

        Node attributes: ``kind``, ``u``. Edge attributes: ``form`` (index), ``start``, ``end`` (arclengths, end > start),
        ``length``, ``travel`` (n,). A closed form that passes no singular point is a loop on a node of its own.
        """
        graph = nx.MultiGraph()
        for point in self.points:
            graph.add_node(point.name, kind=point.kind.value, u=point.point.u)
        for index, form in enumerate(self.forms):
            branch = form.branch
            stops = sorted((s, p.name) for p in self.points for i, s in p.passes if i == index)
            if branch.closed:
                if not stops:
                    name = f"{form.name} start"
                    graph.add_node(name, kind="regular", u=branch(0.0))
                    stops = [(0.0, name)]
                stops.append((stops[0][0] + branch.length, stops[0][1]))
            else:
                for end, which in ((0.0, "start"), (branch.length, "end")):
                    if not any(abs(s - end) < 1e-6 * max(branch.length, 1.0) for s, _ in stops):
                        name = f"{form.name} {which}"
                        graph.add_node(name, kind="end", u=branch(end))
                        stops.append((end, name))
                stops.sort()
            for (a, left), (b, right) in zip(stops[:-1], stops[1:], strict=True):
                graph.add_edge(left, right, form=index, start=a, end=b, length=b - a, travel=branch.travel(a, b))
        return graph

    @cached_property
    def graph(self) -> nx.MultiGraph:
        """Graph of forms: nodes are the names of the forms, edges the bifurcations at which two of them meet."""
        graph = nx.MultiGraph()
        for form in self.forms:
            graph.add_node(form.name, component=form.component, length=form.branch.length, closed=form.branch.closed)
        for point in self.bifurcations:
            meeting = sorted({i for i, _ in point.passes})
            for a, i in enumerate(meeting):
                for j in meeting[a + 1 :]:
                    graph.add_edge(self.forms[i].name, self.forms[j].name, key=point.name, bifurcation=point.name)
        return graph

    # --- routes ---------------------------------------------------------------------------------------

    def route(self, start: str | np.ndarray, goal: str | np.ndarray, count: int = 400) -> Route:
        """The shortest chain of arcs from ``start`` to ``goal``, with a path of about ``count`` points.

        Either is a configuration (n,) on a form, or the name of a form, which stands for the middle of its longest
        arc. Raises `RouteError` for an unknown name, a configuration on no form, or where no route exists.
        """
        graph = self.arcs.copy()
        self._split(graph, "__start__", *self._place(start))
        self._split(graph, "__goal__", *self._place(goal))
        try:
            chain = nx.shortest_path(graph, "__start__", "__goal__", weight="length")
        except nx.NetworkXNoPath:
            raise RouteError(
                f"there is no route from {_describe(start)} to {_describe(goal)}: they lie in different components"
            ) from None
        legs: list[Leg] = []
        for a, b in zip(chain[:-1], chain[1:], strict=True):
            edge = min(graph[a][b].values(), key=lambda e: e["length"])
            forward = edge["from"] == a if "from" in edge else self._runs_forward(edge, a)
            ends = (edge["start"], edge["end"]) if forward else (edge["end"], edge["start"])
            form = self.forms[edge["form"]]
            legs.append(Leg(form.name, *ends, "" if b == "__goal__" else b, form.branch.travel(edge["start"], edge["end"])))
        return Route(tuple(legs), self._path(legs, count))

    def _place(self, where: str | np.ndarray) -> tuple[int, float]:
        """(index of the form, arclength) of a form's name or of a configuration."""
        if isinstance(where, str):
            index = self.form(where)
            longest = max(
                (e for _, _, e in self.arcs.edges(data=True) if e["form"] == index), key=lambda e: e["length"]
            )
            middle = 0.5 * (longest["start"] + longest["end"])
            branch = self.forms[index].branch
            return index, middle % branch.length if branch.closed else middle
        distances = [form.branch.nearest(np.asarray(where, dtype=float)) for form in self.forms]
        if not distances:
            raise RouteError("the atlas has no forms")
        index = int(np.argmin([d[0] for d, _ in distances]))
        distance, s = distances[index]
        if distance[0] > 1e-6:
            raise RouteError(f"configuration {where}: it lies {distance[0]:.2g} away from the nearest form")
        return index, float(s[0])

    def _split(self, graph: nx.MultiGraph, node: str, index: int, s: float) -> None:
        """Insert ``node`` at arclength ``s`` of a form into the arc that holds it."""
        branch = self.forms[index].branch
        for a, b, key, edge in list(graph.edges(keys=True, data=True)):
            if edge["form"] != index:
                continue
            at = s + branch.length if branch.closed and s < edge["start"] else s
            if not edge["start"] <= at <= edge["end"]:
                continue
            first, last = (a, b) if edge.get("from", a if self._runs_forward(edge, a) else b) == a else (b, a)
            graph.remove_edge(a, b, key)
            graph.add_node(node)
            for left, right, low, high in ((first, node, edge["start"], at), (node, last, at, edge["end"])):
                graph.add_edge(
                    left, right, form=index, start=low, end=high, length=high - low, **{"from": left}
                )
            return
        raise RouteError(f"no arc of {self.forms[index].name} holds arclength {s}")

    def _runs_forward(self, edge: Mapping[str, Any], node: str) -> bool:
        """Whether the arc starts (in the sense of rising arclength) at ``node``."""
        u = self.arcs.nodes[node]["u"]
        branch = self.forms[edge["form"]].branch
        gap = branch(edge["start"]) - u
        periodic = np.isfinite(self.periods)
        gap[periodic] -= self.periods[periodic] * np.round(gap[periodic] / self.periods[periodic])
        return bool(np.linalg.norm(gap) < 1e-6 * (1 + np.linalg.norm(u)))

    def _path(self, legs: Sequence[Leg], count: int) -> np.ndarray:
        """Samples along the legs, unwrapped so that neighbours are close."""
        total = sum(abs(leg.end - leg.start) for leg in legs)
        parts = []
        for leg in legs:
            share = max(2, round(count * abs(leg.end - leg.start) / max(total, 1e-300)))
            parts.append(self.forms[self.form(leg.form)].branch(np.linspace(leg.start, leg.end, share)))
        path = np.concatenate(parts)
        periodic = np.isfinite(self.periods)
        for i in np.flatnonzero(periodic):
            path[:, i] = np.unwrap(path[:, i], period=self.periods[i])
        return path

    # --- files ----------------------------------------------------------------------------------------

    def to_dataset(self) -> Any:
        """This atlas as an `xarray.Dataset`; see `bifurc.dataset`."""
        from bifurc.dataset import to_dataset

        return to_dataset(self)

    @staticmethod
    def from_dataset(dataset: Any) -> Atlas:
        """The atlas that `to_dataset` stored."""
        from bifurc.dataset import from_dataset

        return from_dataset(dataset)


def _describe(where: str | np.ndarray | Iterable[float]) -> str:
    return repr(where) if isinstance(where, str) else np.array2string(np.asarray(where), precision=6)
