"""Infinitesimal flexes of a rigid assembly, as arrows: where joints would go."""

from __future__ import annotations

import numpy as np

from linkages.pictures.picture import Painter, Part, Stroke
from linkages.readout.readout import Readout
from linkages.readout.rigidity import hold_at, points_at, velocities

LONGEST = 0.2  # of an arrow, in the size of the linkage
SHORTEST = 0.02  # over the longest: less is no arrow
HEAD = (1.8, 0.8)  # length of a head and half its breadth, in the radius of a joint


def flex_strokes(painter: Painter, readout: Readout, point: np.ndarray) -> list[Stroke]:
    """The arrows of all flexes of the assembly at a configuration (n,), from the joints,
    as a ``painter`` sees them."""
    hold = hold_at(readout, point)
    (places,) = points_at(readout, point[None])
    strokes = []
    for rates in velocities(readout, hold):
        start, tip = painter.seen(np.stack([places, places + rates]), point)
        way = LONGEST * painter.size * (tip - start)[:, :2]
        for base, along in zip(start[:, :2], way, strict=True):
            if np.linalg.norm(along) > SHORTEST * LONGEST * painter.size:
                strokes += _arrow(base, along, painter.radius)
    return strokes


def _arrow(base: np.ndarray, along: np.ndarray, radius: float) -> list[Stroke]:
    """A line from the rim of a joint, and the head at its end."""
    length = float(np.linalg.norm(along))
    unit = along / length
    base = base + min(radius, 0.5 * length) * unit
    length -= min(radius, 0.5 * length)
    across = np.array([-unit[1], unit[0]])
    tip = base + length * unit
    back = min(HEAD[0] * radius, 0.6 * length)
    breadth = HEAD[1] * radius * back / (HEAD[0] * radius)
    foot = tip - back * unit
    head = np.array([tip, foot + breadth * across, foot - breadth * across])
    line = Stroke(Part.FLEX, np.array([base, foot]), np.inf)
    return [line, Stroke(Part.FLEX, head, np.inf, closed=True)]
