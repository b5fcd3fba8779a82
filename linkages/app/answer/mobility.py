"""Mobility of what was mapped."""

from __future__ import annotations

from bifurc.atlas import Atlas


def mobility_of(atlas: Atlas) -> int:
    """The largest dimension of a component; 0 where nothing moves."""
    dimensions = [surface.dimension for surface in atlas.surfaces]
    dimensions += [1] * bool(atlas.forms)
    return max(dimensions, default=0)
