"""Certificates: a traced curve lies on one arc of solutions and has not jumped to
another.

At a place s of the dense curve u let t = u'(s), and let G = L^T F be n - 1 combinations
of the equations with G'(u(s)) V = I for a matrix V (n, n - 1) across t. In the slice
through u(s) across t the equations are g(y) = G(u(s) + V y) = 0, with g'(0) = I. If

    omega |g(0)| < 1/2,    |g'(y) - g'(z)| <= omega |y - z|,

there is one solution with |y| <= 2 |g(0)|, and no other in a ball that is larger, by
the theorem of Newton and Kantorovich in its affine invariant form (Deuflhard 2004,
theorem 2.1). Where that holds for all s from one place to another, the solutions of the
slices change continuously, by the implicit function theorem, and are one arc: it passes
through every slice once, and the traced curve cannot have left it. It is checked for
all s, not only at samples: see `bifurc.curves.kantorovich`. Where pieces meet, what is
left between them is added to |g(0)|.

omega is K |V|^2 where K bounds F''. Near a surface of solutions V is large in one
direction w, in which F'' is as small. There omega is taken from F''(u(s))(V y, V z)
itself, with the weakest component of y and the others on scales of their own, and with
what F'' may change by within the ball.

Every solution of F solves G, whatever the number of equations. That F has solutions at
all is not claimed: an overdetermined system may fail to have them by less than
rounding. The check is made in doubles, without interval arithmetic: |g(0)| counts as
2e-15 at least. Where that is too large for omega, which is about 1 / sigma^2 beside a
bifurcation, doubles cannot tell a single arc from two that cross, and the certificate
says where.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import pairwise
from typing import TypedDict

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.kantorovich import NODE_COUNT, Joints, check_arcs
from bifurc.curves.monitor import Profile
from bifurc.system import System

# distance, in scales, at which an arc is handed over to a located singular point
HANDOVER = 1e-3
SHORTEST = 1e-9  # arc, in scales, that is not divided any more
AT_ONCE = 400  # arcs that are looked at together
# arcs of one branch, and for each piece: a curve that needs more is left uncertified
MOST = 1000
MOST_OF_PIECE = 30
TOUCHING = 1e-12  # of the length: intervals so near to each other are one


class CertificateStatus(StrEnum):
    """What was certified of a branch."""

    # The whole branch is one arc.
    CERTIFIED = "certified"
    # Each stretch between two located singular points is one arc.
    UP_TO_SINGULAR_POINTS = "certified up to the singular points"
    # So is each stretch between places where F' is singular to within rounding.
    UP_TO_ROUNDING = "certified up to places singular to rounding"
    # Somewhere the theorem does not hold, or no bound on F'' is known.
    NOT_CERTIFIED = "not certified"


class CertificateValues(TypedDict):
    """A certificate in values that JSON can hold."""

    status: str
    gaps: list[list[float]]
    blurred: list[list[float]]
    points: int
    bound: float


@dataclass(frozen=True, eq=False)
class Certificate:
    """What was certified of a branch, and where not.

    ``gaps`` (g, 2) are the arclengths between which the theorem does not hold,
    ``blurred`` (b, 2) those between which F' is singular to within rounding, so that
    doubles do not tell arcs apart; ``points`` at how many places F was evaluated,
    ``bound`` the constant K, infinite where none is known.
    """

    status: CertificateStatus
    gaps: np.ndarray
    blurred: np.ndarray
    points: int
    bound: float

    @property
    def holds(self) -> bool:
        """Whether nothing is left out but singular points, located or not."""
        return self.status is not CertificateStatus.NOT_CERTIFIED

    @property
    def leaves_doubt(self) -> bool:
        """Whether anything is left out but located singular points."""
        return bool(len(self.gaps) or len(self.blurred))

    @property
    def refused_length(self) -> float:
        """Arclength of all gaps."""
        return float(np.diff(self.gaps, axis=1).sum())

    def with_gaps(self, gaps: np.ndarray) -> Certificate:
        """The certificate with further gaps (g, 2)."""
        status = CertificateStatus.NOT_CERTIFIED
        return replace(self, status=status, gaps=_merged([self.gaps, gaps], 0.0))

    def as_values(self) -> CertificateValues:
        """The certificate in values that JSON can hold."""
        return {
            "status": self.status.value,
            "gaps": self.gaps.tolist(),
            "blurred": self.blurred.tolist(),
            "points": self.points,
            "bound": self.bound,
        }

    @staticmethod
    def from_values(values: CertificateValues) -> Certificate:
        """The certificate that `as_values` wrote down."""
        return Certificate(
            status=CertificateStatus(values["status"]),
            gaps=_intervals(values["gaps"]),
            blurred=_intervals(values["blurred"]),
            points=values["points"],
            bound=values["bound"],
        )


def certify_branch(
    problem: System, branch: Branch, profile: Profile, singular: Sequence[float] = ()
) -> Certificate:
    """Whether the dense curve follows one arc from every singular point to the next.

    ``singular`` are the arclengths of located singular points, next to which nothing is
    claimed. Nothing is certified without `Problem.curvature`, nor where F' has a lower
    rank all along. Raises nothing: what is missing is in the result.
    """
    curvature = problem.curvature
    nowhere = np.empty((0, 2))
    is_curve = branch.length > 0 and profile.rank >= problem.n - 1
    if curvature is None or not is_curve:
        whole = np.array([[0.0, branch.length]])
        status = CertificateStatus.NOT_CERTIFIED
        return Certificate(status, whole, nowhere, points=0, bound=np.inf)
    handover = HANDOVER * problem.domain.scale
    survey = _Survey(problem, branch)
    survey.look_at(_arcs_between(branch, singular, handover))
    gaps, blurred = survey.refused(widest_blur=2 * handover)
    status = CertificateStatus.CERTIFIED
    if len(singular):
        status = CertificateStatus.UP_TO_SINGULAR_POINTS
    if len(gaps):
        status = CertificateStatus.NOT_CERTIFIED
    elif len(blurred):
        status = CertificateStatus.UP_TO_ROUNDING
    return Certificate(status, gaps, blurred, survey.points, float(curvature.bound))


class _Survey:
    """What has been seen of a branch so far: arcs on which the theorem holds are done
    with, what is refused is divided and looked at again, as long as that may help."""

    def __init__(self, problem: System, branch: Branch):
        self.points = 0
        self._problem = problem
        self._branch = branch
        self._joints = Joints.of(problem, branch)
        self._open: list[np.ndarray] = []
        self._closed: list[np.ndarray] = []

    def look_at(self, arcs: np.ndarray) -> None:
        """Look at arcs (a, 2), and at parts of them, until nothing more can be had."""
        most = MOST + MOST_OF_PIECE * len(self._branch.pieces)
        looked_at = 0
        while len(arcs) and looked_at + len(arcs) <= most:
            looked_at += len(arcs)
            parts: list[np.ndarray] = []
            for first in range(0, len(arcs), AT_ONCE):
                parts += self._refused_parts(arcs[first : first + AT_ONCE])
            arcs = np.concatenate([np.empty((0, 2)), *parts])
        self._open.append(arcs)
        self.points = looked_at * NODE_COUNT

    def _refused_parts(self, arcs: np.ndarray) -> Iterator[np.ndarray]:
        """Parts (p, 2) of those of the arcs (a, 2) that are refused, to look at
        again."""
        checks = check_arcs(self._problem, self._branch, arcs, self._joints)
        for k in np.flatnonzero(~checks.holds.all(axis=1)):
            refused = _runs(checks.edges[k], ~checks.holds[k])
            is_long = np.ptp(arcs[k]) > SHORTEST * self._problem.domain.scale
            if checks.is_promising[k] and is_long:
                yield _divided(refused, arcs[k])
            elif checks.is_closed[k]:
                self._closed.append(refused)
            else:
                self._open.append(refused)

    def refused(self, widest_blur: float) -> tuple[np.ndarray, np.ndarray]:
        """Intervals (g, 2) and (b, 2) on which the theorem does not hold: those where F
        is not zero or that are too wide, and those where only rounding is in the
        way."""
        touching = TOUCHING * self._branch.length
        dark = _merged(self._closed, touching)
        is_narrow = np.diff(dark, axis=1)[:, 0] <= widest_blur
        gaps = _merged([*self._open, dark[~is_narrow]], touching)
        return self._in_turn(gaps), self._in_turn(dark[is_narrow])

    def _in_turn(self, intervals: np.ndarray) -> np.ndarray:
        """Intervals (k, 2) with their begins on the first turn of a closed curve."""
        if not self._branch.closed or not len(intervals):
            return intervals
        turns = np.floor(intervals[:, :1] / self._branch.length)
        shifted: np.ndarray = intervals - turns * self._branch.length
        return shifted[np.argsort(shifted[:, 0], kind="stable")]


# --- intervals of arclength -----------------------------------------------------------


def _arcs_between(
    branch: Branch, singular: Sequence[float], handover: float
) -> np.ndarray:
    """Arcs (a, 2), each within one piece, of all that is farther than ``handover`` from
    singular points."""
    inner = branch.breaks
    if branch.closed:
        inner = np.concatenate([branch.breaks[:-1], branch.breaks + branch.length])
    arcs = [np.empty((0, 2))]
    for low, high in _stretches(branch, singular, handover):
        between = inner[(inner > low) & (inner < high)]
        edges = np.concatenate([[low], between, [high]])
        arcs.append(np.column_stack([edges[:-1], edges[1:]]))
    return np.concatenate(arcs)


def _stretches(
    branch: Branch, singular: Sequence[float], handover: float
) -> list[tuple[float, float]]:
    """The intervals of arclength that remain when a neighbourhood of every singular
    point is left out."""
    stops = sorted(singular)
    if not stops:
        return [(0.0, branch.length)]
    on_circle = [*stops, stops[0] + branch.length]
    on_line = [-handover, *stops, branch.length + handover]
    edges = on_circle if branch.closed else on_line
    stretches = []
    for left, right in pairwise(edges):
        low, high = left + handover, right - handover
        if high > low:
            stretches.append((low, high))
    return stretches


def _divided(refused: np.ndarray, arc: np.ndarray) -> np.ndarray:
    """Refused intervals (r, 2) of an arc (2,); one that is most of it, in halves."""
    is_most = np.diff(refused, axis=1)[:, 0] > 0.5 * np.ptp(arc)
    low, high = refused[is_most].T
    middle = 0.5 * (low + high)
    first = np.column_stack([low, middle])
    second = np.column_stack([middle, high])
    return np.concatenate([refused[~is_most], first, second])


def _runs(s: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Begin and end (r, 2) of every run of consecutive intervals ``where`` (k - 1,)
    between the arclengths s (k,)."""
    inside = np.concatenate([[0], where, [0]])
    change = np.diff(inside)
    begins = s[change == 1]
    ends = s[change == -1]
    return np.column_stack([begins, ends])


def _merged(parts: Sequence[np.ndarray], touching: float) -> np.ndarray:
    """Intervals (k, 2) in order, those that touch joined."""
    intervals = np.concatenate([np.empty((0, 2)), *parts])
    merged: list[list[float]] = []
    for low, high in intervals[np.argsort(intervals[:, 0], kind="stable")]:
        if merged and low <= merged[-1][1] + touching:
            merged[-1][1] = max(merged[-1][1], high)
        else:
            merged.append([low, high])
    return _intervals(merged)


def _intervals(rows: list[list[float]]) -> np.ndarray:
    """Intervals (k, 2) from their begins and ends, also where there are none."""
    return np.array(rows).reshape(-1, 2)
