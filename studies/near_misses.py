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
from typing import TypeAlias

import mpmath
import numpy as np
from numpy.typing import NDArray

from bifurc import Branch
from linkages import Closure, GeometryError, Loop
from linkages.catalogue import entry
from studies.half_turn import HalfTurn, never_at, samples

Floats: TypeAlias = NDArray[np.float64]
Test: TypeAlias = Callable[[Branch], bool]

TRIED = 40  # random configurations, of which starts are made
CLOSED = 1e-13  # closure residual of a start
CLEAR = 3e-2  # smallest regular singular value at a start
ALONG = 1e-6  # by how much a traced curve may be off its closed form
SMALLEST, LARGEST = -8.0, -2.0  # powers of ten of the sizes of the changes


@dataclass(frozen=True)
class NearMiss:
    """A linkage whose parameters are off those of a bifurcating one by ``size``;
    ``stays`` is exact."""

    family: str
    size: float
    problem: Closure
    start: Floats
    stays: Test


def _starts(problem: Closure, rng: np.random.Generator) -> Floats:
    """Closed configurations (k, n) on curves, away from singular points."""
    n = problem.n
    points, gaps = problem.project(rng.uniform(-np.pi, np.pi, (TRIED, n)))
    points = points[gaps < CLOSED]
    values = np.linalg.svd(problem.jacobians(points), compute_uv=False)
    if n == 4:  # a four-bar has rank 3, and every configuration lies on a curve
        return points[values[:, 2] > CLEAR]
    is_on_curve = values[:, n - 1] < 1e-9
    return points[is_on_curve & (values[:, 4] > CLEAR)]


# --- four-bars ------------------------------------------------------------------------


def _four_bar(rng: np.random.Generator, size: float) -> NearMiss | None:
    a, b = rng.uniform(0.5, 2.0, 2)
    errors = size * rng.choice([-1.0, 1.0], 4) * rng.uniform(0.1, 1.0, 4)
    lengths = np.array([a, b, a, b]) * (1 + errors)
    problem = Closure(Loop(tuple(lengths), (0.0,) * 4, (0.0,) * 4))
    starts = _starts(problem, rng)
    if not len(starts):
        return None
    barred = _flat_joints(lengths)

    def stays(branch: Branch) -> bool:
        points = branch(samples(branch))
        return all(never_at(points[:, joint], angle) for joint, angle in barred)

    return NearMiss("parallelogram four-bar", size, problem, starts[0], stays)


def _flat_joints(lengths: Floats) -> list[tuple[int, float]]:
    """Joints 1 and 3 (from 0: 0 and 2) with the angles 0 or pi that no configuration of
    a four-bar has.

    A cos(theta1) - B cos(theta3) = C, with exact A, B and C.
    """
    l1, l2, l3, l4 = (mpmath.mpf(float(length)) for length in lengths)
    big = l1 * l4
    small = l2 * l3
    constant = (l2**2 + l3**2 - l1**2 - l4**2) / 2
    barred = []
    for sign, angle in ((1, 0.0), (-1, math.pi)):
        if abs(sign * big - constant) > small:
            barred.append((0, angle))
        if abs(sign * small + constant) > big:
            barred.append((2, angle))
    return barred


# --- double-Goldberg linkages ---------------------------------------------------------


def _double_goldberg(rng: np.random.Generator, size: float) -> NearMiss | None:
    values = entry("special-double-subtractive-goldberg").draw(rng)
    tangents = {key: math.tan(values[key] / 2) for key in ("alpha", "beta", "delta")}
    special = math.atan(tangents["beta"] * tangents["delta"] / tangents["alpha"])
    gamma = 2 * special * (1 + size * rng.choice([-1.0, 1.0]))
    family = entry("double-subtractive-goldberg")
    problem = Closure(family.build(**values, gamma=gamma))
    for start in _starts(problem, rng):
        motion = _goldberg_motion(start)
        if motion is not None and motion.is_near_another_arc(size):
            return NearMiss("double-Goldberg 6R", size, problem, start, motion.stays)
    return None


