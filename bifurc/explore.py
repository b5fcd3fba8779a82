"""The whole loop: seeds -> branches -> singular points -> atlas."""

from __future__ import annotations

import logging
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from itertools import pairwise

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Surface, wrap
from bifurc.branch import Branch, Outcome
from bifurc.components import Components, lies_on, singular_points_of, sort_out
from bifurc.continuation import DEFAULT_SETTINGS, TraceSettings, trace_branch
from bifurc.deadline import Deadline
from bifurc.deflation import Deflated, lower_rank_direction
from bifurc.dimension import is_on_surface
from bifurc.interrupts import HeldInterrupt
from bifurc.monitor import Profile, dead_points, profile_branch, singular_value_minima, singular_values
from bifurc.problem import Problem, ProblemError
from bifurc.seeding import Completeness, Seeds, missed_probability
from bifurc.singular import Kind, SingularPoint, classify_singular_point, locate_singular_point

__all__ = ["explore"]

log = logging.getLogger(__name__)

SAME = 1e-6  # distance, in units of the problem's scale, below which a seed lies on a traced curve
STUB = 2e-2  # length, in scales, below which a branch that stalls at both ends is none
INITIALS = {Kind.BIFURCATION: "B", Kind.RANK_DROP: "R", Kind.DIMENSION_CHANGE: "D"}
NEARLY = 1e-3  # singular value, over the problem's magnitude, below which a singular point is looked for


@dataclass
class _Findings:
    """What is known so far. ``owner`` labels every seed with what it lies on: (kind, number)."""

    branches: list[Branch] = field(default_factory=list)
    profiles: list[Profile] = field(default_factory=list)
    minima: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    located: list[list[float]] = field(default_factory=list)  # arclengths of minima that are singular points
    points: list[SingularPoint] = field(default_factory=list)
    rigid: list[np.ndarray] = field(default_factory=list)
    components: Components = field(default_factory=Components)
    gaps: list[float] = field(default_factory=list)  # residuals of starts that only nearly solve the system
    owner: dict[int, tuple[str, int]] = field(default_factory=dict)
    deadline: Deadline = field(default_factory=Deadline)


def explore(
    problem: Problem,
    *,
    starts: int = 200,
    seed: int = 0,
    seeds: Seeds | None = None,
    settings: TraceSettings = DEFAULT_SETTINGS,
    progress: Callable[[str, int], None] | None = None,
    budget: float = np.inf,
    charts: int = 1500,
) -> Atlas:
    """All solution curves of a problem, all singular points on them, nothing twice.

    Seeds come from `Problem.seeds` (complete slices where the problem has them, and ``starts`` random starts
    drawn with ``seed``) unless given. Every branch found is traced whole and monitored; from every singular
    point the directions in which other branches leave become further starts. ``progress`` is called with what
    was found and how many. Ctrl-C ends the search early: the atlas holds what was found, and
    ``info["interrupted"]`` is true. The search also ends when the ``budget`` (s) is used up, but for the step
    it is in: the completeness says so, and ``info["out_of_time"]``. Surfaces are covered with up to ``charts`` charts.
    """
    if not budget > 0:
        raise ProblemError("budget", budget, "a positive number of seconds")
    if starts < 1 and seeds is None:
        raise ProblemError("starts", starts, "at least 1")
    began = time.perf_counter()
    deadline = Deadline(budget)
    found = _Findings(deadline=deadline)
    interrupted = False
    gathered = seeds
    try:
        with HeldInterrupt() as held:
            if gathered is None:
                gathered = problem.seeds(np.random.default_rng(seed), starts)
            held.check()
            _work_through(problem, gathered, found, settings, progress, held)
            _work_on_surfaces(problem, gathered, found, settings, charts)
    except KeyboardInterrupt:
        interrupted = True
        log.warning("interrupted: the atlas holds what was found so far")
    if gathered is None:
        nothing = np.empty((0, problem.n))
        gathered = Seeds(nothing, np.empty(0, dtype=bool), np.empty(0), nothing)
    info = {
        "seed": seed, "starts": starts, "settings": asdict(settings), "interrupted": interrupted,
        "budget": budget, "out_of_time": deadline.passed, "derivatives": problem.derivatives,
        "seconds": time.perf_counter() - began,
    }  # fmt: skip
    return _assemble(problem, found, gathered, interrupted, info)


