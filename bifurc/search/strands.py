"""What the curves about a singular point must do inside: a check by parity.

A disc about the point in its null space is entered and left by strands of curves. Two of
them whose ends alternate on its rim cross an odd number of times inside, others an even
number of times (Jordan's curve theorem). Each crossing that is known shows, in the same
way, on a disc of its own. Where both do not agree a crossing is missing.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_same_line
from bifurc.problem import Problem
from bifurc.singular.point import SingularPoint

# Radii of discs, over the scale: of a plane curve, and where the curves lie on a surface
# of which the null space is tangent.
IN_PLANE, ON_SURFACE = 0.03, 1e-5
LONGEST = 4.0  # radii: a strand that is longer to either side is none
SAMPLES = 400  # of a strand to either side
FIRST = 16  # of these: those next to the rim, among which it leaves as a rule
AT_POINT = 1e-9  # over the scale: how near to a crossing its strands come
SHARP = 0.1  # of a disc: where its middle is known no better it shows nothing
CLEAR = 1e-3  # rad: ends that are nearer to each other on a rim do not tell


class MissingCrossing(NamedTuple):
    """A ``place`` (n,) next to a point, by its number, about which two curves, by their
    numbers, cross once more."""

    point: int
    curves: tuple[int, int]
    place: np.ndarray


class _Strand(NamedTuple):
    """A stretch of a curve, by its number, inside a disc, between two ``arclengths`` (2,);
    its ``ends`` (2, 2) in the null space, from the middle."""

    curve: int
    arclengths: np.ndarray
    ends: np.ndarray


def missing_crossings(
    problem: Problem, points: Sequence[SingularPoint], branches: Sequence[Branch]
) -> Iterator[MissingCrossing]:
    """The crossings that are missing among singular ``points`` of ``branches``."""
    reach = (IN_PLANE if problem.n == 2 else ON_SURFACE) * problem.domain.scale
    for number, point in enumerate(points):
        is_sharp = point.error < SHARP * reach
        if not is_sharp or point.null_space.shape[1] != 2 or point.dimension != 1:
            continue
        disc = _Disc(problem, point, branches, reach)
        beside = problem.domain.difference(np.array([p.u for p in points]), point.u)
        inside = np.flatnonzero(np.linalg.norm(beside, axis=1) < reach)
        known = [points[k] for k in inside.tolist()]
        for one, other in itertools.combinations(disc.strands, 2):
            place = disc.missing_of(one, other, known)
            if place is not None:
                yield MissingCrossing(number, (one.curve, other.curve), place)


class _Disc:
    """A disc about a singular ``point`` with the strands of ``branches`` in it."""

    def __init__(
        self,
        problem: Problem,
        point: SingularPoint,
        branches: Sequence[Branch],
        radius: float,
    ):
        self.problem = problem
        self.branches = branches
        self.point = point
        self.radius = radius
        self.strands = [
            strand
            for curve, branch in enumerate(branches)
            for strand in self._strands_of(curve, branch)
        ]

    def _strands_of(self, curve: int, branch: Branch) -> Iterator[_Strand]:
        """The strands of one branch that enter the disc and leave it."""
        begin = -np.inf
        for s in branch.passes(self.point.u, self.radius).tolist():
            if s <= begin:
                continue
            arclengths = self._leaves(branch, s)
            if arclengths is None:
                continue
            begin = float(arclengths[1])
            ends = self._gaps(branch, arclengths) @ self.point.null_space
            yield _Strand(curve, arclengths, ends)

    def _leaves(self, branch: Branch, s: float) -> np.ndarray | None:
        """The arclengths (2,) at which a branch has left the disc to either side of
        ``s``; None where it does not.

        As long as it is no longer than what is left of the radius it cannot have left.
        """
        reach = min(LONGEST * self.radius, 0.5 * branch.length)
        inside = self.radius - np.linalg.norm(self._gaps(branch, s))
        shares = np.arange(1, SAMPLES + 1) / SAMPLES
        first = int(np.searchsorted(shares, inside / reach))
        for sampled in (shares[first : first + FIRST], shares[first:]):
            arclengths = s + reach * np.array([-sampled, sampled])  # (2, k)
            if not branch.closed:
                arclengths = np.clip(arclengths, 0.0, branch.length)
            distances = np.linalg.norm(self._gaps(branch, arclengths), axis=2)
            is_out = distances >= self.radius
            if np.all(np.any(is_out, axis=1)):
                return arclengths[[0, 1], is_out.argmax(axis=1)]
        return None

    def _gaps(self, branch: Branch, arclengths: np.ndarray | float) -> np.ndarray:
        """How far (..., n) from the middle a branch is at arclengths (...)."""
        return self.problem.domain.difference(branch(arclengths), self.point.u)

    def missing_of(
        self, one: _Strand, other: _Strand, known: Sequence[SingularPoint]
    ) -> np.ndarray | None:
        """Where two strands cross besides the ``known`` points, next to the middle (n,);
        None where they do not have to, or their ends do not tell."""
        is_odd = _alternate(one.ends, other.ends)
        if is_odd is None:
            return None
        for point in known:
            is_crossed = self._cross_at(one, other, point)
            if is_crossed is None:
                return None
            is_odd ^= is_crossed
        if not is_odd:
            return None
        return self._place_of(one, other, known)

    def _cross_at(
        self, one: _Strand, other: _Strand, point: SingularPoint
    ) -> bool | None:
        """Whether two strands cross at a point; None where that does not show."""
        tangents = []
        for strand in (one, other):
            branch = self.branches[strand.curve]
            within = AT_POINT * self.problem.domain.scale + 2.0 * point.error
            low, high = strand.arclengths
            passes = branch.passes(point.u, within)
            if branch.closed:
                passes = low + (passes - low) % branch.length
            passes = passes[(passes >= low) & (passes <= high)]
            if len(passes) > 1:
                return None  # it comes back
            if not len(passes):
                return False
            tangents.append(branch(float(passes[0]), 1))
        cosine = abs(float(tangents[0] @ tangents[1]))
        cosine /= float(np.prod(np.linalg.norm(tangents, axis=1)))
        return None if is_same_line(1.0 - cosine) else True

    def _place_of(
        self, one: _Strand, other: _Strand, known: Sequence[SingularPoint]
    ) -> np.ndarray:
        """Where two strands come nearest to each other, away from the known points."""
        u, offsets = self._sampled(one)
        _, others = self._sampled(other)
        apart = np.linalg.norm(offsets[:, None] - others[None], axis=2)
        spacing = float(np.linalg.norm(np.diff(offsets, axis=0), axis=1).max())
        for point in known:
            gaps = self.problem.domain.difference(u, point.u)
            apart[np.linalg.norm(gaps, axis=1) < spacing] = np.inf
        nearest = np.unravel_index(np.argmin(apart), apart.shape)[0]
        place: np.ndarray = u[nearest]
        return place

    def _sampled(self, strand: _Strand) -> tuple[np.ndarray, np.ndarray]:
        """Points (k, n) all along a strand, and their offsets (k, 2) from the middle in
        the null space."""
        begin, end = strand.arclengths
        arclengths = np.linspace(begin, end, 2 * SAMPLES + 1)
        u = self.branches[strand.curve](arclengths)
        gaps = self.problem.domain.difference(u, self.point.u)
        return u, gaps @ self.point.null_space


def _alternate(one: np.ndarray, other: np.ndarray) -> bool | None:
    """Whether the ends (2, 2) of two strands alternate on a rim; None where two of them
    are too near to each other to tell."""
    angles = np.arctan2(*np.concatenate([one, other]).T[::-1])
    turns = (angles - angles[0]) % (2.0 * np.pi)
    gaps = np.diff(np.sort(np.append(turns, 2.0 * np.pi)))
    if gaps.min() < CLEAR:
        return None
    return bool(np.count_nonzero(turns[2:] < turns[1]) == 1)
