"""Where hinges sit along their axes so that no parts meet along forms: candidates at
random, of which the best are improved, within growing ranges.

A candidate is looked at in some configurations; the one that is best there is checked
everywhere between two bounds, and where it comes too near in between, that
configuration is looked at, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bifurc.atlas import Form
from bifurc.branch import Branch
from linkages.links.distances import (
    distances_by_ends,
    find_least_distance,
    largest_rates,
)
from linkages.loop import Loop
from linkages.printing.assembly import Assembly, Dimensions, Part, Seats, place_segments

REACHES = (0.25, 0.5, 1.0, 1.0)  # how far hinges move out, in characteristic lengths
CANDIDATES = 400  # at random, for each range
MOMENTS = 192  # of each form, where candidates are looked at
CHUNK = 4  # configurations, and then more, after which the worse ones are left out
BEST = 8  # candidates that are improved
ROUNDS = 24  # of improvement
CHILDREN = 6  # of each candidate in a round
FIRST_STEP, LAST_STEP = 0.3, 0.01  # of the range, by which children differ
TURNOVER = 0.1  # of the sides of a child are the other ones
CHECKS = 6  # of candidates everywhere, for each range
DECIMALS = 2  # of heights, mm
SPARE = 1.25  # candidates look for so much more than the gap
TOLERANCE = 1e-3  # of the characteristic length
PLAY_SHARE = 0.25  # and of the play, for hinges with little of it
SAMPLES = 721  # of a form, where all parts that meet are looked for


@dataclass(frozen=True, eq=False)
class PartApproach:
    """Where two parts are nearest along a form: the ``clearance`` that is left between
    them, mm, the arclength ``s`` and the configuration ``theta`` (n,), rad.

    No clearance along the form is less by more than ``error``.
    """

    parts: tuple[Part, Part]
    form: Form
    clearance: float
    s: float
    theta: np.ndarray
    error: float

    @property
    def at_least(self) -> float:
        """The clearance that is kept everywhere along the form."""
        return self.clearance - self.error


def nearest_approach(assembly: Assembly, form: Form) -> PartApproach:
    """Where any two parts are nearest along a form."""
    return _nearest_of(assembly, form, assembly.pairs)


def find_meetings(assembly: Assembly, form: Form, gap: float) -> list[PartApproach]:
    """Every two parts that come nearer than a ``gap`` (mm) along a form, with the place
    where they are nearest, the nearest first.

    Those that do so only for less than a step of 721 to a form may be missing.
    """
    s = np.linspace(0.0, form.branch.length, SAMPLES)
    placed = assembly.placed(form.branch(s))
    least = assembly.clearances(placed, assembly.pairs).min(axis=0)
    segments: dict[tuple[Part, Part], list[np.ndarray]] = {}
    for pair in assembly.pairs[least < gap]:
        parts = assembly.part(pair[0]), assembly.part(pair[1])
        segments.setdefault(parts, []).append(pair)
    meetings = []
    for pairs in segments.values():
        meetings.append(_nearest_of(assembly, form, np.array(pairs)))
    return sorted(meetings, key=lambda approach: approach.clearance)


def _nearest_of(assembly: Assembly, form: Form, pairs: np.ndarray) -> PartApproach:
    """Where any of some pairs (p, 2) of segments are nearest along a form."""
    branch = form.branch
    radii = assembly.radii[pairs].sum(axis=1)

    def clearance(numbers: np.ndarray, s: np.ndarray) -> np.ndarray:
        moments, moment_of = np.unique(s, return_inverse=True)
        placed = assembly.placed(branch(moments))
        first = placed[moment_of, pairs[numbers, 0]]
        second = placed[moment_of, pairs[numbers, 1]]
        distances = distances_by_ends(first, second)
        return np.asarray(distances - radii[numbers])

    size = assembly.loop.characteristic_length
    error = min(TOLERANCE * size, PLAY_SHARE * assembly.dimensions.play)
    least = find_least_distance(
        clearance,
        _slopes(assembly, branch, pairs),
        branch.length,
        error,
        floor=-float(radii.max()),
    )
    first, second = pairs[least.number]
    parts = assembly.part(first), assembly.part(second)
    theta = branch(least.s)
    return PartApproach(parts, form, least.value, least.s, theta, least.error)


def _slopes(assembly: Assembly, branch: Branch, pairs: np.ndarray) -> np.ndarray:
    """How fast two segments of each pair (p, 2) can near each other for each unit of
    arclength.

    Only the joints between them move them, either way round. A part is no farther from
    the axis of another joint than half the way round the loop, and its own reach.
    """
    lengths, _, offsets = assembly.loop.arrays
    half_way = float(np.abs(lengths).sum() + np.abs(offsets).sum()) / 2
    farthest = half_way + _reach(assembly)
    turned = np.concatenate([[0.0], np.cumsum(largest_rates(branch))])
    frames = np.sort(assembly.frames[pairs], axis=1)
    between = turned[frames[:, 1] + 1] - turned[frames[:, 0] + 1]
    around = turned[-1] - between
    slopes: np.ndarray = farthest * np.minimum(between, around)
    return slopes


def _reach(assembly: Assembly) -> float:
    """How far any point of a middle line is from the feet of its link."""
    feet = np.zeros((len(assembly.frames), 3))
    feet[:, 0] = -assembly.loop.arrays.lengths[assembly.frames]
    ends = assembly.segments
    from_origin = np.linalg.norm(ends, axis=-1).max()
    from_feet = np.linalg.norm(ends - feet[:, None], axis=-1).max()
    return float(min(from_origin, from_feet))


@dataclass(frozen=True, eq=False)
class Seating:
    """Where hinges sit, and where parts are ``nearest`` along the forms then.

    ``is_apart`` where they keep the gap that was asked for, everywhere; ``reach`` is
    the range, mm, in which heights were looked for.
    """

    assembly: Assembly
    nearest: PartApproach
    is_apart: bool
    reach: float


@dataclass(frozen=True, eq=False)
class _Trial:
    """What candidates are measured by: configurations, and what is enough, mm."""

    loop: Loop
    dimensions: Dimensions
    configurations: np.ndarray
    enough: float

    def clearances(self, seats: Seats, keep: int, floor: float = -np.inf) -> np.ndarray:
        """The least clearance (c,) of candidates; -inf for those that fall below a
        ``floor``, and for those that were left out while ``keep`` better ones
        remained."""
        assembly = Assembly(self.loop, self.dimensions, seats)
        poses = assembly.poses(self.configurations)
        least = np.full(len(seats.heights), np.inf)
        alive = np.arange(len(least))
        end = 0
        while end < len(poses) and len(alive) > 0:
            start, end = end, 2 * end + CHUNK
            placed = place_segments(assembly.segments[alive], poses[start:end])
            seen = assembly.clearances(placed, assembly.pairs).min(axis=(1, 2))
            least[alive] = np.minimum(least[alive], seen)
            alive = alive[least[alive] >= floor]
            if len(alive) > keep:
                limit = np.sort(least[alive])[-max(keep, len(alive) // 2)]
                alive = alive[least[alive] >= min(limit, self.enough)]
        out = np.full(len(least), -np.inf)
        out[alive] = least[alive]
        return out


def choose_seats(
    loop: Loop,
    dimensions: Dimensions,
    forms: Sequence[Form],
    generator: np.random.Generator,
    offsets: np.ndarray | None = None,
) -> Seating:
    """Seats of the hinges of a loop (mm) that keep all parts at least the play apart
    along forms, within the smallest range that has any; where none has, the best ones.

    With ``offsets`` (n,), mm, the heights are these, and only sides are chosen.
    """
    gap = dimensions.play
    rows = [
        form.branch(np.linspace(0.0, form.branch.length, MOMENTS)) for form in forms
    ]
    # in any order, so that the first ones are already far from each other
    turned = generator.permutation(np.concatenate(rows))
    trial = _Trial(loop, dimensions, turned, SPARE * gap)
    size = loop.characteristic_length
    reaches = [reach * size for reach in REACHES] if offsets is None else [0.0]
    centre = np.zeros(loop.n) if offsets is None else offsets
    seatings = []
    for reach in reaches:
        seating = _seating_within(trial, forms, centre, reach, gap, generator)
        seatings.append(seating)
        if seating.is_apart:
            return seating
    return max(seatings, key=lambda one: one.nearest.clearance)


def _seating_within(
    trial: _Trial,
    forms: Sequence[Form],
    centre: np.ndarray,
    reach: float,
    gap: float,
    generator: np.random.Generator,
) -> Seating:
    """The best seats with heights within a range of some ``centre`` (n,)."""
    shape = (CANDIDATES, len(centre))
    heights = np.round(centre + generator.uniform(-reach, reach, shape), DECIMALS)
    seats = Seats(heights, generator.choice([-1.0, 1.0], shape))
    seatings = []
    for _ in range(CHECKS):
        seats = _improved(trial, seats, centre, reach, generator)
        assembly = Assembly(trial.loop, trial.dimensions, seats[0])
        approaches = [nearest_approach(assembly, form) for form in forms]
        nearest = min(approaches, key=lambda approach: approach.at_least)
        seatings.append(Seating(assembly, nearest, nearest.at_least >= gap, reach))
        seen = trial.clearances(seats[:1], 1)[0]
        if seatings[-1].is_apart or seen < gap:
            break
        configurations = np.vstack([nearest.theta, trial.configurations])
        trial = replace(trial, configurations=configurations)
    return max(seatings, key=lambda one: one.nearest.clearance)


def _improved(
    trial: _Trial,
    seats: Seats,
    centre: np.ndarray,
    reach: float,
    generator: np.random.Generator,
) -> Seats:
    """The best candidates, the best one first, and their children as long as none is
    good enough."""
    clearances = trial.clearances(seats, BEST)
    seats, clearances = _best_of(seats, clearances)
    for step in np.geomspace(FIRST_STEP, LAST_STEP, ROUNDS):
        if clearances[0] >= trial.enough:
            break
        children = _children(seats, centre, reach, float(step), generator)
        # the parents are known, and what is worse than the last of them is of no use
        seen = trial.clearances(children, BEST, floor=float(clearances[-1]))
        family = Seats(
            np.concatenate([seats.heights, children.heights]),
            np.concatenate([seats.sides, children.sides]),
        )
        seats, clearances = _best_of(family, np.concatenate([clearances, seen]))
    return seats


def _best_of(seats: Seats, clearances: np.ndarray) -> tuple[Seats, np.ndarray]:
    """The best candidates and their clearances, the best first."""
    order = np.argsort(-clearances, kind="stable")[:BEST]
    return seats[order], clearances[order]


def _children(
    seats: Seats,
    centre: np.ndarray,
    reach: float,
    step: float,
    generator: np.random.Generator,
) -> Seats:
    """Candidates that differ a little from those that there are."""
    heights = np.repeat(seats.heights, CHILDREN, axis=0)
    sides = np.repeat(seats.sides, CHILDREN, axis=0)
    heights += step * reach * generator.normal(size=heights.shape)
    heights = np.round(np.clip(heights, centre - reach, centre + reach), DECIMALS)
    is_turned = generator.random(sides.shape) < TURNOVER
    return Seats(heights, np.where(is_turned, -sides, sides))
