"""Cycle bases: short, complete, and the same wherever the search ends."""

import numpy as np
import pytest

from linkages.structure import cycles
from linkages.structure.cycles import Ends, cycle_basis


def grid(rows, columns):
    """Bodies on a grid, each joined to the next one in its row and in its column."""
    pairs = {}
    for i in range(rows):
        for j in range(columns):
            body = i * columns + j
            if j + 1 < columns:
                pairs[len(pairs)] = Ends(body, body + 1, 1)
            if i + 1 < rows:
                pairs[len(pairs)] = Ends(body, body + columns, 1)
    return rows * columns, pairs


def test_the_loops_of_a_grid_are_its_meshes():
    chains = cycle_basis(*grid(7, 9))
    assert len(chains) == 6 * 8
    assert {len(chain) for chain in chains} == {4}


def test_long_cycles_are_found_where_short_ones_are_too_few():
    count = 40
    ring = {k: Ends(k, (k + 1) % count, 1) for k in range(count)}
    ring[count] = Ends(0, count // 2, 2)
    chains = cycle_basis(count, ring)
    assert [len(chain) for chain in chains] == [21, 21]


def test_pairs_in_two_parts_have_the_loops_of_both():
    bodies, pairs = grid(2, 3)
    more = {
        len(pairs) + k: Ends(e[0] + bodies, e[1] + bodies, 1) for k, e in pairs.items()
    }
    lonely = 1
    chains = cycle_basis(2 * bodies + lonely, pairs | more)
    assert len(chains) == 4


@pytest.mark.parametrize("seed", range(3))
def test_the_basis_does_not_depend_on_where_the_search_begins(monkeypatch, seed):
    rng = np.random.default_rng(seed)
    bodies, pairs = grid(4, 5)
    for _ in range(8):
        base, moved = rng.choice(bodies, 2, replace=False).tolist()
        pairs[len(pairs)] = Ends(base, moved, int(rng.integers(0, 4)))
    expected = cycle_basis(bodies, pairs)
    for limit in (1, 2, 1000):
        monkeypatch.setattr(cycles, "FIRST_LIMIT", limit)
        assert cycle_basis(bodies, pairs) == expected
