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

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np

from bifurc.limits import Deadline
from linkages import _core
from linkages.decisions import (
    is_in_reach,
    is_near_its_end,
    is_nearly_singular_end,
    is_real_end,
    is_same_end,
    is_singular_end,
)
from linkages.kinematics import LinkTable, joint_frames
from linkages.loop import Loop
from linkages.values import GeometryError

JOINTS = 6
ATTEMPTS = 3  # generic geometries from which the paths start
ROTATION = np.exp(0.7j)  # of the generic lengths and offsets from attempt to attempt
# Lengths (over the characteristic length), twists and offsets of the cuts; and the angles
# before them, without which the axes would all be square to one direction.
CUTS = ((0.618, 1.234, -0.377), (0.441, 0.873, 0.289))
ANGLES = (0.754, 2.016)


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

    >>> import linkages, numpy as np
    >>> twists = np.radians([90, 40, 70, 60, 80, 50])
    >>> loop = linkages.Loop([1, 0.9, 1.1, 0.8, 1.2, 0.7], twists, [0.1, 0, 0.2, 0, 0.1, 0])
    >>> assemblies = linkages.isolated_assemblies(loop)
    >>> assemblies.configurations.shape, assemblies.complete
    ((6, 6), True)
    """
    if not isinstance(loop, Loop):
        raise GeometryError("loop", type(loop).__name__, "a Loop, such as linkage.loop")
    if loop.n > JOINTS:
        raise GeometryError("number of joints", loop.n, f"at most {JOINTS}")
    deadline = Deadline(seconds)
    longer = _with_six_joints(loop)
    known = np.empty((0, JOINTS), dtype=complex)
    for attempt in range(ATTEMPTS):
        start = _generic_loop(attempt)
        paths = follow_paths(start, longer.table, deadline.left)
        paths = _followed_on(paths, start, longer.table, deadline)
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


def regular_complex(table: np.ndarray) -> tuple[np.ndarray, int]:
    """Configurations (k, 6), complex, rad, of six joints with a complex geometry ``table``
    (3, 6), lengths, twists (rad) and offsets, which are all of them if they are 16; and
    how many paths ended at others, at which the closure has no full rank."""
    for attempt in range(ATTEMPTS):
        start = _generic_loop(attempt)
        paths = follow_paths(start, table)
        arrived = paths.angles[paths.ends == PathEnd.ARRIVED]
        smallest = _core.smallest_singular_values(arrived, table)
        is_regular = ~is_nearly_singular_end(smallest)
        regular = _distinct(arrived[is_regular])
        if len(regular) == len(start.configurations):
            break
    return regular, int(np.count_nonzero(~is_regular))


def follow_paths(
    start: GenericLoop,
    table: np.ndarray,
    seconds: float = np.inf,
    shares: np.ndarray | float = 1.0,
) -> Paths:
    """The paths of all configurations of ``start`` while its geometry moves straight to
    ``table`` (3, 6); none of them is begun after about so many ``seconds``.

    Of all the way ``shares`` (k,) are left where they begin, each counted as 1.
    """
    last = np.asarray(table, dtype=complex)
    left = np.full(len(start.configurations), shares, dtype=float)
    paths = _core.follow_paths(start.configurations, start.table, last, left, seconds)
    return Paths(*paths)


def _followed_on(
    paths: Paths, start: GenericLoop, table: np.ndarray, deadline: Deadline
) -> Paths:
    """Those of the ``paths`` that stopped near their end, followed again from there, as
    long as there is time.

    Two regular configurations may be so near each other that the last steps of a path
    to one of them are too short beside all of it; beside what is left of it they are
    not.
    """
    angles, rest, ends = paths.angles.copy(), paths.rest.copy(), paths.ends.copy()
    stopped = np.flatnonzero(ends == PathEnd.STOPPED)
    near = stopped[is_near_its_end(rest[stopped])]
    for shares in (rest[near], 0.0):
        # at the end Newton's method goes on: a singular value that vanishes falls with it
        if not len(near) or deadline.passed:
            break
        here = GenericLoop(start.table, angles[near])
        again = follow_paths(here, table, deadline.left, shares)
        angles[near], ends[near] = again.angles, again.ends
        rest[near] *= again.rest
        has_arrived = again.ends == PathEnd.ARRIVED
        near = near[has_arrived]
    return Paths(angles, rest, ends)


# --- a loop of six joints -------------------------------------------------------------


@dataclass(frozen=True)
class _LongerLoop:
    """A loop of fewer joints with its last link cut by further axes.

    ``table`` (3, 6) of the longer loop, lengths over the characteristic length;
    ``joints`` of the given loop; ``zero`` (6,): the angles where those of the given loop
    are 0 and the further joints stand still.
    """

    table: np.ndarray
    joints: int
    zero: np.ndarray

    def configurations_of_given_loop(self, angles: np.ndarray) -> np.ndarray:
        """Those of the configurations (k, 6) in which the further joints stand still,
        as configurations (m, n) of the given loop, rad in (-pi, pi]."""
        given = _wrapped(angles - self.zero)
        away = np.abs(given[:, self.joints :])
        stands_still = is_same_end(away.max(axis=1, initial=0.0))
        own: np.ndarray = given[stands_still, : self.joints]
        return own


def _with_six_joints(loop: Loop) -> _LongerLoop:
    """``loop`` with its last link cut until it has six joints."""
    lengths, twists, offsets = loop.arrays
    size = loop.characteristic_length
    table = np.array([lengths / size, twists, offsets / size])
    zero = [0.0] * loop.n
    for cut, angle in list(zip(CUTS, ANGLES, strict=True))[: JOINTS - loop.n]:
        before = np.array(cut)
        rest = np.linalg.inv(_link_matrix(before, angle)) @ _link_matrix(table[:, -1])
        after = _link_between(rest)
        table = np.column_stack([table[:, :-1], before, after.link])
        table[2, 0] += after.slide
        zero[0] += after.turn
        zero[-1] += angle
        zero.append(after.angle)
    return _LongerLoop(table, loop.n, np.array(zero))


class _LinkBetween(NamedTuple):
    """A transform as Rz(angle) Tz(offset) Tx(length) Rx(twist) Rz(turn) Tz(slide);
    ``link`` (3,) holds length, twist and offset."""

    angle: float
    link: np.ndarray
    turn: float
    slide: float


def _link_between(transform: np.ndarray) -> _LinkBetween:
    """The link from the z-axis of the base to that of ``transform`` (4, 4), which must
    not be parallel."""
    axis = transform[:3, 2]
    twist = np.arccos(np.clip(axis[2], -1.0, 1.0))
    angle = float(np.arctan2(axis[0], -axis[1]))
    normal = np.array([np.cos(angle), np.sin(angle), 0.0])
    directions = np.column_stack([[0.0, 0.0, 1.0], normal, axis])
    offset, length, slide = np.linalg.solve(directions, transform[:3, 3])
    link = np.array([length, twist, offset])
    rest = np.linalg.inv(_link_matrix(link, angle)) @ transform
    turn = float(np.arctan2(rest[1, 0], rest[0, 0]))
    return _LinkBetween(angle, link, turn, float(slide))


def _link_matrix(link: np.ndarray, angle: float = 0.0) -> np.ndarray:
    """Rz(angle) Tz(offset) Tx(length) Rx(twist) (4, 4) of a link (length, twist,
    offset)."""
    table = LinkTable(*np.reshape(link, (3, 1)))
    matrix: np.ndarray = joint_frames(table, np.array([angle]))[-1]
    return matrix


# --- the ends of the paths ------------------------------------------------------------


@cache
def _generic_loop(number: int) -> GenericLoop:
    """The generic loop from which the paths of attempt ``number`` start: the first one
    comes with the package.

    Another geometry makes other paths: those of an attempt may pass too near to a
    singular geometry to be followed in doubles.
    """
    if number == 0:
        text = files("linkages.slices").joinpath("generic_loop.json").read_text("utf-8")
        stored = json.loads(text)
        table = np.array(stored["table"]) @ [1.0, 1.0j]
        return GenericLoop(table, np.array(stored["configurations"]) @ [1.0, 1.0j])
    loop = _generic_loop(0)
    table = loop.table.copy()
    table[[0, 2]] *= ROTATION**number
    table[1] += 0.1j * number
    return GenericLoop(table, follow_paths(loop, table).angles)


@dataclass(frozen=True)
class _Ends:
    """Where paths ended: at ``regular`` configurations (k, 6), complex; and how many of
    them at ``singular`` ones, at ``nearly_singular`` ones, ``at_infinity``, on the way
    there (``distant``), or ``lost``. Of the singular ones some are ``far_out``, where
    it is not known whether they run to infinity."""

    regular: np.ndarray
    singular: int
    nearly_singular: int
    far_out: int
    at_infinity: int
    distant: int
    lost: int

    @staticmethod
    def of(paths: Paths, table: np.ndarray) -> _Ends:
        """From the paths to a geometry, ``table`` (3, 6)."""
        has_arrived = paths.ends == PathEnd.ARRIVED
        has_stopped = paths.ends == PathEnd.STOPPED
        arrived = paths.angles[has_arrived]
        smallest = _core.smallest_singular_values(arrived, table.astype(complex))
        is_singular = is_singular_end(smallest)
        is_regular = ~is_nearly_singular_end(smallest)
        stopped, rest = paths.angles[has_stopped], paths.rest[has_stopped]
        is_near = is_near_its_end(rest)
        may_be_reached = is_in_reach(_largest_imaginary_parts(stopped))
        return _Ends(
            regular=arrived[is_regular],
            singular=int(np.count_nonzero(is_singular) + np.count_nonzero(is_near)),
            nearly_singular=int(np.count_nonzero(~is_singular & ~is_regular)),
            far_out=int(np.count_nonzero(is_near & ~may_be_reached)),
            at_infinity=int(np.count_nonzero(paths.ends == PathEnd.AT_INFINITY)),
            distant=int(np.count_nonzero(~is_near & ~may_be_reached)),
            lost=int(np.count_nonzero(~is_near & may_be_reached)),
        )

    @property
    def are_complete(self) -> bool:
        """Whether no path was lost, and none went over to another one: two would end at
        one configuration, or one of two conjugate configurations would be missing.

        What runs to infinity does so in conjugate pairs: where one angle goes to +i
        infinity, that of the other goes to -i infinity. Where a path ends far out it is
        not known whether its partner is counted among them.
        """
        in_reach = is_in_reach(_largest_imaginary_parts(self.regular))
        configurations = self.regular[in_reach]
        both = np.concatenate([configurations, configurations.conj()])
        numbers = {len(_distinct(each)) for each in (configurations, both)}
        are_pairs = (self.at_infinity + self.distant) % 2 == 0 or self.far_out > 0
        return (
            not self.lost
            and not self.nearly_singular
            and are_pairs
            and numbers == {len(configurations)}
        )

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
        if self.nearly_singular:
            parts.append(f"{self.nearly_singular} where the rank is nearly low")
        return ", ".join(parts)


def _largest_imaginary_parts(angles: np.ndarray) -> np.ndarray:
    """The largest size of an imaginary part (k,) in each of the configurations
    (k, 6)."""
    parts: np.ndarray = np.abs(angles.imag).max(axis=1, initial=0.0)
    return parts


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
