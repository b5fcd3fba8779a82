"""Boxes in which exact equations have no solution, or a single arc of a known branch.

The bounds are divided until every box is settled. A box is empty where bounds on F, or
on F in the middle and on F' in the box, leave out zero. It holds a single arc where
Krawczyk's test (1969), with one unknown as the parameter, finds one solution of the
others for each of its values: a branch through one of these solutions is that arc. The
branches are held against the same bounds all along, also between the nodes of their
pieces. What remains lies about singular points. All these bounds are intervals rounded
outwards (`bifurc/core/boxes.hpp`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.branch import Branch
from bifurc.completeness import Level, Scope
from bifurc.curves.certificate import Certificate, CertificateStatus
from bifurc.curves.monitor import dead_points
from bifurc.decisions import closes_to_rounding, is_same_point
from bifurc.equations.tape import Operation
from bifurc.function_problem import EquationProblem
from bifurc.limits import is_time_over
from bifurc.problem import Problem
from bifurc.search.answer.completeness import SearchClaim
from bifurc.search.records import TracedBranch
from bifurc.seeds import Audit
from bifurc.singular.point import CROSSING, LONE_POINT, SingularPoint
from bifurc.system import relative_gaps

MOST_UNKNOWNS = 4
FIRST_BOXES = 64
# Boxes that are looked at before their arcs are held against the branches.
AT_ONCE = 1024
ENOUGH = 30  # solutions on unknown arcs, to trace before boxes are divided further
MOST_LEFT = 24  # places that are listed of what is not settled
MOST_STRETCHES = 4000  # of a branch that are divided
# Radius of a box, or half a stretch, over the scale, that is not divided any more.
SMALLEST = 1e-7
SOLVED = 1e-9  # over the scale: |F| where Newton's method has settled
DETOUR = 2.0  # times as long as its chord a branch may be from one place to the next
# Radii, over the scale, about singular points in which nothing is claimed: of ordinary
# crossings and others, where branches may run very close to each other.
BESIDE_CROSSING = 1e-5
BESIDE_OTHER = 0.03
WIDER = 1e-15  # of a period: the box of a circle is so much wider than one


class _Verdict(IntEnum):
    """What is known of a branch, as `_core.Tape.course` numbers it."""

    SOLVED = 0
    MISSED = 1
    OPEN = 2


@dataclass(frozen=True, eq=False)
class Subdivision:
    """What became of ``count`` boxes.

    ``found`` (k, n) are solutions on arcs of no known branch, ``seeds`` (i, n) what may
    be more of them, ``left`` (j, n) middles of boxes that are not settled, `MOST_LEFT`
    at most, ``refuted`` numbers of branches with arclengths at which they solve nothing.
    Within ``beside`` of singular points, in scales, nothing was looked at.
    """

    count: int
    found: np.ndarray
    seeds: np.ndarray
    left: np.ndarray
    refuted: tuple[tuple[int, float], ...]
    beside: float

    @property
    def is_complete(self) -> bool:
        """Whether the known branches are all, and each of them is one."""
        return not len(self.found) and not len(self.left) and not self.refuted


def continuous_tape(problem: Problem) -> _core.Tape | None:
    """The recorded equations in compiled form, with bounds on F and F' in boxes; None
    where they are not recorded, or jump: an angle does."""
    if not isinstance(problem, EquationProblem):
        return None
    tape = problem.recording.tape
    if tape is None or np.any(tape.operations == Operation.ANGLE):
        return None
    return tape.compiled


def can_be_subdivided(problem: Problem) -> bool:
    """Whether there are few enough unknowns within finite bounds, one equation less,
    and bounds on F."""
    if not 2 <= problem.n <= MOST_UNKNOWNS or not np.all(np.isfinite(_box(problem))):
        return False
    if np.any(problem.domain.has_assumed_bounds):
        return False
    tape = continuous_tape(problem)
    return tape is not None and tape.equations == problem.n - 1


def subdivide(
    problem: Problem,
    branches: Sequence[Branch],
    points: Sequence[SingularPoint],
    most: int,
) -> Subdivision:
    """The bounds divided into boxes, until all are settled, or enough is found to be
    traced first, or there would be more than ``most``, or the time is over."""
    division = _Division(problem, branches, points)
    division.verify_branches()
    boxes = _grid(_box(problem))
    while len(boxes.low) and division.is_worth_while and division.count < most:
        if is_time_over():
            break
        boxes = division.open_boxes(boxes, min(AT_ONCE, most - division.count))
    if division.is_worth_while and division.count:
        division.look_next_to(boxes.middles)
    division.left.append(boxes.middles)
    return division.result()


def _box(problem: Problem) -> np.ndarray:
    """The bounds (n, 2); of a circle one period, and a little more."""
    periods = problem.domain.periods
    turn = np.column_stack([-WIDER * periods, (1.0 + WIDER) * periods])
    is_circle = np.isfinite(periods) & np.isinf(problem.domain.bounds[:, 0])
    return np.where(is_circle[:, None], turn, problem.domain.bounds)


class _Boxes(NamedTuple):
    """Boxes from ``low`` (k, n) to ``high`` (k, n)."""

    low: np.ndarray
    high: np.ndarray

    @property
    def middles(self) -> np.ndarray:
        """Their middles (k, n)."""
        middles: np.ndarray = 0.5 * (self.low + self.high)
        return middles

    def at(self, numbers: np.ndarray) -> _Boxes:
        """Those with these numbers."""
        return _Boxes(self.low[numbers], self.high[numbers])

    def and_others(self, others: _Boxes) -> _Boxes:
        """These, and the others after them."""
        low, high = zip(self, others, strict=True)
        return _Boxes(np.concatenate(low), np.concatenate(high))

    def halves(self) -> _Boxes:
        """Each of them cut in half where it is widest."""
        rows = np.arange(len(self.low))
        sides = np.argmax(self.high - self.low, axis=1)
        cuts = self.middles[rows, sides]
        first, second = self.high.copy(), self.low.copy()
        first[rows, sides] = cuts
        second[rows, sides] = cuts
        return _Boxes(self.low, first).and_others(_Boxes(second, self.high))


class _Arcs(NamedTuple):
    """Arcs with ``points`` (k, 3, n) where the parameter begins, in the middle and where
    it ends; an unknown that ``is_steady`` (k, n) rises or falls all along, one that
    ``is_within`` (k, n) stays within its bounds."""

    points: np.ndarray
    is_steady: np.ndarray
    is_within: np.ndarray


class _Feet(NamedTuple):
    """The numbers of the branches (k,) on which points lie, -1 for none, and the
    arclengths there (k,)."""

    branch: np.ndarray
    s: np.ndarray


class _Division:
    """A subdivision under way."""

    def __init__(
        self,
        problem: Problem,
        branches: Sequence[Branch],
        points: Sequence[SingularPoint],
    ):
        tape = continuous_tape(problem)
        assert tape is not None
        self.tape = tape
        self.problem = problem
        self.branches = branches
        self.centers = np.array([p.u for p in points]).reshape(-1, problem.n)
        ordinary = (CROSSING, LONE_POINT)
        reaches = [
            BESIDE_CROSSING if p.invariants in ordinary else BESIDE_OTHER
            for p in points
        ]
        self.reaches = problem.domain.scale * np.array(reaches)
        self.within = is_same_point.threshold * problem.domain.scale
        self.count = 0
        self.found: list[np.ndarray] = []
        self.seeds = np.empty((0, problem.n))
        self.left: list[np.ndarray] = []
        self.refuted: dict[int, float] = {}

    @property
    def is_worth_while(self) -> bool:
        """Whether there is more to see than what was found, which is to be traced
        first."""
        return sum(len(points) for points in self.found) < ENOUGH

    def verify_branches(self) -> None:
        """Note which branches are none, and where one is not known to be one: by bounds
        on F and F' about stretches of it, but beside singular points."""
        for number, branch in enumerate(self.branches):
            torn = self._torn_at(branch)
            if torn is not None:
                self.refuted[number] = torn
                continue
            verdict, s = self.tape.course(
                branch.compiled,
                self.centers,
                self.reaches,
                self.problem.domain.periods,
                residual=self.within * self.problem.magnitude,
                shortest=SMALLEST * self.problem.domain.scale,
                most=MOST_STRETCHES,
            )
            if verdict == _Verdict.MISSED:
                self.refuted[number] = s
            elif verdict == _Verdict.OPEN:
                self.left.append(branch(s)[None])
            else:
                points = branch(np.concatenate(dead_points(branch)))
                self.left.append(points[~self.problem.domain.are_inside(points)][:1])

    def _torn_at(self, branch: Branch) -> float | None:
        """The arclength at which a branch does not hand over from one piece to the next,
        or from the last one of a closed curve to the first; None where it does, but
        beside singular points."""
        begins, ends = branch.compiled.ends_of_pieces(0)
        following = np.roll(begins, -1, axis=0)
        gaps = np.linalg.norm(self.problem.domain.difference(following, ends), axis=1)
        if not branch.closed:
            gaps[-1] = 0.0
        torn = np.flatnonzero(~is_same_point(gaps, self.problem.domain.scale))
        torn = torn[~self._are_beside_points(ends[torn], gaps[torn])]
        return float(branch.breaks[torn[0] + 1]) if len(torn) else None

    def _are_beside_points(
        self, places: np.ndarray, gaps: np.ndarray | float = 0.0
    ) -> np.ndarray:
        """Which places (k, n), with ``gaps`` (k,) from there on, lie next to a singular
        point, where nothing is claimed."""
        offsets = self.problem.domain.difference(places[:, None], self.centers)
        farthest = np.linalg.norm(offsets, axis=2) + np.reshape(gaps, (-1, 1))
        are_beside: np.ndarray = np.any(farthest < self.reaches, axis=1)
        return are_beside

    def result(self) -> Subdivision:
        nowhere = np.empty((0, self.problem.n))
        return Subdivision(
            count=self.count,
            found=np.concatenate([nowhere, *self.found]),
            seeds=self.seeds,
            left=self._apart(np.concatenate([nowhere, *self.left[::-1]])),
            refuted=tuple(self.refuted.items()),
            beside=float(self.reaches.max(initial=0.0)) / self.problem.domain.scale,
        )

    def _apart(self, middles: np.ndarray) -> np.ndarray:
        """The first of points (k, n) that do not lie beside each other."""
        kept: list[np.ndarray] = []
        while len(middles) and len(kept) < MOST_LEFT:
            kept.append(middles[0])
            offsets = self.problem.domain.difference(middles, middles[0])
            reach = BESIDE_CROSSING * self.problem.domain.scale
            middles = middles[np.linalg.norm(offsets, axis=1) > reach]
        return np.array(kept).reshape(-1, self.problem.n)

    # --- boxes ------------------------------------------------------------------------

    def open_boxes(self, boxes: _Boxes, most: int) -> _Boxes:
        """What is not settled when ``most`` of the boxes and of their parts were looked
        at."""
        smallest = SMALLEST * self.problem.domain.scale
        count, waiting, small, with_arcs, rooms, points, is_steady = self.tape.divide(
            np.ascontiguousarray(boxes.low),
            np.ascontiguousarray(boxes.high),
            self.centers,
            self.reaches,
            self.problem.domain.periods,
            smallest,
            most,
        )
        self.count += count
        self.left.append(_Boxes(*small).middles)
        boxes = _Boxes(*with_arcs)
        inner = _Boxes(*rooms)
        low, high = self.problem.domain.bounds.T
        is_within = (inner.low >= low) & (inner.high <= high)
        unknown = boxes.at(~self._are_known(_Arcs(points, is_steady, is_within)))
        widths = np.max(unknown.high - unknown.low, axis=1, initial=0.0)
        is_small = widths < 2.0 * smallest
        self.left.append(unknown.at(is_small).middles)
        quarters = unknown.at(~is_small).halves().halves()
        return _Boxes(*waiting).and_others(quarters)

    def look_next_to(self, places: np.ndarray) -> None:
        """Take as seeds what Newton's method reaches from ``places`` (k, n) and seems to
        lie on no branch: boxes that stay open may hold curves smaller than they are."""
        points, gaps = self.problem.project(places)
        points = points[closes_to_rounding(gaps)]
        points = points[self.problem.domain.are_inside(points)]
        points = points[~self._are_beside_points(points)]
        is_new = self._feet(points).branch < 0
        self.seeds = points[is_new][:ENOUGH]

    # --- arcs -------------------------------------------------------------------------

    def _are_known(self, arcs: _Arcs) -> np.ndarray:
        """Which arcs (k,) are known all along; a solution on each one that is in part
        inside the bounds and on no branch is found, and makes it known too."""
        points = arcs.points
        flat = points.reshape(-1, points.shape[2])
        sides = self._sides(flat).reshape(points.shape)
        outside = np.any(sides != 0, axis=2)
        feet = self._feet(flat)
        numbers = feet.branch.reshape(outside.shape)
        is_solved = (
            relative_gaps(self.problem, flat) < SOLVED * self.problem.domain.scale
        )
        is_solved = np.all(is_solved.reshape(outside.shape), axis=1)
        is_new = (numbers < 0) & ~outside & is_solved[:, None]
        new = np.any(is_new, axis=1)
        self.found.append(points[new, np.argmax(is_new[new], axis=1)])
        # an unknown that rises or falls all along passes a bound once
        is_steady = arcs.is_steady
        settled = is_solved.copy()
        for k in range(points.shape[1] - 1):
            before, after = sides[:, k], sides[:, k + 1]
            is_covered = self._are_covered(feet, points, k)
            stays = np.any((before == after) & (before != 0) & is_steady, axis=1)
            leaves = outside[:, k] != outside[:, k + 1]
            leaves &= np.all(is_steady | arcs.is_within, axis=1)
            settled &= is_covered | stays | leaves
        known: np.ndarray = new | settled
        return known

    def _are_covered(self, feet: _Feet, points: np.ndarray, k: int) -> np.ndarray:
        """On which arcs (j,) one branch runs straight from place ``k`` of the ``points``
        (j, 3, n), of which the ``feet`` are given, to the next."""
        numbers = feet.branch.reshape(points.shape[:2])
        arclengths = feet.s.reshape(points.shape[:2])
        travelled = np.abs(arclengths[:, k + 1] - arclengths[:, k])
        lengths = np.array(
            [*(b.length if b.closed else np.inf for b in self.branches), 0]
        )
        travelled = np.minimum(travelled, np.abs(lengths[numbers[:, k]] - travelled))
        chords = np.linalg.norm(points[:, k + 1] - points[:, k], axis=1)
        is_one = (numbers[:, k] == numbers[:, k + 1]) & (numbers[:, k] >= 0)
        covered: np.ndarray = is_one & (travelled < DETOUR * chords)
        return covered

    def _sides(self, points: np.ndarray) -> np.ndarray:
        """To which side (k, n) of the bounds points (k, n) lie outside, 0 inside."""
        low, high = self.problem.domain.bounds.T
        slack = self.problem.domain.slack
        is_above = (points > high + slack).astype(int)
        sides: np.ndarray = is_above - (points < low - slack)
        return sides

    def _feet(self, points: np.ndarray) -> _Feet:
        """The branches on which points (k, n) lie."""
        feet = _Feet(np.full(len(points), -1), np.zeros(len(points)))
        for number, branch in enumerate(self.branches):
            rest = np.flatnonzero(feet.branch < 0)
            distances, arclengths = branch.nearest(points[rest], within=self.within)
            is_on = is_same_point(distances, self.problem.domain.scale)
            feet.branch[rest[is_on]] = number
            feet.s[rest[is_on]] = arclengths[is_on]
        return feet


