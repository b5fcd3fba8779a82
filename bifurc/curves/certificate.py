"""Certificates: a traced curve lies on one arc of solutions and has not jumped to
another.

Let G be the n - 1 combinations of F whose derivatives are independent at x0 (the left
singular vectors of F'(x0)), sigma their smallest singular value, t the unit tangent,
and K a Lipschitz constant of F'. In the ball |x - x0| <= r with K r < sigma every
hyperplane across t holds at most one zero of G, because there |G(x) - G(y)| >= (sigma -
K r) |x - y|, and the zeros form a graph over t with slope at most K r / (sigma - K r):
the uniqueness part of the theorem of Newton and Kantorovich, with the tangent as
parameter (Ortega and Rheinboldt 1970, 12.6; Deuflhard 2004, 4.4). With K r = sigma / 2
the slope is at most 1, so that the arc from x0 runs at least r / sqrt(2) far in the
ball: two solutions closer than sigma / (2 sqrt(2) K) lie on one arc.

The points are as far apart as sigma lets them be: their number is about 3 K times the
integral of 1 / sigma along the curve, which grows with the logarithm of 1 / width
beside a near miss.

The check is made in doubles, without interval arithmetic. Existence is another matter:
an overdetermined system may fail to have solutions by less than rounding. What is
certified is that whatever solves it here is a single arc. Where sigma^2 is not far
above rounding times K, doubles cannot tell a single arc from two that cross, and the
certificate says where.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import TypedDict

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.kantorovich import SHARE, Samples, sample_curve
from bifurc.curves.monitor import Profile
from bifurc.problem import Problem

__all__ = ["Certificate", "CertificateStatus", "CertificateValues", "certify_branch"]

# distance, in scales, at which an arc is handed over to a located singular point
HANDOVER = 1e-3
MOST = 1_000_000  # points of one branch: a curve that needs more is left uncertified
AT_ONCE = 20_000  # points that are looked at together
ROUNDS = 12  # of adding points where those chosen before are too far apart
# singular value, over the magnitude, below which more points do not help
RESOLVED = 1e-7
CLOSER = 0.8  # of what the ball allows: how far apart points are chosen
MORE = 1.2  # times as many points as the ball asks for are added between two
MOST_BETWEEN = 8  # parts into which a gap is divided in one round


class CertificateStatus(StrEnum):
    """What was certified of a branch."""

    # The whole branch is one arc.
    CERTIFIED = "certified"
    # Each stretch between two located singular points is one arc.
    UP_TO_SINGULAR_POINTS = "certified up to the singular points"
    # So is each stretch between places where F' is singular to within rounding.
    UP_TO_ROUNDING = "certified up to places singular to rounding"
    # Some neighbouring points are too far apart, or no bound on F'' is known.
    NOT_CERTIFIED = "not certified"


class CertificateValues(TypedDict):
    """A certificate in values that JSON can hold."""

    status: str
    gaps: list[list[float]]
    blurred: list[list[float]]
    points: int
    bound: float
    reversals: list[float]


@dataclass(frozen=True, eq=False)
class Certificate:
    """What was certified of a branch, and where not.

    ``gaps`` (g, 2) are the arclengths between which the points are too far apart for
    the theorem, ``blurred`` (b, 2) those between which F' is singular to within
    rounding, so that doubles do not tell arcs apart; ``points`` how many were used,
    ``bound`` the constant K, ``reversals`` the arclengths at which det [G'; t] changed
    sign although no singular point is known there.
    """

    status: CertificateStatus
    gaps: np.ndarray
    blurred: np.ndarray
    points: int
    bound: float
    reversals: np.ndarray

    def as_values(self) -> CertificateValues:
        """The certificate in values that JSON can hold."""
        return {
            "status": self.status.value,
            "gaps": self.gaps.tolist(),
            "blurred": self.blurred.tolist(),
            "points": self.points,
            "bound": self.bound,
            "reversals": self.reversals.tolist(),
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
            reversals=np.array(values["reversals"]),
        )


def _intervals(rows: list[list[float]]) -> np.ndarray:
    """Intervals (k, 2) from their begins and ends, also where there are none."""
    return np.array(rows).reshape(-1, 2)


def certify_branch(
    problem: Problem, branch: Branch, profile: Profile, singular: Sequence[float] = ()
) -> Certificate:
    """Whether neighbouring points of the dense curve are everywhere close enough to lie
    on one arc.

    ``singular`` are the arclengths of located singular points, next to which nothing is
    claimed. Needs a `Problem.curvature_bound`; without one nothing is certified. Raises
    nothing: what is missing is in the result.
    """
    bound = problem.curvature_bound()
    record = _Record()
    is_curve = branch.length > 0 and profile.rank >= problem.n - 1
    if bound is None or not is_curve:
        record.add_gap(0.0, branch.length)
        return record.certificate(np.inf, CertificateStatus.NOT_CERTIFIED)
    handover = HANDOVER * problem.scale
    for low, high in _stretches(branch, singular, handover):
        arclengths = _first_choice(profile, bound, branch, low, high)
        if record.points + len(arclengths) > MOST:
            record.add_gap(low, high)
            continue
        for part in _parts(arclengths):
            samples = _refined(problem, branch, part, bound)
            record.add_samples(samples, widest_blur=2 * handover)
    at_best = CertificateStatus.CERTIFIED
    if len(singular):
        at_best = CertificateStatus.UP_TO_SINGULAR_POINTS
    return record.certificate(float(bound), at_best)


class _Record:
    """What has been seen of a branch so far."""

    def __init__(self) -> None:
        self.points = 0
        self._gaps = [np.empty((0, 2))]
        self._blurred = [np.empty((0, 2))]
        self._reversals = [np.empty(0)]

    def add_gap(self, low: float, high: float) -> None:
        """Nothing is certified between two arclengths."""
        self._gaps.append(np.array([[low, high]]))

    def add_samples(self, samples: Samples, widest_blur: float) -> None:
        """Neighbouring samples were looked at; where they are far apart is a gap, or a
        blur, if F' is singular there to within rounding and it is not too wide."""
        is_dark = samples.blurred[1:] | samples.blurred[:-1]
        clear = _runs(samples.s, samples.far & ~is_dark)
        dark = _runs(samples.s, samples.far & is_dark)
        widths = dark[:, 1] - dark[:, 0]
        is_narrow = widths <= widest_blur
        self.points += len(samples.s)
        self._gaps.append(clear)
        self._gaps.append(dark[~is_narrow])
        self._blurred.append(dark[is_narrow])
        self._reversals.append(samples.reversals)

    def certificate(self, bound: float, at_best: CertificateStatus) -> Certificate:
        """The certificate, with the status ``at_best`` where nothing stands against
        it."""
        gaps = np.concatenate(self._gaps)
        blurred = np.concatenate(self._blurred)
        status = at_best
        if len(gaps):
            status = CertificateStatus.NOT_CERTIFIED
        elif len(blurred):
            status = CertificateStatus.UP_TO_ROUNDING
        reversals = np.concatenate(self._reversals)
        return Certificate(status, gaps, blurred, self.points, bound, reversals)


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


def _first_choice(
    profile: Profile, bound: float, branch: Branch, low: float, high: float
) -> np.ndarray:
    """Points from ``low`` to ``high``, as far apart as the singular values at the nodes
    of the pieces allow.

    Pieces shorten with the distance to a singular point or a near miss, and their nodes
    with them.
    """
    s = profile.arclength.ravel()
    sigma = profile.smallest.ravel()
    if branch.closed:
        turn = branch.length
        s = np.concatenate([s - turn, s, s + turn])
        sigma = np.tile(sigma, 3)
    between = s[(s > low) & (s < high)]
    grid = np.unique(np.concatenate([[low], between, [high]]))
    local = np.maximum(np.interp(grid, s, sigma), RESOLVED)
    inverse = 1.0 / local
    mean = 0.5 * (inverse[1:] + inverse[:-1])
    integral = np.cumsum(np.diff(grid) * mean)
    count = np.concatenate([[0.0], integral])  # points from ``low`` on
    count *= bound / (CLOSER * SHARE)
    total = count[-1]
    points = int(min(np.ceil(total), MOST)) + 2
    equal_shares = np.linspace(0.0, total, points)
    arclengths: np.ndarray = np.interp(equal_shares, count, grid)
    return arclengths


def _parts(s: np.ndarray) -> Iterator[np.ndarray]:
    """The arclengths in portions that share their ends."""
    for first in range(0, len(s) - 1, AT_ONCE):
        yield s[first : first + AT_ONCE + 1]


def _refined(problem: Problem, branch: Branch, s: np.ndarray, bound: float) -> Samples:
    """Samples at ``s`` and, where neighbours are too far apart, between, as far as the
    singular values tell."""
    samples = sample_curve(problem, branch, s, bound)
    for _ in range(ROUNDS):
        is_dark = samples.blurred[1:] & samples.blurred[:-1]
        wide = np.flatnonzero(samples.far & ~is_dark)
        if not len(wide) or len(samples.s) > 3 * AT_ONCE:
            break
        between = _between(samples, wide)
        samples = samples.joined(sample_curve(problem, branch, between, bound))
    return samples


def _between(samples: Samples, wide: np.ndarray) -> np.ndarray:
    """Arclengths that divide the intervals ``wide`` after these samples as finely as
    their balls ask for."""
    distances = samples.distances[wide] + 1e-300
    reach = np.maximum(samples.reach[wide], distances / MOST_BETWEEN)
    wanted = np.ceil(MORE * distances / reach)
    parts = np.clip(wanted, 2, MOST_BETWEEN).astype(int)
    divisions = []
    for i, count in zip(wide, parts, strict=True):
        low, high = samples.s[i : i + 2]
        ends_and_inner = np.linspace(low, high, count + 1)
        divisions.append(ends_and_inner[1:-1])
    return np.concatenate(divisions)


def _runs(s: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Begin and end (r, 2) of every run of consecutive intervals ``where`` (k - 1,)
    between the arclengths s (k,)."""
    inside = np.concatenate([[0], where, [0]])
    change = np.diff(inside)
    begins = s[change == 1]
    ends = s[change == -1]
    return np.column_stack([begins, ends])
