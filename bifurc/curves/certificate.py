"""Certificates: a traced curve lies on one arc of solutions and has not jumped to
another.

Let G be the n - 1 combinations of F whose derivatives are independent at x0 (the left
singular vectors of F'(x0)), sigma their smallest singular value, t the unit tangent,
and K a Lipschitz constant of F'. In the ball
|x - x0| <= r with K r < sigma every hyperplane across t holds at most one zero of G, because there |G(x) -
G(y)| >= (sigma - K r) |x - y|, and the zeros form a graph over t with slope at most K r
/ (sigma - K r): the uniqueness part of the theorem of Newton and Kantorovich, with the
tangent as parameter (Ortega and Rheinboldt 1970, 12.6; Deuflhard 2004, 4.4). With K r =
sigma / 2 the slope is at most 1, so that the arc from x0 runs at least r / sqrt(2) far
in the ball: two solutions closer than sigma / (2 sqrt(2) K) lie on one arc.

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

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.kantorovich import SHARE, Samples, sample_curve
from bifurc.curves.monitor import Profile
from bifurc.problem import Problem

__all__ = ["Certificate", "certify_branch"]

# distance, in scales, at which an arc is handed over to a located singular point
HANDOVER = 1e-3
MOST = 1_000_000  # points of one branch: a curve that needs more is left uncertified
AT_ONCE = 20_000  # points that are looked at together
ROUNDS = 12  # of adding points where those chosen before are too far apart
RESOLVED = (
    1e-7  # singular value, over the magnitude, below which more points do not help
)


@dataclass(frozen=True)
class Certificate:
    """What was certified of a branch.

    ``status``: "certified", "certified up to the singular points", "certified up to
    places singular to rounding" or "not certified"; ``gaps`` (g, 2) are the arclengths
    between which the points are too far apart for the theorem, ``blurred`` (b, 2) those
    between which F' is singular to within rounding, so that doubles do not tell arcs
    apart; ``points`` how many were used, ``bound`` the constant K, ``reversals`` the
    arclengths at which det [G'; t] changed sign although no singular point is known
    there.
    """

    status: str
    gaps: np.ndarray
    blurred: np.ndarray
    points: int
    bound: float
    reversals: np.ndarray

    def as_values(self) -> dict[str, Any]:
        """The certificate in values that JSON can hold."""
        return {
            "status": self.status,
            "gaps": self.gaps.tolist(),
            "blurred": self.blurred.tolist(),
            "points": self.points,
            "bound": self.bound,
            "reversals": self.reversals.tolist(),
        }

    @staticmethod
    def from_values(values: Mapping[str, Any]) -> Certificate:
        """The certificate that `as_values` wrote down."""
        return Certificate(
            values["status"],
            np.array(values["gaps"]).reshape(-1, 2),
            np.array(values["blurred"]).reshape(-1, 2),
            values["points"],
            values["bound"],
            np.array(values["reversals"]),
        )


def certify_branch(
    problem: Problem, branch: Branch, profile: Profile, singular: Sequence[float] = ()
) -> Certificate:
    """Whether neighbouring points of the dense curve are everywhere close enough to lie
    on one arc.

    ``singular`` are the arclengths of located singular points, next to which nothing is
    claimed. Needs a `Problem.curvature_bound`; without one nothing is certified. Raises
    nothing: what is missing is in the result.
    """
    bound, none = problem.curvature_bound(), np.empty((0, 2))
    if bound is None or profile.rank < problem.n - 1 or not branch.length > 0:
        return Certificate(
            "not certified",
            np.array([[0.0, branch.length]]),
            none,
            0,
            np.inf,
            np.empty(0),
        )
    gaps, blurred, reversals, points = [none], [none], [np.empty(0)], 0
    handover = HANDOVER * problem.scale
    for low, high in _stretches(branch, singular, handover):
        chosen = _first_choice(profile, bound, branch, low, high)
        if points + len(chosen) > MOST:
            gaps.append(np.array([[low, high]]))
            continue
        for s in _parts(chosen):
            samples = _refined(problem, branch, s, bound)
            points += len(samples.s)
            excused = samples.blurred[1:] | samples.blurred[:-1]
            dark = _runs(samples.s, samples.far & excused)
            narrow = dark[:, 1] - dark[:, 0] <= 2 * handover
            gaps += [_runs(samples.s, samples.far & ~excused), dark[~narrow]]
            blurred.append(dark[narrow])
            reversals.append(samples.reversals)
    uncertain, unresolved = np.concatenate(gaps), np.concatenate(blurred)
    status = (
        "not certified"
        if len(uncertain)
        else "certified up to places singular to rounding"
        if len(unresolved)
        else "certified up to the singular points"
        if len(singular)
        else "certified"
    )
    return Certificate(
        status, uncertain, unresolved, points, float(bound), np.concatenate(reversals)
    )


def _stretches(
    branch: Branch, singular: Sequence[float], handover: float
) -> list[tuple[float, float]]:
    """The intervals of arclength that remain when a neighbourhood of every singular
    point is left out."""
    stops = sorted(singular)
    if not stops:
        return [(0.0, branch.length)]
    if branch.closed:
        ends = [*stops[1:], stops[0] + branch.length]
        inner = [(a + handover, b - handover) for a, b in zip(stops, ends, strict=True)]
    else:
        edges = [-handover, *stops, branch.length + handover]
        inner = [(a + handover, b - handover) for a, b in pairwise(edges)]
    return [(a, b) for a, b in inner if b > a]


def _first_choice(
    profile: Profile, bound: float, branch: Branch, low: float, high: float
) -> np.ndarray:
    """Points from ``low`` to ``high``, as far apart as the singular values at the nodes
    of the pieces allow.

    Pieces shorten with the distance to a singular point or a near miss, and their nodes
    with them.
    """
    s, sigma = profile.arclength.ravel(), profile.smallest.ravel()
    if branch.closed:
        s = np.concatenate([s - branch.length, s, s + branch.length])
        sigma = np.tile(sigma, 3)
    grid = np.unique(np.concatenate([[low], s[(s > low) & (s < high)], [high]]))
    local = np.maximum(np.interp(grid, s, sigma), RESOLVED)
    count = np.concatenate(
        [[0.0], np.cumsum(np.diff(grid) * 0.5 * (1.0 / local[1:] + 1.0 / local[:-1]))]
    )
    count *= bound / (0.8 * SHARE)
    chosen = int(min(np.ceil(count[-1]), MOST)) + 2
    return np.interp(np.linspace(0.0, count[-1], chosen), count, grid)


def _parts(s: np.ndarray) -> Iterator[np.ndarray]:
    """The arclengths in portions that share their ends."""
    for first in range(0, len(s) - 1, AT_ONCE):
        yield s[first : first + AT_ONCE + 1]


def _refined(problem: Problem, branch: Branch, s: np.ndarray, bound: float) -> Samples:
    """Samples at ``s`` and, where neighbours are too far apart, between, as far as the
    singular values tell."""
    samples = sample_curve(problem, branch, s, bound)
    for _ in range(ROUNDS):
        where = np.flatnonzero(
            samples.far & ~(samples.blurred[1:] & samples.blurred[:-1])
        )
        if not len(where) or len(samples.s) > 3 * AT_ONCE:
            break
        apart = samples.apart[where] + 1e-300
        count = np.clip(
            np.ceil(1.2 * apart / np.maximum(samples.reach[where], apart / 8)), 2, 8
        ).astype(int)
        ends = zip(samples.s[where], samples.s[where + 1], count, strict=True)
        between = np.concatenate(
            [np.linspace(a, b, parts + 1)[1:-1] for a, b, parts in ends]
        )
        samples = samples.joined(sample_curve(problem, branch, between, bound))
    return samples


def _runs(s: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Begin and end (r, 2) of every run of consecutive intervals ``where`` (k - 1,)
    between the arclengths s (k,)."""
    edges = np.diff(np.concatenate([[False], where, [False]]).astype(int))
    return np.column_stack([s[edges == 1], s[edges == -1]])