def _grid(box: np.ndarray) -> _Boxes:
    """About `FIRST_BOXES` equal boxes that fill one (n, 2)."""
    n = len(box)
    count = round(FIRST_BOXES ** (1.0 / n))
    marks = np.linspace(box[:, 0], box[:, 1], count + 1)
    numbers = np.indices((count,) * n).reshape(n, -1).T
    columns = np.arange(n)
    return _Boxes(marks[numbers, columns], marks[numbers + 1, columns])


WIDTH = 1e-6  # of the length: of the gap in a certificate where a branch is refuted


def audit_of(division: Subdivision) -> Audit:
    """What a complete subdivision says: nothing is missing; next to singular points
    that is not claimed."""
    nowhere = np.empty((0, division.left.shape[1]))
    kind, level = SearchClaim.BOXES, Level.COUNTED
    if division.beside:
        kind, level = SearchClaim.BOXES_BESIDE_POINTS, Level.CERTIFIED
    data = {"boxes": int(division.count), "beside": float(division.beside)}
    return Audit((kind.claim(Scope.MOTIONS, level, **data),), nowhere)


def refuted_at(traced: TracedBranch, s: float) -> TracedBranch:
    """The branch with a gap in its certificate about arclength ``s``, where it
    solves nothing."""
    certificate = traced.certificate
    if certificate is None:
        nothing = np.empty((0, 2))
        status = CertificateStatus.NOT_CERTIFIED
        certificate = Certificate(status, nothing, nothing, points=0, bound=np.inf)
    half = WIDTH * traced.branch.length
    gap = np.clip([[s - half, s + half]], 0.0, traced.branch.length)
    return replace(traced, certificate=certificate.with_gaps(gap))
