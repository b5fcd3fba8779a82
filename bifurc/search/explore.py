"""The whole loop: seeds -> branches -> singular points -> atlas."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Atlas, Provenance
from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import TraceSettings, trace_branch
from bifurc.curves.deflation import Deflated, lower_rank_direction
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.monitor import Profile, profile_branch, singular_values
from bifurc.limits import Deadline, HeldInterrupt
from bifurc.problem import Problem
from bifurc.search.components import singular_points_of, sort_out
from bifurc.search.findings import SAME, Findings, assemble_atlas
from bifurc.search.settings import SearchSettings
from bifurc.seeding import CLOSED
from bifurc.seeds import Seeds
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import LocatedPoint, locate_singular_point
from bifurc.singular.point import SingularPoint
from bifurc.singular.sphere import is_on_surface

__all__ = ["explore"]

DEFAULT_SEARCH = SearchSettings()

log = logging.getLogger(__name__)

STUB = 2e-2  # length, in scales, below which a branch that stalls at both ends is none
BESIDE_END = (0.0, 0.01, 0.02)  # of a stalled branch, in scales: starts for a cusp
CUSP_REACH = 0.2  # how far from there the cusp may lie, in scales
# singular value, over the problem's magnitude, below which a singular point is looked
# for
NEARLY = 1e-3


def explore(
    problem: Problem,
    *,
    settings: SearchSettings = DEFAULT_SEARCH,
    seed: int = 0,
    seeds: Seeds | None = None,
    progress: Callable[[str, int], None] | None = None,
) -> Atlas:
    """All solution curves of a problem, all singular points on them, nothing twice.

    Seeds come from `Problem.seeds` (complete slices where the problem has them, and
    random starts drawn with ``seed``) unless given. Every branch found is traced whole
    and monitored; from every singular point the directions in which other branches
    leave become further starts. ``progress`` is called with what was found and how
    many. Ctrl-C ends the search early: the atlas holds what was found, and
    its provenance says so. When the budget of time is used up, the
    completeness and the provenance say so.
    """
    began = time.perf_counter()
    deadline = Deadline(settings.budget)
    found = Findings(deadline=deadline)
    interrupted = False
    gathered = seeds
    try:
        with HeldInterrupt() as held:
            if gathered is None:
                gathered = problem.seeds(np.random.default_rng(seed), settings.starts)
            held.check()
            _work_through(problem, gathered, found, settings.tracing, progress, held)
            _work_on_surfaces(
                problem,
                gathered,
                found,
                settings.tracing,
                settings.charts,
                progress,
                held,
            )
            gathered = _audited(
                problem,
                gathered,
                found,
                settings.tracing,
                progress,
                held,
                settings.prove,
            )
    except KeyboardInterrupt:
        interrupted = True
        log.warning("interrupted: the atlas holds what was found so far")
    if gathered is None:
        nothing = np.empty((0, problem.n))
        gathered = Seeds(nothing, np.empty(0, dtype=bool), np.empty(0), nothing)
    provenance = Provenance(
        seed=seed,
        settings=settings,
        interrupted=interrupted,
        out_of_time=deadline.passed,
        derivatives=problem.derivatives,
        seconds=time.perf_counter() - began,
    )
    return assemble_atlas(problem, found, gathered, provenance)


# --- the search ---------------------------------------------------------------------------------------


def _work_through(
    problem: Problem,
    seeds: Seeds,
    found: Findings,
    settings: TraceSettings,
    progress: Callable[[str, int], None] | None,
    held: HeldInterrupt,
) -> None:
    """Trace from every seed that lies on no surface, and from every half-branch that
    shows up on the way."""
    if not len(seeds.points):
        return
    values = singular_values(problem, seeds.points)
    found.components = sort_out(problem, seeds.points, values, found.deadline)
    for dimension, numbers in found.components.seeds.items():
        found.owner.update((k, ("component of dimension", dimension)) for k in numbers)
    waiting = [k for k in range(len(seeds.points)) if k not in found.owner]
    _trace_from(
        problem, seeds, waiting, values[waiting], found, settings, progress, held
    )


def _trace_from(
    problem: Problem,
    seeds: Seeds,
    waiting: list[int],
    values: np.ndarray,
    found: Findings,
    settings: TraceSettings,
    progress: Callable[[str, int], None] | None,
    held: HeldInterrupt,
) -> None:
    """Trace from the seeds numbered ``waiting``, with singular ``values`` (k, n), that
    lie on nothing known."""
    # the clearest first: those whose curve is far from singular
    order = np.argsort(-values[:, max(problem.n - 2, 0)], kind="stable")
    own = dict(zip(waiting, values, strict=True))
    waiting = [waiting[k] for k in order]
    matched = 0
    while waiting and not found.deadline.passed:
        for number in range(matched, len(found.branches)):
            within = SAME * problem.scale
            on = (
                found.branches[number].nearest(seeds.points[waiting], within=within)[0]
                < within
            )
            found.owner.update(
                (waiting[k], ("form", number)) for k in np.flatnonzero(on)
            )
            waiting = [waiting[k] for k in np.flatnonzero(~on)]
        matched = len(found.branches)
        if progress is not None:
            progress("forms", matched)
        if waiting:
            i = waiting.pop(0)
            found.owner[i] = _take_seed(
                problem, seeds.points[i], own[i], found, settings
            )
        held.check()


def _audited(
    problem: Problem,
    seeds: Seeds,
    found: Findings,
    settings: TraceSettings,
    progress: Callable[[str, int], None] | None,
    held: HeldInterrupt,
    prove: bool,
) -> Seeds:
    """Hold the branches against the problem's audit, and trace what it leads to; the
    seeds with those of the audit."""
    while seeds.audit is not None and not found.deadline.passed:
        found.audit = seeds.audit(found.branches, found.deadline.left if prove else 0.0)
        held.check()
        known, before = len(found.branches), len(seeds.points)
        starts, gaps = problem.project(found.audit.starts)
        starts = starts[gaps < CLOSED]
        if not len(starts):
            break
        seeds = seeds.with_constructed(starts)
        numbers = list(range(before, len(seeds.points)))
        _trace_from(
            problem,
            seeds,
            numbers,
            singular_values(problem, starts),
            found,
            settings,
            progress,
            held,
        )
        if len(found.branches) == known:
            break
    return seeds


def _take_seed(
    problem: Problem,
    point: np.ndarray,
    values: np.ndarray,
    found: Findings,
    settings: TraceSettings,
) -> tuple[str, int]:
    """Find out what a seed lies on: a curve, a rigid assembly, a singular point, or a
    surface."""
    n = problem.n
    if values[n - 1] > 1e-6:
        return "rigid", _known_or_new(problem, point, found.rigid)
    if values[n - 2] <= 1e-4:
        known = _nearest(problem, point, [p.u for p in found.points], 1e-4)
        if known is not None:
            return "point", known
        for number, branch in enumerate(found.branches):
            if branch.nearest(point)[0][0] < 1e-4 * problem.scale:
                return (
                    "form",
                    number,
                )  # where the rank is low a seed is good to half the digits only
        along = lower_rank_direction(problem, point)
        if along is not None:
            number = len(found.branches)
            return (
                ("form", number)
                if _trace_lower_rank(problem, point, along, found, settings)
                else ("no solution", 0)
            )
        nullity = int(np.count_nonzero(values < 1e-4))
        located = _examine(problem, point, nullity, found, reach=1e-2)
        if located is not None:
            number = next(i for i, p in enumerate(found.points) if p is located)
            starts = [
                (located.u + located.radius * h, h) for h in located.half_branches
            ]
            _trace_and_follow(problem, starts, found, settings)
            return "point", number
    number = len(found.branches)
    nearly = len(found.gaps)
    if _trace_and_follow(problem, [(point, None)], found, settings):
        return "form", number
    if len(found.gaps) > nearly:
        return "no solution", 0
    return "rigid", _known_or_new(problem, point, found.rigid)


def _trace_lower_rank(
    problem: Problem,
    point: np.ndarray,
    along: np.ndarray,
    found: Findings,
    settings: TraceSettings,
) -> bool:
    """Trace the curve of lower rank through ``point``; what may cross it is left to
    other seeds."""
    branch = trace_branch(Deflated(problem), point, along, settings)
    if not _is_curve(problem, branch):
        log.info("no curve of lower rank through %s: %s", point, branch.outcome.value)
        return False
    _add_branch(problem, branch, found)
    return True


def _work_on_surfaces(
    problem: Problem,
    seeds: Seeds,
    found: Findings,
    settings: TraceSettings,
    charts: int,
    progress: Callable[[str, int], None] | None,
    held: HeldInterrupt,
) -> None:
    """Cover the surfaces with charts, locate singular points on them, and trace the
    curves that leave there."""
    refused = found.components.cover(problem, seeds.points, charts, found.deadline)
    if refused:
        values = singular_values(problem, seeds.points[refused])
        _trace_from(problem, seeds, refused, values, found, settings, progress, held)
    if found.components.charts is None:
        return
    for located in singular_points_of(problem, found.components, found.deadline):
        if found.deadline.passed:
            break
        point = _point_of(problem, *located, found)
        starts: list[tuple[np.ndarray, np.ndarray | None]] = [
            (point.u + point.radius * h, h) for h in point.half_branches
        ]
        _trace_and_follow(problem, starts, found, settings)


def _trace_and_follow(
    problem: Problem,
    queue: list[tuple[np.ndarray, np.ndarray | None]],
    found: Findings,
    settings: TraceSettings,
) -> bool:
    """Trace the branches through the starts and everything that hangs on them; False
    where there is no curve."""
    traced = False
    while queue and not found.deadline.passed:
        point, along = queue.pop()
        within = SAME * problem.scale
        if any(
            branch.nearest(point, within=within)[0][0] < within
            for branch in found.branches
        ):
            continue
        branch = trace_branch(problem, point, along, settings)
        if branch.outcome is Outcome.OPEN:
            found.gaps.append(branch.gap)
        if not _is_curve(problem, branch):
            log.info("no curve through %s: %s", point, branch.outcome.value)
            continue
        traced = True
        if any(_is_the_same(problem, branch, known) for known in found.branches):
            # the start lay beside the curve, by rounding over a small singular value
            continue
        queue = queue + _add_branch(problem, branch, found)
    return traced


def _is_curve(problem: Problem, branch: Branch) -> bool:
    """Whether a traced branch is more than the trace of rounding beside a singular
    point."""
    shortest = STUB if branch.outcome is Outcome.STALLED else STUB / 20
    return bool(len(branch.pieces)) and branch.length > shortest * problem.scale


def _is_the_same(problem: Problem, branch: Branch, known: Branch) -> bool:
    """Whether a branch runs along a known one."""
    distance, _ = known.nearest(
        branch(branch.length * np.array([0.11, 0.29, 0.47, 0.71, 0.93]))
    )
    return bool(np.all(distance < SAME * problem.scale))


def _add_branch(
    problem: Problem, branch: Branch, found: Findings
) -> list[tuple[np.ndarray, np.ndarray | None]]:
    """Record a traced branch and the singular points on it; starts on all branches
    through them come back."""
    profile = profile_branch(problem, branch)
    s, value = singular_value_minima(problem, branch, profile)
    found.branches.append(branch)
    found.profiles.append(profile)
    found.minima.append((s, value))
    located: list[float] = []
    starts: list[tuple[np.ndarray, np.ndarray | None]] = []
    for candidate in _candidates(problem, branch, profile, s, value):
        if found.deadline.passed:
            break
        known = len(found.points)
        point = _singular_point_of(problem, branch, candidate, found)
        if point is not None:
            located.append(candidate.looks[0])
        if point is not None and len(found.points) > known:
            starts += [(point.u + point.radius * h, h) for h in point.half_branches]
    found.located.append(located)
    return starts


@dataclass(frozen=True)
class _Candidate:
    """A place on a branch from which a singular point is looked for.

    ``looks``: arclengths of the starts, of which the first one that leads to a singular
    point counts, ``small``: singular values below it count as zero, ``reach``: how far
    away the point may lie, in units of the problem's scale.
    """

    looks: tuple[float, ...]
    small: float
    reach: float = 0.05


def _candidates(
    problem: Problem,
    branch: Branch,
    profile: Profile,
    s: np.ndarray,
    values: np.ndarray,
) -> list[_Candidate]:
    """Where to look for singular points: at minima ``values`` (k,) at ``s`` (k,), and
    ends."""
    minima = zip(s.tolist(), values.tolist(), strict=True)
    out = [
        _Candidate((at,), max(NEARLY, 3 * low)) for at, low in minima if low < NEARLY
    ]
    if branch.outcome is Outcome.STALLED:
        # before a cusp or beyond it: how far hangs on rounding, and so does it whether
        # the point is reached from one start
        inwards = np.minimum(problem.scale * np.array(BESIDE_END), 0.5 * branch.length)
        for looks in (inwards, branch.length - inwards):
            out.append(_Candidate(tuple(looks.tolist()), 10 * NEARLY, CUSP_REACH))
    elif not branch.closed:
        # an end is no minimum, and yet a singular point may lie there
        ends = np.array([0.0, branch.length])
        smallest = singular_values(problem, branch(ends))[:, profile.rank - 1]
        out += [_Candidate((float(at),), NEARLY) for at in ends[smallest < NEARLY]]
    return out


def _singular_point_of(
    problem: Problem, branch: Branch, candidate: _Candidate, found: Findings
) -> SingularPoint | None:
    """The singular point, known or new, to which the looks of a candidate lead."""
    for at in candidate.looks:
        near = branch(at)
        known = _known_point(problem, near, 0.0, found)
        if known is not None and known.dimension == 1:
            return known
        values = singular_values(problem, near[None])[0]
        nullity = int(np.count_nonzero(values < candidate.small))
        if nullity < 2:
            continue
        point = _examine(problem, near, nullity, found, candidate.reach)
        if point is not None:
            return point
    return None


def _examine(
    problem: Problem, near: np.ndarray, nullity: int, found: Findings, reach: float
) -> SingularPoint | None:
    """Locate and classify the singular point near a configuration; one already known is
    returned as it is."""
    for k in sorted({max(nullity, 2), 2, 3}, key=lambda k: abs(k - nullity)):
        result = (
            locate_singular_point(problem, near, k, reach * problem.scale)
            if k <= problem.n
            else None
        )
        if result is None:
            continue
        known = _known_point(problem, result[0], result[2], found)
        if known is not None and known.dimension == 1:
            return known
        if not is_on_surface(problem, result[0]):
            return _point_of(problem, *result, found)
    return None


def _point_of(
    problem: Problem,
    u: np.ndarray,
    null_space: np.ndarray,
    error: float,
    found: Findings,
) -> SingularPoint:
    """The known singular point that a located one is, or a new one, classified."""
    known = _known_point(problem, u, error, found)
    if known is not None:
        return known
    point = classify_singular_point(problem, LocatedPoint(u, null_space, error))
    found.points.append(point)
    return point


def _known_point(
    problem: Problem, u: np.ndarray, error: float, found: Findings
) -> SingularPoint | None:
    """The known singular point at ``u``, located to within ``error``, or None."""
    for point in found.points:
        within = SAME * problem.scale + 2 * max(error, point.error)
        if np.linalg.norm(problem.difference(point.u, u)) < within:
            return point
    return None


def _nearest(
    problem: Problem, point: np.ndarray, others: list[np.ndarray], within: float
) -> int | None:
    """Number of the first of ``others`` at less than ``within`` scales from ``point``,
    or None."""
    for i, other in enumerate(others):
        if np.linalg.norm(problem.difference(other, point)) < within * problem.scale:
            return i
    return None


def _known_or_new(problem: Problem, point: np.ndarray, known: list[np.ndarray]) -> int:
    """Number of ``point`` in the list, to which it is added where it is new."""
    number = _nearest(problem, point, known, SAME)
    if number is None:
        known.append(point)
        return len(known) - 1
    return number
