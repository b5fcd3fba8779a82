"""The transition map as data: forms, singular points, surfaces, and what is known."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np

from bifurc.branch import Branch
from bifurc.checks import check_type
from bifurc.completeness import Completeness
from bifurc.curves.certificate import Certificate
from bifurc.curves.monitor import Profile
from bifurc.diagrams.diagram import Diagram
from bifurc.errors import ProblemError, RouteError
from bifurc.limits import Deadline
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind, SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.factor import Factor, describe_product, product_of
from bifurc.tables import count_of, html_paragraph, html_table

# Values that JSON can hold, nested to any depth, by their names.
JsonObject: TypeAlias = Mapping[str, Any]

SHOWN = 12  # things of one kind that are shown at a prompt; the others are counted
SHOWN_IN_NOTEBOOK = 50
ROUNDING = 1e-12  # of the largest unknown: less is shown as 0
# From a configuration as drawn to what is there, over the scale of the unknowns:
# coordinates of a file have so many digits.
NEAR_DRAWN = 1e-5


@dataclass(frozen=True, eq=False)
class Form:
    """A smooth motion branch with its name, the singular values along it, the smallest
    regular one of them (0 where it passes a singular point), and the number of the
    component it belongs to.

    ``misclosure`` is the largest relative residual that no correction across the form
    removes: rounding, some 1e-15, unless the equations contradict each other a little.
    ``certificate`` says what is certified of it. ``labels`` holds what whoever knows
    more than the equations said of it, as values that JSON can hold. ``multiplicity``:
    how often the equations are solved all along it, as a square is twice; where that
    comes from repeated factors the singular values are those of the equations with
    every factor once.
    """

    name: str
    branch: Branch
    profile: Profile
    min_singular_value: float
    component: int = 0
    misclosure: float = 0.0
    certificate: Certificate | None = None
    labels: JsonObject = field(default_factory=dict)
    multiplicity: int = 1

    @property
    def rank(self) -> int:
        """The rank that F' has along the form, but for single points."""
        return self.profile.rank

    def __repr__(self) -> str:
        return f"<Form {self.name!r}: {_course(self.branch)}>"


@dataclass(frozen=True, eq=False)
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

    def __repr__(self) -> str:
        forms = ", ".join(f"forms[{form}]" for form, _ in self.passes)
        words = [self.kind.value, f"rank {self.point.rank}", forms or "no form"]
        if self.surfaces:
            words.append(f"surfaces {', '.join(map(str, self.surfaces))}")
        if self.note:
            words.append(self.note)
        return f"<MeetingPoint {self.name!r}: {', '.join(words)}>"


@dataclass(frozen=True, eq=False)
class Event:
    """Something at one arclength of a form: a near miss with its ``value``, which is
    off by ``error`` at most, or a dead point of unknown ``index``."""

    form: int
    s: float
    u: np.ndarray
    value: float = 0.0
    error: float = 0.0
    index: int = -1

    def __repr__(self) -> str:
        kind = f"near miss {self.value:.4g}"
        if self.index >= 0:
            kind = f"dead point of unknown {self.index + 1}"
        return f"<Event: {kind} on forms[{self.form}] at s = {self.s:.6g}>"


@dataclass(frozen=True, eq=False)
class Surface:
    """A component of ``dimension`` 2 or more: solutions (k, n) seen on it, and
    ``charts`` that cover it, which are made up to dimension 5.

    Without charts or factors it may be several components of that dimension: whether
    they are connected is not known, but for what walks between samples show. Where the
    charts of a surface are unfinished, it holds the solutions from which a walk over it
    arrives at the charts; others may belong to it as well. ``note`` says what is known
    of its singular points besides those in the atlas, and of what it is joined to. With
    ``factors`` it is their product: it is connected, and all of it is known by what
    each of them is.
    """

    dimension: int
    samples: np.ndarray
    name: str = ""
    charts: ChartAtlas | None = None
    note: str = ""
    factors: tuple[Factor, ...] = ()

    @property
    def complete(self) -> bool:
        """Whether charts cover all of it."""
        return self.charts is not None and self.charts.complete

    @property
    def is_short_of_charts(self) -> bool:
        """Whether charts ran out before all of it was covered, and nothing else says what
        it is."""
        if self.charts is None or self.factors:
            return False
        return self.charts.is_short_of_charts

    def __repr__(self) -> str:
        words = [f"dimension {self.dimension}", product_of(self.factors)]
        words += [_covering(self), self.note]
        return f"<Surface {self.name!r}: {', '.join(filter(None, words))}>"


