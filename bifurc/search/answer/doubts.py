"""What doubles leave undecided in the answer of a search, with the candidates."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence

import numpy as np

from bifurc.atlas import Event, Form, MeetingPoint, Surface, samples_beyond_charts
from bifurc.branch import Branch, Outcome
from bifurc.completeness import Doubt
from bifurc.curves.misclosure import misclosure_at
from bifurc.decisions import (
    hangs_on_data,
    is_faint,
    is_known_assembly,
    is_known_curve,
    is_multiple_curve,
    is_same_line,
    is_same_point,
    is_single_assembly,
    is_stub,
    may_be_null,
    misses_by_rounding,
    stands_still,
    unit_over_rounding,
)
from bifurc.function_problem import EquationProblem
from bifurc.limits import is_time_over
from bifurc.numerics.blur import (
    change_by_blur,
    distance_to_singular,
    rounding_unit,
)
from bifurc.numerics.null_spaces import null_spaces
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from bifurc.search.findings import Findings
from bifurc.search.own_units.unit_problem import sheets_beside
from bifurc.search.records import RigidAssembly, TracedBranch
from bifurc.search.solutions import solutions_on_rims
from bifurc.search.strands import missing_crossings
from bifurc.singular.dimension import misclosures_beside, project_slowly
from bifurc.singular.point import Kind, SingularPoint
from bifurc.surfaces.chart_atlas import Covering
from bifurc.system import relative_gaps

RIM = 1e-4  # scales from a rim at which starts end where F vanishes slowly towards it
ROUNDING = 1e-16  # over the magnitude and the scale, what F is known to at best
TINY = 1e-300  # keeps a singular value of zero from being divided by
COVERING_DOUBTS = {
    Covering.UNDECIDED: SearchDoubt.SHEETS_TOGETHER,
    Covering.UNFIT: SearchDoubt.HOLES,
    Covering.MISFIT: SearchDoubt.MISFIT,
}
ON_SURFACE = "it may be a regular point of a surface"
MOST_SAMPLES = 200  # of a surface at which it is seen what it misses


def doubts_of(
    problem: Problem,
    traced: Sequence[TracedBranch],
    forms: Sequence[Form],
    points: Sequence[MeetingPoint],
    surfaces: Sequence[Surface],
    of_surfaces: Problem | None = None,
) -> Iterator[Doubt]:
    """One doubt for each thing that is not decided: surfaces for which charts ran out,
    surfaces that may be curves, curves that may be surfaces, stretches of forms that
    are not certified, ends of forms at nothing known, singular points of no certain
    kind.

    The ``forms`` are those of the branches ``traced``. Solutions on the ``surfaces``
    are regular ones of the problem ``of_surfaces``, where it is another one.
    """
    yield from _doubts_of_covering(surfaces)
    for surface in surfaces:
        missed = _misclosure(of_surfaces or problem, surface)
        samples = surface.samples[:MOST_SAMPLES]
        if not _is_rounding(of_surfaces or problem, missed, samples):
            yield SearchDoubt.SURFACE_OR_CURVES.doubt(surface.name, missed)
    for index, branch in enumerate(traced):
        yield from _doubts_of_form(problem, index, branch, points)
    for index, form in enumerate(forms):
        certificate = form.certificate
        if certificate is None or not certificate.leaves_doubt:
            continue
        kind, places = SearchDoubt.BLURRED, certificate.blurred
        if len(certificate.gaps):
            kind, places = SearchDoubt.UNCERTIFIED, certificate.gaps
        yield kind.of_forms(index, places=places.tolist())
    for point in points:
        yield from _doubts_of_point(problem, point)
        yield from _doubts_of_halves(traced, point)


def doubts_of_isolated(
    findings: Findings, points: Sequence[MeetingPoint]
) -> Iterator[Doubt]:
    """Whether isolated singular points are double, and whether something leads on from
    those at which several unknowns are in bounds; nothing where the time is over, which
    is said of the whole search.

    In such a corner what is left of the flexes may be an edge of what leads away without
    bounds, which no sample of that meets.
    """
    if is_time_over():
        return
    domain, n = findings.problem.domain, findings.problem.n
    isolated = [point for point in points if point.kind is Kind.ISOLATED]
    double, corners = [], []
    for point in isolated:
        u = point.point.u
        if point.point.rank == n - 1 and not findings.is_held(u):
            double.append(point.name)
        at_bounds = np.any(np.abs(domain.bounds.T - u) <= domain.slack, axis=0)
        if at_bounds.sum() > 1 and not findings.second_order(u).is_rigid:
            corners.append(point.name)
    if double:
        yield SearchDoubt.DOUBLE_SOLUTIONS.doubt(points=double)
    if corners:
        yield SearchDoubt.OPEN_CORNERS.doubt(points=corners)


def doubts_of_crossings(
    problem: Problem, traced: Sequence[TracedBranch], points: Sequence[MeetingPoint]
) -> Iterator[Doubt]:
    """Whether curves have to cross once more next to singular points; nothing where the
    time is over, which is said of the whole search."""
    if is_time_over():
        return
    located = [point.point for point in points]
    branches = [one.branch for one in traced]
    open_pairs: dict[tuple[int, ...], str] = {}
    for missing in missing_crossings(problem, located, branches):
        pair = tuple(sorted(set(missing.curves)))
        open_pairs.setdefault(pair, points[missing.point].name)
    for pair, name in open_pairs.items():
        yield SearchDoubt.CROSSING_MISSING.of_forms(*pair, point=name)


def _doubts_of_covering(surfaces: Sequence[Surface]) -> Iterator[Doubt]:
    """Whether charts ran out, or could not tell sheets apart."""
    if any(surface.is_short_of_charts for surface in surfaces):
        starts = samples_beyond_charts(surfaces)
        yield SearchDoubt.CHARTS_RAN_OUT.doubt(starts=starts)
    for surface in surfaces:
        charts = surface.charts
        if charts is not None and charts.outcome in COVERING_DOUBTS:
            yield COVERING_DOUBTS[charts.outcome].doubt(surface.name)


def doubts_of_near_misses(problem: Problem, misses: Sequence[Event]) -> Iterator[Doubt]:
    """Whether the numbers that the equations are made of tell near misses from
    bifurcations.

    At the distance of a singular point the singular value vanishes; F changes on the
    way by half of their product.
    """
    rounding = float(problem.accuracy.data_rounding)
    if rounding == 0.0:
        return
    hanging = []
    for miss in misses:
        change = miss.value * distance_to_singular(problem, miss.u) / 2
        if hangs_on_data(change, rounding):
            hanging.append(miss.value)
    if hanging:
        smallest, count = min(hanging), len(hanging)
        kind = SearchDoubt.NEAR_MISSES
        yield kind.doubt(amount=smallest, count=count, rounding=rounding)


def doubts_of_findings(
    problem: Problem, findings: Findings, points: Sequence[SingularPoint]
) -> Iterator[Doubt]:
    """What is open about the ``findings`` of a search besides forms, surfaces and the
    singular ``points`` listed."""
    if problem.accuracy.noise:
        yield SearchDoubt.NOISE.doubt(amount=problem.accuracy.noise)
    others = _others(problem, findings, points)
    if others:
        yield SearchDoubt.HIDDEN_POINTS.doubt(count=others)
    traces = list(findings.near_motions.values())
    counts = {
        SearchDoubt.FAINT_NEAR_MOTIONS: sum(is_faint(t.misclosure) for t in traces),
        SearchDoubt.LOOSE_NEAR_MOTIONS: sum(t.has_loose_end for t in traces),
        SearchDoubt.REPEATED_NEAR_MOTIONS: sum(t.is_repeated for t in traces),
        SearchDoubt.BLURRED_NEAR_MOTIONS: sum(t.is_blurred for t in traces),
    }
    for kind, count in counts.items():
        if count:
            yield kind.doubt(amount=is_faint.threshold, count=int(count))
    yield from _doubts_of_assumed_bounds(problem, findings)
    knows_all = findings.audit is not None and findings.audit.has_all_isolated
    if (traces or findings.near_surfaces) and not knows_all:
        yield SearchDoubt.NEAR_ASSEMBLIES.doubt()
    assemblies = list(findings.rigid.values())
    hidden = np.array([assembly.hidden for assembly in assemblies])
    is_known = is_known_assembly(hidden, problem.domain.scale)
    missed, are_single = _missed_by(problem, assemblies)
    is_open = ~(is_known & are_single)
    for k in np.flatnonzero(is_open & is_known).tolist():
        is_open[k] = not findings.is_held(assemblies[k].place)
    if np.any(is_open):
        # what bends by one over the scale and misses so much is the root of it apart
        apart = np.maximum(hidden / problem.domain.scale, np.sqrt(missed))[is_open]
        kind = SearchDoubt.HIDDEN_ASSEMBLIES
        yield kind.doubt(amount=float(apart.max()), count=len(apart))
    on_rim = int(np.count_nonzero(are_on_rim(problem, findings.rigid.values())))
    if on_rim:
        yield SearchDoubt.ON_RIM.doubt(count=on_rim)
    yield from _doubts_on_rims(problem, findings, points)
    unfollowed = len(findings.components.notes[2].unfollowed)
    if unfollowed:
        yield SearchDoubt.SINGULAR_CURVES.doubt(count=unfollowed)
    off_charts = findings.components.off_charts
    if off_charts:
        yield SearchDoubt.UNCHARTED.doubt(starts=off_charts)
    if findings.gaps_of_stops:
        yield SearchDoubt.SHORT_STOPS.doubt(amount=min(findings.gaps_of_stops))


def _doubts_of_assumed_bounds(problem: Problem, findings: Findings) -> Iterator[Doubt]:
    """That of solutions which paths reach, beyond bounds that nobody gave."""
    if findings.audit is None or not np.any(problem.domain.has_assumed_bounds):
        return
    for claim in findings.audit.claims:
        beyond = claim.data.get("real", 0) - claim.data.get("inside", 0)
        if SearchClaim.ALL_ISOLATED.is_kind_of(claim) and beyond > 0:
            yield SearchDoubt.BEYOND_ASSUMED_BOUNDS.doubt(count=beyond)


def are_on_rim(problem: Problem, assemblies: Collection[RigidAssembly]) -> np.ndarray:
    """Which of the assemblies (k,) lie on a rim of where the equations are defined: F'
    is not finite beside them, and does not tell whether they are isolated."""
    reach = RIM * problem.domain.scale
    rough = [not _is_smooth_within(problem, one.place, reach) for one in assemblies]
    return np.array(rough, dtype=bool)


def _doubts_on_rims(
    problem: Problem, findings: Findings, points: Sequence[SingularPoint]
) -> Iterator[Doubt]:
    """Whether solutions along rims of the equations lie on no form, and whether forms
    meet on a rim where none of the singular ``points`` is listed."""
    on_rims = solutions_on_rims(problem, np.random.default_rng(0))
    reach = RIM * problem.domain.scale
    passes = np.zeros(len(on_rims.points), dtype=int)
    for branch in findings.branches:
        distances, _ = branch.nearest(on_rims.points, reach)
        passes += distances < reach
    missing = int(np.count_nonzero(on_rims.are_others & (passes == 0)))
    if missing:
        yield SearchDoubt.ALONG_RIM.doubt(count=missing)
    meeting = on_rims.points[passes > 1]
    for point in points:
        distances = np.linalg.norm(problem.domain.difference(meeting, point.u), axis=1)
        meeting = meeting[distances > reach]
    if len(meeting):
        yield SearchDoubt.MEETING_ON_RIM.doubt(starts=len(meeting))


def _missed_by(
    problem: Problem, assemblies: Sequence[RigidAssembly]
) -> tuple[np.ndarray, np.ndarray]:
    """How much assemblies miss (k,), over the scale, and which are solutions, and one
    each, by that and by how weakly they are held."""
    places = np.array([one.place for one in assemblies]).reshape(-1, problem.n)
    missed = relative_gaps(problem, places) / problem.domain.scale + ROUNDING
    weakest = singular_values(problem, places)[:, problem.n - 1]
    return missed, is_single_assembly(missed / (weakest**2 + TINY))


def _others(
    problem: Problem, findings: Findings, points: Sequence[SingularPoint]
) -> int:
    """How many singular points the exact equations have beside ``points``: doubles do
    not tell them apart."""
    known = [point.u for point in points]
    for germ in findings.germs:
        for other in germ.others:
            places = np.array(known).reshape(-1, problem.n)
            distances = np.linalg.norm(problem.domain.difference(places, other), axis=1)
            if not np.any(is_same_point(distances, problem.domain.scale)):
                known.append(other)
    return len(known) - len(points)


def _is_rounding(problem: Problem, missed: float, points: np.ndarray) -> bool:
    """Whether a residual is no more than rounding, which is measured at points (k, n)
    where it is not plain."""
    if misses_by_rounding(missed):
        return True
    return misses_by_rounding(missed, rounding_unit(problem, points))


def _misclosure(problem: Problem, surface: Surface) -> float:
    """The largest relative residual seen on a surface, infinite where nothing is.

    Where F' has a lower rank, steps towards a solution beside a sample shrink slowly,
    and what is left tells nothing: the samples themselves count, as near to solutions
    as they can be known. Some lie next to where another surface crosses, and are known
    less well: of these residuals it is the median.
    """
    seen = np.empty(0)
    if surface.charts is not None:
        seen = relative_gaps(problem, surface.charts.centers)
    samples = surface.samples[:MOST_SAMPLES]
    sigma, right = null_spaces(problem, samples)
    is_regular = np.count_nonzero(may_be_null(sigma), axis=1) == surface.dimension
    missed = misclosures_beside(
        problem, samples[is_regular], right[is_regular, problem.n - surface.dimension :]
    )
    seen = np.concatenate([seen, missed[np.isfinite(missed)]])
    if not np.all(is_regular):
        shaky = samples[~is_regular]
        _, left = project_slowly(problem, shaky, misses_by_rounding)
        seen = np.append(seen, np.median(left))
    return float(seen.max()) if len(seen) else np.inf


def _doubts_of_form(
    problem: Problem, index: int, traced: TracedBranch, points: Sequence[MeetingPoint]
) -> Iterator[Doubt]:
    """Whether a form is a curve, as far as doubles tell, and has no loose end."""
    apart = sheets_beside(problem, traced.branch, traced.profile.rank)
    if not is_multiple_curve(apart):
        yield SearchDoubt.SEVERAL_CURVES.of_forms(index, amount=apart)
    branch, profile = traced.branch, traced.profile
    is_regular = profile.rank == branch.n - 1
    if is_regular and not is_known_curve(traced.blur):
        yield SearchDoubt.CURVE_OR_SURFACE.of_forms(index, amount=traced.blur)
    if not traced.multiplicity:
        yield SearchDoubt.MULTIPLICITY.of_forms(index, rank=profile.rank)
    rates = branch.largest_rates
    unit = unit_over_rounding(stands_still, change_by_blur(traced.blur))
    # larger than the rounding of an ordinary curve, and no larger than what this makes
    is_hidden = stands_still(rates, unit) & (rates >= stands_still.threshold)
    hidden = np.flatnonzero(is_hidden)
    if len(hidden):
        numbers = [int(k) + 1 for k in hidden]
        yield SearchDoubt.STILL_UNKNOWNS.of_forms(index, unknowns=numbers)
    if traced.missing and traced.certificate is None:
        place = traced.missing[0]
        yield SearchDoubt.UNLOCATED_POINT.of_forms(index, amount=place)
    names = ended_at_assumed_bounds(problem, branch)
    if names:
        yield SearchDoubt.NO_BOUNDS.of_forms(index, unknowns=names)
    if branch.outcome in (Outcome.STEP_LIMIT, Outcome.TIME_LIMIT):
        yield SearchDoubt.TOO_LONG.of_forms(index)
    if branch.outcome is Outcome.STALLED:
        passes = [s for point in points for form, s in point.passes if form == index]
        loose = loose_ends(problem, branch, passes)
        if loose:
            reach = is_stub.threshold * problem.domain.scale
            rough = sum(not _is_smooth_within(problem, end, reach) for end in loose)
            if rough:
                kind = SearchDoubt.STALLED_AT_RIM
                yield kind.of_forms(index, ends=len(loose), rough=rough)
            else:
                yield SearchDoubt.STALLED.of_forms(index, ends=len(loose))


def loose_ends(
    problem: Problem, branch: Branch, passes: Collection[float]
) -> list[np.ndarray]:
    """The ends (n,) of a branch that lie neither on the bounds nor at a singular point,
    which it ``passes`` at these arclengths."""
    return [
        branch(s)
        for s in (0.0, branch.length)
        if s not in passes and not np.any(_are_at_bounds(problem, branch(s)))
    ]


def _is_smooth_within(problem: Problem, point: np.ndarray, reach: float) -> bool:
    """Whether F and F' are finite up to ``reach`` from ``point`` (n,) in every unknown:
    by intervals where the equations are recorded, else as far as is seen at the point
    and beside it."""
    if isinstance(problem, EquationProblem) and problem.recording.tape is not None:
        low, high = (point - reach)[None], (point + reach)[None]
        bounds = problem.recording.tape.compiled.jacobian_bounds(low, high)
        return bool(np.isfinite(bounds).all())
    shifts = reach * np.eye(problem.n)
    with np.errstate(all="ignore"):
        points = np.vstack([point, point + shifts, point - shifts])
        values, slopes = problem.residuals(points), problem.jacobians(points)
    return bool(np.isfinite(values).all() and np.isfinite(slopes).all())


def _are_at_bounds(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Which unknowns of points (..., n) lie at the ends of their bounds (..., n, 2)."""
    gaps = np.abs(points[..., None] - problem.domain.bounds)
    at_bounds: np.ndarray = is_same_point(gaps, problem.domain.scale)
    return at_bounds


