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

from bifurc.limits import Deadline
from linkages.decisions import (
    is_in_reach,
    is_near_its_end,
    is_real_end,
    is_same_end,
    is_singular_end,
)
from linkages.loop import GeometryError, Loop

__all__ = [
    "Assemblies",
    "GenericLoop",
    "PathEnd",
    "follow_paths",
    "isolated_assemblies",
]

JOINTS = 6
ATTEMPTS = 3  # generic geometries from which the paths start
ROTATION = np.exp(0.7j)  # of the generic lengths and offsets from attempt to attempt
# Lengths (over the characteristic length), twists and offsets of the cuts.
CUTS = ((0.618, 1.234, -0.377), (0.441, 0.873, 0.289))

# Of the paths.
FIRST_STEP, LONGEST_STEP = 0.02, 0.1
# A step shorter than this share of the rest of the path is none; near the end, where
# rounding stops a path to a singular configuration, than the other one.
SHORTEST_SHARE, SHORTEST_STIFF_SHARE = 1e-7, 0.05
STIFF = 1e-5
# A step that is not all of the rest is at most this share of it. If the step to the
# end fails, it is tried again when the rest is smaller by the other share.
MOST_SHARE, WHOLE_AGAIN = 0.8, 1e-3
SHORTER = 0.4  # by which a step that failed is shortened
# The rest of a path that is taken in one step or not at all: a path to a singular
# configuration comes to its end in ever shorter steps. Two configurations of which each
# has the singular value s meet about s^2 behind the end.
LAST_STRETCH = 1e-12
TRUSTED = 1e-2  # rad: the largest first correction of an accepted step
AIM = 1e-3  # rad: the first correction that the length of a step aims at
CONTRACTION = 0.1  # of a correction to the next, on an accepted step
ROUNDING = 1e-7  # rad: a correction that may be one of rounding
EXACT = 1e-11  # rad: a correction after which no other is made
CORRECTED = 1e-5  # rad: the largest last correction of an accepted step
CORRECTIONS, LAST_CORRECTIONS = 2, 5  # of a step, and of the last step of a path
FAR_AWAY = 2.0  # imaginary part beyond which dual quaternions save digits
INFINITE = 12.0  # imaginary part of an angle beyond which a path runs to infinity
MOST_STEPS = 2000


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


