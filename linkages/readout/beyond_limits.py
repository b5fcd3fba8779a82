"""What limits keep out: the configurations that a mechanism has without them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.settings import SearchSettings
from bifurc.torus import wrap
from linkages.mechanisms.joint import Limits
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.ranges import VariableRange, variable_ranges
from linkages.readout.readout import Readout

SAMPLES = 401  # of a form, for the ranges along it
QUICK = SearchSettings(
    starts=50, budget=5.0, charts=100, count=False, certify=False, near_motions=False
)


@dataclass(frozen=True)
class LimitedRange:
    """A variable with ``limits``, and the ranges that it has without any, form by form,
    in rad or the user's unit."""

    label: str
    is_turn: bool
    limits: Limits
    ranges: tuple[VariableRange, ...]

    @property
    def meets_limits(self) -> bool:
        """Whether some of the ranges and the limits have values in common, angles up to
        whole turns: then these limits alone do not say why nothing is within them."""
        return any(self._meets_limits(one) for one in self.ranges)

    def _meets_limits(self, one: VariableRange) -> bool:
        low, high = self.limits
        if one.turns:
            return True
        if self.is_turn:
            turns = math.ceil((one.low - high) / (2 * math.pi))
            low, high = low + 2 * math.pi * turns, high + 2 * math.pi * turns
        return low <= one.high and one.low <= high


def ranges_beyond_limits(
    mechanism: Mechanism, map_linkage: Callable[..., Atlas]
) -> list[LimitedRange]:
    """The variables with limits, and what they are in the configurations that were
    found without these in a few seconds; none where there are no configurations, or no
    limits."""
    limited = [one for one in mechanism.variables if one.limits and one.locked is None]
    if not limited:
        return []
    joints = tuple(replace(joint, limits=()) for joint in mechanism.joints)
    free = replace(mechanism, joints=joints)
    atlas = map_linkage(free, settings=QUICK)
    everywhere = _ranges(atlas, Readout(free))
    if not everywhere:
        return []
    result = []
    for variable in limited:
        assert variable.limits is not None
        own = tuple(one for one in everywhere if one.label == variable.label)
        is_turn = variable.motion.is_turn
        result.append(LimitedRange(variable.label, is_turn, variable.limits, own))
    return result


def _ranges(atlas: Atlas, readout: Readout) -> list[VariableRange]:
    """The ranges of all variables on everything in an atlas."""
    ranges: list[VariableRange] = []
    for form in atlas.forms:
        ends = form.branch(np.array([0.0, form.branch.length]))
        places = np.linspace(0.0, form.branch.length, SAMPLES)
        points = np.concatenate([ends, form.branch(places)])
        ranges += variable_ranges(readout, form.branch, points)
    for surface in atlas.surfaces:
        ranges += _of_points(readout, surface.samples)
    for point in atlas.rigid:
        ranges += _of_points(readout, point[None])
    for meeting in atlas.points:
        ranges += _of_points(readout, meeting.point.u[None])
    return ranges


def _of_points(readout: Readout, points: np.ndarray) -> Sequence[VariableRange]:
    """The ranges over some points (k, n)."""
    values = wrap(readout.values(points), readout.periods)
    rows = zip(readout.labels(), values.min(axis=0), values.max(axis=0), strict=True)
    return [VariableRange(label, float(a), float(b), 0) for label, a, b in rows]
