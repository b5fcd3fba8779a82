"""Rigid assemblies of mechanisms on the screen, and what holds them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.atlas import Atlas
from bifurc.limits import Deadline, made_in_time, until
from bifurc.tables import count_of
from linkages.app.texts.configurations import show_configuration
from linkages.app.texts.numbers import in_lengths
from linkages.readout.readout import Readout
from linkages.readout.rigidity import (
    dimension_of_points,
    hold_at,
    moving_points,
    points_at,
)
from linkages.subject import subject_at

PATIENCE = 1.0  # s, for a remark that takes seconds where a sheet has a hundred panels


def assemblies_table(
    atlas: Atlas, readout: Readout
) -> tuple[Sequence[str], list[Sequence[str]]]:
    """The head and the rows of rigid assemblies: where points are, or the variables of
    joints, and, where one has flexes or stresses, how many, and what holds it."""
    heads: tuple[str, ...] = (subject_at(atlas).heading(atlas),)
    rows: list[Sequence[str]] = [(show_configuration(atlas, u),) for u in atlas.rigid]
    size = dimension_of_points(readout.mechanism)
    names = moving_points(readout.mechanism) if size else []
    if names:
        axes = ", ".join("xyz"[:size])
        heads = tuple(f"{name} ({axes})" for name in names)
        rows = [_places(readout, u) for u in atlas.rigid]
    holds = [hold_at(readout, u) for u in atlas.rigid]
    if not any(hold.flexes or hold.stresses for hold in holds):
        return heads, rows
    held = [(str(one.flexes), str(one.stresses), one.words) for one in holds]
    rows = [(*row, *cells) for row, cells in zip(rows, held, strict=True)]
    return (*heads, "flexes", "stresses", "rigid by"), rows


def _places(readout: Readout, u: np.ndarray) -> list[str]:
    """Where the points that move are at a configuration (n,)."""
    unit, size = readout.structure.unit, dimension_of_points(readout.mechanism)
    mechanism = readout.mechanism
    names = [joint.name for joint in mechanism.joints]
    places = points_at(readout, u[None])[0] + np.array(mechanism.origin)
    moving = places[[names.index(name) for name in moving_points(mechanism)], :size]
    return [", ".join(in_lengths(x, unit) for x in place) for place in moving.tolist()]


def how_held(readout: Readout, u: np.ndarray) -> str:
    """How many flexes and stresses there are at an isolated assembly (n,), and by what it
    is known to be rigid, unless that takes long."""
    with until(Deadline(PATIENCE)):
        hold = made_in_time(lambda: hold_at(readout, u))
    if hold is None:
        return "what holds it was not found in time"
    flexes = count_of(hold.flexes, "flex")
    counts = f"{flexes}, {count_of(hold.stresses, 'stress')}"
    return f"{counts}, rigid by {hold.words}" if hold.order.is_rigid else counts
