"""Curves of many unknowns with what lies on them as an atlas."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Provenance
from bifurc.branch import Branch, Outcome
from bifurc.completeness import Claim, Completeness, Doubt, Level, Scope
from bifurc.curves.monitor import Profile
from bifurc.decisions import is_same_point
from bifurc.diagrams.diagram import Diagram, DiagramPoint
from bifurc.diagrams.make_diagram import named_points
from bifurc.diagrams.stability import unknown_stability
from bifurc.isometry import Course
from bifurc.large.large_branch import LargeBranch, LargePoint
from bifurc.problem import Problem
from bifurc.search.answer.assemble import component_numbers
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt, ended_early
from bifurc.search.answer.doubts import ended_at_assumed_bounds
from bifurc.singular.point import Kind, SingularPoint

ROUNDING = 1e-10  # of a point's place, over the size of the unknowns
AT_CROSSING = 1e-4  # arclength beside a crossing within which a parameter turns at it
SETTINGS_OF_STABILITY = "stability along the parameter is not told of so many unknowns"
CROSSINGS = (Kind.CROSSING, Kind.RANK_DROP, Kind.MULTIPLE)


class Courses(NamedTuple):
    """Curves of a ``problem`` whose parameter is unknown number ``parameter``: each as it was
    traced, in the user's unknowns, and what gives ``points`` and ``directions`` (k, n)
    in these."""

    problem: Problem
    parameter: int
    traced: Sequence[LargeBranch]
    courses: Sequence[Course]
    points: Callable[[np.ndarray], np.ndarray]
    directions: Callable[[np.ndarray], np.ndarray]


class Reach(NamedTuple):
    """How many ``starts`` ``reached`` a solution, and at how many crossings other curves
    were ``left``."""

    starts: int
    reached: int
    left: int


def atlas_of_curves(found: Courses, reach: Reach, provenance: Provenance) -> Atlas:
    """The atlas, with its diagram."""
    domain = found.problem.domain
    points = tuple(_meeting_points(found))
    components = component_numbers(len(found.traced), points)
    singular = {form for point in points for form, _ in point.passes}
    forms = tuple(
        _form(found, number, components[number], number in singular)
        for number in range(len(found.traced))
    )
    completeness = Completeness(
        (*_claims(reach, provenance, domain.names),),
        tuple(_doubts(found, forms, points, reach)),
        1.0,
    )
    return Atlas(
        names=domain.names,
        units=domain.units,
        periods=domain.periods,
        forms=forms,
        points=points,
        near_misses=tuple(_near_misses(found)),
        dead_points=(),
        rigid=np.empty((0, found.problem.n)),
        surfaces=(),
        completeness=completeness,
        provenance=provenance,
        diagram=_diagram(found, points, forms),
    )


def _form(found: Courses, number: int, component: int, is_singular: bool) -> Form:
    """A curve as a form: of the singular values only the smallest are known."""
    traced, course = found.traced[number], found.courses[number]
    n, count = found.problem.n, traced.values.shape[1]
    values = np.full((len(traced.places), n), np.nan)
    values[:, -1] = 0.0
    values[:, n - 1 - count : n - 1] = traced.values[:, ::-1]
    arclength = course.arclengths(traced.places)
    nodes = len(traced.places) // max(len(traced.branch.pieces), 1)
    shape = (-1, max(nodes, 1))
    profile = Profile(arclength.reshape(shape), values.reshape(*shape, n), n - 1)
    smallest = 0.0 if is_singular else float(np.nanmin(traced.values, initial=np.inf))
    return Form(f"Form {number + 1}", course.branch, profile, smallest, component)


# --- singular points ------------------------------------------------------------------


def _meeting_points(found: Courses) -> Iterator[MeetingPoint]:
    """The singular points, those that several curves pass once."""
    listed: list[tuple[LargeBranch, np.ndarray]] = []
    for traced in found.traced:
        for point in traced.points:
            if point.kind not in CROSSINGS:
                continue
            inner = traced.units.inwards(point.u)
            if any(_is_near(traced, inner, other) for _, other in listed):
                continue
            listed.append((traced, point.u))
            yield _meeting_point(found, len(listed), point)


def _is_near(traced: LargeBranch, inner: np.ndarray, other: np.ndarray) -> bool:
    gap = float(np.linalg.norm(traced.units.inwards(other) - inner))
    return is_same_point(gap)


def _meeting_point(found: Courses, number: int, point: LargePoint) -> MeetingPoint:
    passes = tuple(_passes(found, point.u))
    tangents = np.array(
        [_unit_tangent(found.courses[form].branch, s) for form, s in passes]
    ).reshape(-1, found.problem.n)
    known = found.directions(point.directions.reshape(-1, found.problem.n))
    null = np.concatenate([point.null_vectors, point.directions[:1]])
    basis = np.linalg.qr(found.directions(null).T)[0]
    u = found.points(point.u)
    singular = SingularPoint(
        u=u,
        rank=found.problem.n - 1 - point.multiplicity,
        null_space=basis,
        error=ROUNDING * float(np.linalg.norm(u)),
        half_branches=np.concatenate([known, -known]),
        tangents=known,
        dimension=1,
        order=point.order,
        radius=0.0,
    )
    kind, note = _kind_of(point, len(passes))
    return MeetingPoint(f"B{number}", kind, singular, passes, tangents, note)


def _unit_tangent(branch: Branch, s: float) -> np.ndarray:
    tangent = branch(s, 1)
    unit: np.ndarray = tangent / np.linalg.norm(tangent)
    return unit


def _kind_of(point: LargePoint, passes: int) -> tuple[Kind, str]:
    """The kind of a singular point that curves pass so many times, and a note."""
    kind, note = Kind.BIFURCATION, ""
    if point.kind is Kind.RANK_DROP:
        kind = Kind.RANK_DROP
    elif point.kind is Kind.MULTIPLE:
        kind, note = Kind.UNDECIDED, "directions of other curves are not computed"
    elif passes < len(point.directions):
        note = f"of {len(point.directions)} directions {passes} are followed"
    return kind, note


def _passes(found: Courses, u: np.ndarray) -> Iterator[tuple[int, float]]:
    """Curves that pass a point (n,), each with its arclengths there."""
    for number, (traced, course) in enumerate(
        zip(found.traced, found.courses, strict=True)
    ):
        inner = traced.units.inwards(u)
        places = traced.branch.passes(inner, is_same_point.threshold)
        for s in course.arclengths(places).tolist():
            yield number, s


def _near_misses(found: Courses) -> Iterator[Event]:
    for number, (traced, course) in enumerate(
        zip(found.traced, found.courses, strict=True)
    ):
        for point in traced.near_misses:
            s = float(course.arclengths(np.array([point.s]))[0])
            yield Event(number, s, found.points(point.u), point.gap)


# --- along the parameter --------------------------------------------------------------


def _diagram(
    found: Courses, points: Sequence[MeetingPoint], forms: Sequence[Form]
) -> Diagram:
    """Folds and Hopf points."""
    listed: list[DiagramPoint] = []
    remarks = [SETTINGS_OF_STABILITY]
    stretches = []
    for number, traced in enumerate(found.traced):
        crossings = [one.s for one in traced.points if one.kind in CROSSINGS]
        folds = [
            fold
            for fold in traced.folds
            if all(abs(fold.s - s) > AT_CROSSING for s in crossings)
        ]
        own = [_fold(found, number, fold) for fold in folds]
        listed += own
        listed += [_hopf_point(found, number, one) for one in traced.hopf_points]
        for low, high in traced.unsettled:
            ends = traced.parameters(np.array([low, high]))
            remarks.append(
                f"between {ends[0]:.6g} and {ends[1]:.6g} on {forms[number].name} "
                "eigenvalues change sides, and how is not told"
            )
        cuts = [one.s for one in own]
        branch = forms[number].branch
        stretches += unknown_stability(branch, number, cuts).stretches
    return Diagram(
        found.problem.domain.names[found.parameter],
        named_points(found.problem, listed),
        tuple(stretches),
        (),
        tuple(remarks),
    )


def _fold(found: Courses, number: int, fold: LargePoint) -> DiagramPoint:
    s, speed = _arclength(found, number, fold.s)
    u = found.points(fold.u)
    return DiagramPoint("", Kind.FOLD, number, s, u, fold.bend / speed**2)


def _arclength(found: Courses, number: int, s: float) -> tuple[float, float]:
    """The user's arclength where that of the tracing is ``s``, and its derivative."""
    tangent = found.points(found.traced[number].tangent(s))
    arclength = found.courses[number].arclengths(np.array([s]))
    return float(arclength[0]), float(np.linalg.norm(tangent))