def ended_at_assumed_bounds(problem: Problem, branch: Branch) -> list[str]:
    """The unknowns without bounds of which a form reaches the ends of the region that
    was chosen instead."""
    if branch.outcome is not Outcome.LEFT_REGION:
        return []
    ends = branch(np.array([0.0, branch.length]))
    is_at_bounds = np.asarray(_are_at_bounds(problem, ends).any(axis=0))
    is_there: np.ndarray = is_at_bounds & problem.domain.has_assumed_bounds
    return [problem.domain.names[k] for k in np.flatnonzero(is_there.any(axis=1))]


def _doubts_of_halves(
    traced: Sequence[TracedBranch], point: MeetingPoint
) -> Iterator[Doubt]:
    """Whether forms that stall at a point in opposite directions are one, which goes on
    through it."""
    ends: list[tuple[int, np.ndarray]] = []
    for (index, s), tangent in zip(point.passes, point.tangents, strict=True):
        branch = traced[index].branch
        if branch.outcome is Outcome.STALLED and s in (0.0, branch.length):
            inward = tangent if s == 0.0 else -tangent
            ends.append((index, inward / np.linalg.norm(inward)))
    for (one, along), (other, back) in itertools.combinations(ends, 2):
        if not is_same_line(1.0 + float(along @ back)):
            continue
        met = dict.fromkeys((one, other))
        yield SearchDoubt.ONE_CURVE.of_forms(*met, point=point.name)


