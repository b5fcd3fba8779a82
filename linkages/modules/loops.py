"""Single loops in space, by the chains of turns and slides that they are.

Where an unknown of a loop is held, all others are a chain of single turns and slides,
whatever joints these are of: six that lead to a frame, three that lead to a point, or one
that leads to a distance. There are few types of such chains, and the generic solutions
of all of them are part of the package. So paths lead from these to the configurations of
any loop where an unknown has some value, real or not.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple, TypeAlias

import numpy as np

from linkages.decisions import (
    is_degenerate_dyad,
    meets_in_one_point,
)
from linkages.dyads.generic import SOLVED, UnfollowedError
from linkages.mechanisms.joint import Joint, JointKind, Motion
from linkages.mechanisms.mechanism import Mechanism
from linkages.modules.equations import (
    ClosureFamily,
    Move,
    mirror_of,
    quaternion,
    require_no_short_length,
)
from linkages.slices.assemblies import regular_complex
from linkages.structure.structure import Closure, ClosureKind, Share, Structure

# Turns and slides, one after the other.
Letters: TypeAlias = str
SLIDE, TURN, POINT = "P", "R", "S"
KINDS = {
    SLIDE: JointKind.PRISMATIC,
    TURN: JointKind.REVOLUTE,
    POINT: JointKind.SPHERICAL,
}
# How many unknowns a chain determines, and the spherical joints that close it so.
LENGTHS = {ClosureKind.CYCLE: 6, ClosureKind.POINT: 3, ClosureKind.ROD: 1}
SPHERICAL = {ClosureKind.CYCLE: 0, ClosureKind.POINT: 1, ClosureKind.ROD: 2}
RING = 6 * TURN
NOTHING = -1  # the number of no unknown
MOST_SLIDES = 3  # more of them in a cycle move, or turns cannot close it


class Chain(NamedTuple):
    """The ``moves`` along a chain, and where it ends: ``second`` (3,) of the last body
    comes to ``first`` (3,) of the first one, or to a distance from it."""

    moves: tuple[Move, ...]
    first: np.ndarray
    second: np.ndarray


@dataclass(frozen=True, eq=False)
class Held:
    """A chain with what is held in it taken out: the ``unknowns``, by number, their
    ``directions`` and ``points`` (3,), and the displacement (4, 4) that is left at the
    end of it. All are complex."""

    chain: Chain
    unknowns: list[int]
    directions: list[np.ndarray]
    points: list[np.ndarray]
    rest: np.ndarray

    @property
    def turn(self) -> np.ndarray:
        """The rotation (3, 3) that is left."""
        return self.rest[:3, :3]

    def moved(self, place: np.ndarray) -> np.ndarray:
        """Where what is left takes a place (3,)."""
        moved: np.ndarray = self.turn @ place + self.rest[:3, 3]
        return moved

    @property
    def end(self) -> list[complex]:
        """Where the unknowns have to lead: a quaternion and a translation."""
        back = -self.turn.T @ self.rest[:3, 3]
        return [*quaternion(*self.turn[:2]), *back.tolist()]


def single_loop(closures: ClosureFamily) -> SingleLoop | None:
    """The loop that they are of; None where they are of none, and where it is of no type,
    or with some of its unknowns held if it is driven."""
    numbers = (
        range(len(closures.structure.unknowns)) if closures.is_driven else [NOTHING]
    )
    try:
        loop = SingleLoop(closures)
        for number in numbers:
            loop.family(number)
    except ValueError:
        return None
    return loop


class SingleLoop:
    """The loop of a ``closures`` family. Raises `ValueError` where these are of no single
    loop in space, of single turns and slides."""

    def __init__(self, closures: ClosureFamily):
        self.closures, self.structure = closures, closures.structure
        placement, moves = closures.placement, closures.moves
        shares = (self.structure.share(move.variable) for move in moves)
        known = sorted(share for share in shares if share is not None)
        is_flat = placement.is_planar or placement.is_spherical
        has_leg = any(one.rod and one.rod.leg for one in closures.closures)
        numbers = range(len(self.structure.unknowns))
        is_whole = known == [Share(number, 1.0, 0.0) for number in numbers]
        if not closures.is_single or is_flat or has_leg or not is_whole:
            raise ValueError("it is no single loop of turns and slides in space")

    @property
    def _closure(self) -> Closure:
        return self.closures.closures[0]

    def family(self, driver: int = NOTHING) -> ClosureFamily:
        """The chains of the type that is left where an unknown, by number, is held.

        Raises `ValueError` where there is no such type.
        """
        letters = min(
            _letters(self.closures, one.moves, driver) for one in self._ways()
        )
        return chains_of(self._closure.kind, letters)

    def solutions(self, driver: int = NOTHING, place: complex = 0.0) -> np.ndarray:
        """All configurations, with an unknown, by number, at a place: coordinates
        (k, c) of the closures.

        Raises `UnfollowedError` where it is not known that they are all.
        """
        family = self.family(driver)
        own = self.closures if driver == NOTHING else self.closures.driven_by((driver,))
        if not own.is_regular:
            raise UnfollowedError("it moves, or more holds it than has to")
        held = self._held(self._chain(family, driver), driver, place)
        found = self._of_ring(family, held)
        if found is None:
            found = self._ends(family, self._member(family, held))
        points = np.empty((len(found), self.closures.n), dtype=complex)
        columns = self.closures.columns
        for number, there in zip(held.unknowns, _columns(family), strict=True):
            points[:, columns[number]] = found[:, there]
        given = own.given
        if driver != NOTHING:
            given = own.given_at(place)
            is_angle = self.structure.unknowns[driver].is_angle
            at = [np.exp(1j * place), np.exp(-1j * place)] if is_angle else place
            points[:, columns[driver]] = at
        self._require_solved(points, given)
        return points

    def _ends(self, family: ClosureFamily, member: np.ndarray) -> np.ndarray:
        """All solutions (k, n) of a member (q,) of a family: where paths to it are lost at
        once, as beside those that end where what is special moves, it is not worth more."""
        paths = family.followed(family.generic.fibre, member, again=1)
        if not np.all(paths.is_regular | ~paths.is_finite):
            raise UnfollowedError("some configurations are singular, or not reached")
        if not np.all(paths.is_finite):
            require_no_short_length(self.structure)
        return paths.regular

    def _require_solved(self, points: np.ndarray, given: np.ndarray) -> None:
        gaps = np.abs(self.closures.family.residuals(points, given))
        size = 1.0 + np.abs(points).max(initial=0.0)
        if gaps.max(initial=0.0) > SOLVED * size * size:
            raise UnfollowedError("what solves the equations of a chain closes no loop")

    def is_ring_beside(self, driver: int) -> bool:
        """Whether six turns are left where an unknown, by number, is held."""
        return self.family(driver) is _ring()

    def on_every_motion(self) -> list[int]:
        """Unknowns, by number, of which one moves on every motion: all but some that do
        not move without others."""
        left_out: list[int] = []
        if self._closure.kind is ClosureKind.CYCLE:
            left_out = self._of_no_cycle()
        elif self._closure.kind is ClosureKind.POINT:
            left_out = self._of_no_point()
        unknowns = range(len(self.structure.unknowns))
        return [number for number in unknowns if number not in left_out]

    def _of_no_cycle(self) -> list[int]:
        """Unknowns of a cycle, by number, that do not move without others.

        Turns that move alone have one direction, so there are two of them at least, or
        else two slides. Three in a row do not move alone where neighbours are not
        parallel and the first and the last do not become so (`SpaceGeometry`).
        """
        axes = self._axes()
        turns = [number for number, motion in axes if motion.is_turn]
        slides = [number for number, motion in axes if not motion.is_turn]
        lasts = [motion for _, motion in axes if motion.is_turn][-3:]
        if len(axes) == len(self.closures.moves) and len(lasts) == 3:
            first, second, third = (motion.direction for motion in lasts)
            cosines = abs(float(first @ second)), abs(float(second @ third))
            sine = math.sqrt(max(0.0, 1.0 - max(cosines) ** 2))
            if not is_degenerate_dyad(min(abs(cosines[0] - cosines[1]), sine)):
                return [*turns[-3:], *slides[-1:]]
        return [*turns[-1:], *slides[-1:]]

    def _of_no_point(self) -> list[int]:
        """Unknowns next to a point, by number, that do not move without others: it moves
        on a circle or a line, and the next ones move it on another one."""
        axes = self._axes()
        if len(axes) < len(self.closures.moves):
            return []
        (before, other), (last, motion) = axes[-2:]
        arm = (self._closure.second - motion.point) / self.structure.unit
        distance = float(np.linalg.norm(np.cross(motion.direction, arm)))
        if motion.is_turn and meets_in_one_point(distance, 1.0):
            return []
        across = np.cross(other.direction, motion.direction)
        is_other = other.is_turn != motion.is_turn
        if is_other or not is_degenerate_dyad(float(np.linalg.norm(across))):
            return [before, last]
        return [last]

    def _axes(self) -> list[tuple[int, Motion]]:
        """The unknowns along the chain, by number, and their motions as drawn."""
        variables = self.structure.mechanism.variables
        numbers = map(self.closures.unknown_of, self.closures.moves)
        return [
            (number, variables[move.variable].motion)
            for number, move in zip(numbers, self.closures.moves, strict=True)
            if number is not None
        ]

    def _of_ring(self, family: ClosureFamily, held: Held) -> np.ndarray | None:
        """All solutions (16, 12) of a ring of six turns by the paths of such loops; None
        of others, and where these do not find all."""
        if family is not _ring():
            return None
        table, zero = _links(held)
        if not np.all(np.isfinite(table)):
            raise UnfollowedError("axes are parallel")
        angles, singular = regular_complex(table)
        if singular:
            raise UnfollowedError("some configurations are singular or move")
        if len(angles) < len(family.generic.fibre.solutions):
            return None
        found = np.empty((len(angles), family.n), dtype=complex)
        for angle, own in zip((angles - zero).T, _columns(family), strict=True):
            found[:, own] = np.exp(1j * np.outer(angle, [1.0, -1.0]))
        return found

    # --- the chain --------------------------------------------------------------------

    def _chain(self, family: ClosureFamily, driver: int) -> Chain:
        """The chain, passed as those of its type are where the driver is held."""
        letters = _letters(family, family.moves)
        return next(
            chain
            for chain in self._ways()
            if _letters(self.closures, chain.moves, driver) == letters
        )

    def _ways(self) -> Iterator[Chain]:
        """The chain, both ways and a cycle from everywhere."""
        closure, placement = self._closure, self.closures.placement
        ends = placement.point(closure.first), placement.point(closure.second)
        there = tuple(self.closures.moves)
        back = tuple(Move(-sign, variable) for sign, variable in reversed(there))
        is_cycle = closure.kind is ClosureKind.CYCLE
        for moves, (first, second) in ((there, ends), (back, ends[::-1])):
            for start in range(len(moves) if is_cycle else 1):
                yield Chain(moves[start:] + moves[:start], first, second)

    def _held(self, chain: Chain, driver: int, place: complex) -> Held:
        """A chain with the driver held at a place: what is behind it is moved."""
        held = Held(chain, [], [], [], np.eye(4, dtype=complex))
        placement, rest = self.closures.placement, held.rest
        for move in chain.moves:
            variable = self.structure.mechanism.variables[move.variable]
            motion, number = variable.motion, self.closures.unknown_of(move)
            direction = move.sign * placement.direction(motion)
            point = np.zeros(3)
            if motion.is_turn:
                point = placement.point_on_axis(motion)
            if number is not None and number != driver:
                held.unknowns.append(number)
                held.directions.append(rest[:3, :3] @ direction)
                held.points.append(rest[:3, :3] @ point + rest[:3, 3])
                continue
            value = place
            if number is None:
                unit = 1.0 if motion.is_turn else self.structure.unit
                value = (variable.locked or 0.0) / unit
            rest = rest @ _displacement(motion, direction, point, value)
        return replace(held, rest=rest)

    def _member(self, family: ClosureFamily, held: Held) -> np.ndarray:
        """The parameters (q,) of the chain among those of its type."""
        given, blocks = family.given, family.parameters.blocks
        axes = zip(family.moves, held.directions, held.points, strict=True)
        for (sign, number), direction, point in axes:
            motion = family.structure.mechanism.variables[number].motion
            given[blocks[family.direction_of(motion)]] = mirror_of(sign * direction)
            if motion.is_turn:
                given[blocks[family.point_of(motion)]] = point
        (closure,) = family.closures
        target: Sequence[complex] = held.end
        if closure.kind is not ClosureKind.CYCLE:
            moved = held.moved(held.chain.second)
            given[blocks[family.place_of(closure.second)]] = moved
            target = held.chain.first.tolist()
        if closure.kind is ClosureKind.ROD:
            given[blocks[family.place_of(closure.first)]] = held.chain.first
            target = self.closures.target_of(self._closure)
        given[blocks["target", 0]] = target
        return given


def _links(held: Held) -> tuple[np.ndarray, np.ndarray]:
    """Lengths, twists and offsets (3, k) of a ring of turns, and the angles (k,) between
    the links where its unknowns are 0; not finite where axes are parallel."""
    axes = np.array([*held.directions, held.turn @ held.directions[0]])
    points = np.array([*held.points, held.moved(held.points[0])])
    ways, here, there = np.diff(points, axis=0), axes[:-1], axes[1:]
    cosines, along = _dots(here, there), _dots(ways, here)
    with np.errstate(all="ignore"):
        normals = np.cross(here, there)
        sines = np.sqrt(_dots(normals, normals))
        normals /= sines[:, None]
        # where a normal comes to the next axis
        ends = (cosines * along - _dots(ways, there)) / sines**2
    before = np.roll(normals, 1, axis=0)
    before[0] = held.turn.T @ before[0]
    zero = _angles(_dots(before, normals), _dots(here, np.cross(before, normals)))
    # from where a normal comes to an axis to where the next one leaves it
    offsets = along + cosines * ends - np.roll(ends, 1)
    return np.array([_dots(ways, normals), _angles(cosines, sines), offsets]), zero


def _dots(vectors: np.ndarray, others: np.ndarray) -> np.ndarray:
    """The products (k,) of complex vectors (k, 3) with others."""
    dots: np.ndarray = (vectors * others).sum(axis=1)
    return dots


def _angles(cosines: np.ndarray, sines: np.ndarray) -> np.ndarray:
    """The complex angles with these cosines and sines."""
    angles: np.ndarray = -1j * np.log(cosines + 1j * sines)
    return angles


def _columns(family: ClosureFamily) -> list[slice]:
    """The coordinates of the unknowns of a family, in the order of its chain."""
    numbers = map(family.unknown_of, family.moves)
    return [family.columns[number] for number in numbers if number is not None]


def _displacement(
    motion: Motion, direction: np.ndarray, point: np.ndarray, value: complex
) -> np.ndarray:
    """What a motion (4, 4) makes of a value, real or not, along or about an axis."""
    displacement = np.eye(4, dtype=complex)
    if not motion.is_turn:
        displacement[:3, 3] = value * direction
        return displacement
    x, y, z = direction
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + np.sin(value) * cross + (1.0 - np.cos(value)) * cross @ cross
    displacement[:3, :3] = turn
    displacement[:3, 3] = point - turn @ point
    return displacement


# --- types ----------------------------------------------------------------------------


def _letters(
    closures: ClosureFamily, moves: Iterable[Move], driver: int = NOTHING
) -> Letters:
    """The turns and slides that are not held."""
    numbers = map(closures.unknown_of, moves)
    unknowns = closures.structure.unknowns
    return "".join(
        TURN if unknowns[number].is_angle else SLIDE
        for number in numbers
        if number is not None and number != driver
    )


@cache
def chains_of(kind: ClosureKind, letters: Letters) -> ClosureFamily:
    """All chains of so many turns and slides. Raises `ValueError` where these do not
    determine each other."""
    if letters not in letters_of(kind):
        raise ValueError(f"letters: {letters!r} are no type of chains")
    return ClosureFamily(Structure(_generic_loop(letters + SPHERICAL[kind] * POINT)))


def _ring() -> ClosureFamily:
    """The rings of six turns."""
    return chains_of(ClosureKind.CYCLE, RING)


@cache
def letters_of(kind: ClosureKind) -> tuple[Letters, ...]:
    """The types of chains, passed the way in which the letters are first."""
    words = set()
    for letters in map("".join, itertools.product(SLIDE + TURN, repeat=LENGTHS[kind])):
        starts = range(len(letters) if kind is ClosureKind.CYCLE else 1)
        ways = (letters, letters[::-1])
        words.add(min(way[k:] + way[:k] for way in ways for k in starts))
    return tuple(one for one in sorted(words) if one.count(SLIDE) <= MOST_SLIDES)


def _generic_loop(letters: Letters) -> Mechanism:
    """A loop of joints at random places."""
    rng = np.random.default_rng(0)
    joints = []
    for number, letter in enumerate(letters):
        bodies = f"b{number}", f"b{(number + 1) % len(letters)}"
        point, direction = rng.normal(size=(2, 3)).tolist()
        joint = Joint(
            name=f"{letter}{number}",
            kind=KINDS[letter],
            bodies=bodies,
            point=None if letter == SLIDE else point,
            direction=None if letter == POINT else direction,
        )
        joints.append(joint)
    return Mechanism(tuple(joints))
