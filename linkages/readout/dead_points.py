"""The dead points that matter: of the joint that drives, and of joints with limits."""

from __future__ import annotations

import numpy as np

from bifurc.atlas import Atlas, Event
from linkages.decisions import keeps_angle

SAMPLES = 64  # of a form, by which it is seen whether an unknown changes


def moving_dead_points(atlas: Atlas) -> list[Event]:
    """The dead points of an atlas but those of unknowns that stand still along the whole
    form."""
    ranges = [np.ptp(form.branch.sample(SAMPLES), axis=0) for form in atlas.forms]
    return [
        event
        for event in atlas.dead_points
        if not keeps_angle(float(ranges[event.form][event.index]))
    ]


def driven_dead_points(atlas: Atlas) -> list[Event]:
    """Those of the unknowns that drive or have limits."""
    drivers = atlas.subject.get("drivers", ())
    return [event for event in moving_dead_points(atlas) if event.index in drivers]