# --- the search ---------------------------------------------------------------------------------------


def _work_through(
    problem: Problem, seeds: Seeds, found: _Findings, settings: TraceSettings,
    progress: Callable[[str, int], None] | None, held: HeldInterrupt,
) -> None:  # fmt: skip
    """Trace from every seed that lies on nothing known, and from every half-branch that shows up on the way."""
    if not len(seeds.points):
        return
    values = singular_values(problem, seeds.points)
    # the clearest first: those whose curve is far from singular
    order = np.argsort(-values[:, max(problem.n - 2, 0)], kind="stable")
    found.components = sort_out(problem, seeds.points, values, found.deadline)
    for dimension, numbers in found.components.seeds.items():
        found.owner.update((k, ("component of dimension", dimension)) for k in numbers)
    waiting = [k for k in order.tolist() if k not in found.owner]
    matched = 0
    while waiting and not found.deadline.passed:
        i = waiting.pop(0)
        found.owner[i] = _take_seed(problem, seeds.points[i], values[i], found, settings)
        for number in range(matched, len(found.branches)):
            distance, _ = found.branches[number].nearest(seeds.points[waiting])
            on = distance < SAME * problem.scale
            found.owner.update((waiting[k], ("form", number)) for k in np.flatnonzero(on))
            waiting = [waiting[k] for k in np.flatnonzero(~on)]
        matched = len(found.branches)
        if progress is not None:
            progress("forms", matched)
        held.check()


def _take_seed(
    problem: Problem, point: np.ndarray, values: np.ndarray, found: _Findings, settings: TraceSettings
) -> tuple[str, int]:
    """Find out what a seed lies on: a curve, a rigid assembly, a singular point, or a surface."""
    n = problem.n
    if values[n - 1] > 1e-6:
        return "rigid", _known_or_new(problem, point, found.rigid)
    if values[n - 2] <= 1e-4:
        known = _nearest(problem, point, [p.u for p in found.points], 1e-4)
        if known is not None:
            return "point", known
        for number, branch in enumerate(found.branches):
            if branch.nearest(point)[0][0] < 1e-4 * problem.scale:
                return "form", number  # where the rank is low a seed is good to half the digits only
        along = lower_rank_direction(problem, point)
        if along is not None:
            number = len(found.branches)
            return ("form", number) if _trace_lower_rank(problem, point, along, found, settings) else ("no solution", 0)
        nullity = int(np.count_nonzero(values < 1e-4))
        located = _examine(problem, point, nullity, found, reach=1e-2)
        if located is not None:
            number = next(i for i, p in enumerate(found.points) if p is located)
            starts = [(located.u + located.radius * h, h) for h in located.half_branches]
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
    problem: Problem, point: np.ndarray, along: np.ndarray, found: _Findings, settings: TraceSettings
) -> bool:
    """Trace the curve of lower rank through ``point``; what may cross it is left to other seeds."""
    branch = trace_branch(Deflated(problem), point, along, settings)
    if not _is_curve(problem, branch):
        log.info("no curve of lower rank through %s: %s", point, branch.outcome.value)
        return False
    _add_branch(problem, branch, found)
    return True


def _work_on_surfaces(
    problem: Problem, seeds: Seeds, found: _Findings, settings: TraceSettings, charts: int
) -> None:
    """Cover the surfaces with charts, locate singular points on them, and trace the curves that leave there."""
    found.components.cover(problem, seeds.points, charts, found.deadline)
    if found.components.charts is None:
        return
    for located in singular_points_of(problem, found.components.charts, found.deadline):
        if found.deadline.passed:
            break
        point = _point_of(problem, *located, found)
        starts: list[tuple[np.ndarray, np.ndarray | None]] = [
            (point.u + point.radius * h, h) for h in point.half_branches
        ]
        _trace_and_follow(problem, starts, found, settings)


