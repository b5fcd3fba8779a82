"""What several rooms look at and takes a while to make."""

import pytest

from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.covering import cover_surface
from tests.bifurc.known_surfaces import SPHERE, seeds


@pytest.fixture(scope="session")
def sphere_charts() -> ChartAtlas:
    """The unit sphere, covered."""
    return cover_surface(SPHERE, seeds(SPHERE))
