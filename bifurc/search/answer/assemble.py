"""From the findings of a search to an atlas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import compress

import numpy as np

from bifurc.atlas import (
    Atlas,
    Event,
    Form,
    MeetingPoint,
    NearMotion,
    Provenance,
    Surface,
)
from bifurc.branch import Branch, Outcome
from bifurc.completeness import numbered_form
from bifurc.curves.certificate import Certificate
from bifurc.curves.minima import stand_out
from bifurc.curves.monitor import dead_points
from bifurc.curves.near_miss import near_miss_values
from bifurc.decisions import closes_to_rounding
from bifurc.limits import Deadline
from bifurc.numerics.blur import change_by_blur
from bifurc.numerics.connected_parts import connected_parts
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.answer.completeness import judge_completeness
from bifurc.search.answer.doubts import (
    are_on_rim,
    doubts_of,
    doubts_of_crossings,
    doubts_of_findings,
    doubts_of_isolated,
    doubts_of_near_misses,
    loose_ends,
)
from bifurc.search.answer.meeting_points import meeting_points
from bifurc.search.branches.certification import certificate_of
from bifurc.search.canonical_order import (
    order_branches,
    order_points,
    order_surfaces,
    order_values,
)
from bifurc.search.findings import Findings
from bifurc.search.near_motion_search import closure_gap
from bifurc.search.records import TracedBranch
from bifurc.singular.point import Kind, SingularPoint
from bifurc.torus import wrap, wrapped_periods

# Decades by which the misclosures of two near motions differ that are not alike.
SAME_MISCLOSURE = 1e-3


def _is_listed_else(findings: Findings, point: SingularPoint) -> bool:
    """Whether a point is an assembly that is held, as what leads on from there leaves the
    bounds, or one that no branch passes that of a near motion where its rank drops."""
    at = findings.assembly_at(point.u)
    if at is not None and findings.is_held(findings.rigid[at.number].place):
        return True
    is_isolated = point.kind is Kind.ISOLATED
    return is_isolated and findings.near_motion_through(point.u) is not None


def assemble_atlas(
    problem: Problem,
    findings: Findings,
    provenance: Provenance,
    deadline: Deadline,
) -> Atlas:
    """The atlas of the findings, in an order that does not depend on the seeds.

    Every point in it is wrapped: see `Atlas`. Past the ``deadline`` of the search a
    closure gap is measured at few points.
    """
    periods = wrapped_periods(problem.domain.periods, problem.domain.bounds)
    order = order_branches(problem, findings.branches)
    in_search = list(findings.traced.values())
    traced = [in_search[k] for k in order]
    branches = [branch.branch for branch in traced]
    surfaces = _surfaces(problem, findings, periods)
    located = [
        replace(point, u=wrap(point.u, periods))
        for point in findings.points.values()
        if not _is_listed_else(findings, point)
    ]
    met = meeting_points(problem, located, branches, surfaces, periods)
    points = tuple(_with_misclosure(point, traced) for point in met)
    assemblies = list(findings.rigid.values())
    is_inner = ~are_on_rim(problem, assemblies)
    places = [assembly.place for assembly in compress(assemblies, is_inner)]
    rigid = wrap(np.array(places).reshape(-1, problem.n), periods)
    is_mobile = bool(traced or surfaces)
    forms = _forms(problem, traced, points)
    singular = list(findings.points.values())
    near_misses = near_misses_of(problem, traced, singular, points, periods)
    near_motions = _near_motions(problem, findings, periods)
    deflated = findings.components.deflated
    may_cross = not surfaces and not findings.have_all_crossings
    doubts = [
        *doubts_of(problem, traced, forms, points, surfaces, deflated),
        *(doubts_of_crossings(problem, traced, points) if may_cross else ()),
        *doubts_of_isolated(findings, points),
        *doubts_of_near_misses(problem, near_misses),
        *doubts_of_findings(problem, findings, located),
    ]
    shaky = [point.point.u for point in points if point.kind is Kind.ISOLATED]
    held = sum(findings.is_held(u) for u in [*shaky, *rigid])
    gap = 0.0
    if near_motions and not is_mobile:
        gap = min(near.misclosure for near in near_motions)
    elif not is_mobile:
        gap = closure_gap(problem, findings.book.seeds, findings.gaps, deadline)
    return Atlas(
        names=problem.domain.names,
        units=problem.domain.units,
        periods=problem.domain.periods,
        forms=forms,
        points=points,
        near_misses=near_misses,
        dead_points=_dead_points(problem, traced, periods),
        rigid=rigid[order_points(rigid, periods, problem.domain.scale)],
        surfaces=surfaces,
        near_motions=near_motions,
        completeness=judge_completeness(findings, provenance, doubts, held),
        closure_gap=gap,
        provenance=provenance,
    )


# --- forms and surfaces ---------------------------------------------------------------


def _forms(
    problem: Problem, traced: Sequence[TracedBranch], points: Sequence[MeetingPoint]
) -> tuple[Form, ...]:
    """The branches as forms, numbered from 1."""
    components = component_numbers(len(traced), points)
    singular = {form for point in points for form, _ in point.passes}
    forms = []
    for index, (branch, component) in enumerate(zip(traced, components, strict=True)):
        smallest = 0.0 if index in singular else smallest_value(problem, branch)
        passes = [s for point in points for form, s in point.passes if form == index]
        form = Form(
            name=numbered_form(index),
            branch=_with_known_ends(problem, branch.branch, passes),
            profile=branch.profile,
            min_singular_value=smallest,
            component=component,
            misclosure=branch.misclosure,
            certificate=_certificate(problem, branch, passes),
            multiplicity=max(branch.multiplicity, 1),
        )
        forms.append(form)
    return tuple(forms)


def _with_known_ends(
    problem: Problem, branch: Branch, passes: Sequence[float]
) -> Branch:
    """A branch that stalled, where it did at points that it ``passes`` as at an end."""
    is_stalled = branch.outcome is Outcome.STALLED
    if not is_stalled or loose_ends(problem, branch, passes):
        return branch
    return replace(branch, outcome=Outcome.ENDS_AT_A_POINT)


def _certificate(
    problem: Problem, traced: TracedBranch, passes: Sequence[float]
) -> Certificate | None:
    """The certificate of a branch between all singular points that it ``passes``, also
    those that were seen from other branches only."""
    certificate = traced.certificate
    if certificate is None:
        return None
    if not certificate.leaves_doubt and len(passes) == len(traced.passes):
        return certificate
    return certificate_of(problem, traced.branch, traced.profile, passes)


def smallest_value(problem: Problem, traced: TracedBranch) -> float:
    """The smallest regular singular value along a branch: at its minima or its ends."""
    branch, profile = traced.branch, traced.profile
    if not profile.rank:
        return 0.0
    _, minima = traced.minima
    smallest = min(minima.min(initial=np.inf), profile.smallest.min())
    if not branch.closed:
        ends = branch(np.array([0.0, branch.length]))
        at_ends = singular_values(problem, ends)[:, profile.rank - 1]
        smallest = min(smallest, at_ends.min())
    return float(smallest)


def component_numbers(count: int, points: Sequence[MeetingPoint]) -> list[int]:
    """Number of the connected component of every form, counted from 0 in the order of
    the forms."""
    surfaces = (
        max((max(point.surfaces, default=-1) for point in points), default=-1) + 1
    )
    meeting = [
        [form for form, _ in point.passes]
        + [count + number for number in point.surfaces]
        for point in points
    ]
    return connected_parts(count + surfaces, meeting)[:count]


def _surfaces(
    problem: Problem, findings: Findings, periods: np.ndarray
) -> tuple[Surface, ...]:
    """The surfaces, numbered from 1."""
    surfaces = findings.components.surfaces(findings.book.seeds.points)
    in_order = [surfaces[k] for k in order_surfaces(problem, surfaces)]
    named = []
    for number, surface in enumerate(in_order, start=1):
        samples = wrap(surface.samples, periods)
        named.append(replace(surface, name=f"surface {number}", samples=samples))
    return tuple(named)


def _near_motions(
    problem: Problem, findings: Findings, periods: np.ndarray
) -> tuple[NearMotion, ...]:
    """The near motions: surfaces, the largest mobility first, and then curves, the one
    that misses least first; those that miss as much in the order of branches."""
    traces = list(findings.near_motions.values())
    order = order_branches(problem, [trace.branch for trace in traces])
    decades = np.array([np.log10(traces[k].misclosure) for k in order])
    surfaces = sorted(findings.near_surfaces, key=lambda one: -one.dimension)
    near_motions = []
    for surface in surfaces:
        sample = wrap(surface.sample, periods)
        near_motions.append(
            NearMotion("", surface.misclosure, None, sample, surface.dimension)
        )
    for k in order[order_values(decades, SAME_MISCLOSURE)]:
        branch = traces[k].branch
        sample = wrap(branch(0.0), periods)
        near_motions.append(NearMotion("", traces[k].misclosure, branch, sample))
    return tuple(
        replace(near, name=f"near motion {number}")
        for number, near in enumerate(near_motions, start=1)
    )


def _with_misclosure(
    point: MeetingPoint, traced: Sequence[TracedBranch]
) -> MeetingPoint:
    """The point with a note where a form through it misses closure by more than
    rounding: then the form passes it to within the root of that."""
    misclosures = [traced[form].misclosure for form, _ in point.passes]
    largest = max(misclosures, default=0.0)
    if closes_to_rounding(largest):
        return point
    note = f"within the closing tolerance, the forms miss {largest:.1e}"
    return replace(point, note="; ".join(filter(None, [point.note, note])))


# --- events ---------------------------------------------------------------------------


def near_misses_of(
    problem: Problem,
    traced: Sequence[TracedBranch],
    points: Sequence[SingularPoint],
    met: Sequence[MeetingPoint],
    periods: np.ndarray,
) -> tuple[Event, ...]:
    """The minima of the singular value that are no singular points, nor as near to one
    of the ``points`` as its place is open, or to where a form meets one of those that
    are ``met``, form by form."""
    events = []
    located = np.array([point.u for point in points]).reshape(-1, problem.n)
    errors = np.array([point.error for point in points])
    for form, branch in enumerate(traced):
        arclengths = _low_minima(problem, branch)
        places = wrap(branch.branch(arclengths), periods)
        apart = problem.domain.difference(places[:, None], located)
        passed, reach = _passes_of(form, met)
        # an end that stops short of a cusp is at it
        is_known = np.any(np.linalg.norm(apart, axis=2) <= errors, axis=1)
        is_known |= np.any(np.abs(arclengths[:, None] - passed) <= reach, axis=1)
        arclengths, places = arclengths[~is_known], places[~is_known]
        if not len(arclengths):
            continue
        rank = branch.profile.rank
        sizes = near_miss_values(problem, branch.branch, rank, arclengths)
        for k in order_points(places, periods, problem.domain.scale):
            events.append(Event(form, float(arclengths[k]), places[k], *sizes[k]))
    return tuple(events)


def _low_minima(problem: Problem, traced: TracedBranch) -> np.ndarray:
    """Arclengths (k,) of the minima of the singular value on a branch that stand out,
    and are not those of singular points that were located there."""
    arclengths, values = traced.minima
    is_low = stand_out(problem, traced.branch, traced.profile, values)
    low: np.ndarray = arclengths[is_low & ~np.isin(arclengths, traced.located)]
    return low


def _passes_of(form: int, met: Sequence[MeetingPoint]) -> tuple[np.ndarray, np.ndarray]:
    """Where a form, by index, passes points (k,), and how exactly these are known
    (k,)."""
    passes = [
        (passed, meeting.point.error)
        for meeting in met
        for number, passed in meeting.passes
        if number == form
    ]
    passed, reach = np.array(passes).reshape(-1, 2).T
    return passed, reach


def _dead_points(
    problem: Problem, traced: Sequence[TracedBranch], periods: np.ndarray
) -> tuple[Event, ...]:
    """The dead points, form by form and unknown by unknown."""
    events = []
    for form, branch in enumerate(traced):
        by_rounding = change_by_blur(branch.blur)
        roots = dead_points(branch.branch, by_rounding, problem.domain.slack)
        unknowns = np.repeat(np.arange(problem.n), [len(each) for each in roots])
        arclengths = np.concatenate(roots)
        places = wrap(branch.branch(arclengths), periods)
        for k in order_points(places, periods, problem.domain.scale, groups=unknowns):
            s, index = float(arclengths[k]), int(unknowns[k])
            events.append(Event(form, s, places[k], index=index))
    return tuple(events)
