"""All isolated assemblies of a loop of four to six joints, by parameter continuation.

A 6R loop with generic complex geometry closes in 16 configurations (Raghavan and Roth
1993). While the geometry moves along a generic path to that of a given loop, these 16
move along, and every isolated configuration of the given loop, real or complex, is the
end of one of the paths (coefficient-parameter continuation: Morgan and Sommese 1989;
Sommese and Wampler 2005, theorem 7.1.1). What is left of them ends on motions, at
singular configurations or at infinity. So motions do no harm, and no resultant has to
be split.

A loop of four or five joints becomes one of six: its last link is cut by generic axes.
A configuration of the longer loop is one of the given loop where these stand still.
"""

# numba infers the types of compiled functions
# mypy: allow-untyped-defs, allow-untyped-calls
from __future__ import annotations

import json
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from importlib.resources import files

import numpy as np
from numba import njit

from linkages.loop import GeometryError, Loop

__all__ = [
    "Assemblies",
    "GenericLoop",
    "PathEnd",
    "follow_paths",
    "isolated_assemblies",
]

JOINTS = 6
REAL = 1e-6  # rad: the largest imaginary part of a configuration taken for real
REGULAR = 1e-6  # smallest singular value of F' at an isolated assembly
EQUAL = 1e-6  # rad: two configurations that agree to this are one
ATTEMPTS = 3  # generic geometries from which the paths start
ROTATION = np.exp(0.7j)  # of the generic lengths and offsets from attempt to attempt
# Lengths (over the characteristic length), twists and offsets of the cuts.
CUTS = ((0.618, 1.234, -0.377), (0.441, 0.873, 0.289))

# Of the paths.
FIRST_STEP, LONGEST_STEP = 0.02, 0.1
# A step shorter than this share of the rest of the path is none.
SHORTEST_SHARE = 1e-7
# The rest of a path that is taken in one step or not at all: a path to a singular
# configuration comes to its end in ever shorter steps. Two configurations of which each
# has the singular value s meet about s^2 behind the end.
LAST_STRETCH = 1e-12
TRUSTED = 1e-3  # rad: the largest first correction of an accepted step
TRUSTED_AT_THE_END = 1e-2
AIM = 1e-4  # rad: the first correction that the length of a step aims at
EXACT = 1e-11  # rad: a correction after which no other is made
CORRECTED = 1e-9  # rad: the largest last correction of an accepted step
NEAR_THE_END = 1e-2  # the rest of a path that stops at a singular configuration
INFINITE = 14.0  # imaginary part of an angle beyond which a path runs to infinity
MOST_STEPS = 2000
DIFFERENCE = 1e-7  # of the path parameter, for the velocity of the equations


class PathEnd(IntEnum):
    """How a path ended. The compiled tracker returns the numbers."""

    ARRIVED = 0  # at a configuration of the given loop
    STOPPED = 1  # no step is short enough
    AT_INFINITY = 2  # an angle has grown beyond all bounds


@dataclass(frozen=True)
class GenericLoop:
    """A complex geometry, and all configurations in which it closes.

    ``table`` (3, 6), complex: lengths, twists (rad) and offsets; ``configurations``
    (16, 6), complex, rad.
    """

    table: np.ndarray
    configurations: np.ndarray


@dataclass(frozen=True)
class Paths:
    """Paths from the configurations of one loop towards those of another.

    ``angles`` (k, 6), complex, rad, where each path ended; ``rest`` (k,), from 1 to 0,
    what was left of it; ``ends`` (k,) are `PathEnd` numbers.
    """

    angles: np.ndarray
    rest: np.ndarray
    ends: np.ndarray


@dataclass(frozen=True)
class Assemblies:
    """The isolated assemblies of a loop at which its closure has full rank.

    ``configurations`` (k, n), rad in (-pi, pi]. ``complete`` says whether all 16 paths
    were followed to an end; ``statement`` says where they ended.
    """

    configurations: np.ndarray
    complete: bool
    statement: str


