"""Between which values the joint variables of a mechanism move along a form.

Angles are known but for whole turns. A form that passes through the reference
configuration has them from there, where they are 0; on others the middle of each range
lies above -180 and up to 180 degrees. Neither hangs on where a form begins, but for
joints that turn fully: of their ranges only the width counts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from bifurc.torus import difference, whole_turns
from linkages.decisions import passes_reference
from linkages.readout.readout import Readout

SAMPLES = 400  # of a form, to see where it is nearest to the reference configuration
AROUND, ROUNDS = 41, 4  # places about the nearest one, and how often they are refined
SEAM = 1e-6  # turns: a middle so little above -180 degrees is at 180


@dataclass(frozen=True)
class VariableRange:
    """The range of a variable along a form, from ``low`` to ``high`` (rad, the user's
    unit), and its ``turns``, 0 where the form is not closed."""

    label: str
    low: float
    high: float
    turns: int


def variable_ranges(
    readout: Readout, branch: Branch, points: np.ndarray
) -> tuple[VariableRange, ...]:
    """The ranges of all variables along a form, from ``points`` (k, n) of it, of which
    the first two are its ends."""
    values = readout.values(points)
    travel = whole_turns(values[1] - values[0], readout.periods) * branch.closed
    at_reference = _values_at_reference(readout, branch)
    if at_reference is None:
        middles = (values.min(axis=0) + values.max(axis=0)) / 2
        away = turns_of_middles(middles, readout.periods)
    else:
        away = whole_turns(at_reference, readout.periods)
    periods = np.where(np.isfinite(readout.periods), readout.periods, 0.0)
    values = values - away * periods
    lowest, highest = values.min(axis=0), values.max(axis=0)
    rows = zip(readout.labels(), lowest, highest, travel, strict=True)
    return tuple(
        VariableRange(label, float(low), float(high), int(turns))
        for label, low, high, turns in rows
    )


def turns_of_middles(middles: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """The whole turns (v,) by which middles (v,) lie away from the turn about 0."""
    turns = np.zeros(len(periods), dtype=int)
    is_periodic = np.isfinite(periods)
    shares = middles[is_periodic] / periods[is_periodic]
    turns[is_periodic] = np.ceil(shares - 0.5 - SEAM)
    return turns


def _values_at_reference(readout: Readout, branch: Branch) -> np.ndarray | None:
    """The values (v,) of all variables where the branch passes through the reference
    configuration; None where it does not."""
    step = branch.length / SAMPLES
    arclengths = branch.arclengths(SAMPLES)
    for _ in range(ROUNDS):
        gaps = difference(
            branch(arclengths), readout.structure.reference, branch.periods
        )
        distances = np.abs(gaps).max(axis=1)
        nearest = arclengths[np.argmin(distances)]
        low, high = max(nearest - step, 0.0), min(nearest + step, branch.length)
        arclengths = np.linspace(low, high, AROUND)
        step = 2 * step / (AROUND - 1)
    if not passes_reference(float(distances.min())):
        return None
    at_reference: np.ndarray = readout.values(branch(nearest)[None])[0]
    return at_reference
