"""What a search has found so far, and how it becomes an atlas."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import pairwise

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Provenance, Surface
from bifurc.branch import Branch, Outcome
from bifurc.curves.minima import stand_out
from bifurc.curves.monitor import Profile, dead_points, singular_values
from bifurc.limits import Deadline
from bifurc.problem import Problem
from bifurc.search.components import Components, lies_on
from bifurc.seeding import missed_probability
from bifurc.seeds import Audit, Completeness, Level, Seeds
from bifurc.singular.point import Kind, SingularPoint
from bifurc.torus import wrap

__all__ = ["SAME", "Findings", "assemble_atlas"]

# distance, in units of the problem's scale, below which a point lies on a traced curve
SAME = 1e-6
INITIALS = {Kind.BIFURCATION: "B", Kind.RANK_DROP: "R", Kind.DIMENSION_CHANGE: "D"}


@dataclass
class Findings:
    """What is known so far. ``owner`` labels every seed with what it lies on: (kind,
    number)."""

    branches: list[Branch] = field(default_factory=list)
    profiles: list[Profile] = field(default_factory=list)
    minima: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    located: list[list[float]] = field(
        default_factory=list
    )  # arclengths of minima that are singular points
    points: list[SingularPoint] = field(default_factory=list)
    rigid: list[np.ndarray] = field(default_factory=list)
    components: Components = field(default_factory=Components)
    gaps: list[float] = field(
        default_factory=list
    )  # residuals of starts that only nearly solve the system
    owner: dict[int, tuple[str, int]] = field(default_factory=dict)
    audit: Audit | None = None  # the last word on what the branches leave out
    deadline: Deadline = field(default_factory=Deadline)


def assemble_atlas(
    problem: Problem,
    found: Findings,
    seeds: Seeds,
    provenance: Provenance,
) -> Atlas:
    """The atlas of the findings, in an order that does not depend on the seeds."""
    periods = _turning(problem)
    order = sorted(
        range(len(found.branches)),
        key=lambda i: (-round(found.branches[i].length, 6), i),
    )
    branches = [found.branches[i] for i in order]
    surfaces = tuple(
        replace(surface, name=f"surface {i}", samples=wrap(surface.samples, periods))
        for i, surface in enumerate(found.components.surfaces(seeds.points), start=1)
    )
    located = [replace(p, u=wrap(p.u, periods)) for p in found.points]
    points = [_meeting_point(problem, p, branches, surfaces) for p in located]
    points = sorted(points, key=lambda p: (p.kind.value, *_place(p.point.u, periods)))
    points = [
        replace(p, name=f"{INITIALS.get(p.kind, 'S')}{i}")
        for i, p in enumerate(points, start=1)
    ]
    component = _components(len(branches), points)
    passing = {i for point in points for i, _ in point.passes}
    forms, near, dead = [], [], []
    for i, k in enumerate(order):
        branch, profile, minima = found.branches[k], found.profiles[k], found.minima[k]
        smallest = (
            0.0
            if i in passing
            else _smallest_value(problem, branch, profile, minima[1])
        )
        forms.append(Form(f"Form {i + 1}", branch, profile, smallest, component[i]))
        low = stand_out(problem, branch, profile, minima[1])
        is_near_miss = low & ~np.isin(minima[0], found.located[k])
        for s, value in zip(
            minima[0][is_near_miss], minima[1][is_near_miss], strict=True
        ):
            near.append(Event(i, float(s), wrap(branch(s), periods), float(value)))
        for j, roots in enumerate(dead_points(branch)):
            places = wrap(branch(roots), periods)
            dead += [
                Event(i, float(s), u, index=j)
                for s, u in zip(roots, places, strict=True)
            ]
    rigid = wrap(np.array(found.rigid).reshape(-1, problem.n), periods)
    rigid = np.array(sorted(rigid, key=lambda u: _place(u, periods))).reshape(
        rigid.shape
    )
    mobile = bool(found.branches or surfaces)
    return Atlas(
        names=problem.names,
        units=problem.units,
        periods=problem.periods,
        forms=tuple(forms),
        points=tuple(points),
        near_misses=tuple(near),
        dead_points=tuple(dead),
        rigid=rigid,
        surfaces=surfaces,
        completeness=_completeness(found, seeds, provenance.interrupted),
        closure_gap=0.0 if mobile else _closure_gap(problem, seeds, found),
        provenance=provenance,
    )


def _turning(problem: Problem) -> np.ndarray:
    """Periods (n,) of the unknowns to wrap; inf for those whose bounds reach
    farther."""
    half = 0.5 * problem.periods
    finite = np.isfinite(problem.bounds).any(axis=1)
    low, high = problem.bounds.T
    elsewhere = finite & ((low < -half) | (high > half))
    return np.where(elsewhere, np.inf, problem.periods)


def _place(point: np.ndarray, periods: np.ndarray) -> tuple[float, ...]:
    """A point (n,) to six digits, those beside an end of a period at the same end."""
    wrapped = wrap(point, periods, within=1e-6)
    return tuple(float(x) + 0.0 for x in np.round(wrapped, 6))


def _smallest_value(
    problem: Problem, branch: Branch, profile: Profile, minima: np.ndarray
) -> float:
    """The smallest regular singular value along a branch: at its ``minima`` or its
    ends."""
    values = [*minima, profile.smallest.min()]
    if not branch.closed:
        ends = branch(np.array([0.0, branch.length]))
        values += [*singular_values(problem, ends)[:, profile.rank - 1]]
    return float(min(values))


def _closure_gap(problem: Problem, seeds: Seeds, found: Findings) -> float:
    """Median residual along the valley in which the system is nearly solved, where it
    has no curve of solutions.

    From every start that did not solve the system, Gauss-Newton steps of rank n - 1 run
    down to the valley but not along it, so that an isolated solution at its end does
    not hide the gap. Where there is no valley, the residuals themselves.
    """
    points = seeds.missed.copy()
    for _ in range(12):
        if not len(points):
            break
        residual = problem.residuals(points) / problem.magnitude
        left, sigma, right = np.linalg.svd(
            problem.jacobians(points) / problem.magnitude, full_matrices=False
        )
        inverse = np.zeros_like(sigma)
        kept = sigma[:, : problem.n - 1] > 1e-6 * sigma[:, :1]
        inverse[:, : problem.n - 1][kept] = 1.0 / sigma[:, : problem.n - 1][kept]
        step = np.einsum("kji,kj,kmj,km->ki", right, inverse, left, residual)
        points -= (
            step
            * np.minimum(
                1.0, 0.5 * problem.scale / (np.linalg.norm(step, axis=1) + 1e-300)
            )[:, None]
        )
    gaps = (
        np.linalg.norm(problem.residuals(points), axis=1) / problem.magnitude
        if len(points)
        else np.empty(0)
    )
    gaps = np.concatenate([np.maximum(gaps, seeds.gaps), found.gaps])
    return float(np.median(gaps)) if len(gaps) else 0.0


def _meeting_point(
    problem: Problem,
    point: SingularPoint,
    branches: list[Branch],
    surfaces: tuple[Surface, ...],
) -> MeetingPoint:
    """A singular point with the branches that pass it or end there, and the surfaces on
    which it lies; where the branches and the section disagree, a note."""
    through: list[tuple[int, float]] = []
    ends: list[tuple[int, float]] = []
    for i, branch in enumerate(branches):
        own_ends = _ends_at(problem, branch, point)
        ends += [(i, s) for s in own_ends]
        through += [(i, s) for s in _passes_at(problem, branch, point, own_ends)]
    tangents = np.array([branches[i](s, 1) for i, s in through + ends]).reshape(
        -1, problem.n
    )
    explained, seen = 2 * len(through) + len(ends), len(point.half_branches)
    kind, note = point.kind, ""
    if explained != seen:
        note = f"{explained} half-branches were traced, the section shows {seen}"
        crossing = Kind.BIFURCATION if explained > 2 else Kind.UNDECIDED
        kind = Kind.DIMENSION_CHANGE if point.dimension > 1 else crossing
    met = lies_on(problem, surfaces, point.u) if point.dimension > 1 else ()
    return MeetingPoint("", kind, point, tuple(through + ends), tangents, note, met)


def _ends_at(problem: Problem, branch: Branch, point: SingularPoint) -> list[float]:
    """Arclengths of the ends of a branch that stalled at a cusp, along a half-branch.

    Where it stalled hangs on rounding: before a sharp cusp, about where the section
    tells the half-branches apart, or beyond it, where nothing but rounding looks like
    solutions. Up to a few times the radius of the section an end belongs to the point
    if the branch came along a half-branch, and does not go on along another.
    """
    if branch.outcome is not Outcome.STALLED or not len(point.half_branches):
        return []
    farthest = max(5 * point.radius, 4 * point.error)
    ends = []
    for s, sense in ((0.0, 1.0), (branch.length, -1.0)):
        end = problem.difference(branch(s), point.u)
        gap = float(np.linalg.norm(end))
        if gap > farthest:
            continue
        clear = max(1.5 * gap, point.radius)
        inwards = np.linspace(0.0, min(4 * clear, branch.length), 33)
        offsets = problem.difference(branch(s + sense * inwards), point.u)
        outside = np.flatnonzero(np.linalg.norm(offsets, axis=1) >= clear)
        if not len(outside):
            continue
        origin = offsets[outside[0]]
        came_along = _is_along(point, origin)
        goes_on = end @ origin < 0 and gap > 2 * point.error and _is_along(point, end)
        if came_along and not goes_on:
            ends.append(s)
    return ends


def _is_along(point: SingularPoint, offset: np.ndarray) -> bool:
    """Whether an ``offset`` (n,) from a point has the direction of a half-branch."""
    along = float((point.half_branches @ offset).max())
    return along > 0.95 * float(np.linalg.norm(offset))


def _passes_at(
    problem: Problem, branch: Branch, point: SingularPoint, ends: list[float]
) -> list[float]:
    """Arclengths at which a branch passes a point, but for the ``ends`` that lie
    there."""
    within = SAME * problem.scale + 2 * point.error
    passes = [float(s) for s in branch.passes(point.u, within)]
    if branch.outcome is not Outcome.STALLED:
        return passes
    for s in (0.0, branch.length):
        # nearer to a stalled end it is the end that counts
        taken = max(0.05 * problem.scale, 2 * within)
        if s in ends:
            gap = float(np.linalg.norm(problem.difference(branch(s), point.u)))
            taken = max(taken, 2 * (gap + within))
        passes = [other for other in passes if abs(other - s) > taken]
    return passes


def _components(count: int, points: list[MeetingPoint]) -> list[int]:
    """Number of the connected component of every form, counted from 0 in the order of
    the forms."""
    graph = nx.Graph()
    graph.add_nodes_from(range(count))
    for point in points:
        indices = [i for i, _ in point.passes] + [
            ("surface", k) for k in point.surfaces
        ]
        graph.add_edges_from(pairwise(indices))
    out = [0] * count
    parts = (
        [i for i in members if isinstance(i, int)]
        for members in nx.connected_components(graph)
    )
    for number, members in enumerate(sorted(filter(None, parts), key=min)):
        for i in members:
            out[i] = number
    return out


def _completeness(found: Findings, seeds: Seeds, interrupted: bool) -> Completeness:
    """What the seeds prove, and the estimate for the rest."""
    hits = Counter(owner for i, owner in found.owner.items() if seeds.random[i])
    closed = sum(hits.values())
    hits["no solution", 0] = len(seeds.gaps)
    missed = missed_probability(list(hits.values()))
    total = closed + len(seeds.gaps)
    reached = (
        f"{closed} of {total} random starts reached a solution, each listed here"
        if closed
        else (f"none of {total} random starts reached a solution")
    )
    estimate = (
        f"{reached}: one more start would reach something new with a probability of at most {missed:.2g} "
        "(95 % confidence)"
    )
    if found.deadline.passed and found.audit is None:
        left = len(seeds.points) - len(found.owner)
        reason = f"the budget of {found.deadline.seconds:.4g} s was used up with {left} starts not looked at; "
        return Completeness(
            Level.OUT_OF_TIME, reason + estimate, missed if not left else 1.0
        )
    if interrupted:
        return Completeness(
            Level.INTERRUPTED, "the search was interrupted; " + estimate, missed
        )
    if found.audit is None:
        return Completeness(Level.ESTIMATED, estimate, missed)
    return Completeness(
        found.audit.level, f"{found.audit.statement}; {estimate}", missed
    )
