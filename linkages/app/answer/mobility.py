"""Mobility and Grübler's count of what was mapped."""

from __future__ import annotations

from bifurc.atlas import Atlas
from linkages.app.answer.configurations import readout_of

SPACE = 6  # freedoms of a body


def mobility_of(atlas: Atlas) -> int:
    """The largest dimension of a component; 0 where nothing moves."""
    dimensions = [surface.dimension for surface in atlas.surfaces]
    dimensions += [1] * bool(atlas.forms)
    return max(dimensions, default=0)


def gruebler_of(atlas: Atlas) -> int:
    """Grübler's count: the freedoms of the joints, less six for every independent
    loop."""
    readout = readout_of(atlas)
    if readout is None:
        return len(atlas.names) - SPACE
    return readout.mechanism.gruebler
