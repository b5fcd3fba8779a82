"""Where on its map a mechanism is as its file draws it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.atlas import NEAR_DRAWN, Atlas
from bifurc.singular.point import Kind
from bifurc.torus import difference


@dataclass(frozen=True)
class Drawn:
    """A configuration ``point`` (n,), the ``name`` of the form, the singular point or the
    surface that is there, empty where nothing is; the first ``form`` that passes, and
    its arclength ``s``."""

    point: np.ndarray
    name: str = ""
    form: int | None = None
    s: float = 0.0


def drawn_place(atlas: Atlas) -> Drawn | None:
    """Where the configuration of the file is; None of what has none, such as a
    table."""
    point = atlas.drawn
    if point is None:
        return None
    for meeting in atlas.points:
        gap = difference(meeting.point.u, point, atlas.periods)
        if not np.linalg.norm(gap) < NEAR_DRAWN:
            continue
        if meeting.passes:
            return Drawn(point, meeting.name, *meeting.passes[0])
        if meeting.kind is Kind.ISOLATED:
            return Drawn(point, meeting.name)
    for number, form in enumerate(atlas.forms):
        distance, s = form.branch.nearest(point[None])
        if distance[0] < NEAR_DRAWN:
            return Drawn(point, form.name, number, float(s[0]))
    for solution in atlas.rigid:
        if np.linalg.norm(difference(solution, point, atlas.periods)) < NEAR_DRAWN:
            return Drawn(point, "a rigid assembly")
    if atlas.surfaces:
        names = " or ".join(surface.name for surface in atlas.surfaces)
        return Drawn(point, names)
    return Drawn(point)
