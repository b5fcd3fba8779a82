"""Where parts are nearest along forms, checked everywhere between two bounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Form
from bifurc.branch import Branch
from linkages.links.distances import (
    distances_by_ends,
    find_least_distance,
    largest_rates,
)
from linkages.printing.assembly import Assembly, Part

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