def samples_beyond_charts(surfaces: Sequence[Surface]) -> int:
    """How many of the solutions seen on components that are no products lie in no chart
    of their dimension, where charts are made."""
    others = [surface for surface in surfaces if not surface.factors]
    count = 0
    for dimension in {one.dimension for one in others if one.charts is not None}:
        of_dimension = [one for one in others if one.dimension == dimension]
        open_samples = np.concatenate([surface.samples for surface in of_dimension])
        for surface in of_dimension:
            if surface.charts is not None and len(open_samples):
                covered = surface.charts.covers(open_samples)
                open_samples = open_samples[~covered]
        count += len(open_samples)
    return count


@dataclass(frozen=True, eq=False)
class NearMotion:
    """A curve along which the system is nearly solved, or a surface.

    Across it no correction makes the relative residual smaller than ``misclosure``
    everywhere. ``sample`` (n,) is a point of it. Its ``mobility`` is 1 for a curve, the
    ``branch``; a surface, with a mobility of 2 or more, has none. It is no motion: along
    the branch the equations are solved but for the misclosure.
    """

    name: str
    misclosure: float
    branch: Branch | None
    sample: np.ndarray
    mobility: int = 1

    @property
    def length(self) -> float:
        """The arclength of the curve; 0 of a surface."""
        return 0.0 if self.branch is None else self.branch.length

    @property
    def is_closed(self) -> bool:
        """Whether the curve comes back to its start."""
        return self.branch is not None and self.branch.closed


@dataclass(frozen=True)
class Provenance:
    """How an atlas came about.

    ``seed`` of the random starts and ``settings`` of the search, whether it was
    ``interrupted`` or ``out_of_time``, how F' was made (``derivatives``), whether the
    ``equations`` are recorded, for a function, and the ``seconds`` it took.
    """

    seed: int = 0
    settings: SearchSettings = field(default_factory=SearchSettings)
    interrupted: bool = False
    out_of_time: bool = False
    derivatives: str = "exact"
    equations: str = ""
    seconds: float = 0.0

    def at_end(self, deadline: Deadline, is_cut_off: bool) -> Provenance:
        """The same of a search that ended before its ``deadline``, or was cut off."""
        interrupted = deadline.is_interrupted
        return replace(
            self,
            interrupted=interrupted,
            out_of_time=(is_cut_off or deadline.passed) and not interrupted,
            seconds=time.perf_counter() - deadline.began,
        )


