"""Surfaces in a dataset: what is written is read again."""

from pathlib import Path

import networkx as nx
import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.files.dataset import load_atlas, save_atlas
from bifurc.graphs import transition_graph

COLUMNS = (
    "centers",
    "bases",
    "radii",
    "neighbours",
    "vertices",
    "polygons",
    "polygon_sizes",
)


@pytest.fixture(scope="module")
def read_again(folded_sarrus: Atlas, tmp_path_factory: pytest.TempPathFactory) -> Atlas:
    folder: Path = tmp_path_factory.mktemp("dataset")
    return load_atlas(save_atlas(folded_sarrus, folder / "sarrus.nc"))


def test_charts_survive_a_dataset(folded_sarrus: Atlas, read_again: Atlas) -> None:
    old, new = folded_sarrus.surfaces[0], read_again.surfaces[0]
    assert new.name == old.name
    assert new.dimension == 2
    assert new.complete == old.complete
    for name in COLUMNS:
        assert np.array_equal(getattr(old.charts, name), getattr(new.charts, name))
    assert new.charts is not None
    assert old.charts is not None
    assert new.charts.area == old.charts.area
    assert new.charts.euler_characteristic == 0


def test_meeting_points_with_surfaces_survive_a_dataset(
    folded_sarrus: Atlas, read_again: Atlas
) -> None:
    assert [point.surfaces for point in read_again.points] == [(0,)] * 4
    old, new = transition_graph(folded_sarrus), transition_graph(read_again)
    assert nx.utils.graphs_equal(old, new)
