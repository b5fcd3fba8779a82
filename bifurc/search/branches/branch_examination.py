"""What a traced branch is: its profile, the singular points along it, its certificate."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.certificate import Certificate
from bifurc.curves.deflation import ORDINARY, LowerRank, lower_rank_along
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.misclosure import largest_misclosure
from bifurc.curves.monitor import Profile, profile_branch
from bifurc.decisions import (
    is_deep_place,
    is_passed,
    is_singular_to_rounding,
    may_be_crossed,
    may_be_known,
)
from bifurc.numerics.blur import blur_along
from bifurc.numerics.singular_values import singular_values
from bifurc.search.branches.canonical_course import canonical_course
from bifurc.search.branches.certification import certificate_of
from bifurc.search.findings import Run
from bifurc.search.point_search import BRANCH_REACH, PointSearch
from bifurc.search.records import PointSighting, Start, TracedBranch, half_branch_starts
from bifurc.singular.locate import LocatedPoint

ABOUT = 16  # nodes before and after a deep place that are not lower: those of a piece
BESIDE = 3 * ABOUT  # and among which some are far higher, as a whole piece may be flat
BESIDE_END = np.array([0.0, 0.01, 0.02])  # of a stalled branch: starts for a cusp
CUSP_REACH = 0.2  # how far from there the cusp may lie
# Of a point, over the scale, that deflation gives: no germ separates double curves.
DEFLATED_ERROR = 1e-10


class ExaminedBranch(NamedTuple):
    """A branch with what was seen along it, and the starts on the branches through the
    singular points that are new."""

    traced: TracedBranch
    starts: list[Start]


class _Candidate(NamedTuple):
    """A place on a branch to look for a singular point.

    ``looks`` are the arclengths (k,) of the starts, of which the first one that leads
    to a singular point counts. Singular values below ``zero`` count as zero. ``reach``
    is how far away the point may lie, in units of the problem's scale. Where there
    ``must_be`` one, none that is located is said to be missing.
    """

    looks: np.ndarray
    zero: float
    reach: float = BRANCH_REACH
    must_be: bool = False


class _Sightings(NamedTuple):
    """What is seen along a branch, to which more is added: the arclengths ``located``
    of minima that lead to singular points, ``passes`` of points on the branch,
    ``missing`` where one must be, and the starts from new points."""

    located: list[float]
    passes: list[float]
    missing: list[float]
    starts: list[Start]


class BranchExaminer:
    """Looks for the singular points along branches of a ``run`` with a search for
    ``points``."""

    def __init__(self, run: Run, points: PointSearch):
        self.run = run
        self.problem = run.problem
        self.points = points

    def examine(
        self, branch: Branch, misclosure: float | None = None
    ) -> ExaminedBranch:
        """Look for the singular points on a branch with a ``misclosure``, which is
        measured unless given, and certify it between them."""
        if misclosure is None:
            misclosure = largest_misclosure(self.problem, branch)
        branch = canonical_course(self.problem, branch)
        profile = profile_branch(self.problem, branch)
        minima = singular_value_minima(self.problem, branch, profile)
        candidates = []
        if profile.rank:  # where F' vanishes all along nothing of it tells places apart
            candidates = _small_minima(*minima)
            candidates += _deep_places(profile, minima[0])
            candidates += self._candidate_ends(branch, profile)
        lower = ORDINARY
        if profile.rank < branch.n - 1:
            lower = lower_rank_along(self.problem, branch, profile)
        sightings = _Sightings([], [], [], [])
        self._sight_crossings(branch, lower, sightings)
        self._sight_candidates(branch, candidates, misclosure, sightings)
        certificate = None
        if self.run.settings.certify:
            certificate = self._certified(branch, profile, misclosure, sightings)
        traced = TracedBranch(
            branch=branch,
            profile=profile,
            minima=minima,
            located=tuple(sightings.located),
            misclosure=misclosure,
            blur=blur_along(self.problem, branch),
            passes=tuple(sightings.passes),
            missing=tuple(sightings.missing),
            certificate=certificate,
            multiplicity=lower.multiplicity,
        )
        return ExaminedBranch(traced, sightings.starts)

    def _certified(
        self,
        branch: Branch,
        profile: Profile,
        misclosure: float,
        sightings: _Sightings,
    ) -> Certificate | None:
        """What is certified of a branch with a ``misclosure`` between the singular
        points seen along it, to which those are added that lie where F' is singular to
        rounding: dips of the singular value between two nodes show only there."""
        certificate = certificate_of(self.problem, branch, profile, sightings.passes)
        if certificate is None:
            return None
        known = len(sightings.passes)
        dark = certificate.blurred.mean(axis=1) % branch.length
        zero = may_be_crossed.threshold
        candidates = [_Candidate(s[None], zero) for s in dark]
        self._sight_candidates(branch, candidates, misclosure, sightings)
        if len(sightings.passes) == known:
            return certificate
        return certificate_of(self.problem, branch, profile, sightings.passes)

    def _sight_candidates(
        self,
        branch: Branch,
        candidates: list[_Candidate],
        misclosure: float,
        sightings: _Sightings,
    ) -> None:
        """Add what the candidates on a branch with a ``misclosure`` lead to."""
        for candidate in candidates:
            if self.run.is_over:
                break
            place = float(candidate.looks[0])
            sighting = self._examine_candidate(branch, candidate, misclosure)
            if sighting is None:
                if candidate.must_be:
                    sightings.missing.append(place)
                continue
            sightings.located.append(place)
            gap = self.problem.domain.difference(branch(place), sighting.point.u)
            beside = float(np.linalg.norm(gap)) - sighting.point.error
            if is_passed(beside, self.problem.domain.scale):  # and not only near it
                sightings.passes.append(place)
                sighting = self.points.seen_on_curve(sighting)
            if sighting.is_new:
                sightings.starts.extend(half_branch_starts(sighting.point))

    def _sight_crossings(
        self, branch: Branch, lower: LowerRank, sightings: _Sightings
    ) -> None:
        """Add the points at which others meet a branch of lower rank."""
        for place in lower.crossings.tolist():
            if self.run.is_over:
                break
            u = branch(place)
            jacobian = self.problem.jacobians(u[None])[0]
            _, _, right = np.linalg.svd(jacobian)
            null_space = right[self.problem.n - 2 :].T
            error = DEFLATED_ERROR * self.problem.domain.scale
            sighting = self.points.sight(LocatedPoint(u, null_space, error))
            sightings.passes.append(place)
            if sighting.is_new:
                sightings.starts.extend(half_branch_starts(sighting.point))

    def _candidate_ends(self, branch: Branch, profile: Profile) -> list[_Candidate]:
        """The ends of an open branch where a singular point may lie."""
        if branch.closed:
            return []
        if branch.outcome is Outcome.STALLED:
            # It stalls before a cusp or beyond it: how far hangs on rounding, and so
            # does it whether the point is reached from one start.
            offsets = np.minimum(
                self.problem.domain.scale * BESIDE_END, 0.5 * branch.length
            )
            stretches = (offsets, branch.length - offsets)
            return [
                _Candidate(looks, 10 * may_be_crossed.threshold, CUSP_REACH)
                for looks in stretches
            ]
        # An end is no minimum, and yet a singular point may lie there.
        ends = np.array([0.0, branch.length])
        values = singular_values(self.problem, branch(ends))[:, profile.rank - 1]
        return [
            _Candidate(end[None], may_be_crossed.threshold)
            for end in ends[may_be_crossed(values)]
        ]

    def _examine_candidate(
        self, branch: Branch, candidate: _Candidate, misclosure: float
    ) -> PointSighting | None:
        """The singular point to which the looks of a candidate lead, on a branch with a
        ``misclosure``."""
        for arclength in candidate.looks:
            near = branch(arclength)
            known = self.run.findings.point_at(near, 0.0, may_be_known)
            if known is not None and known.point.dimension == 1:
                return known
            values = singular_values(self.problem, near[None])[0]
            nullity = int(np.count_nonzero(values < candidate.zero))
            if nullity < 2:
                continue
            sighting = self.points.near(near, nullity, candidate.reach, misclosure)
            if sighting is not None:
                return sighting
        return None


def _deep_places(profile: Profile, minima: np.ndarray) -> list[_Candidate]:
    """Nodes of a profile where the singular value is far smaller than a little before
    and a little after, and no minimum (k,) is near.

    Beside a surface that value is so small all along that its slope is lost in
    rounding, by which minima are found.
    """
    values = profile.smallest.ravel()
    arclengths = profile.arclength.ravel()
    candidates = []
    for k in _lowest(values, may_be_crossed(values)):
        before = values[max(k - BESIDE, 0) : k].max(initial=0.0)
        after = values[k + 1 : k + 1 + BESIDE].max(initial=0.0)
        beside = arclengths[max(k - 1, 0) : k + 2]
        is_found = (minima >= beside[0]) & (minima <= beside[-1])
        is_deep = is_deep_place(float(values[k]), float(min(before, after)))
        if is_deep and not np.any(is_found):
            candidate = _Candidate(
                looks=arclengths[k : k + 1],
                zero=may_be_crossed.threshold,
                must_be=bool(is_singular_to_rounding(values[k])),
            )
            candidates.append(candidate)
    return candidates


def _lowest(values: np.ndarray, is_small: np.ndarray) -> list[int]:
    """Numbers of those of the small values in a row (k,) that are the lowest of those
    about them; of equal ones the last."""
    falls = np.concatenate([[True], values[1:] <= values[:-1]])
    rises = np.concatenate([values[1:] > values[:-1], [True]])
    bottoms = np.flatnonzero(is_small & falls & rises).tolist()
    return [
        k
        for k in bottoms
        if values[k] <= values[max(k - ABOUT, 0) : k + ABOUT + 1].min()
    ]


def _small_minima(arclengths: np.ndarray, values: np.ndarray) -> list[_Candidate]:
    """Minima (k,) of the singular value that may be singular points."""
    candidates = []
    for k in np.flatnonzero(may_be_crossed(values)):
        zero = max(may_be_crossed.threshold, 3 * float(values[k]))
        candidates.append(_Candidate(arclengths[k : k + 1], zero))
    return candidates