@dataclass(frozen=True, eq=False)
class Atlas:
    """All that `bifurc.search.explore.explore` found of a problem.

    Periodic unknowns of points, events, rigid assemblies and samples of surfaces lie
    within (-period / 2, period / 2], but for those whose bounds reach farther. What
    lies nearer to either end than 1e-12 of the period comes out at + period / 2. The
    branches of the forms are continuous instead.

    ``closure_gap``: where nothing moves, the misclosure of the near motion that misses
    least, and without one the median relative residual that starts are left with; 0
    where there are forms or surfaces. ``provenance`` says
    how the atlas came about. ``subject`` says what was mapped, in values that JSON can
    hold: whoever maps something more than equations defines it; a ``scale`` in it is
    what each unknown is multiplied with to be in the user's unit, ``drawn`` the
    configuration in which it was given, ``drivers`` the unknowns, by index, whose dead
    points matter. ``diagram``: what
    happens as a parameter changes, where one was named or events were asked for.
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
    near_motions: tuple[NearMotion, ...] = ()
    closure_gap: float = 0.0
    provenance: Provenance = field(default_factory=Provenance)
    subject: JsonObject = field(default_factory=dict)
    diagram: Diagram | None = None

    # --- queries ----------------------------------------------------------------------

    @property
    def drawn(self) -> np.ndarray | None:
        """The configuration (n,) in which what was mapped was given, if any."""
        values = self.subject.get("drawn")
        return None if values is None else np.array(values, dtype=float)

    @property
    def bifurcations(self) -> tuple[MeetingPoint, ...]:
        """Singular points where two or more branches meet."""
        return tuple(p for p in self.points if p.kind is Kind.BIFURCATION)

    @property
    def rank_drops(self) -> tuple[MeetingPoint, ...]:
        """Singular points that a single smooth branch passes."""
        return tuple(p for p in self.points if p.kind is Kind.RANK_DROP)

    @property
    def mobility(self) -> int:
        """The largest dimension of a component; 0 where nothing moves."""
        dimensions = [surface.dimension for surface in self.surfaces]
        dimensions += [1] * bool(self.forms)
        return max(dimensions, default=0)

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
        forms = [form.name for form in self.forms]
        try:
            return forms[_find(name, forms)]
        except RouteError:
            everything = forms + [surface.name for surface in self.surfaces]
            return everything[_find(name, everything)]

    def renamed(
        self, names: Sequence[str], labels: Sequence[JsonObject] | None = None
    ) -> Atlas:
        """The same atlas with other names for its forms, and labels where there are
        any; raises `ProblemError` unless there is one name of its own for each form."""
        if len(set(names)) != len(names) or len(names) != len(self.forms):
            expected = f"{len(self.forms)} different names"
            raise ProblemError("names of the forms", list(names), expected)
        if labels is None:
            labels = [form.labels for form in self.forms]
        forms = [
            replace(form, name=name, labels=dict(label))
            for form, name, label in zip(self.forms, names, labels, strict=True)
        ]
        doubts = tuple(doubt.naming(names) for doubt in self.completeness.doubts)
        completeness = replace(self.completeness, doubts=doubts)
        return replace(self, forms=tuple(forms), completeness=completeness)

    # --- display ----------------------------------------------------------------------

    def __repr__(self) -> str:
        lines = [f"<Atlas of {_abbreviated(self.names)}: {_counts(self)}"]
        lines += _first([_form_line(form) for form in self.forms], "forms")
        lines += _first([_point_line(self, p) for p in self.points], "singular points")
        lines += _first([_miss_line(self, e) for e in self.near_misses], "near misses")
        lines += _first([f"  {surface!r}" for surface in self.surfaces], "surfaces")
        lines += _diagram_lines(self)
        lines.append(f"  completeness: {self.completeness.level}>")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """Tables for a notebook; `bifurc.figures.notebook` adds the picture."""
        unit = _common_unit(self)
        forms = [_form_row(form) for form in self.forms]
        points = [_point_row(self, point) for point in self.points]
        surfaces = [_surface_row(self, surface) for surface in self.surfaces]
        misses = [_miss_row(self, event) for event in self.near_misses]
        rigid = [[_configuration(point)] for point in self.rigid]
        tables = [
            _table(f"Forms{unit}", FORM_HEADS, forms),
            _table(f"Singular points{unit}", POINT_HEADS, points),
            _table("Surfaces", SURFACE_HEADS, surfaces),
            _table(f"Near misses{unit}", MISS_HEADS, misses),
            _table(f"Rigid assemblies{unit}", RIGID_HEADS, rigid),
        ]
        level, statement = self.completeness.level, self.completeness.statement
        completeness = html_paragraph(f"Completeness: {level}.", f"{statement}.")
        return "".join(tables) + completeness


def _find(name: str, names: Sequence[str]) -> int:
    """Index of the one of the ``names`` that is ``name``, or begins with it, or
    contains it; raises `RouteError`, also for a blank name, and `ProblemError` for what
    is no text."""
    check_type("name", name, str)
    lowered = name.lower()
    equal: list[int] = []
    beginning: list[int] = []
    containing: list[int] = []
    for i, candidate in enumerate(names):
        if candidate == name:
            equal.append(i)
        next_letter = candidate[len(name) : len(name) + 1]
        if candidate.lower().startswith(lowered) and not next_letter.isalnum():
            beginning.append(i)
        if lowered in candidate.lower():
            containing.append(i)
    # every name contains a blank one, which names nothing
    lists = (equal, beginning, containing) if name.strip() else (equal,)
    for matches in lists:
        if len(matches) == 1:
            return matches[0]
    raise RouteError(f"form {name!r}: it must be one of {', '.join(map(repr, names))}")


# --- what a prompt shows --------------------------------------------------------------


def _abbreviated(names: Sequence[str]) -> str:
    """The names, of many the first and the last."""
    return ", ".join(names) if len(names) < 4 else f"{names[0]}, ..., {names[-1]}"


def _counts(atlas: Atlas) -> str:
    """How many there are of every kind of thing that there is."""
    numbers = [
        (len(atlas.forms), "form"),
        (atlas.components, "component"),
        (len(atlas.bifurcations), "bifurcation"),
        (len(atlas.near_misses), "near miss"),
        (len(atlas.surfaces), "surface"),
        (len(atlas.rigid), "rigid assembly"),
        (len(atlas.near_motions), "near motion"),
    ]
    counts = [count_of(number, noun) for number, noun in numbers if number]
    return ", ".join(counts) or "nothing"


def _first(lines: Sequence[str], noun: str) -> list[str]:
    """The first lines, and how many of the ``noun`` there are besides."""
    left = len(lines) - SHOWN
    return [*lines[:SHOWN], f"  and {left} more {noun}"] if left > 0 else list(lines)


def _form_line(form: Form) -> str:
    return f"  {form.name}: {_course(form.branch)}"


def _point_line(atlas: Atlas, point: MeetingPoint) -> str:
    members = ", ".join(_members(atlas, point))
    return f"  {point.name}: {point.kind.value} of {members or 'no form'}"


def _miss_line(atlas: Atlas, event: Event) -> str:
    return f"  near miss: {event.value:.4g} on {atlas.forms[event.form].name}"


def _diagram_lines(atlas: Atlas) -> list[str]:
    """Folds, Hopf points and events, a line each."""
    if atlas.diagram is None:
        return []
    lines = [
        f"  {point.name}: {point.words} on {atlas.forms[point.form].name}"
        for point in atlas.diagram.points
    ]
    return _first(lines, "points")


def _course(branch: Branch) -> str:
    """Length, end and winding numbers of a branch."""
    words = [f"length {branch.length:.6g}", _end(branch)]
    if branch.closed:
        words.append(f"winding {_winding(branch)}")
    return ", ".join(words)


def _end(branch: Branch) -> str:
    return branch.outcome.name.lower().replace("_", " ")


def _winding(branch: Branch) -> str:
    return " ".join(f"{turns:+d}" if turns else "0" for turns in branch.winding)


def _members(atlas: Atlas, point: MeetingPoint) -> list[str]:
    """Names of the forms, once for every pass, and of the surfaces that meet at a
    point."""
    forms = [atlas.forms[form].name for form, _ in point.passes]
    return forms + [atlas.surfaces[k].name for k in point.surfaces]


def _covering(surface: Surface) -> str:
    """How much of a surface is known."""
    if surface.charts is None:
        return count_of(len(surface.samples), "sample")
    extent = "complete" if surface.complete else "incomplete"
    charts = count_of(len(surface.charts), "chart")
    area = surface.charts.area_words
    return ", ".join([charts, *([f"area {area}"] if area else []), extent])


# --- what a notebook shows ------------------------------------------------------------

FORM_HEADS = ("name", "length", "end", "winding", "smallest s.v.", "component")
POINT_HEADS = ("name", "kind", "meeting", "rank", "error", "configuration", "note")
SURFACE_HEADS = ("name", "dimension", "covering", "note")
MISS_HEADS = ("form", "arclength", "singular value", "configuration")
RIGID_HEADS = ("configuration",)


def _table(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return html_table(title, heads, rows, SHOWN_IN_NOTEBOOK)


def _form_row(form: Form) -> list[str]:
    branch = form.branch
    length, smallest = f"{branch.length:.6g}", f"{form.min_singular_value:.3g}"
    course = [length, _end(branch), _winding(branch)]
    return [form.name, *course, smallest, str(form.component)]


def _point_row(atlas: Atlas, point: MeetingPoint) -> list[str]:
    members = ", ".join(_members(atlas, point))
    rank, error = str(point.point.rank), f"{point.point.error:.0e}"
    place = _configuration(point.point.u)
    return [point.name, point.kind.value, members, rank, error, place, point.note]


def _surface_row(atlas: Atlas, surface: Surface) -> list[str]:
    product = describe_product(surface.factors, atlas.names)
    remark = "; ".join(filter(None, [product, surface.note]))
    return [surface.name, str(surface.dimension), _covering(surface), remark]


def _miss_row(atlas: Atlas, event: Event) -> list[str]:
    name = atlas.forms[event.form].name
    return [name, f"{event.s:.6g}", f"{event.value:.4g}", _configuration(event.u)]


def _configuration(point: np.ndarray) -> str:
    """The unknowns to six digits, those as small as rounding as 0."""
    rounding = ROUNDING * np.abs(point).max(initial=0.0)
    shown = np.where(np.abs(point) < rounding, 0.0, point)
    return " ".join(f"{value:.6g}" for value in shown)


def _common_unit(atlas: Atlas) -> str:
    """The unit of all unknowns in brackets, or nothing where they differ."""
    units = set(atlas.units)
    return f" ({units.pop()})" if len(units) == 1 and units != {""} else ""