def _trace_and_follow(
    problem: Problem, queue: list[tuple[np.ndarray, np.ndarray | None]], found: _Findings, settings: TraceSettings
) -> bool:
    """Trace the branches through the starts and everything that hangs on them; False where there is no curve."""
    traced = False
    while queue and not found.deadline.passed:
        point, along = queue.pop()
        if any(branch.nearest(point)[0][0] < SAME * problem.scale for branch in found.branches):
            continue
        branch = trace_branch(problem, point, along, settings)
        if branch.outcome is Outcome.OPEN:
            found.gaps.append(branch.gap)
        if not _is_curve(problem, branch):
            log.info("no curve through %s: %s", point, branch.outcome.value)
            continue
        traced = True
        if any(_is_the_same(problem, branch, known) for known in found.branches):
            continue  # the start lay beside the curve, by rounding over a small singular value
        queue = queue + _add_branch(problem, branch, found)
    return traced


def _is_curve(problem: Problem, branch: Branch) -> bool:
    """Whether a traced branch is more than the trace of rounding beside a singular point."""
    shortest = STUB if branch.outcome is Outcome.STALLED else STUB / 20
    return bool(len(branch.pieces)) and branch.length > shortest * problem.scale


def _is_the_same(problem: Problem, branch: Branch, known: Branch) -> bool:
    """Whether a branch runs along a known one."""
    distance, _ = known.nearest(branch(branch.length * np.array([0.11, 0.29, 0.47, 0.71, 0.93])))
    return bool(np.all(distance < SAME * problem.scale))


def _add_branch(
    problem: Problem, branch: Branch, found: _Findings
) -> list[tuple[np.ndarray, np.ndarray | None]]:
    """Record a traced branch and the singular points on it; starts on all branches through them come back."""
    profile = profile_branch(problem, branch)
    s, value = singular_value_minima(problem, branch, profile)
    found.branches.append(branch)
    found.profiles.append(profile)
    found.minima.append((s, value))
    located: list[float] = []
    candidates = [(float(at), max(NEARLY, 3 * small)) for at, small in zip(s, value, strict=True) if small < NEARLY]
    if branch.outcome is Outcome.STALLED:  # at a cusp the curve ends before the singular point is reached
        candidates += [(0.0, 10 * NEARLY), (branch.length, 10 * NEARLY)]
    starts: list[tuple[np.ndarray, np.ndarray | None]] = []
    for at, small in candidates:
        if found.deadline.passed:
            break
        nullity = int(np.count_nonzero(singular_values(problem, branch(at)[None])[0] < small))
        known = len(found.points)
        point = _examine(problem, branch(at), nullity, found, reach=0.05) if nullity > 1 else None
        if point is not None:
            located.append(at)
        if point is not None and len(found.points) > known:
            starts += [(point.u + point.radius * h, h) for h in point.half_branches]
    found.located.append(located)
    return starts


def _examine(
    problem: Problem, near: np.ndarray, nullity: int, found: _Findings, reach: float
) -> SingularPoint | None:
    """Locate and classify the singular point near a configuration; one already known is returned as it is."""
    for k in sorted({max(nullity, 2), 2, 3}, key=lambda k: abs(k - nullity)):
        result = locate_singular_point(problem, near, k, reach * problem.scale) if k <= problem.n else None
        if result is None or is_on_surface(problem, result[0]):
            continue
        return _point_of(problem, *result, found)
    return None


