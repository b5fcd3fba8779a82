"""Connected parts: numbered in the order of the things, however these are grouped."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from bifurc.numerics.connected_parts import connected_parts


def test_what_groups_share_connects_them():
    assert connected_parts(6, [(4, 1), (), (5, 2), (3,), (2, 4)]) == [0, 1, 1, 2, 1, 1]
    assert connected_parts(0, []) == []


def test_parts_are_those_of_scipy():
    rng = np.random.default_rng(3)
    pairs = rng.integers(0, 60, (45, 2))
    graph = coo_array((np.ones(45), tuple(pairs.T)), shape=(60, 60))
    _, labels = connected_components(graph, directed=False)
    assert connected_parts(60, pairs.tolist()) == labels.tolist()
