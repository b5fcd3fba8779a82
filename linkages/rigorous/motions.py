"""Which joints are held to show that the map has all motions: those with which the fewest
cells are to be expected."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from flint import arb, arb_mat

from bifurc.limits import is_time_over
from linkages.rigorous import check
from linkages.rigorous.check import DoesNotHold
from linkages.rigorous.selection import floats_of

STATIONS = 100  # on all tubes, at which cells are counted
LARGEST_REACH = 0.125  # rad: cells are no larger, however regular the equations are
SMALLEST = 1e-12  # singular value: where it is 0 no number of cells is enough
MOST_CELLS = 60_000  # about a minute
NOT_LOOKED_FOR = "not looked for"


@dataclass(frozen=True)
class _Choice:
    """The joint ``first`` of the two chains, and one joint of each that is ``held``."""

    first: int
    held: tuple[int, ...]


def proved_motions(
    loop: check.Loop,
    boxes: list[check.Box],
    spheres: list[tuple[check.Vector, arb]],
) -> check.Json:
    """What a certificate holds of all motions beside the boxes of its tubes and the spheres
    of its points, their centres and radii: the joints to hold, or why there are none."""
    if not check.SHORTEST <= loop.n <= check.LONGEST:
        return f"loops of {loop.n} joints are not looked at"
    choice = _best_choice(loop, boxes)
    motions = check.Motions(loop, choice.first, boxes, spheres)
    try:
        for count, _ in enumerate(motions.cells(choice.held)):
            check.require(not is_time_over(), "the time was over")
            check.require(count < MOST_CELLS, f"it takes more than {MOST_CELLS} cells")
    except DoesNotHold as reason:
        return str(reason)
    return {"first": choice.first, "held": list(choice.held)}


def _best_choice(loop: check.Loop, boxes: Sequence[check.Box]) -> _Choice:
    stations = boxes[:: max(1, len(boxes) // STATIONS)]
    costs = {}
    for choice, chains in _choices(loop):
        costs[choice] = sum(_cells_at(box, choice, chains) for box in stations)
    return min(costs, key=lambda choice: costs[choice])


def _choices(loop: check.Loop) -> Iterator[tuple[_Choice, list[check.Chain]]]:
    half = (loop.n + 1) // 2
    # chains of equal length are the same again after half of the joints
    for first in range(loop.n if loop.n % 2 else half):
        chains = check.chains_of(loop, first)
        for held in product(*(chain.joints for chain in chains)):
            yield _Choice(first, held), chains


def _cells_at(box: check.Box, choice: _Choice, chains: Sequence[check.Chain]) -> float:
    """About how many cells hold the curve of a box: as many along it as the uncertainty of
    the other joints takes to be less than its reach."""
    u = [float(x) for x in box.point(arb(0))]
    parts, slopes = [], []
    for chain, joint in zip(chains, choice.held, strict=True):
        held = [(u[joint], 0.0) if one == joint else None for one in chain.joints]
        parts.append(_table(chain.columns(held)))
        place = chain.joints.index(joint)
        slopes.append(_table(chain.columns(held, place)))
    left, sizes, right = np.linalg.svd(np.hstack(parts), full_matrices=False)
    inverse = (right[:-1].T / np.maximum(sizes[:-1], SMALLEST)) @ left[:, :-1].T
    changes = np.abs(np.hstack([inverse @ slope for slope in slopes]))
    rate = float(changes.sum(axis=1).max())
    return float(box.half) * rate / min(float(box.reach), LARGEST_REACH)


def _table(columns: Sequence[check.Vector]) -> np.ndarray:
    return floats_of(arb_mat(columns)).T
