"""From a start to the branch through it, as it is recorded."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import Deflated, lower_rank_direction
from bifurc.curves.misclosure import largest_misclosure
from bifurc.decisions import (
    closes_to_rounding,
    is_plainly_closed_curve,
    is_solution,
    is_stub,
    may_be_shaky,
)
from bifurc.numerics.blur import blur_along
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.branches.branch_examination import BranchExaminer, ExaminedBranch
from bifurc.search.branches.certification import finer_settings, may_be_mended
from bifurc.search.findings import Run
from bifurc.search.near_motion_search import NearMotionSearch
from bifurc.search.records import NO_DOUBT, Start
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.settings import TraceSettings

log = logging.getLogger(__name__)

# Of the slack of a bound: what is nearer to it runs in it.
IN_BOUND = 0.1
LEAVING_STUB = 20  # times shorter: a branch that leaves the bounds and is none
# A curve is traced at a misclosure a little above what it may have: the largest one
# along it, measured afterwards, decides.
LENIENT = 4.0 * is_solution.threshold
SAMPLES = 256  # of a curve, by which it is told whether it enters the bounds
LOOKS_ALONG = 5  # on a branch, for a rank that is lower all along it


class Trace(NamedTuple):
    """What a start lies on, None for no branch at all, and the starts on the branches
    that leave from there."""

    fate: SeedFate | None
    starts: Sequence[Start] = ()


class Tracer:
    """Traces branches of a ``run``, with an ``examiner`` of what is new and a search for
    ``near_motions``."""

    def __init__(
        self, run: Run, examiner: BranchExaminer, near_motions: NearMotionSearch
    ):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings
        self.examiner = examiner
        self.near_motions = near_motions

    def branch_off(self, starts: Sequence[Start]) -> None:
        """Trace the branches through the starts, and everything that hangs on them."""
        queue = list(starts)
        while queue and not self.run.is_over:
            queue += self.trace(queue.pop()).starts

    def trace(self, start: Start, is_new: bool = False) -> Trace:
        """Trace the branch through a start, unless it is known; where the start ``is_new``
        it is not one of those along which it seems to run."""
        fate = self.findings.branch_through(start.point)
        if fate is not None:
            return Trace(fate)
        branch = self.follow(start, self.run.settings.tracing)
        is_open = branch.outcome is Outcome.OPEN
        if is_open:
            self.findings.gaps.append(branch.gap)
        if not self.is_curve(branch):
            log.info("no curve through %s: %s", start.point, branch.outcome.value)
            return Trace(SeedFate(Fate.NO_SOLUTION) if is_open else None)
        # by rounding over a small singular value a start may lie beside its curve
        fate = None if is_new else self.findings.branch_along(branch)
        if fate is None:
            fate = self._fate_at_lower_rank(branch)
        if fate is not None:
            return Trace(fate)
        misclosure = largest_misclosure(self.problem, branch)
        has_failed = branch.outcome is Outcome.STALLED
        if not is_solution(misclosure) or (
            has_failed and not closes_to_rounding(misclosure)
        ):
            fate = self.near_motions.through(start.point)
            if fate is not None:
                return Trace(fate)
        examined = self.examiner.examine(branch, misclosure)
        if examined.traced.is_refused and may_be_mended(self.problem, examined.traced):
            examined = self._finer(start, examined)
            fate = self.findings.branch_along(examined.traced.branch)
        if fate is None:
            fate = self.findings.add_branch(examined.traced)
        return Trace(fate, examined.starts)

    def follow(self, start: Start, settings: TraceSettings) -> Branch:
        """The branch through a start."""
        deadline = self.run.deadline
        return trace_branch(self.problem, *start, settings, LENIENT, deadline)

    def _finer(self, start: Start, coarse: ExaminedBranch) -> ExaminedBranch:
        """The branch traced again, ever finer, until its certificate holds, or the
        one of which least is refused; with the starts that all of them led to."""
        best = coarse.traced
        starts = coarse.starts
        for settings in finer_settings(self.run.settings.tracing):
            if self.run.is_over:
                break
            branch = self.follow(start, settings)
            if not self.is_curve(branch):
                continue
            finer = self.examiner.examine(branch)
            starts += finer.starts
            if finer.traced.doubt < best.doubt:
                best = finer.traced
            if best.doubt == NO_DOUBT:
                break
        return ExaminedBranch(best, starts)

    # --- curves of lower rank ---------------------------------------------------------

    def _fate_at_lower_rank(self, branch: Branch) -> SeedFate | None:
        """Trace a branch again where F' has a lower rank all along it, as it was
        corrected to half the digits only; None where it has not."""
        if self.problem.n < 2:
            return None
        # not at its ends: what is traced from a bound may leave there at once
        inner = np.linspace(0.0, branch.length, LOOKS_ALONG + 2)[1:-1]
        points = branch(inner)
        values = singular_values(self.problem, points)
        if not np.all(may_be_shaky(values[:, self.problem.n - 2])):
            return None
        clearest = np.argmax(values[:, self.problem.n - 3])
        return self.trace_lower_rank(points[clearest])

    def trace_lower_rank(self, point: np.ndarray) -> SeedFate | None:
        """Trace the curve through a point (n,) all along which F' has rank n - 2, None
        where there is none; what may cross it is left to other seeds."""
        direction = lower_rank_direction(self.problem, point)
        if direction is None:
            return None
        branch = self.follow_deflated(Deflated(self.problem), Start(point, direction))
        if branch is None:
            return None
        return self.findings.add_branch(self.examiner.examine(branch).traced)

    def follow_deflated(self, deflated: Problem, start: Start) -> Branch | None:
        """The branch through a start, followed with a ``deflated`` problem; None where
        there is no curve."""
        tracing, deadline = self.run.settings.tracing, self.run.deadline
        closing = is_solution.threshold
        branch = trace_branch(deflated, *start, tracing, closing, deadline)
        if self.is_curve(branch):
            return branch
        outcome = branch.outcome.value
        log.info("no curve of lower rank through %s: %s", start.point, outcome)
        return None

    # --- what is a curve --------------------------------------------------------------

    def is_curve(self, branch: Branch) -> bool:
        """Whether a traced branch is more than the trace of rounding beside a singular
        point."""
        if not len(branch.pieces):
            return False
        if branch.closed:
            blur = blur_along(self.problem, branch) * self.problem.domain.scale
            return is_plainly_closed_curve(blur, branch.length)
        unit = self.problem.domain.scale
        if branch.outcome is Outcome.STALLED:
            return not is_stub(branch.length, unit)
        unit /= LEAVING_STUB
        depths = -self.problem.domain.excess(branch.sample(SAMPLES))
        slack = self.problem.domain.slack
        if not is_stub(branch.length, unit):
            # beyond a bound that it touches rounding lets a curve go on
            only_touches = depths.max() < IN_BOUND * slack < -depths.min()
            return not only_touches
        # what is short between two bounds is an arc of the longer curve beyond them,
        # unless it only touches them from outside
        if is_stub(branch.trusted_length, unit):
            return False
        return float(depths.max()) > slack
