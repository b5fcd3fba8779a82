"""Points of bodies along a motion: coupler curves.

In: texts "BODY:X,Y,Z", and the parts of a linkage; out: where the points are at
configurations, seen from the body that is drawn at rest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkages.links.parts import Parts
from linkages.values import GeometryError, quoted

COORDINATES = (2, 3)  # how many a point may have; the third one is 0 if left out


@dataclass(frozen=True, eq=False)
class TracedPoint:
    """A ``place`` (3,) of a ``body``, by its number, called ``name`` as it was given. It
    counts as joints of mechanisms do: from the origin of the file, in the configuration
    that is given there; on a link of a table from the joint that the link follows, along
    its common normal and its axis."""

    name: str
    body: int
    place: np.ndarray


def traced_point(parts: Parts, text: str) -> TracedPoint:
    """The point that is given as "BODY:X,Y" or "BODY:X,Y,Z"; raises `GeometryError`."""
    body, _, coordinates = text.rpartition(":")
    names = list(parts.names)
    if body not in names:
        allowed = f"BODY:X,Y,Z with one of the bodies {', '.join(names)}"
        raise GeometryError("traced point", quoted(text), allowed)
    try:
        numbers = [float(number) for number in coordinates.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in COORDINATES or not all(map(math.isfinite, numbers)):
        allowed = "BODY:X,Y,Z with two or three finite coordinates"
        raise GeometryError("traced point", quoted(text), allowed)
    return TracedPoint(text, names.index(body), np.array([*numbers, 0.0][:3]))


def traced_path(parts: Parts, traced: TracedPoint, points: np.ndarray) -> np.ndarray:
    """Where a traced point is at configurations (k, n): (k, 3), seen from the body that
    is drawn at rest, in the unit of length of the linkage."""
    poses = parts.poses(points)
    seen = np.linalg.inv(poses[:, parts.held]) @ poses[:, traced.body]
    path: np.ndarray = seen[:, :3, :3] @ traced.place + seen[:, :3, 3]
    return path


def traced_columns(
    parts: Parts, trace: Sequence[str], points: np.ndarray
) -> tuple[list[str], np.ndarray]:
    """The heads of three columns for every point of a ``trace``, and these at
    configurations (k, n): (k, 3 t)."""
    heads = [f"{text} {axis}" for text in trace for axis in "xyz"]
    paths = [traced_path(parts, traced_point(parts, text), points) for text in trace]
    return heads, np.concatenate([np.empty((len(points), 0)), *paths], axis=1)
