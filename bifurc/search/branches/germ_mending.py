"""Branches that were lost where they touch to a high order, traced again outward from the
germs of singular points.

A trace that runs into the neighbourhood in which doubles lose the branches comes out of
it on any of them, or not at all. So every branch is followed from where its germ hands
it over until it comes to the neighbourhood of a germ again, or to its end, and within
these it goes on along the branch that the germ has there.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from enum import Enum
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import follow_curve
from bifurc.curves.track import Place
from bifurc.decisions import (
    is_lost_in_rounding,
    is_precise_enough,
    is_same_point,
    is_solution,
)
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.branches.branch_examination import BranchExaminer
from bifurc.search.branches.branch_parts import (
    curve_through,
    followed_by,
    half_curve,
    joined_outcome,
    part_of,
)
from bifurc.search.findings import Run
from bifurc.search.records import Start, TracedBranch
from bifurc.settings import TraceSettings
from bifurc.singular.germ import Germ
from bifurc.singular.local_branches import LocalBranch

INSIDE = 0.98  # of the radius of a neighbourhood: nearer than its ends
LEAVING = 1e-3  # of that radius: a curve that leaves is not there again so soon


class HalfEnd(NamedTuple):
    """Where half-branch number ``half`` of germ number ``germ`` is handed over."""

    germ: int
    half: int


class _Begin(Enum):
    """What is before the first arc of a branch."""

    # It is run backward, from its own end.
    LOOSE = "loose"
    CUSP = "cusp"
    # Another arc of the same closed branch.
    BETWEEN = "between"


class _Lost(Exception):
    """A trace does not come back along a half-branch, or a part between two of them is
    no solution."""


class _Arc(NamedTuple):
    """A curve from the end of a half-branch to another one, or to its own end."""

    curve: Branch
    end: HalfEnd | None


def ends_of(germ: Germ) -> np.ndarray:
    """Where the half-branches (h, n) of a germ are handed over."""
    offsets = germ.neighbourhood.ends()
    ends: np.ndarray = germ.u + offsets.reshape(-1, len(germ.u))
    return ends


def passes_inside(branch: Branch, germ: Germ) -> np.ndarray:
    """The arclengths (k,) at which a branch is nearest to the point of a germ, inside
    its neighbourhood."""
    return branch.passes(germ.u, INSIDE * germ.radius)


class _Tracer:
    """Arcs between ``germs``, whose neighbourhoods are known, and what they make
    together."""

    def __init__(
        self, problem: Problem, germs: Sequence[Germ], settings: TraceSettings
    ):
        self.problem = problem
        self.germs = germs
        self.settings = settings
        self._ends = [ends_of(germ) for germ in germs]
        # the arc that begins at the end of a half-branch
        self._arcs: dict[HalfEnd, _Arc] = {}

    # --- arcs -------------------------------------------------------------------------

    def _trace_arcs(self) -> None:
        """Trace from the end of every half-branch to another one, or to an end of its
        own."""
        for number, ends in enumerate(self._ends):
            for half in range(len(ends)):
                begin = HalfEnd(number, half)
                if begin in self._arcs:
                    continue
                arc = self._arc_from(begin)
                if arc.end in self._arcs:
                    raise _Lost
                self._arcs[begin] = arc
                if arc.end is not None:
                    self._arcs[arc.end] = _Arc(arc.curve.reversed(), begin)

    def _arc_from(self, begin: HalfEnd) -> _Arc:
        """The arc that leaves a half-branch, up to the first place at which it is nearest
        to the point of a germ, inside its neighbourhood."""
        inward = self._half_curve(begin)
        start = Place(inward(0.0), -inward(0.0, 1))
        closing = is_solution.threshold
        curve = follow_curve(self.problem, start, self.settings, closing)
        if not len(curve.pieces):
            raise _Lost
        entries = [
            (float(s), number)
            for number, germ in enumerate(self.germs)
            if germ.branches  # an isolated point is beside the curve
            for s in passes_inside(curve, germ)
        ]
        if entries:
            s, end = self._handover(curve, *min(entries))
            return _Arc(part_of(curve, 0.0, s), end)
        if curve.closed:
            raise _Lost
        return _Arc(curve, None)

    def _handover(
        self, curve: Branch, stop: float, number: int
    ) -> tuple[float, HalfEnd]:
        """The arclength, before ``stop``, at which a curve comes to the end of a
        half-branch of a germ, and that end."""
        within = is_same_point.threshold * self.problem.domain.scale
        leaving = LEAVING * self.germs[number].radius
        handovers = [
            (float(s), HalfEnd(number, half))
            for half, end in enumerate(self._ends[number])
            for s in curve.passes(end, within)
            if leaving < s < stop
        ]
        if not handovers:
            raise _Lost
        return max(handovers)

    # --- branches ---------------------------------------------------------------------

    def branches(self) -> list[Branch]:
        """All branches through the points of the germs: arcs together with those
        inside. Raises `_Lost`."""
        self._trace_arcs()
        branches: list[Branch] = []
        waiting = set(self._arcs)
        ends = sorted(waiting)
        loose = [end for end in ends if self._arcs[end].end is None]
        cusps = [end for end in ends if self._partner(end) is None]
        for kind, begins in ((_Begin.LOOSE, loose), (_Begin.CUSP, cusps)):
            for begin in begins:
                if begin in waiting:
                    branches.append(self._walked(begin, kind, waiting))
        while waiting:
            branches.append(self._walked(min(waiting), _Begin.BETWEEN, waiting))
        return branches

    def _walked(self, begin: HalfEnd, kind: _Begin, waiting: set[HalfEnd]) -> Branch:
        """The branch that begins with the arc of one end, or, of a kind `LOOSE`, with it
        run backward; the ends on the way are ``waiting`` no longer."""
        parts: list[Branch] = []
        arc = self._arcs[begin]
        inward: HalfEnd | None = arc.end
        waiting.discard(begin)
        if kind is _Begin.LOOSE:
            parts.append(arc.curve.reversed())
            inward = begin
        else:
            if kind is _Begin.CUSP:
                parts.append(self._half_curve(begin).reversed())
            parts.append(arc.curve)
        is_closed = False
        while inward is not None:
            waiting.discard(inward)
            outward = self._partner(inward)
            if outward is None:
                parts.append(self._half_curve(inward))
                break
            parts.append(self._curve_through(inward))
            is_closed = kind is _Begin.BETWEEN and outward == begin
            if is_closed:
                break
            waiting.discard(outward)
            parts.append(self._arcs[outward].curve)
            inward = self._arcs[outward].end
        return self._joined(parts, is_closed)

    def _joined(self, parts: Sequence[Branch], is_closed: bool) -> Branch:
        """The branch of consecutive parts."""
        branch = parts[0]
        for part in parts[1:]:
            last, first = branch(branch.length), part(0.0)
            whole_periods = self.problem.domain.difference(first, last) - (first - last)
            branch = followed_by(branch, part, whole_periods)
        outcome = Outcome.CLOSED
        if not is_closed:
            outcome = joined_outcome(self.problem, branch, branch)
        return replace(branch, outcome=outcome)

    def _partner(self, end: HalfEnd) -> HalfEnd | None:
        """The end of the other half of a branch; None where it is a cusp."""
        branch = self.germs[end.germ].neighbourhood.branch_of(end.half)
        if branch.returns:
            return None
        one, other = branch.halves
        return HalfEnd(end.germ, other if end.half == one else one)

    def _half_curve(self, end: HalfEnd) -> Branch:
        """The half-branch that ends there, from there on inward."""
        germ = self.germs[end.germ]
        return half_curve(self.problem, germ, end.half, self.settings.order)

    def _curve_through(self, end: HalfEnd) -> Branch:
        """The branch from the end of one half to that of the other."""
        germ = self.germs[end.germ]
        curve = curve_through(self.problem, germ, end.half, self.settings.order)
        if curve is None:
            raise _Lost
        return curve


log = logging.getLogger(__name__)

PLACES = (np.arange(8) + 0.5) / 8  # of every piece, at which branches are compared
SAME_LENGTH = 0.02  # of a stretch: by which two ways to measure it differ
LENGTH_LOOKS = 200  # on a local branch, for its length
# Shares of the way to the end of half a local branch, at which a branch is held against
# it; where it ends at the point it may stall before.
SHARES = np.geomspace(2e-3, 1.0, 24)
BEFORE_CUSP = 0.1


class _Pass(NamedTuple):
    """A ``branch`` passes a place at an arclength ``s``."""

    branch: TracedBranch
    s: float


class GermMender:
    """Holds the branches of a ``run`` against the germs that it knows, and traces them
    again where they do not follow these."""

    def __init__(self, run: Run, examiner: BranchExaminer):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings
        self.examiner = examiner

    def mend(self) -> list[Start]:
        """Put branches traced outward from the germs in the place of those that pass
        them, where these do not all follow the germs; the starts on branches through
        singular points that this leads to."""
        germs = [germ for germ in self.findings.germs if germ.radius]
        if all(self._is_followed(germ) for germ in germs):
            return []
        settings = self.run.settings.tracing
        try:
            branches = _Tracer(self.problem, germs, settings).branches()
        except _Lost:
            log.info("no branches outward from germs at %s", [g.u for g in germs])
            return []
        superseded = self._superseded(germs, branches)
        if superseded is None:
            log.info("branches outward from germs leave out some that were traced")
            return []
        starts: list[Start] = []
        traced: list[TracedBranch] = []
        for branch in branches:
            examined = self.examiner.examine(branch)
            traced.append(examined.traced)
            starts += examined.starts
        for number in superseded:
            self.findings.forget_branch(number)
        for one in traced:
            self.findings.add_branch(one)
        return starts

    # --- what follows a germ ----------------------------------------------------------

    def _is_followed(self, germ: Germ) -> bool:
        """Whether one branch passes each end of the half-branches of a germ, and goes on
        from there as the germ does."""
        passing = [self._passes(end) for end in ends_of(germ)]
        if not passing:
            branches = self.findings.branches
            return not any(len(passes_inside(branch, germ)) for branch in branches)
        if any(len(passes) != 1 for passes in passing):
            return False
        if any(passes[0].branch.is_refused for passes in passing):
            return False
        return all(
            self._follows(germ, branch, *(passing[half][0] for half in branch.halves))
            for branch in germ.neighbourhood.branches
        )

    def _passes(self, place: np.ndarray) -> list[_Pass]:
        """The passes of all branches at a place (n,)."""
        within = is_same_point.threshold * self.problem.domain.scale
        return [
            _Pass(traced, float(s))
            for traced in self.findings.traced.values()
            for s in traced.branch.passes(place, within)
        ]

    def _follows(
        self, germ: Germ, local: LocalBranch, one: _Pass, other: _Pass
    ) -> bool:
        """Whether the branches that pass the ends of a local branch of a germ go along
        it."""
        if not self._runs_along(germ, local, 1.0, one):
            return False
        if not self._runs_along(germ, local, -1.0, other):
            return False
        branch = one.branch.branch
        lengths = [_length(local, side) for side in (1.0, -1.0)]
        if local.returns:
            pairs = zip((one, other), lengths, strict=True)
            return all(_ends_after(*pair) for pair in pairs)
        if one.branch is not other.branch:
            return False
        way = abs(one.s - other.s)
        if branch.closed:
            way = min(way, branch.length - way)
        return abs(way - sum(lengths)) < SAME_LENGTH * sum(lengths)

    def _runs_along(
        self, germ: Germ, local: LocalBranch, side: float, at: _Pass
    ) -> bool:
        """Whether a branch is, to the digits that doubles know elsewhere, half a local
        branch, after the pass at its end.

        F is so flat beside the point that rounding leaves more open.
        """
        shares = SHARES[SHARES > BEFORE_CUSP] if local.returns else SHARES
        distances, _ = at.branch.branch.nearest(germ.u + local(side * shares))
        return bool(np.all(is_precise_enough(distances, self.problem.domain.scale)))

    # --- what is put in whose place ---------------------------------------------------

    def _superseded(
        self, germs: list[Germ], branches: list[Branch]
    ) -> list[int] | None:
        """The numbers of the known branches that are, where doubles tell, parts of the
        new ``branches``; None where one of them is in part only."""
        superseded = []
        for number, traced in self.findings.traced.items():
            if not any(len(passes_inside(traced.branch, germ)) for germ in germs):
                continue
            shares = self._shares_on(traced.branch, branches)
            if np.all(shares):
                superseded.append(number)
            elif np.any(shares):
                return None
        return superseded

    def _shares_on(self, known: Branch, branches: list[Branch]) -> np.ndarray:
        """Of the places (k,) of a known branch where doubles do not lose it, which are
        on one of the new ``branches``."""
        places = known(known.places(PLACES).ravel())
        values = singular_values(self.problem, places)
        places = places[~is_lost_in_rounding(values[:, self.problem.n - 2])]
        on_any = np.zeros(len(places), dtype=bool)
        for branch in branches:
            distances, _ = branch.nearest(places)
            on_any |= is_same_point(distances, self.problem.domain.scale)
        return on_any


def _length(local: LocalBranch, side: float) -> float:
    """The length of one half of a local branch."""
    points = local(side * np.linspace(0.0, 1.0, LENGTH_LOOKS))
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _ends_after(at: _Pass, length: float) -> bool:
    """Whether a branch ends after a pass and about so long a way."""
    branch = at.branch.branch
    way = min(at.s, branch.length - at.s)
    is_there = abs(way - length) < SAME_LENGTH * length
    return branch.outcome is Outcome.STALLED and is_there
