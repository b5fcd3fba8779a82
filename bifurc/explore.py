"""The whole loop: seeds -> branches -> singular points -> atlas."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Surface, wrap
from bifurc.branch import Branch, Outcome
from bifurc.continuation import DEFAULT_SETTINGS, TraceSettings, trace_branch
from bifurc.monitor import dead_points, profile_branch, singular_value_minima, singular_values
from bifurc.problem import Problem, ProblemError
from bifurc.seeding import Completeness, Seeds, missed_probability
from bifurc.singular import Kind, SingularPoint, classify_singular_point, locate_singular_point, section

__all__ = ["explore"]

log = logging.getLogger(__name__)

SAME = 1e-6  # distance, in units of the problem's scale, below which a seed lies on a traced curve
SURFACE_CHECKS = 12  # how many seeds of nullity 2 are examined one by one once a surface is known


@dataclass
class _Findings:
    """What is known so far."""

    branches: list[Branch] = field(default_factory=list)
    minima: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    ranks: list[int] = field(default_factory=list)
    typical: list[float] = field(default_factory=list)
    located: list[list[float]] = field(default_factory=list)  # arclengths of minima that are singular points
    points: list[SingularPoint] = field(default_factory=list)
    rigid: list[np.ndarray] = field(default_factory=list)
    surface: list[np.ndarray] = field(default_factory=list)
    hits: list[int] = field(default_factory=list)  # random starts per branch, then per rigid assembly
    rigid_hits: list[int] = field(default_factory=list)


def explore(
    problem: Problem,
    *,
    starts: int = 200,
    seed: int = 0,
    seeds: Seeds | None = None,
    settings: TraceSettings = DEFAULT_SETTINGS,
    progress: Callable[[str, int], None] | None = None,
) -> Atlas:
    """All solution curves of a problem, all singular points on them, nothing twice.

    Seeds come from `Problem.seeds` (complete slices where the problem has them, and ``starts`` random starts drawn with
    ``seed``) unless given. Every branch found is traced whole and monitored; from every singular point the
    directions in which other branches leave become further starts. ``progress`` is called with what was found and
    how many. Ctrl-C ends the search early: the atlas holds what was found, and ``info["interrupted"]`` is true.
    """
    if starts < 1 and seeds is None:
        raise ProblemError("starts", starts, "at least 1")
    began = time.perf_counter()
    found = _Findings()
    interrupted = False
    gathered = seeds
    try:
        if gathered is None:
            gathered = problem.seeds(np.random.default_rng(seed), starts)
        _work_through(problem, gathered, found, settings, progress)
    except KeyboardInterrupt:
        interrupted = True
        log.warning("interrupted: the atlas holds what was found so far")
    if gathered is None:
        gathered = Seeds(np.empty((0, problem.n)), np.empty(0, dtype=bool), np.empty(0))
    info = {
        "seed": seed, "starts": starts, "settings": asdict(settings), "interrupted": interrupted,
        "derivatives": problem.derivatives, "seconds": time.perf_counter() - began,
    }  # fmt: skip
    return _assemble(problem, found, gathered, interrupted, info)


# --- the search ---------------------------------------------------------------------------------------


def _work_through(
    problem: Problem, seeds: Seeds, found: _Findings, settings: TraceSettings,
    progress: Callable[[str, int], None] | None,
) -> None:  # fmt: skip
    """Trace from every seed that lies on nothing known, and from every half-branch that shows up on the way."""
    values = singular_values(problem, seeds.points) if len(seeds.points) else np.empty((0, problem.n))
    open_seeds = np.ones(len(seeds.points), dtype=bool)
    # clear seeds first: those whose curve is far from singular
    order = np.argsort(-values[:, problem.n - 2], kind="stable") if len(values) else []
    for i in order:
        if not open_seeds[i]:
            continue
        known = len(found.branches)
        _take_seed(problem, seeds.points[i], values[i], bool(seeds.random[i]), found, settings)
        open_seeds[i] = False
        for branch in found.branches[known:]:
            rest = np.flatnonzero(open_seeds)
            on = branch.nearest(seeds.points[rest])[0] < SAME * problem.scale if len(rest) else np.empty(0, bool)
            open_seeds[rest[on]] = False
            found.hits.append(int(seeds.random[rest[on]].sum()))
            if progress is not None:
                progress("forms", len(found.branches))
        if len(found.branches) > known and i < len(seeds.random) and seeds.random[i]:
            found.hits[known] += 1


def _take_seed(
    problem: Problem, point: np.ndarray, values: np.ndarray, random: bool, found: _Findings, settings: TraceSettings
) -> None:
    """Find out what a seed lies on: a curve, a rigid assembly, a singular point, or a surface."""
    n, top = problem.n, max(values[0], 1e-300)
    if values[n - 1] > 1e-9 * top:
        nearly = values[n - 1] < 1e-6 * top  # rounding on a curve that is hard to solve, or a linkage slightly off
        if not (nearly and _trace_and_follow(problem, point, None, found, settings)):
            _add_rigid(problem, point, random, found)
        return
    if values[n - 2] > 1e-4 * top:
        _trace_and_follow(problem, point, None, found, settings)
        return
    if _near_any(problem, point, [p.u for p in found.points], 1e-4):
        return
    nullity = int(np.count_nonzero(values < 1e-4 * top))
    if values[n - 2] < 1e-9 * top:
        # a whole neighbourhood of lower rank, or a singular point hit by chance: the section tells
        known_surface = len(found.surface) > SURFACE_CHECKS
        if known_surface or _on_surface(problem, point):
            found.surface.append(point)
            return
    _examine(problem, point, nullity, found, settings, reach=1e-2)
    if not _near_any(problem, point, [p.u for p in found.points], 1e-4):
        _trace_and_follow(problem, point, None, found, settings)


def _on_surface(problem: Problem, point: np.ndarray) -> bool:
    """Whether the solution set about a point has dimension 2 or more."""
    jacobian = problem.jacobians(point[None])[0] / problem.magnitude
    _, sigma, right = np.linalg.svd(jacobian)
    padded = np.concatenate([sigma, np.zeros(len(right) - len(sigma))])
    null_space = right[padded < 1e-7 * padded[0]].T
    return null_space.shape[1] > 1 and section(problem, point, null_space, 1e-2 * problem.scale).dimension > 1


def _trace_and_follow(
    problem: Problem, start: np.ndarray, direction: np.ndarray | None, found: _Findings, settings: TraceSettings
) -> bool:
    """Trace the branch through ``start`` and everything that hangs on it; False where there is no curve."""
    queue = [(start, direction)]
    traced = False
    while queue:
        point, along = queue.pop()
        if any(branch.nearest(point)[0][0] < SAME * problem.scale for branch in found.branches):
            continue
        branch = trace_branch(problem, point, along, settings)
        if branch.outcome is Outcome.OPEN or branch.length < 1e-3 * problem.scale:
            log.info("no curve through %s: %s", point, branch.outcome.value)
            continue
        traced = True
        queue += _add_branch(problem, branch, found, settings)
    return traced


def _add_branch(
    problem: Problem, branch: Branch, found: _Findings, settings: TraceSettings
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Record a traced branch and the singular points on it; starts on the other branches through them come back."""
    profile = profile_branch(problem, branch)
    s, value = singular_value_minima(problem, branch, profile)
    found.branches.append(branch)
    found.minima.append((s, value))
    found.ranks.append(profile.rank)
    found.typical.append(float(np.max(profile.smallest)))
    located: list[float] = []
    starts: list[tuple[np.ndarray, np.ndarray]] = []
    top = float(np.median(profile.values[..., 0]))
    for at, small in zip(s, value, strict=True):
        if small > 1e-3 * top:
            continue
        values = singular_values(problem, branch(at)[None])[0]
        nullity = int(np.count_nonzero(values < max(1e-3 * top, 3 * small)))
        point = _examine(problem, branch(at), nullity, found, settings, reach=0.05)
        if point is not None:
            located.append(float(at))
            starts += [(point.u + point.radius * h, h) for h in point.half_branches]
    for end in () if branch.closed else (0.0, branch.length):
        if branch.outcome is Outcome.STALLED:
            values = singular_values(problem, branch(end)[None])[0]
            nullity = int(np.count_nonzero(values < 1e-2 * top))
            if nullity > 1 and (point := _examine(problem, branch(end), nullity, found, settings, reach=0.05)) is not None:
                starts += [(point.u + point.radius * h, h) for h in point.half_branches]
    found.located.append(located)
    return starts