def isolated_assemblies(loop: Loop, seconds: float = np.inf) -> Assemblies:
    """All real configurations of ``loop`` at which its closure has full rank.

    After about so many ``seconds`` no further path is followed. Raises `GeometryError`
    for a loop of more than six joints.
    """
    if not isinstance(loop, Loop):
        raise GeometryError("loop", type(loop).__name__, "a Loop, such as linkage.loop")
    if loop.n > JOINTS:
        raise GeometryError("number of joints", loop.n, f"at most {JOINTS}")
    deadline = Deadline(seconds)
    longer = _with_six_joints(loop)
    known = np.empty((0, JOINTS), dtype=complex)
    for attempt in range(ATTEMPTS):
        paths = _paths_in_time(_generic_loop(attempt), longer.table, deadline)
        ends = _Ends.of(paths, longer.table)
        known = _distinct(np.concatenate([known, ends.regular]))
        if ends.are_complete or deadline.passed:
            break
    real = known[is_real_end(_largest_imaginary_parts(known))].real
    configurations = longer.configurations_of_given_loop(real)
    return Assemblies(
        configurations=configurations,
        complete=ends.are_complete,
        statement=ends.statement(len(configurations)),
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
        stands_still = is_same_end(away.max(axis=1, initial=0.0))
        own = angles[stands_still, : self.joints].copy()
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


def _paths_in_time(start: GenericLoop, table: np.ndarray, deadline: Deadline) -> Paths:
    """The paths of all configurations of ``start`` to ``table`` (3, 6), none of them
    begun after the deadline."""
    count = len(start.configurations)
    angles = start.configurations.copy()
    rest = np.ones(count)
    ends = np.full(count, PathEnd.STOPPED)
    for k in range(count):
        if deadline.passed:
            break
        one = GenericLoop(start.table, start.configurations[k : k + 1])
        path = follow_paths(one, table)
        angles[k], rest[k], ends[k] = path.angles[0], path.rest[0], path.ends[0]
    return Paths(angles, rest, ends)


@dataclass(frozen=True)
class _Ends:
    """Where paths ended: at ``regular`` configurations (k, 6), complex; and how many of
    them at ``singular`` ones, ``at_infinity``, on the way there (``distant``), or
    ``lost``."""

    regular: np.ndarray
    singular: int
    at_infinity: int
    distant: int
    lost: int

    @staticmethod
    def of(paths: Paths, table: np.ndarray) -> _Ends:
        """From the paths to a geometry, ``table`` (3, 6)."""
        has_arrived = paths.ends == PathEnd.ARRIVED
        has_stopped = paths.ends == PathEnd.STOPPED
        arrived = paths.angles[has_arrived]
        is_singular = is_singular_end(_smallest_singular_values(arrived, table))
        stopped, rest = paths.angles[has_stopped], paths.rest[has_stopped]
        is_near = is_near_its_end(rest)
        is_lost = is_in_reach(_largest_imaginary_parts(stopped[~is_near]))
        return _Ends(
            regular=arrived[~is_singular],
            singular=int(np.count_nonzero(is_singular) + np.count_nonzero(is_near)),
            at_infinity=int(np.count_nonzero(paths.ends == PathEnd.AT_INFINITY)),
            distant=int(np.count_nonzero(~is_lost)),
            lost=int(np.count_nonzero(is_lost)),
        )

    @property
    def are_complete(self) -> bool:
        """Whether no path was lost, and none went over to another one: two would end at
        one configuration, or one of two conjugate configurations would be missing.

        What runs to infinity does so in conjugate pairs: where one angle goes to +i
        infinity, that of the other goes to -i infinity.
        """
        in_reach = is_in_reach(_largest_imaginary_parts(self.regular))
        configurations = self.regular[in_reach]
        both = np.concatenate([configurations, configurations.conj()])
        numbers = {len(_distinct(each)) for each in (configurations, both)}
        are_pairs = (self.at_infinity + self.distant) % 2 == 0
        return not self.lost and are_pairs and numbers == {len(configurations)}

    def statement(self, real: int) -> str:
        """Where the paths ended, as a sentence; ``real`` assemblies are known."""
        regular = len(self.regular)
        parts = [f"{regular} of 16 paths ended at isolated configurations"]
        if regular:
            parts[0] += f", {real or 'none'} of them real"
        if self.singular:
            parts.append(f"{self.singular} on motions or where the rank is low")
        if self.at_infinity + self.distant:
            parts.append(f"{self.at_infinity + self.distant} ran to infinity")
        if self.lost:
            parts.append(f"{self.lost} stopped on the way")
        return ", ".join(parts)


def _largest_imaginary_parts(angles: np.ndarray) -> np.ndarray:
    """The largest size of an imaginary part (k,) in each of the configurations
    (k, 6)."""
    parts: np.ndarray = np.abs(angles.imag).max(axis=1, initial=0.0)
    return parts


def _smallest_singular_values(angles: np.ndarray, table: np.ndarray) -> np.ndarray:
    """The smallest singular value (k,) of F' at configurations (k, 6), complex."""
    if not len(angles):
        return np.empty(0)
    geometry = np.empty((4, JOINTS), dtype=complex)
    _fill_geometry(np.ascontiguousarray(table, dtype=complex), geometry)
    screws = np.empty((len(angles), 6, JOINTS), dtype=complex)
    no_change = np.zeros((3, JOINTS), dtype=complex)
    for configuration, of_configuration in zip(angles, screws, strict=True):
        rights = np.empty((6, 2), dtype=complex)
        _close(configuration, geometry, no_change, of_configuration, rights)
    values: np.ndarray = np.linalg.svd(screws, compute_uv=False)[:, -1]
    return values


def _distinct(angles: np.ndarray) -> np.ndarray:
    """Configurations (k, 6), complex, without those that stand there before."""
    gaps = _wrapped(angles[:, None] - angles[None])
    is_equal = is_same_end(np.abs(gaps).max(axis=2, initial=0.0))
    is_repeated = np.tril(is_equal, -1).any(axis=1)
    distinct: np.ndarray = angles[~is_repeated]
    return distinct


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
    change = first - last
    work = _workspace(n)
    steps = work[3]  # the last step of Newton's method, and the velocity
    if not _correct(theta, first, change, work, TRUSTED, CORRECTIONS) <= TRUSTED:
        return 1.0, PathEnd.STOPPED.value
    velocity, trial = steps[:, 1].copy(), np.empty(n, np.complex128)
    before, velocity_before = np.zeros_like(trial), np.zeros_like(trial)
    rest, step, last_step = 1.0, FIRST_STEP, 0.0
    whole_below = 1.0  # the rest below which a step of all of it is tried
    for _ in range(MOST_STEPS):
        at_the_end = rest < LAST_STRETCH
        to_the_end = at_the_end or (step >= rest and rest <= whole_below)
        step = rest if to_the_end else min(step, MOST_SHARE * rest)
        _predict(theta, velocity, before, velocity_before, last_step, step, trial)
        table = last + (rest - step) * change
        most = LAST_CORRECTIONS if to_the_end else CORRECTIONS
        correction = _correct(trial, table, change, work, TRUSTED, most)
        if not correction <= TRUSTED:
            whole_below = WHOLE_AGAIN * rest if to_the_end else whole_below
            step *= SHORTER
            if at_the_end or step < _shortest_share(rest) * rest:
                return rest, PathEnd.STOPPED.value
            continue
        before[:], velocity_before[:] = theta, velocity
        theta[:], velocity[:] = trial, steps[:, 1]
        rest, last_step = rest - step, step
        if to_the_end:
            return 0.0, PathEnd.ARRIVED.value
        if _largest_imaginary_part(theta) > INFINITE:
            return rest, PathEnd.AT_INFINITY.value
        growth = (AIM / (correction + 1e-14)) ** 0.25
        step = min(LONGEST_STEP, step * min(2.0, max(0.5, growth)))
    return rest, PathEnd.STOPPED.value


@njit(cache=True, nogil=True, error_model="numpy")
def _shortest_share(rest):
    """The smallest share of the ``rest`` of a path that is a step."""
    return SHORTEST_SHARE if rest > STIFF else SHORTEST_STIFF_SHARE


@njit(cache=True, nogil=True, error_model="numpy")
def _largest_imaginary_part(theta):
    """The largest size of an imaginary part in ``theta`` (n,)."""
    largest = 0.0
    for angle in theta:
        largest = max(largest, abs(angle.imag))
    return largest


@njit(cache=True, nogil=True, error_model="numpy")
def _workspace(n):
    """Geometry (4, n), screws (6, n), the closure error with its rate (6, 2) and what
    solves for them (n, 2), to be filled."""
    geometry, screws = np.empty((4, n), np.complex128), np.empty((6, n), np.complex128)
    rights, steps = np.empty((6, 2), np.complex128), np.empty((n, 2), np.complex128)
    return geometry, screws, rights, steps


@njit(cache=True, nogil=True, error_model="numpy")
def _predict(theta, velocity, before, velocity_before, last_step, step, trial):
    """Fill the point ``trial`` (6,) a ``step`` ahead on the cubic through the last two
    points and their velocities; on the tangent where there is no ``last_step``."""
    for i in range(len(theta)):
        trial[i] = theta[i] + step * velocity[i]
        if last_step > 0:
            slope = (theta[i] - before[i]) / last_step
            bend = (2 * velocity[i] + velocity_before[i] - 3 * slope) / last_step
            twist = (velocity[i] + velocity_before[i] - 2 * slope) / last_step**2
            trial[i] += step**2 * (bend + step * twist)


@njit(cache=True, nogil=True, error_model="numpy")
def _correct(theta, table, change, work, trusted, most):
    """The first correction of Newton's method on ``theta`` (6,), in place; infinite
    where it is larger than ``trusted`` or the next ones, at most ``most`` in all, do
    not converge.

    The first correction says how far the prediction was off; each following one is to
    be smaller by `CONTRACTION`, which it is not where another configuration is near.
    The last array of ``work`` holds the velocity along the path afterwards.
    """
    geometry, screws, rights, steps = work
    _fill_geometry(table, geometry)
    is_far_away = _largest_imaginary_part(theta) > FAR_AWAY
    first, size = np.inf, np.inf
    for i in range(most):
        _close(theta, geometry, change, screws, rights)
        if is_far_away:
            _close_far_away(theta, table, screws, rights)
        if not _solve(screws, rights, steps):
            return np.inf
        former, size = size, 0.0
        for j in range(len(theta)):
            size = max(size, abs(steps[j, 0].real) + abs(steps[j, 0].imag))
        if i == 0:
            first = size
        if not size <= trusted:
            return np.inf
        if i > 0 and size > max(CONTRACTION * former, ROUNDING):
            return np.inf
        theta -= steps[:, 0]
        if size < EXACT:
            break
    return first if size < CORRECTED else np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_geometry(table, geometry):
    """Fill lengths, offsets, cosines and sines of the twists (4, 6) from a ``table``
    (3, 6) of lengths, twists and offsets."""
    for i in range(table.shape[1]):
        geometry[0, i], geometry[1, i] = table[0, i], table[2, i]
        geometry[2, i], geometry[3, i] = _cosine_and_sine(table[1, i])


@njit(cache=True, nogil=True, error_model="numpy")
def _cosine_and_sine(angle):
    """Cosine and sine of a complex angle."""
    c, s = np.cos(angle.real), np.sin(angle.real)
    e = np.exp(angle.imag)
    cosh, sinh = (e + 1.0 / e) / 2, (e - 1.0 / e) / 2
    return complex(c * cosh, -s * sinh), complex(s * cosh, c * sinh)


@njit(cache=True, nogil=True, error_model="numpy")
def _close(theta, geometry, change, screws, rights):
    """Fill the joint screws (6, n), direction over moment, in ``rights`` (6, 2) the
    closure error, and its rate where the table of the geometry has the rates ``change``
    (3, 6).

    The screws are the derivatives of the error where the loop is closed. The error
    (skew part of the rotation, translation) vanishes for half turns, too: no path leads
    from a closed loop to one.
    """
    frame = np.zeros((3, 4), np.complex128)  # columns: three axes, origin
    for r in range(3):
        frame[r, r] = 1.0
    normal = np.empty(6, np.complex128)
    rights[:, 1] = 0.0
    for i in range(len(theta)):
        _fill_line(frame, 2, screws[:, i])
        _advance(frame, theta[i], geometry[:, i])
        _fill_line(frame, 0, normal)  # about which the twist turns
        for r in range(6):
            rights[r, 1] += change[1, i] * normal[r]
        for r in range(3):
            slide = change[0, i] * normal[r] + change[2, i] * screws[r, i]
            rights[r + 3, 1] += slide
    for r in range(3):
        u, v = (r + 1) % 3, (r + 2) % 3
        rights[r, 0] = 0.5 * (frame[v, u] - frame[u, v])
        rights[r + 3, 0] = frame[r, 3]


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_line(frame, axis, line):
    """Fill the ``line`` (6,), direction over moment, of an axis of a frame (3, 4)."""
    for r in range(3):
        u, v = (r + 1) % 3, (r + 2) % 3
        line[r] = frame[r, axis]
        line[r + 3] = frame[u, 3] * frame[v, axis] - frame[v, 3] * frame[u, axis]


@njit(cache=True, nogil=True, error_model="numpy")
def _advance(frame, angle, link):
    """Move a frame (3, 4) over a joint and its ``link`` (4,): length, offset, cosine and
    sine of the twist."""
    c, s = _cosine_and_sine(angle)
    length, offset, ca, sa = link
    for r in range(3):
        x, y = c * frame[r, 0] + s * frame[r, 1], c * frame[r, 1] - s * frame[r, 0]
        z = frame[r, 2]
        frame[r, 3] += offset * z + length * x
        frame[r, 0], frame[r, 1], frame[r, 2] = x, ca * y + sa * z, ca * z - sa * y


@njit(cache=True, nogil=True, error_model="numpy")
def _close_far_away(theta, table, screws, rights):
    """Fill joint screws and closure error as `_close` does, from unit dual quaternions:
    twice the vector parts of that of the whole loop, and their derivatives.

    Where angles have large imaginary parts the entries of a quaternion grow with half
    of these only, and it takes many digits less.
    """
    n = len(theta)
    links = np.zeros((n, 8), np.complex128)
    _fill_links(table, links)
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
        rights[r, 0] = 2 * before[0] * after[0, r + 1]
        rights[r + 3, 0] = 2 * before[0] * after[0, r + 5]
    for i in range(n):
        _turn_by_right_angle(after[i], turned)
        _multiply(before, turned, derivative)
        for r in range(3):
            screws[r, i] = derivative[r + 1]
            screws[r + 3, i] = derivative[r + 5]
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
    c, s = _cosine_and_sine(angle / 2)
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
        c, s = _cosine_and_sine(alpha / 2)
        links[i, 0], links[i, 1], links[i, 2], links[i, 3] = c, s, 0, 0
        links[i, 4], links[i, 5] = -a * s / 2, a * c / 2
        links[i, 6], links[i, 7] = offset * s / 2, offset * c / 2


@njit(cache=True, nogil=True, error_model="numpy")
def _solve(matrix, rights, solutions):
    """Fill the ``solutions`` (6, 2) of matrix X = rights by elimination with row
    pivots; False for a singular matrix. Overwrites both."""
    n = len(rights)
    for k in range(n):
        pivot, largest = k, 0.0
        for i in range(k, n):
            size = abs(matrix[i, k].real) + abs(matrix[i, k].imag)
            if size > largest:
                pivot, largest = i, size
        if not 0.0 < largest < np.inf:
            return False
        if pivot != k:
            for j in range(k, n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            for j in range(2):
                rights[k, j], rights[pivot, j] = rights[pivot, j], rights[k, j]
        inverse = 1.0 / matrix[k, k]
        for i in range(k + 1, n):
            factor = matrix[i, k] * inverse
            for j in range(k + 1, n):
                matrix[i, j] -= factor * matrix[k, j]
            for j in range(2):
                rights[i, j] -= factor * rights[k, j]
        matrix[k, k] = inverse
    for k in range(n - 1, -1, -1):
        for j in range(2):
            total = rights[k, j]
            for i in range(k + 1, n):
                total -= matrix[k, i] * solutions[i, j]
            solutions[k, j] = total * matrix[k, k]
    return True