def _point_of(
    problem: Problem, u: np.ndarray, null_space: np.ndarray, error: float, found: _Findings
) -> SingularPoint:
    """The known singular point that a located one is, or a new one, classified."""
    known = _nearest(problem, u, [p.u for p in found.points], SAME + 10 * error / problem.scale)
    if known is not None:
        return found.points[known]
    point = classify_singular_point(problem, u, null_space, error)
    found.points.append(point)
    return point


def _nearest(problem: Problem, point: np.ndarray, others: list[np.ndarray], within: float) -> int | None:
    """Number of the first of ``others`` at less than ``within`` scales from ``point``, or None."""
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


# --- putting the atlas together -----------------------------------------------------------------------


def _assemble(problem: Problem, found: _Findings, seeds: Seeds, interrupted: bool, info: dict[str, object]) -> Atlas:
    """The atlas of the findings, in an order that does not depend on the seeds."""
    order = sorted(range(len(found.branches)), key=lambda i: (-round(found.branches[i].length, 6), i))
    branches = [found.branches[i] for i in order]
    surfaces = tuple(
        replace(surface, name=f"surface {i}")
        for i, surface in enumerate(found.components.surfaces(seeds.points), start=1)
    )
    points = [_meeting_point(problem, p, branches, surfaces) for p in found.points]
    points = sorted(points, key=lambda p: (p.kind.value, *np.round(wrap(p.point.u, problem.periods), 6)))
    points = [replace(p, name=f"{INITIALS.get(p.kind, 'S')}{i}") for i, p in enumerate(points, start=1)]
    component = _components(len(branches), points)
    forms, near, dead = [], [], []
    for i, k in enumerate(order):
        branch, profile, minima = found.branches[k], found.profiles[k], found.minima[k]
        smallest = float(min(minima[1].min(initial=np.inf), profile.smallest.min()))
        forms.append(Form(f"Form {i + 1}", branch, profile, smallest, component[i]))
        near += [
            Event(i, float(s), branch(s), float(v))
            for s, v in zip(*minima, strict=True)
            if float(s) not in found.located[k] and v < 0.5 * profile.smallest.max()
        ]
        dead += [Event(i, float(s), branch(s), index=j) for j, roots in enumerate(dead_points(branch)) for s in roots]
    mobile = bool(found.branches or surfaces)
    return Atlas(
        names=problem.names, units=problem.units, periods=problem.periods, forms=tuple(forms), points=tuple(points),
        near_misses=tuple(near), dead_points=tuple(dead), rigid=np.array(found.rigid).reshape(-1, problem.n),
        surfaces=surfaces,
        completeness=_completeness(found, seeds, interrupted),
        closure_gap=0.0 if mobile else _closure_gap(problem, seeds, found), info=info,
    )  # fmt: skip


def _closure_gap(problem: Problem, seeds: Seeds, found: _Findings) -> float:
    """Median residual along the valley in which the system is nearly solved, where it has no curve of solutions.

    From every start that did not solve the system, Gauss-Newton steps of rank n - 1 run down to the valley but
    not along it, so that an isolated solution at its end does not hide the gap. Where there is no valley, the
    residuals themselves.
    """
    points = seeds.missed.copy()
    for _ in range(12):
        if not len(points):
            break
        residual = problem.residuals(points) / problem.magnitude
        left, sigma, right = np.linalg.svd(problem.jacobians(points) / problem.magnitude, full_matrices=False)
        inverse = np.zeros_like(sigma)
        kept = sigma[:, : problem.n - 1] > 1e-6 * sigma[:, :1]
        inverse[:, : problem.n - 1][kept] = 1.0 / sigma[:, : problem.n - 1][kept]
        step = np.einsum("kji,kj,kmj,km->ki", right, inverse, left, residual)
        points -= step * np.minimum(1.0, 0.5 * problem.scale / (np.linalg.norm(step, axis=1) + 1e-300))[:, None]
    gaps = np.linalg.norm(problem.residuals(points), axis=1) / problem.magnitude if len(points) else np.empty(0)
    gaps = np.concatenate([np.maximum(gaps, seeds.gaps), found.gaps])
    return float(np.median(gaps)) if len(gaps) else np.inf