def _examine(
    problem: Problem, near: np.ndarray, nullity: int, found: _Findings, settings: TraceSettings, reach: float
) -> SingularPoint | None:
    """Locate and classify the singular point near a configuration; one already known is returned as it is."""
    for k in range(max(nullity, 2), min(problem.n, 4) + 1) if nullity < 4 else (nullity,):
        result = locate_singular_point(problem, near, k, reach * problem.scale)
        if result is None:
            continue
        u, null_space, error = result
        for known in found.points:
            if np.linalg.norm(problem.difference(known.u, u)) < 1e-6 * problem.scale:
                return known
        point = classify_singular_point(problem, u, null_space, error)
        found.points.append(point)
        return point
    return None


def _add_rigid(problem: Problem, point: np.ndarray, random: bool, found: _Findings) -> None:
    """Record an isolated assembly, or count one more hit of a known one."""
    for i, known in enumerate(found.rigid):
        if np.linalg.norm(problem.difference(known, point)) < SAME * problem.scale:
            found.rigid_hits[i] += int(random)
            return
    found.rigid.append(point)
    found.rigid_hits.append(int(random))


def _near_any(problem: Problem, point: np.ndarray, others: list[np.ndarray], within: float) -> bool:
    return any(np.linalg.norm(problem.difference(other, point)) < within * problem.scale for other in others)