def isolated_assemblies(loop: Loop) -> Assemblies:
    """All real configurations of ``loop`` at which its closure has full rank.

    Raises `GeometryError` for a loop of more than six joints.
    """
    if not isinstance(loop, Loop):
        raise GeometryError("loop", type(loop).__name__, "a Loop, such as linkage.loop")
    if loop.n > JOINTS:
        raise GeometryError("number of joints", loop.n, f"at most {JOINTS}")
    longer = _with_six_joints(loop)
    for attempt in range(ATTEMPTS):
        start = _generic_loop(attempt)
        paths = follow_paths(start, longer.table)
        lost = _lost_paths(paths)
        if not lost:
            break
    angles = paths.angles[paths.ends == PathEnd.ARRIVED]
    regular = angles[_smallest_singular_values(angles, longer.table) > REGULAR]
    distinct = _distinct(regular)
    jumped = len(distinct) < len(regular)
    real = distinct[np.abs(distinct.imag).max(axis=1, initial=0.0) < REAL].real
    at_infinity = int(np.count_nonzero(paths.ends == PathEnd.AT_INFINITY))
    singular = len(paths.ends) - len(regular) - at_infinity - lost
    statement = (
        f"of 16 paths {len(regular)} ended at isolated configurations, {singular} at "
        f"singular ones, {at_infinity} at infinity, {lost} were lost"
    )
    return Assemblies(
        configurations=longer.configurations_of_given_loop(real),
        complete=not lost and not jumped,
        statement=statement,
    )


def follow_paths(start: GenericLoop, table: np.ndarray) -> Paths:
    """The paths of all configurations of ``start`` while its geometry moves straight to
    ``table`` (3, 6)."""
    first = np.ascontiguousarray(start.table, dtype=complex)
    last = np.ascontiguousarray(table, dtype=complex)
    configurations = np.ascontiguousarray(start.configurations, dtype=complex)
    return Paths(*_follow_paths(configurations, first, last))


# --- a loop of six joints -------------------------------------------------------------


@dataclass(frozen=True)
class _LongerLoop:
    """A loop of fewer joints with its last link cut by further axes.

    ``table`` (3, 6) of the longer loop, lengths over the characteristic length;
    ``joints`` of the given loop; ``shift`` of the first angle; ``still`` (6 - n,): the
    angles of the further joints at which it is the given loop.
    """

    table: np.ndarray
    joints: int
    shift: float
    still: np.ndarray

    def configurations_of_given_loop(self, angles: np.ndarray) -> np.ndarray:
        """Those of the configurations (k, 6) in which the further joints stand still,
        as configurations (m, n) of the given loop, rad in (-pi, pi]."""
        away = np.abs(_wrapped(angles[:, self.joints :] - self.still))
        own = angles[np.all(away < EQUAL, axis=1), : self.joints].copy()
        own[:, 0] -= self.shift
        return _wrapped(own)


def _with_six_joints(loop: Loop) -> _LongerLoop:
    """``loop`` with its last link cut until it has six joints."""
    lengths, twists, offsets = loop.arrays
    size = loop.characteristic_length
    table = np.array([lengths / size, twists, offsets / size])
    shift = 0.0
    still: list[float] = []
    for cut in CUTS[: JOINTS - loop.n]:
        before = np.array(cut)
        rest = np.linalg.inv(_link_matrix(before)) @ _link_matrix(table[:, -1])
        after = _link_between(rest)
        table = np.column_stack([table[:, :-1], before, after.link])
        table[2, 0] += after.slide
        shift += after.turn
        still.append(after.angle)
    return _LongerLoop(table, loop.n, shift, np.array(still))


@dataclass(frozen=True)
class _LinkBetween:
    """A transform as Rz(angle) Tz(offset) Tx(length) Rx(twist) Rz(turn) Tz(slide).

    ``link`` (3,) holds length, twist and offset.
    """

    angle: float
    link: np.ndarray
    turn: float
    slide: float


def _link_between(transform: np.ndarray) -> _LinkBetween:
    """The link from the z-axis of the base to that of ``transform`` (4, 4).

    The axes must not be parallel.
    """
    axis = transform[:3, 2]
    twist = np.arccos(np.clip(axis[2], -1.0, 1.0))
    angle = np.arctan2(axis[0], -axis[1])
    normal = np.array([np.cos(angle), np.sin(angle), 0.0])
    directions = np.column_stack([[0.0, 0.0, 1.0], normal, axis])
    offset, length, slide = np.linalg.solve(directions, transform[:3, 3])
    link = np.array([length, twist, offset])
    straight = _turn_matrix(angle) @ _link_matrix(link)
    rest = np.linalg.inv(straight) @ transform
    turn = np.arctan2(rest[1, 0], rest[0, 0])
    return _LinkBetween(float(angle), link, float(turn), float(slide))


