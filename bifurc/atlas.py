"""The transition map as data: forms, singular points, surfaces, and what is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.certificate import Certificate
from bifurc.curves.monitor import Profile
from bifurc.errors import ProblemError, RouteError
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Completeness
from bifurc.singular.point import Kind, SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas

__all__ = ["Atlas", "Event", "Form", "MeetingPoint", "Provenance", "Surface"]


@dataclass(frozen=True)
class Form:
    """A smooth motion branch with its name, the singular values along it, the smallest
    regular one of them (0 where it passes a singular point), and the number of the
    component it belongs to.

    ``certificate`` says what is certified of it. ``labels`` holds what whoever knows
    more than the equations said of it, as values that JSON can hold.
    """

    name: str
    branch: Branch
    profile: Profile
    min_singular_value: float
    component: int = 0
    certificate: Certificate | None = None
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
class Provenance:
    """How an atlas came about.

    ``seed`` of the random starts and ``settings`` of the search, whether it was
    ``interrupted`` or ``out_of_time``, how F' was made (``derivatives``), and the
    ``seconds`` it took.
    """

    seed: int = 0
    settings: SearchSettings = field(default_factory=SearchSettings)
    interrupted: bool = False
    out_of_time: bool = False
    derivatives: str = "exact"
    seconds: float = 0.0


@dataclass(frozen=True)
class Atlas:
    """All that `bifurc.search.explore.explore` found of a problem.

    Periodic unknowns of points, events, rigid assemblies and samples of surfaces lie
    within (-period / 2, period / 2], but for those whose bounds reach farther. What
    lies nearer to either end than 1e-12 of the period comes out at + period / 2. The
    branches of the forms are continuous instead.

    ``closure_gap``: where there is no form, the median relative residual along the
    valley in which the system is nearly solved (0 where there are forms). ``provenance`` says
    how the atlas came about. ``subject`` says what was mapped, in values that JSON can
    hold: whoever maps something more than equations defines it.
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
    provenance: Provenance = field(default_factory=Provenance)
    subject: Mapping[str, Any] = field(default_factory=dict)

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