def _meeting_point(
    problem: Problem, point: SingularPoint, branches: list[Branch], surfaces: tuple[Surface, ...]
) -> MeetingPoint:
    """A singular point with the branches that pass it or end there, and the surfaces on which it lies; where the
    branches and the section disagree, a note."""
    within = SAME * problem.scale + 10 * point.error
    through = [
        (i, float(s))
        for i, branch in enumerate(branches)
        for s in branch.passes(point.u, within)
        if branch.outcome is not Outcome.STALLED or 0.01 * problem.scale < s < branch.length - 0.01 * problem.scale
    ]
    ends = [(i, s) for i, branch in enumerate(branches) for s in _ends_at(problem, branch, point)]
    tangents = np.array([branches[i](s, 1) for i, s in through + ends]).reshape(-1, problem.n)
    explained, seen = 2 * len(through) + len(ends), len(point.half_branches)
    kind, note = point.kind, ""
    if explained != seen:
        note = f"{explained} half-branches were traced, the section shows {seen}"
        crossing = Kind.BIFURCATION if explained > 2 else Kind.UNDECIDED
        kind = Kind.DIMENSION_CHANGE if point.dimension > 1 else crossing
    met = lies_on(surfaces, point.u, problem.periods) if point.dimension > 1 else ()
    return MeetingPoint("", kind, point, tuple(through + ends), tangents, note, met)


def _ends_at(problem: Problem, branch: Branch, point: SingularPoint) -> list[float]:
    """Arclengths of the ends of a branch that stalled before a cusp: near the point, along a half-branch."""
    near, found = 0.02 * problem.scale, []
    if branch.outcome is not Outcome.STALLED or not len(point.half_branches):
        return []
    for s, inside in ((0.0, near), (branch.length, branch.length - near)):
        gap = np.linalg.norm(problem.difference(branch(s), point.u))
        offset = problem.difference(branch(inside), point.u)
        along = float((point.half_branches @ offset).max()) / max(float(np.linalg.norm(offset)), 1e-300)
        if gap < near and along > 0.95:
            found.append(s)
    return found


def _components(count: int, points: list[MeetingPoint]) -> list[int]:
    """Number of the connected component of every form, counted from 0 in the order of the forms."""
    graph = nx.Graph()
    graph.add_nodes_from(range(count))
    for point in points:
        indices = [i for i, _ in point.passes] + [("surface", k) for k in point.surfaces]
        graph.add_edges_from(pairwise(indices))
    out = [0] * count
    parts = ([i for i in members if isinstance(i, int)] for members in nx.connected_components(graph))
    for number, members in enumerate(sorted(filter(None, parts), key=min)):
        for i in members:
            out[i] = number
    return out


def _completeness(found: _Findings, seeds: Seeds, interrupted: bool) -> Completeness:
    """What the seeds prove, and the estimate for the rest."""
    hits = Counter(owner for i, owner in found.owner.items() if seeds.random[i])
    closed = sum(hits.values())
    hits["no solution", 0] = len(seeds.gaps)
    missed = missed_probability(list(hits.values()))
    estimate = (
        f"{closed} of {closed + len(seeds.gaps)} random starts reached a solution, each listed here: one more start "
        f"would reach something new with a probability of at most {missed:.2g} (95 % confidence)"
    )
    if found.deadline.passed:
        left = len(seeds.points) - len(found.owner)
        reason = f"the budget of {found.deadline.seconds:.4g} s was used up with {left} starts not looked at; "
        return Completeness("out of time", reason + estimate, missed if not left else 1.0)
    if interrupted:
        return Completeness("interrupted", "the search was interrupted; " + estimate, missed)
    level = "complete slices" if seeds.complete else "estimated"
    return Completeness(level, f"{seeds.statement}; {estimate}" if seeds.statement else estimate, missed)