def _doubts_of_point(problem: Problem, point: MeetingPoint) -> Iterator[Doubt]:
    """Whether a singular point is one, and of which kind."""
    place = point.point.u[None]
    gap = float(relative_gaps(problem, place)[0])
    # beside the exact point F grows with the square of the distance
    explained = (point.point.error / problem.domain.scale) ** 2
    kind = point.kind.value
    missed = 0.0
    if not _is_rounding(problem, gap - explained, place):
        rank = problem.n - point.point.null_space.shape[1]
        missed = misclosure_at(problem, point.point.u, rank)
    if not misses_by_rounding(missed - explained):
        yield SearchDoubt.POINT_OR_NEAR_MISS.doubt(point.name, missed, point_kind=kind)
    elif point.kind is Kind.UNDECIDED:
        is_on_surface = point.point.dimension > 1
        reason = ON_SURFACE if is_on_surface else "sections of two radii disagree"
        reason = point.note or reason
        yield SearchDoubt.UNDECIDED.doubt(point.name, reason=reason)
    elif point.note:
        doubt = SearchDoubt.NOT_WHOLE
        yield doubt.doubt(point.name, point_kind=kind, reason=point.note)
    elif not point.point.is_confirmed:
        yield SearchDoubt.UNCONFIRMED.doubt(point.name)
