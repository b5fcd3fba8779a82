"""The transition map: forms, singular points, and the graphs between them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations, pairwise, product
from typing import Any

import networkx as nx
import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import Profile
from bifurc.problem import Problem, ProblemError
from bifurc.routes.route import Leg, Route, RouteError, find_route, wrap
from bifurc.seeding import Completeness
from bifurc.singular.locate import Kind, SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas

__all__ = [
    "Atlas",
    "Event",
    "Form",
    "Leg",
    "MeetingPoint",
    "Route",
    "RouteError",
    "Surface",
    "wrap",
]


@dataclass(frozen=True)
class Form:
    """A smooth motion branch with its name, the singular values along it, the smallest
    regular one of them (0 where it passes a singular point), and the number of the
    component it belongs to. ``labels`` holds what a recogniser said of it."""

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
    """A singular point with its name, its ``kind`` once all forms are known, and the
    ``passes``: (index of the form, arclength) for every time a form goes through it.
    ``tangents`` (p, n) are those of the passes, ``surfaces`` the indices of the
    surfaces on which it lies."""

    name: str
    kind: Kind
    point: SingularPoint
    passes: tuple[tuple[int, float], ...]
    tangents: np.ndarray
    note: str = ""
    surfaces: tuple[int, ...] = ()


@dataclass(frozen=True)
class Event:
    """Something at one arclength of a form: a near miss with its ``value``, or a dead
    point of unknown ``index``."""

    form: int
    s: float
    u: np.ndarray
    value: float = 0.0
    index: int = -1


@dataclass(frozen=True)
class Surface:
    """A component of ``dimension`` 2 or more: solutions (k, n) seen on it, and
    ``charts`` that cover it.

    Without charts it may be several components of that dimension: whether they are
    connected is not known. Where the charts of a surface are unfinished, it holds the
    solutions from which a walk over it arrives at the charts; others may belong to it
    as well. ``note`` says what is known of its singular points besides those in the
    atlas.
    """

    dimension: int
    samples: np.ndarray
    name: str = ""
    charts: ChartAtlas | None = None
    note: str = ""

    @property
    def complete(self) -> bool:
        """Whether charts cover all of it."""
        return self.charts is not None and self.charts.complete


@dataclass(frozen=True)
class Atlas:
    """All that `bifurc.search.explore.explore` found of a problem.

    ``closure_gap``: where there is no form, the median relative residual along the
    valley in which the system is nearly solved (0 where there are forms). ``info``
    keeps provenance: settings, seed, seconds, whether the run was interrupted.
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
        """Index of the form called ``name``, in full or by an unambiguous beginning;
        raises `RouteError`."""
        return _find(name, [form.name for form in self.forms])

    def full_name(self, name: str) -> str:
        """The full name of the form, or else the surface, called ``name``, found as by
        `form`; raises `RouteError`."""
        names = [form.name for form in self.forms]
        try:
            return names[_find(name, names)]
        except RouteError:
            names += [surface.name for surface in self.surfaces]
            return names[_find(name, names)]

    def renamed(
        self, names: Sequence[str], labels: Sequence[Mapping[str, Any]] | None = None
    ) -> Atlas:
        """The same atlas with other names for its forms, and labels."""
        if len(set(names)) != len(names) or len(names) != len(self.forms):
            raise ProblemError(
                "names of the forms", list(names), f"{len(self.forms)} different names"
            )
        extra = labels if labels is not None else [f.labels for f in self.forms]
        forms = tuple(
            replace(f, name=name, labels=dict(label))
            for f, name, label in zip(self.forms, names, extra, strict=True)
        )
        return replace(self, forms=forms)

    # --- graphs ---------------------------------------------------------------------------------------

    @cached_property
    def arcs(self) -> nx.MultiGraph:
        """Graph of arcs: nodes are singular points (and ends of open forms), edges the
        arcs between them.

        Node attributes: ``kind``, ``u``. Edge attributes: see `arc`; ``first`` and
        ``last`` are the nodes at its ``start`` and ``end``. A closed form that passes
        no singular point is a loop on a node of its own.
        """
        graph = nx.MultiGraph()
        for point in self.points:
            graph.add_node(point.name, kind=point.kind.value, u=point.point.u)
        for index, form in enumerate(self.forms):
            branch = form.branch
            stops = [
                (s, p.name) for p in self.points for i, s in p.passes if i == index
            ]
            if branch.closed:
                ends = [] if stops else [(0.0, "start")]
            else:
                near = 1e-6 * max(branch.length, 1.0)
                ends = [(0.0, "start"), (branch.length, "end")]
                ends = [
                    (at, which)
                    for at, which in ends
                    if all(abs(s - at) > near for s, _ in stops)
                ]
            for at, which in ends:
                graph.add_node(
                    f"{form.name} {which}",
                    kind="regular" if branch.closed else "end",
                    u=branch(at),
                )
                stops.append((at, f"{form.name} {which}"))
            stops.sort()
            if branch.closed:
                stops.append((stops[0][0] + branch.length, stops[0][1]))
            for (start, first), (end, last) in pairwise(stops):
                graph.add_edge(first, last, **self.arc(index, start, end, first, last))
        return graph

    def arc(
        self, form: int, start: float, end: float, first: Hashable, last: Hashable
    ) -> dict[str, Any]:
        """Attributes of the arc of a form (by its index) from arclength ``start`` to
        ``end`` >= start, which may exceed the length of a closed form: these, its
        ``length``, and the total turning ``travel`` (n,) of each unknown."""
        branch = self.forms[form].branch
        turns = (0.0, branch.length) if branch.closed else (0.0,)
        travel = np.empty(branch.n)
        for i in range(branch.n):
            dead = [
                e.s + turn
                for e in self.dead_points
                if (e.form, e.index) == (form, i)
                for turn in turns
            ]
            stops = np.array([start, *sorted(s for s in dead if start < s < end), end])
            travel[i] = np.abs(np.diff(branch(stops)[:, i])).sum()
        return {
            "form": form,
            "start": start,
            "end": end,
            "length": end - start,
            "travel": travel,
            "first": first,
            "last": last,
        }

    @cached_property
    def graph(self) -> nx.MultiGraph:
        """Graph of forms: nodes are the names of the forms, edges the bifurcations at
        which two of them meet.

        A bifurcation that one form passes more than once is a loop on that form.
        Surfaces are nodes as well, with their ``dimension``, joined to the forms that
        meet them and to the surfaces with which they share a singular point.
        """
        graph = nx.MultiGraph()
        for form in self.forms:
            length, closed = form.branch.length, form.branch.closed
            graph.add_node(
                form.name, component=form.component, length=length, closed=closed
            )
        for point in self.bifurcations:
            passing = sorted(i for i, _ in point.passes)
            for i, j in sorted(set(combinations(passing, 2))):
                graph.add_edge(
                    self.forms[i].name,
                    self.forms[j].name,
                    key=point.name,
                    bifurcation=point.name,
                )
        for surface in self.surfaces:
            graph.add_node(surface.name, dimension=surface.dimension)
        for point in self.points:
            met = [self.surfaces[k].name for k in point.surfaces]
            through = [self.forms[i].name for i in sorted({i for i, _ in point.passes})]
            for one, other in [*product(through, met), *combinations(met, 2)]:
                graph.add_edge(one, other, key=point.name, bifurcation=point.name)
        return graph

    # --- routes ---------------------------------------------------------------------------------------

    def route(
        self,
        start: str | np.ndarray,
        goal: str | np.ndarray,
        count: int = 400,
        problem: Problem | None = None,
    ) -> Route:
        """The shortest way from ``start`` to ``goal`` along forms and over surfaces,
        its path about ``count`` points.

        Either is a configuration (n,) on a form or a surface, or the name of one: it
        stands for the middle of a form's longest arc, or for the chart of a surface
        farthest from its singular points. Forms and surfaces are left at singular
        points. A leg over a surface is a geodesic near the shortest chain of charts.
        The path begins at ``start`` (the point of a name is taken into half a period
        about zero) and has no jumps. An atlas read from a file needs the ``problem``
        for legs over surfaces. Raises `RouteError` for an unknown name, a configuration
        on no form or surface, a component that is only sampled, or where no route
        exists.
        """
        return find_route(self, start, goal, count, problem)

    # --- files ----------------------------------------------------------------------------------------

    def to_dataset(self) -> Any:
        """This atlas as an `xarray.Dataset`; see `bifurc.files.dataset`."""
        from bifurc.files.dataset import to_dataset

        return to_dataset(self)

    @staticmethod
    def from_dataset(dataset: Any) -> Atlas:
        """The atlas that `to_dataset` stored."""
        from bifurc.files.dataset import from_dataset

        return from_dataset(dataset)


def _find(name: str, names: Sequence[str]) -> int:
    """Index of the one of the ``names`` that is ``name``, or begins with it, or
    contains it; raises `RouteError`."""
    lowered = name.lower()
    exact = [i for i, known in enumerate(names) if known == name]
    begins = [
        i
        for i, known in enumerate(names)
        if known.lower().startswith(lowered)
        and not known[len(name) : len(name) + 1].isalnum()
    ]
    contains = [i for i, known in enumerate(names) if lowered in known.lower()]
    for found in (exact, begins, contains):
        if len(found) == 1:
            return found[0]
    raise RouteError(f"form {name!r}: it must be one of {', '.join(map(repr, names))}")
