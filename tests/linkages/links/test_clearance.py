"""The clearance of links: the least distance that there is, and where."""

import itertools

import numpy as np
import pytest
from scipy.optimize import minimize

from linkages.linkage import load
from linkages.links.clearance import TOLERANCE, approaches_along, distances_of
from linkages.loop import Loop
from linkages.subject import as_subject
from tests.linkages.placed_links import place_links
from tests.maps import map_of


def links(loop):
    return as_subject(loop).parts


def pairs_of(loop):
    return links(loop).pairs_apart(links(loop).lines(np.empty((0, loop.n))))


def distances_of_links(loop, theta, pair):
    return distances_of(links(loop), links(loop).lines(theta), theta, pair)


def test_links_that_share_a_joint_are_left_out():
    assert pairs_of(load("bennett").loop) == [(0, 2), (1, 3)]
    pairs = pairs_of(load("bricard-line-symmetric").loop)
    assert len(pairs) == 9
    assert all(b - a not in (1, 5) for a, b in pairs)


def test_distances_are_those_of_the_nearest_points():
    loop = load("special-double-subtractive-goldberg").loop
    theta = np.random.default_rng(1).uniform(-3, 3, (6, loop.n))
    pairs = pairs_of(loop)
    distances = [distances_of_links(loop, theta, pair) for pair in pairs]
    for placed, row in zip(
        place_links(loop, theta), np.transpose(distances), strict=True
    ):
        for (first, second), distance in zip(pairs, row, strict=True):
            expected = nearest_by_optimisation(placed[first], placed[second])
            assert distance == pytest.approx(expected, abs=1e-7)


def nearest_by_optimisation(first, second, rods=3):
    """The least distance of two chains of some rods, by a general optimiser."""
    best = np.inf
    for i, j in itertools.product(range(rods), repeat=2):

        def square(x, i=i, j=j):
            p = first[i] + x[0] * (first[i + 1] - first[i])
            q = second[j] + x[1] * (second[j + 1] - second[j])
            return ((p - q) ** 2).sum()

        found = minimize(square, [0.5, 0.5], bounds=[(0, 1)] * 2, tol=1e-16)
        best = min(best, found.fun**0.5)
    return best


@pytest.mark.parametrize("name", ["bennett", "special-double-subtractive-goldberg"])
def test_no_place_of_a_form_has_links_nearer_than_is_said(name):
    atlas = map_of(name)
    loop = load(name).loop
    pairs = pairs_of(loop)
    for form in atlas.forms[:2]:
        s = np.linspace(0.0, form.branch.length, 4001)
        points = form.branch(s)
        seen = [distances_of_links(loop, points, pair).min() for pair in pairs]
        approaches = approaches_along(links(loop), form.branch)
        assert len(approaches) == len(pairs)
        assert approaches == sorted(approaches, key=lambda one: one.distance)
        for approach in approaches:
            there = distances_of_links(loop, approach.theta[None], approach.links)
            assert there[0] == pytest.approx(approach.distance, abs=1e-12)
            sampled = seen[pairs.index(approach.links)]
            assert approach.distance <= sampled + 1e-9
            assert approach.error <= 2 * TOLERANCE * loop.characteristic_length


def test_the_unit_of_length_does_not_matter():
    loop = load("bennett").loop
    form = map_of(loop).forms[0]
    one = approaches_along(links(loop), form.branch)
    other = approaches_along(links(loop.scaled(1e6)), form.branch)
    assert [a.links for a in one] == [a.links for a in other]
    assert other[1].distance == pytest.approx(1e6 * one[1].distance)


def test_links_that_keep_their_distance_take_no_search():
    """A parallelogram with legs beside each other: its coupler stays away from the
    base, by the length of the legs where they stand upright."""
    loop = Loop([2.0, 1.0, 2.0, 1.0], [0, 0, 0, 0], [0, 0.25, 0, -0.25])
    for form in map_of(loop).forms:
        for approach in approaches_along(links(loop), form.branch):
            assert approach.distance >= 0
            assert approach.error <= 2 * TOLERANCE * loop.characteristic_length
