"""Random linkages that nearly bifurcate, each with an exact test of whether a curve
stays on its own arc.

All three tests rest on closed forms of the motion, not on following it.

Four-bars: the diagonal that joints 1 and 3 span gives A cos(theta1) - B cos(theta3) =
C. Two arcs that pass each other do so at flat joints, and one of these two joints
cannot be flat on either arc.

Double-subtractive-Goldberg linkages: tan(theta1/2) tan(theta2/2) and tan(theta4/2)
tan(theta5/2) are constant, theta6 is theta3 up to sign, and f(theta1) = h(theta4) with
one maximum and one minimum each. Arcs pass each other where both have an extremum; the
one that is larger cannot be reached.

Line-symmetric Bricards: `studies.half_turn`. The forms that crossed the traced one
before the linkage was changed, revised ones or Bennett's, are not line-symmetric and
close no more: to turn into one is a jump.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import mpmath
import numpy as np

from bifurc.branch import Branch
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import GeometryError, Loop
from studies.half_turn import HalfTurn, never_at, samples

__all__ = ["FAMILIES", "NearMiss", "near_misses"]

CLEAR = 3e-2  # smallest regular singular value at a start


@dataclass(frozen=True)
class NearMiss:
    """A linkage whose parameters are off those of a bifurcating one by ``size``;
    ``stays`` is exact."""

    family: str
    size: float
    problem: LoopClosure
    start: np.ndarray
    stays: Callable[[Branch], bool]


def _starts(problem: LoopClosure, rng: np.random.Generator) -> np.ndarray:
    """Closed configurations on curves, away from singular points."""
    points, gaps = problem.project(rng.uniform(-np.pi, np.pi, (40, problem.n)))
    points = points[gaps < 1e-13]
    sigma = np.linalg.svd(problem.jacobians(points), compute_uv=False)
    curve = (
        sigma[:, problem.n - 1] < 1e-9
        if problem.n > 4
        else np.ones(len(points), dtype=bool)
    )
    weakest = sigma[:, 4] if problem.n > 4 else sigma[:, 2]
    return points[curve & (weakest > CLEAR)]


# --- four-bars ----------------------------------------------------------------------------------------


def _four_bar(rng: np.random.Generator, size: float) -> NearMiss | None:
    a, b = rng.uniform(0.5, 2.0, 2)
    errors = size * rng.choice([-1.0, 1.0], 4) * rng.uniform(0.1, 1.0, 4)
    l1, l2, l3, l4 = lengths = np.array([a, b, a, b]) * (1 + errors)
    problem = LoopClosure(Loop(tuple(lengths), (0.0,) * 4, (0.0,) * 4))
    starts = _starts(problem, rng)
    if not len(starts):
        return None
    exact = [mpmath.mpf(float(x)) for x in (l1, l2, l3, l4)]
    big, small = exact[0] * exact[3], exact[1] * exact[2]
    constant = (exact[1] ** 2 + exact[2] ** 2 - exact[0] ** 2 - exact[3] ** 2) / 2
    barred = []  # (joint, angle) that no configuration has
    for sign, angle in ((1, 0.0), (-1, math.pi)):
        if abs(sign * big - constant) > small:
            barred.append((0, angle))
        if abs(sign * small + constant) > big:
            barred.append((2, angle))

    def stays(branch: Branch) -> bool:
        points = branch(samples(branch))
        return all(never_at(points[:, joint], angle) for joint, angle in barred)

    return NearMiss("parallelogram four-bar", size, problem, starts[0], stays)


# --- double-Goldberg linkages -------------------------------------------------------------------------


def _double_goldberg(rng: np.random.Generator, size: float) -> NearMiss | None:
    values = entry("special-double-subtractive-goldberg").draw(rng)
    t = {name: math.tan(values[name] / 2) for name in ("alpha", "beta", "delta")}
    gamma = (
        2
        * math.atan(t["beta"] * t["delta"] / t["alpha"])
        * (1 + size * rng.choice([-1.0, 1.0]))
    )
    problem = LoopClosure(
        entry("double-subtractive-goldberg").build(**values, gamma=gamma)
    )
    for start in _starts(problem, rng):
        found = _goldberg_test(start, size)
        if found is not None:
            return NearMiss("double-Goldberg 6R", size, problem, start, found)
    return None


def _goldberg_test(start: np.ndarray, size: float) -> Callable[[Branch], bool] | None:
    """The test for the form through ``start``, or None where that form comes near no
    other arc."""
    turn = next(
        (s for s in (1.0, -1.0) if abs(math.sin((start[5] - s * start[2]) / 2)) < 1e-9),
        None,
    )
    if turn is None:
        return None
    first, second = (
        -turn * math.tan(start[i] / 2) * math.tan(start[i + 1] / 2) for i in (0, 3)
    )
    if min(first, second) < 1e-3 or max(first, second) > 1e3:
        return None
    above, below = (abs(p - 1) / (2 * math.sqrt(p)) for p in (first, second))
    if abs(above - below) > 100 * size * above:
        return None
    joint, p = (0, first) if above > below else (3, second)
    angle = 2 * math.atan(math.sqrt(p))

    def relation(points: np.ndarray) -> np.ndarray:
        s, c = np.sin(points / 2), np.cos(points / 2)
        ties = [
            s[:, i] * s[:, i + 1] * turn + p * c[:, i] * c[:, i + 1]
            for i, p in ((0, first), (3, second))
        ]
        f, h = (
            (p - 1) * np.sin(points[:, i]) / (s[:, i] ** 2 + p * c[:, i] ** 2)
            for i, p in ((0, first), (3, second))
        )
        return np.array(
            [*ties, np.sin((points[:, 5] - turn * points[:, 2]) / 2), f - turn * h]
        )

    sign = relation(start[None])
    if abs(sign[3, 0]) > 1e-8 * max(1.0, first, second, above):
        return None

    def stays(branch: Branch) -> bool:
        points = branch(samples(branch))
        off = np.abs(relation(points)).max(axis=1)
        barred = never_at(points[:, joint], angle) and never_at(
            points[:, joint], -angle
        )
        return barred and bool(
            np.all(off < 1e-6 * max(1.0, first, second, 1 / first, 1 / second))
        )

    return stays


# --- line-symmetric Bricards --------------------------------------------------------------------------


def _line_symmetric(
    family: str, loop: Loop, rng: np.random.Generator, size: float
) -> NearMiss | None:
    problem = LoopClosure(loop)
    points = _starts(problem, rng)
    points = points[
        np.abs(np.sin((points[:, 3:] - points[:, :3]) / 2)).max(axis=1, initial=0.0)
        < 1e-9
    ]
    return (
        NearMiss(family, size, problem, points[0], HalfTurn(loop).stays)
        if len(points)
        else None
    )


def _tiny_offsets(rng: np.random.Generator, size: float) -> NearMiss | None:
    values = entry("bricard-line-symmetric-zero-offset").draw(rng)
    offsets = dict(
        zip(("R1", "R2", "R3"), size * rng.uniform(-1.0, 1.0, 3), strict=True)
    )
    loop = entry("bricard-line-symmetric").build(**values, **offsets)
    return _line_symmetric("line-symmetric Bricard", loop, rng, size)


def _other_kink(rng: np.random.Generator, size: float) -> NearMiss | None:
    """The offsets of the joints 1 and 3 belong to a kink that is off."""
    values = entry("reconfigurable-bricard-1").draw(rng)
    loop = entry("reconfigurable-bricard-1").build(**values)
    values["kink"] *= 1 + size * rng.choice([-1.0, 1.0])
    other = entry("reconfigurable-bricard-1").build(**values)
    return _line_symmetric(
        "reconfigurable Bricard",
        Loop(loop.lengths, loop.twists, other.offsets),
        rng,
        size,
    )


FAMILIES = (_four_bar, _double_goldberg, _tiny_offsets, _other_kink)


def near_misses(count: int, rng: np.random.Generator) -> Iterator[NearMiss]:
    """``count`` random linkages, the families in turn, sizes from 1e-8 to 1e-2 with
    equal chance for every power."""
    for k in range(count):
        made = None
        while made is None:
            try:
                made = FAMILIES[k % len(FAMILIES)](rng, 10 ** rng.uniform(-8.0, -2.0))
            except GeometryError:
                continue
        yield made