def _link_matrix(link: np.ndarray) -> np.ndarray:
    """Tz(offset) Tx(length) Rx(twist) (4, 4) of a link (length, twist, offset)."""
    length, twist, offset = link
    c, s = np.cos(twist), np.sin(twist)
    return np.array(
        [
            [1.0, 0.0, 0.0, length],
            [0.0, c, -s, 0.0],
            [0.0, s, c, offset],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def _turn_matrix(angle: float) -> np.ndarray:
    """Rz(angle) (4, 4)."""
    c, s = np.cos(angle), np.sin(angle)
    out = np.eye(4)
    out[:2, :2] = [[c, -s], [s, c]]
    return out


# --- the ends of the paths ------------------------------------------------------------


@cache
def _stored_loop() -> GenericLoop:
    """The generic loop that comes with the package."""
    text = files("linkages.slices").joinpath("generic_loop.json").read_text("utf-8")
    stored = json.loads(text)
    table = np.array(stored["table"]) @ [1.0, 1.0j]
    configurations = np.array(stored["configurations"]) @ [1.0, 1.0j]
    return GenericLoop(table, configurations)


@cache
def _generic_loop(number: int) -> GenericLoop:
    """The generic loop from which the paths of attempt ``number`` start.

    Another geometry makes other paths: those of an attempt may pass too near to a
    singular geometry to be followed in doubles.
    """
    loop = _stored_loop()
    if number == 0:
        return loop
    table = loop.table.copy()
    table[[0, 2]] *= ROTATION**number
    table[1] += 0.1j * number
    return GenericLoop(table, follow_paths(loop, table).angles)


def _lost_paths(paths: Paths) -> int:
    """How many paths stopped on the way: no end of theirs is known."""
    stopped = paths.ends == PathEnd.STOPPED
    return int(np.count_nonzero(stopped & (paths.rest > NEAR_THE_END)))


def _smallest_singular_values(angles: np.ndarray, table: np.ndarray) -> np.ndarray:
    """The smallest singular value (k,) of F' at configurations (k, 6), complex."""
    if not len(angles):
        return np.empty(0)
    links = np.zeros((JOINTS, 8), dtype=complex)
    _fill_links(np.ascontiguousarray(table, dtype=complex), links)
    jacobians = np.empty((len(angles), 6, JOINTS), dtype=complex)
    for configuration, jacobian in zip(angles, jacobians, strict=True):
        _closure(links, configuration, jacobian, np.empty(6, dtype=complex))
    return np.linalg.svd(jacobians, compute_uv=False)[:, -1]


def _distinct(angles: np.ndarray) -> np.ndarray:
    """Configurations (k, 6), complex, without those that stand there before."""
    kept: list[np.ndarray] = []
    for configuration in angles:
        gaps = [np.abs(_wrapped(configuration - other)).max() for other in kept]
        if min(gaps, default=np.inf) > EQUAL:
            kept.append(configuration)
    return np.array(kept).reshape(-1, JOINTS)


def _wrapped(angles: np.ndarray) -> np.ndarray:
    """Angles with real parts in (-pi, pi]."""
    turned = angles - 2 * np.pi * np.round(np.real(angles) / (2 * np.pi))
    return np.where(np.real(turned) <= -np.pi, turned + 2 * np.pi, turned)


# --- following a path -----------------------------------------------------------------


@njit(cache=True, nogil=True, error_model="numpy")
def _follow_paths(starts, first, last):
    """Ends (k, 6), rests (k,) and `PathEnd` numbers (k,) of paths from ``starts``."""
    angles, rest = starts.copy(), np.zeros(len(starts))
    ends = np.ones(len(starts), np.int64)
    for k in range(len(starts)):
        rest[k], ends[k] = _follow(angles[k], first, last)
    return angles, rest, ends


@njit(cache=True, nogil=True, error_model="numpy")
def _follow(theta, first, last):
    """Follow the configuration ``theta`` (6,), in place, while the geometry moves from
    ``first`` to ``last`` (3, 6): the rest of the path, and the number of the `PathEnd`.

    The next point is predicted by the cubic through the last two points and their
    velocities, and corrected by Newton's method. The rest of the path, not the way that
    was made, is the parameter: near the end it keeps all its digits.
    """
    n = len(theta)
    links = np.zeros((n, 8), np.complex128)
    jacobian = np.empty((6, n), np.complex128)
    velocity, trial = np.empty(n, np.complex128), np.empty(n, np.complex128)
    before, velocity_before = np.empty(n, np.complex128), np.empty(n, np.complex128)
    rest, step, last_step = 1.0, FIRST_STEP, 0.0
    regular = _velocity(theta, first, last, rest, links, jacobian, velocity)
    for _ in range(MOST_STEPS):
        if not regular:
            return rest, PathEnd.STOPPED.value
        at_the_end = rest < LAST_STRETCH
        step = rest if at_the_end else min(step, rest)
        for i in range(n):
            trial[i] = theta[i] + step * velocity[i]
            if last_step > 0:
                slope = (theta[i] - before[i]) / last_step
                bend = (2 * velocity[i] + velocity_before[i] - 3 * slope) / last_step
                twist = (velocity[i] + velocity_before[i] - 2 * slope) / last_step**2
                trial[i] += step**2 * (bend + step * twist)
        _links_at(first, last, rest - step, links)
        trusted = TRUSTED_AT_THE_END if at_the_end else TRUSTED
        correction = _correct(trial, links, jacobian, trusted)
        if not correction <= trusted:
            step *= 0.4
            if at_the_end or step < SHORTEST_SHARE * rest:
                return rest, PathEnd.STOPPED.value
            continue
        for i in range(n):
            before[i], velocity_before[i] = theta[i], velocity[i]
            theta[i] = trial[i]
        rest, last_step = rest - step, step
        if rest <= 0.0:
            return 0.0, PathEnd.ARRIVED.value
        for i in range(n):
            if abs(theta[i].imag) > INFINITE:
                return rest, PathEnd.AT_INFINITY.value
        regular = _velocity(theta, first, last, rest, links, jacobian, velocity)
        growth = (AIM / (correction + 1e-14)) ** 0.25
        step = min(LONGEST_STEP, step * min(2.0, max(0.5, growth)))
    return rest, PathEnd.STOPPED.value


@njit(cache=True, nogil=True, error_model="numpy")
def _correct(theta, links, jacobian, trusted):
    """The first correction of Newton's method on ``theta`` (6,), in place; infinite
    where it is larger than ``trusted`` or the next ones do not converge."""
    n = len(theta)
    step, error = np.empty(n, np.complex128), np.empty(6, np.complex128)
    first, size = 0.0, np.inf
    for i in range(4):
        _closure(links, theta, jacobian, error)
        if not _solve(jacobian, error, step):
            return np.inf
        size = 0.0
        for j in range(n):
            size = max(size, abs(step[j]))
        if i == 0:
            first = size
        if not size <= trusted:
            return np.inf
        for j in range(n):
            theta[j] -= step[j]
        if size < EXACT:
            break
    return first if size < CORRECTED else np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def _velocity(theta, first, last, rest, links, jacobian, velocity):
    """Fill ``velocity`` (6,), d theta / dt along the path; False where F' is
    singular."""
    _links_at(first, last, rest - DIFFERENCE, links)
    change, error = np.empty(6, np.complex128), np.empty(6, np.complex128)
    _closure(links, theta, jacobian, change)
    _links_at(first, last, rest, links)
    _closure(links, theta, jacobian, error)
    for i in range(6):
        change[i] = -(change[i] - error[i]) / DIFFERENCE
    return _solve(jacobian, change, velocity)


@njit(cache=True, nogil=True, error_model="numpy")
def _links_at(first, last, rest, links):
    """Fill the links (6, 8) of the geometry between two tables (3, 6)."""
    _fill_links(last + rest * (first - last), links)


@njit(cache=True, nogil=True, error_model="numpy")
def _closure(links, theta, jacobian, error):
    """Fill the closure error (6,), the vector parts of the unit dual quaternion of the
    whole loop, and its derivative ``jacobian`` (6, n).

    The vector part of a quaternion vanishes for the identity only.
    """
    n = len(theta)
    after = np.empty((n + 1, 8), np.complex128)
    turned, derivative = np.empty(8, np.complex128), np.empty(8, np.complex128)
    before, longer = np.empty(8, np.complex128), np.empty(8, np.complex128)
    for r in range(8):
        after[n, r] = 1.0 if r == 0 else 0.0
    for i in range(n - 1, -1, -1):
        _multiply(links[i], after[i + 1], turned)
        _turn(theta[i], turned, after[i])
    for r in range(8):
        before[r] = 0.0
    before[0] = 1.0 if after[0, 0].real >= 0 else -1.0
    for r in range(3):
        error[r] = before[0] * after[0, r + 1]
        error[r + 3] = before[0] * after[0, r + 5]
    for i in range(n):
        _turn_by_right_angle(after[i], turned)
        _multiply(before, turned, derivative)
        for r in range(3):
            jacobian[r, i] = derivative[r + 1] / 2
            jacobian[r + 3, i] = derivative[r + 5] / 2
        _turn(theta[i], links[i], turned)
        _multiply(before, turned, longer)
        before, longer = longer, before


@njit(cache=True, nogil=True, error_model="numpy")
def _multiply(p, q, out):
    """Fill the product (8,) of two dual quaternions (w, x, y, z, and the same of the
    dual part)."""
    for r in range(8):
        out[r] = 0.0
    for i in range(0, 8, 4):
        for j in range(0, 8 - i, 4):
            a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
            w, x, y, z = q[j], q[j + 1], q[j + 2], q[j + 3]
            k = i + j
            out[k] += a * w - b * x - c * y - d * z
            out[k + 1] += a * x + b * w + c * z - d * y
            out[k + 2] += a * y - b * z + c * w + d * x
            out[k + 3] += a * z + b * y - c * x + d * w


@njit(cache=True, nogil=True, error_model="numpy")
def _turn(angle, q, out):
    """Fill (cos(angle/2) + k sin(angle/2)) q (8,)."""
    c, s = np.cos(angle / 2), np.sin(angle / 2)
    _turn_by_right_angle(q, out)
    for r in range(8):
        out[r] = c * q[r] + s * out[r]


@njit(cache=True, nogil=True, error_model="numpy")
def _turn_by_right_angle(q, out):
    """Fill k q (8,)."""
    for i in (0, 4):
        out[i], out[i + 1], out[i + 2], out[i + 3] = (
            -q[i + 3],
            -q[i + 2],
            q[i + 1],
            q[i],
        )


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_links(table, links):
    """Fill the unit dual quaternions (n, 8) of Tz(R) Tx(a) Rx(alpha), as in
    `linkages.slices.elimination`, from a table (3, n) of a, alpha and R."""
    for i in range(table.shape[1]):
        a, alpha, offset = table[0, i], table[1, i], table[2, i]
        c, s = np.cos(alpha / 2), np.sin(alpha / 2)
        links[i, 0], links[i, 1], links[i, 2], links[i, 3] = c, s, 0, 0
        links[i, 4], links[i, 5] = -a * s / 2, a * c / 2
        links[i, 6], links[i, 7] = offset * s / 2, offset * c / 2


@njit(cache=True, nogil=True, error_model="numpy")
def _solve(matrix, right, solution):
    """Fill the ``solution`` (n,) of matrix x = right by elimination with row pivots;
    False for a singular matrix. Overwrites both."""
    n = len(right)
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if not 0.0 < abs(matrix[pivot, k]) < np.inf:
            return False
        if pivot != k:
            for j in range(k, n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            right[k], right[pivot] = right[pivot], right[k]
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            for j in range(k + 1, n):
                matrix[i, j] -= factor * matrix[k, j]
            right[i] -= factor * right[k]
    for k in range(n - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, n):
            total -= matrix[k, j] * solution[j]
        solution[k] = total / matrix[k, k]
    return True
