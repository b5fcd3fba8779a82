"""Where hinges sit along their axes so that no parts meet along forms: candidates at
random, of which the best are improved, within growing ranges.

A candidate is looked at in some configurations; the one that is best there is checked
everywhere, and where it comes too near in between, that configuration is looked at,
too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Form
from linkages.loop import Loop
from linkages.printing.assembly import Assembly, Dimensions, Seats, place_segments
from linkages.printing.interference import PartApproach, nearest_approach

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

    def with_configuration(self, theta: np.ndarray) -> _Trial:
        """The same with one more configuration, which comes first."""
        configurations = np.vstack([theta, self.configurations])
        return _Trial(self.loop, self.dimensions, configurations, self.enough)

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
    turned = _configurations(forms, generator)
    trial = _Trial(loop, dimensions, turned, SPARE * gap)
    size = loop.characteristic_length
    reaches = [reach * size for reach in REACHES] if offsets is None else [0.0]
    centre = np.zeros(loop.n) if offsets is None else offsets
    best: Seating | None = None
    for reach in reaches:
        seating = _seating_within(trial, forms, centre, reach, gap, generator)
        if best is None or _clearance(seating) > _clearance(best):
            best = seating
        if seating.is_apart:
            return seating
    assert best is not None
    return best


def _clearance(seating: Seating) -> float:
    return seating.nearest.clearance


def _configurations(
    forms: Sequence[Form], generator: np.random.Generator
) -> np.ndarray:
    """Configurations (k, n) along all forms, in any order, so that the first ones are
    already far from each other."""
    rows = []
    for form in forms:
        rows.append(form.branch(np.linspace(0.0, form.branch.length, MOMENTS)))
    shuffled: np.ndarray = generator.permutation(np.concatenate(rows))
    return shuffled


def _seating_within(
    trial: _Trial,
    forms: Sequence[Form],
    centre: np.ndarray,
    reach: float,
    gap: float,
    generator: np.random.Generator,
) -> Seating:
    """The best seats with heights within a range of some ``centre`` (n,)."""
    seats = _random_seats(centre, reach, generator)
    best: Seating | None = None
    for _ in range(CHECKS):
        seats = _improved(trial, seats, centre, reach, generator)
        assembly = Assembly(trial.loop, trial.dimensions, seats[0])
        approaches = [nearest_approach(assembly, form) for form in forms]
        nearest = min(approaches, key=lambda approach: approach.at_least)
        seating = Seating(assembly, nearest, nearest.at_least >= gap, reach)
        if best is None or nearest.clearance > _clearance(best):
            best = seating
        seen = trial.clearances(seats[:1], 1)[0]
        if seating.is_apart or seen < gap:
            return best
        trial = trial.with_configuration(nearest.theta)
    assert best is not None
    return best


def _random_seats(
    centre: np.ndarray, reach: float, generator: np.random.Generator
) -> Seats:
    """Candidates (c, n) at random."""
    shape = (CANDIDATES, len(centre))
    heights = _rounded(centre + generator.uniform(-reach, reach, shape))
    return Seats(heights, generator.choice([-1.0, 1.0], shape))


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
    heights = _rounded(np.clip(heights, centre - reach, centre + reach))
    is_turned = generator.random(sides.shape) < TURNOVER
    return Seats(heights, np.where(is_turned, -sides, sides))


def _rounded(heights: np.ndarray) -> np.ndarray:
    """Heights as they are shown, so that they can be given again."""
    return np.round(heights, DECIMALS)