# --- putting the atlas together -----------------------------------------------------------------------


def _assemble(problem: Problem, found: _Findings, seeds: Seeds, interrupted: bool, info: dict[str, object]) -> Atlas:
    """The atlas of the findings, in an order that does not depend on the seeds."""
    order = sorted(range(len(found.branches)), key=lambda i: (-round(found.branches[i].length, 6), i))
    branches = [found.branches[i] for i in order]
    points = [_meeting_point(problem, p, branches) for p in found.points]
    points = sorted(points, key=lambda p: (p.kind.value, *np.round(wrap(p.point.u, problem.periods), 6)))
    named = [_with_name(p, i + 1) for i, p in enumerate(points)]
    component = _components(len(branches), named)
    forms = tuple(
        Form(
            f"Form {i + 1}", branch, float(found.minima[k][1].min(initial=found.typical[k])), found.ranks[k], component[i]
        )
        for i, (k, branch) in enumerate(zip(order, branches, strict=True))
    )
    near = [
        Event(i, float(s), branches[i](s), float(v))
        for i, k in enumerate(order)
        for s, v in zip(*found.minima[k], strict=True)
        if float(s) not in found.located[k] and v < 0.5 * found.typical[k]
    ]
    dead = [
        Event(i, float(s), branch(s), index=j)
        for i, branch in enumerate(branches)
        for j, roots in enumerate(dead_points(branch))
        for s in roots
    ]
    surfaces = (Surface(2, np.array(found.surface)),) if found.surface else ()
    solved = bool(found.branches or found.rigid or found.points or found.surface)
    gap = 0.0 if solved else float(seeds.gaps.min(initial=np.inf))
    return Atlas(
        names=problem.names, units=problem.units, periods=problem.periods, forms=forms, points=tuple(named),
        near_misses=tuple(near), dead_points=tuple(dead), rigid=np.array(found.rigid).reshape(-1, problem.n),
        surfaces=surfaces, completeness=_completeness(found, seeds, interrupted), closure_gap=gap, info=info,
    )  # fmt: skip


def _meeting_point(problem: Problem, point: SingularPoint, branches: list[Branch]) -> MeetingPoint:
    """A singular point with the branches that pass it; what they and the section say together is its kind."""
    passes = [
        (i, float(s)) for i, branch in enumerate(branches) for s in branch.passes(point.u, 1e-6 * problem.scale)
    ]
    tangents = np.array([branches[i](s, 1) for i, s in passes]).reshape(-1, problem.n)
    ends = sum(1 for i, s in passes if not branches[i].closed and min(s, branches[i].length - s) < 1e-6)
    explained = 2 * len(passes) - ends
    seen = len(point.half_branches)
    kind, note = point.kind, ""
    if point.dimension <= 1:
        if explained > 2 or (explained == 2 and seen <= 2):
            kind = Kind.BIFURCATION if explained > 2 else Kind.RANK_DROP
        if explained != seen:
            note = f"{explained} half-branches were traced, the section shows {seen}"
            kind = Kind.BIFURCATION if explained > 2 else Kind.UNDECIDED
    return MeetingPoint("", kind, point, tuple(passes), tangents, note)


def _with_name(point: MeetingPoint, number: int) -> MeetingPoint:
    letter = {Kind.BIFURCATION: "B", Kind.RANK_DROP: "R"}.get(point.kind, "S")
    return MeetingPoint(f"{letter}{number}", point.kind, point.point, point.passes, point.tangents, point.note)


def _components(count: int, points: list[MeetingPoint]) -> list[int]:
    """Number of the connected component of every form, counted from 0 in the order of the forms."""
    graph = nx.Graph()
    graph.add_nodes_from(range(count))
    for point in points:
        indices = [i for i, _ in point.passes]
        graph.add_edges_from(zip(indices[:-1], indices[1:], strict=True))
    out = [0] * count
    for number, members in enumerate(sorted(nx.connected_components(graph), key=min)):
        for i in members:
            out[i] = number
    return out


def _completeness(found: _Findings, seeds: Seeds, interrupted: bool) -> Completeness:
    """What the seeds prove, and the estimate for the rest."""
    surface_hits = [len(found.surface)] if found.surface else []
    missed = missed_probability([*found.hits, *found.rigid_hits, *surface_hits])
    hits = int(sum(found.hits) + sum(found.rigid_hits) + sum(surface_hits))
    estimate = (
        f"{hits} random starts reached what is listed here: one more would reach something new with a probability "
        f"of at most {missed:.2g} (95 % confidence)"
    )
    if interrupted:
        return Completeness("interrupted", "the search was interrupted; " + estimate, missed)
    if seeds.complete:
        return Completeness("complete slices", f"{seeds.statement}; {estimate}", missed)
    return Completeness("estimated", f"{seeds.statement}; {estimate}" if seeds.statement else estimate, missed)