@dataclass(frozen=True)
class _GoldbergMotion:
    """The exact relations on a form of a double-subtractive-Goldberg linkage.

    theta6 is ``turn`` theta3, and tan(theta1/2) tan(theta2/2) = -``turn`` ``first``,
    tan(theta4/2) tan(theta5/2) = -``turn`` ``second``.
    """

    turn: float
    first: float
    second: float

    @property
    def _extrema(self) -> tuple[float, float]:
        """The maxima of f(theta1) and of h(theta4)."""
        first, second = (
            abs(p - 1) / (2 * math.sqrt(p)) for p in (self.first, self.second)
        )
        return first, second

    @property
    def _barred(self) -> tuple[int, float]:
        """The joint (from 0) whose function has the larger extrema, and the angle at
        which these are: it cannot be reached."""
        above, below = self._extrema
        joint, product = (0, self.first) if above > below else (3, self.second)
        return joint, 2 * math.atan(math.sqrt(product))

    def is_near_another_arc(self, size: float) -> bool:
        """Whether the extrema differ by no more than a change of this size makes."""
        above, below = self._extrema
        return abs(above - below) <= 100 * size * above

    def holds_at(self, start: Floats) -> bool:
        """Whether f(theta1) = h(theta4) at a configuration (n,)."""
        above, _ = self._extrema
        off = abs(self._deviations(start[None])[3, 0])
        return bool(off <= 1e-8 * max(1.0, self.first, self.second, above))

    def stays(self, branch: Branch) -> bool:
        """Whether a traced branch satisfies the relations and never reaches the barred
        angle."""
        points = branch(samples(branch))
        joint, angle = self._barred
        for barred in (angle, -angle):
            if not never_at(points[:, joint], barred):
                return False
        scale = max(1.0, self.first, self.second, 1 / self.first, 1 / self.second)
        return bool(np.all(np.abs(self._deviations(points)) < ALONG * scale))

    def _deviations(self, points: Floats) -> Floats:
        """By how much configurations (k, n) are off the four relations (4, k)."""
        sines = np.sin(points / 2)
        cosines = np.cos(points / 2)
        products = []
        functions = []
        for i, p in ((0, self.first), (3, self.second)):
            s, c = sines[:, i], cosines[:, i]
            products.append(s * sines[:, i + 1] * self.turn + p * c * cosines[:, i + 1])
            functions.append((p - 1) * np.sin(points[:, i]) / (s**2 + p * c**2))
        kink = np.sin((points[:, 5] - self.turn * points[:, 2]) / 2)
        return np.array([*products, kink, functions[0] - self.turn * functions[1]])


def _goldberg_motion(start: Floats) -> _GoldbergMotion | None:
    """The form through a configuration, or None where it is of another kind."""
    for turn in (1.0, -1.0):
        if abs(math.sin((start[5] - turn * start[2]) / 2)) < 1e-9:
            break
    else:
        return None
    half_tangents = [math.tan(angle / 2) for angle in start]
    first = -turn * half_tangents[0] * half_tangents[1]
    second = -turn * half_tangents[3] * half_tangents[4]
    if min(first, second) < 1e-3 or max(first, second) > 1e3:
        return None
    motion = _GoldbergMotion(turn, first, second)
    return motion if motion.holds_at(start) else None


# --- line-symmetric Bricards ----------------------------------------------------------


def _line_symmetric(
    family: str, loop: Loop, rng: np.random.Generator, size: float
) -> NearMiss | None:
    problem = Closure(loop)
    for start in _starts(problem, rng):
        off = np.abs(np.sin((start[3:] - start[:3]) / 2)).max()
        if off < 1e-9:
            return NearMiss(family, size, problem, start, HalfTurn(loop).stays)
    return None


def _tiny_offsets(rng: np.random.Generator, size: float) -> NearMiss | None:
    values = entry("bricard-line-symmetric-zero-offset").draw(rng)
    r1, r2, r3 = size * rng.uniform(-1.0, 1.0, 3)
    family = entry("bricard-line-symmetric")
    loop = family.build(**values, R1=r1, R2=r2, R3=r3)
    return _line_symmetric("line-symmetric Bricard", loop, rng, size)


def _other_kink(rng: np.random.Generator, size: float) -> NearMiss | None:
    """The offsets of the joints 1 and 3 belong to a kink that is off."""
    family = entry("reconfigurable-bricard-1")
    values = family.draw(rng)
    loop = family.build(**values)
    values["kink"] *= 1 + size * rng.choice([-1.0, 1.0])
    other = family.build(**values)
    mixed = Loop(loop.lengths, loop.twists, other.offsets)
    return _line_symmetric("reconfigurable Bricard", mixed, rng, size)


FAMILIES = (_four_bar, _double_goldberg, _tiny_offsets, _other_kink)


def near_misses(count: int, rng: np.random.Generator) -> Iterator[NearMiss]:
    """``count`` random linkages, the families in turn, sizes from 1e-8 to 1e-2 with
    equal chance for every power."""
    for number in range(count):
        family = FAMILIES[number % len(FAMILIES)]
        case = None
        while case is None:
            size = 10 ** rng.uniform(SMALLEST, LARGEST)
            try:
                case = family(rng, size)
            except GeometryError:  # the constructor refuses these parameters
                continue
        yield case