def _hopf_point(found: Courses, number: int, point: LargePoint) -> DiagramPoint:
    traced = found.traced[number]
    places, unstable = traced.eigenvalues.places, traced.eigenvalues.unstable
    after = min(int(np.searchsorted(places, point.s)), len(places) - 1)
    is_more = unstable[after] > unstable[max(after - 1, 0)]
    label = "becomes unstable" if is_more else "becomes stable"
    s, _ = _arclength(found, number, point.s)
    u = found.points(point.u)
    return DiagramPoint("", Kind.HOPF, number, s, u, point.frequency, label)


# --- what is known --------------------------------------------------------------------


def _claims(
    reach: Reach, provenance: Provenance, names: Sequence[str]
) -> Iterator[Claim]:
    yield from ended_early(provenance, reach.left)
    yield SearchClaim.MANY_UNKNOWNS.claim(
        Scope.STARTS,
        Level.ESTIMATED,
        unknowns=len(names),
        starts=reach.starts,
        reached=reach.reached,
    )


def _doubts(
    found: Courses,
    forms: Sequence[Form],
    points: Sequence[MeetingPoint],
    reach: Reach,
) -> Iterator[Doubt]:
    yield SearchDoubt.OTHER_CURVES.doubt()
    for form in forms:
        names = ended_at_assumed_bounds(found.problem, form.branch)
        if names:
            yield SearchDoubt.NO_BOUNDS.doubt(form.name, unknowns=names)
        if form.branch.outcome in (Outcome.STEP_LIMIT, Outcome.TIME_LIMIT):
            yield SearchDoubt.TOO_LONG.doubt(form.name)
        if form.branch.outcome is Outcome.STALLED:
            yield SearchDoubt.STALLED.doubt(form.name, ends=_stalled_ends(found, form))
    for point in points:
        if point.note:
            kind = SearchDoubt.NOT_WHOLE
            words = point.kind.value
            yield kind.doubt(point.name, point_kind=words, reason=point.note)


def _stalled_ends(found: Courses, form: Form) -> int:
    """How many ends of a form lie within the bounds."""
    ends = form.branch(np.array([0.0, form.branch.length]))
    return int(np.count_nonzero(~found.problem.domain.are_at_bounds(ends)))
