"""What several rooms look at: atlases and charts that take a while to make."""

import pytest

from bifurc.atlas import Atlas
from bifurc.search.explore import explore
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.covering import cover_surface
from tests.bifurc.known_surfaces import SPHERE, sarrus, seeds


@pytest.fixture(scope="session")
def sphere_charts() -> ChartAtlas:
    """The unit sphere, covered."""
    return cover_surface(SPHERE, seeds(SPHERE))


@pytest.fixture(scope="session")
def folded_sarrus() -> Atlas:
    """What there is of the Sarrus loop with folded legs: two forms that meet a torus in
    four points."""
    return explore(sarrus())
