"""Mixed cells have the mixed volume, and solutions of two terms of each polynomial."""

import itertools

import numpy as np
import pytest
from scipy.spatial import ConvexHull, QhullError

from bifurc.limits import Deadline
from bifurc.paths.mixed_cells import MixedCells
from tests.samples import one_in


def cells_of(supports, seed=0, most=10_000):
    return MixedCells.of(supports, np.random.default_rng(seed), Deadline(), most)


def volume_of(points):
    try:
        return ConvexHull(points).volume
    except QhullError:  # flat
        return 0.0


def mixed_volume(supports):
    """By its definition: from the volumes of all sums of the hulls of the supports."""
    n = len(supports)
    total = 0.0
    for count in range(1, n + 1):
        for chosen in itertools.combinations(supports, count):
            sums = [np.sum(points, axis=0) for points in itertools.product(*chosen)]
            total += (-1) ** (n - count) * volume_of(np.array(sums))
    return round(total)


def random_supports(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 4))
    supports = []
    for _ in range(n):
        points = rng.integers(0, 4, (int(rng.integers(2, 6)), n))
        supports.append([(0,) * n, *map(tuple, points.tolist())])
    return supports


@pytest.mark.parametrize("seed", one_in(4, range(40)))
def test_their_volume_is_the_mixed_volume(seed):
    supports = random_supports(seed)
    assert cells_of(supports, seed).volume == mixed_volume(supports)


def cyclic(n):
    """Supports of the equations of cyclic n-roots (Bjorck and Froberg 1991)."""
    rows = [
        [tuple(int((j - start) % n < length) for j in range(n)) for start in range(n)]
        for length in range(1, n)
    ]
    return [*rows, [(1,) * n, (0,) * n]]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("n", "count"), [(5, 70), (6, 156), (7, 924)])
def test_cyclic_roots_are_as_many_as_in_the_literature(n, count, seed):
    assert cells_of(cyclic(n), seed).volume == count


def test_two_terms_of_each_polynomial_are_solved_at_every_start():
    supports = cyclic(6)
    cells = cells_of(supports)
    rng = np.random.default_rng(1)
    coefficients = np.exp(2j * np.pi * rng.random(sum(map(len, supports))))
    starts, heights = cells.starts(coefficients)
    exponents = np.array([one for support in supports for one in support])
    terms = coefficients * np.prod(starts[:, None] ** exponents, axis=2)
    rows = np.repeat(np.arange(len(supports)), [len(one) for one in supports])
    sums = np.where(heights == 0.0, terms, 0.0) @ np.eye(len(supports))[rows]
    assert np.all((heights == 0.0) @ np.eye(len(supports))[rows] == 2)
    assert np.abs(sums).max() < 1e-12
    assert len(np.unique(starts.round(9), axis=0)) == len(starts) == cells.volume
    assert np.exp(-heights[heights > 0.0]).max() < 1e-13


NONE = {
    "a direction that no polynomial has": [[(0, 0), (1, 0)], [(0, 0), (2, 0)]],
    "a polynomial of one term": [[(0, 0)], [(0, 0), (1, 1)]],
}


@pytest.mark.parametrize("name", NONE)
def test_without_volume_there_are_none(name):
    cells = cells_of(NONE[name])
    starts, heights = cells.starts(np.ones(sum(map(len, NONE[name])), dtype=complex))
    assert cells.volume == len(starts) == len(heights) == 0


def test_no_more_are_looked_for_than_are_allowed():
    assert cells_of(cyclic(5), most=69) is None
    assert cells_of(cyclic(5), most=70).volume == 70
