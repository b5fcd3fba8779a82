"""Which configuration of an atlas is shown first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.figures.planes import shown_branches
from bifurc.form_order import listed_numbers
from linkages.readout.drawn import drawn_place
from linkages.subject import subject_at

SAMPLES = 72  # places on each form that are looked at
BESIDE_A_POINT = 2  # of the spacing of these: a form is first shown farther from points
ALIKE = 1e-3  # of a breadth: configurations that differ by less show as much


class Place(NamedTuple):
    """A configuration (n,) of an atlas, and the index of the form on which it is, if it
    is on one."""

    point: np.ndarray
    form: int | None


def first_place(atlas: Atlas) -> Place:
    """What is shown first: the configuration as drawn, or the form that is listed first,
    or what stands first on the map."""
    drawn = drawn_place(atlas)
    if drawn is not None:
        return Place(drawn.point, drawn.form)
    if atlas.forms:
        number = listed_numbers(atlas)[0]
        return Place(atlas.forms[number].branch(start_of(atlas, number)), number)
    first = configurations(atlas)[0]
    return Place(first[len(first) // 2], None)


def start_of(atlas: Atlas, number: int) -> float:
    """Where a form, by its index, is first shown: its joints are farthest from one
    line there, and no singular point is near."""
    places = free_places(atlas, number)
    points = atlas.forms[number].branch(places)
    return float(places[clearest(subject_at(atlas).parts.breadths(points))])


def clearest(breadths: np.ndarray) -> int:
    """The index of the largest breadth, the first of those that are alike, whatever
    rounding makes of them."""
    return int(np.argmax(breadths > (1 - ALIKE) * breadths.max()))


def free_places(atlas: Atlas, number: int) -> np.ndarray:
    """Places (k,) on a form, by its index, that are not next to a singular point or an
    end; all where none is free."""
    branch = atlas.forms[number].branch
    spacing = branch.length / SAMPLES
    places = spacing * np.arange(SAMPLES)
    is_free = np.ones(SAMPLES, dtype=bool)
    if not branch.closed:
        is_free[[0, 1, -1]] = False
    for point in atlas.points:
        for form, s in point.passes:
            if form != number:
                continue
            gaps = np.abs(places - s)
            if branch.closed:
                gaps = np.minimum(gaps, branch.length - gaps)
            is_free &= gaps > BESIDE_A_POINT * spacing
    return places[is_free] if is_free.any() else places


def configurations(atlas: Atlas) -> Sequence[np.ndarray]:
    """Configurations (k, n) of everything that is on the map, zeros where that is
    nothing."""
    parts = [branch.sample(SAMPLES) for branch in shown_branches(atlas)]
    parts += [surface.samples for surface in atlas.surfaces]
    parts += [motion.sample[None] for motion in atlas.near_motions]
    if len(atlas.rigid):
        parts.append(atlas.rigid)
    return parts or [np.zeros((1, len(atlas.names)))]
