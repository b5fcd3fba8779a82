"""Certificates: a traced curve lies on one arc of solutions and has not jumped to another.

Let G be the n - 1 combinations of F whose derivatives are independent at x0 (the left singular vectors of
F'(x0)), sigma their smallest singular value, t the unit tangent, and K a Lipschitz constant of F'. In the ball
|x - x0| <= r with K r < sigma every hyperplane across t holds at most one zero of G, because there |G(x) -
G(y)| >= (sigma - K r) |x - y|, and the zeros form a graph over t with slope at most K r / (sigma - K r): the
uniqueness part of the theorem of Newton and Kantorovich, with the tangent as parameter (Ortega and Rheinboldt
1970, 12.6; Deuflhard 2004, 4.4). With K r = sigma / 2 the slope is at most 1, so that the arc from x0 runs at
least r / sqrt(2) far in the ball: two solutions closer than sigma / (2 sqrt(2) K) lie on one arc.

The check is made in doubles, without interval arithmetic. Existence is another matter: an overdetermined system
may fail to have solutions by less than rounding. What is certified is that whatever solves it here is a single
arc.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.monitor import Profile
from bifurc.problem import Problem

__all__ = ["Certificate", "certify_atlas", "certify_branch"]

SHARE = 1.0 / (2.0 * np.sqrt(2.0))  # of sigma / K: how far neighbouring points may be apart
HANDOVER = 1e-3  # distance, in scales, at which an arc is handed over to a located singular point
MOST = 60_000  # points of one arc: a curve that needs more is left uncertified where it does
ROUNDS = 6  # of halving where the first choice of points was too coarse


@dataclass(frozen=True)
class Certificate:
    """What was certified of a branch.

    ``status``: "certified", "certified up to the singular points" or "not certified"; ``gaps`` (g, 2) are the
    arclengths between which the points are too far apart for the theorem, ``points`` how many were used,
    ``bound`` the constant K, ``reversals`` the arclengths at which det [G'; t] changed sign although no
    singular point is known there.
    """

    status: str
    gaps: np.ndarray
    points: int
    bound: float
    reversals: np.ndarray

    def as_labels(self) -> dict[str, Any]:
        """The certificate as plain values, for `Form.labels`."""
        return {
            "status": self.status, "gaps": self.gaps.tolist(), "points": self.points, "bound": self.bound,
            "reversals": self.reversals.tolist(),
        }  # fmt: skip


def certify_atlas(problem: Problem, atlas: Atlas) -> Atlas:
    """The atlas with a certificate among the labels of every form; its located singular points are handed over to."""
    forms = []
    for i, form in enumerate(atlas.forms):
        singular = [s for p in atlas.points for j, s in p.passes if j == i]
        certificate = certify_branch(problem, form.branch, form.profile, singular)
        forms.append(replace(form, labels={**form.labels, "certificate": certificate.as_labels()}))
    return replace(atlas, forms=tuple(forms))


def certify_branch(
    problem: Problem, branch: Branch, profile: Profile, singular: Sequence[float] = ()
) -> Certificate:
    """Whether neighbouring points of the dense curve are everywhere close enough to lie on one arc.

    ``singular`` are the arclengths of located singular points, next to which nothing is claimed. Needs a
    `Problem.curvature_bound`; without one nothing is certified. Raises nothing: what is missing is in the result.
    """
    bound = problem.curvature_bound()
    if bound is None or profile.rank < problem.n - 1:
        return Certificate("not certified", np.array([[0.0, branch.length]]), 0, np.inf, np.empty(0))
    gaps, reversals, points = [], [], 0
    for low, high in _stretches(branch, singular, HANDOVER * problem.scale):
        s = _first_choice(branch, profile, singular, bound, low, high)
        for _ in range(ROUNDS):
            apart, reach, frame = _reach(problem, branch, s, bound)
            wide = apart > reach
            if not np.any(wide) or len(s) > MOST:
                break
            s = np.sort(np.concatenate([s, 0.5 * (s[:-1] + s[1:])[wide]]))
        else:
            apart, reach, frame = _reach(problem, branch, s, bound)
            wide = apart > reach
        points += len(s)
        gaps += [(s[i], s[i + 1]) for i in np.flatnonzero(wide)]
        reversals += list(s[1:][frame[1:] * frame[:-1] < 0])
    status = "not certified" if gaps else "certified up to the singular points" if len(singular) else "certified"
    return Certificate(status, np.array(gaps).reshape(-1, 2), points, float(bound), np.array(reversals))


def _stretches(branch: Branch, singular: Sequence[float], handover: float) -> list[tuple[float, float]]:
    """The intervals of arclength that remain when a neighbourhood of every singular point is left out."""
    stops = sorted(singular)
    if not stops:
        return [(0.0, branch.length)]
    if branch.closed:
        ends = [*stops[1:], stops[0] + branch.length]
        return [(a + handover, b - handover) for a, b in zip(stops, ends, strict=True)]
    edges = [-handover, *stops, branch.length + handover]
    inner = [(a + handover, b - handover) for a, b in pairwise(edges)]
    return [(a, b) for a, b in inner if b > a]


def _first_choice(
    branch: Branch, profile: Profile, singular: Sequence[float], bound: float, low: float, high: float
) -> np.ndarray:
    """Points from ``low`` to ``high``, about as far apart as the singular values of the profile allow."""
    grid = np.concatenate([[low], np.linspace(low, high, 400)[1:-1], [high]])
    for stop in singular:  # the singular value falls off towards a stop: a grid that follows it
        for shift in (-branch.length, 0.0, branch.length) if branch.closed else (0.0,):
            near = stop + shift + np.concatenate([-np.geomspace(1.0, HANDOVER, 60), np.geomspace(HANDOVER, 1.0, 60)])
            grid = np.concatenate([grid, near[(near > low) & (near < high)]])
    grid = np.unique(grid)
    s, sigma = profile.arclength.ravel(), profile.smallest.ravel()
    if branch.closed:
        s = np.concatenate([s - branch.length, s, s + branch.length])
        sigma = np.tile(sigma, 3)
    local = np.interp(grid, s, sigma)
    if len(singular):
        distance = np.min([np.abs(grid - stop - k * branch.length) for stop in singular for k in (-1, 0, 1)], axis=0)
        local = np.minimum(local, np.maximum(distance * _slope(s, sigma, singular), 1e-12))
    spacing = 0.9 * SHARE * np.minimum(local[1:], local[:-1]) / bound
    count = np.concatenate([[0.0], np.cumsum(np.diff(grid) / spacing)])
    chosen = int(min(np.ceil(count[-1]), MOST)) + 2
    return np.interp(np.linspace(0.0, count[-1], chosen), count, grid)


def _slope(s: np.ndarray, sigma: np.ndarray, singular: Sequence[float]) -> float:
    """How fast the smallest singular value grows away from the singular points, at the slowest."""
    slopes = []
    for stop in singular:
        near = np.argsort(np.abs(s - stop))[:6]
        slopes.append(float(np.median(sigma[near] / (np.abs(s[near] - stop) + 1e-300))))
    return min(slopes)


def _reach(
    problem: Problem, branch: Branch, s: np.ndarray, bound: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far neighbouring points are apart (k - 1,), how far their balls let them be, and the running sign of
    det [G'; t] (k,)."""
    points, tangents = branch(s), branch(s, 1)
    left, sigma, right = np.linalg.svd(problem.jacobians(points) / problem.magnitude, full_matrices=True)
    rank = problem.n - 1
    smallest = np.maximum(sigma[:, rank - 1], 1e-300)
    # a sample is off the solution by at most twice its residual over sigma (Newton and Kantorovich again)
    offset = 2.0 * np.linalg.norm(problem.residuals(points), axis=1) / problem.magnitude / smallest
    holds = problem.curvature_residual / sigma[:, 0]  # beyond this the bound on the second derivative may fail
    ball = SHARE * np.minimum(smallest / bound, holds) - 2.0 * offset
    tangents = tangents / np.linalg.norm(tangents, axis=1)[:, None]
    frames = np.concatenate([right[:, :rank], tangents[:, None, :]], axis=1)
    turn = np.einsum("kmi,kmj->kij", left[:-1, :, :rank], left[1:, :, :rank])
    sign = np.concatenate([[1.0], np.sign(np.linalg.det(turn))])
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return apart, np.maximum(ball[:-1], ball[1:]), np.sign(np.linalg.det(frames)) * np.cumprod(sign)
