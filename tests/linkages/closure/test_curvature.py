"""Bounds on second derivatives hold wherever they are looked at."""

import numpy as np
import pytest

from bifurc.system import hessian_at, relative_gaps
from linkages.closure.closure import Closure
from tests.linkages.mechanisms.frameworks import OCTAHEDRON, framework, places_of
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import (
    carried_by_legs,
    one_of_each,
    platform,
    platform_on_a_platform,
    ring_with_rods,
    rods,
    rods_and_a_leg,
    rsrs,
    samples,
)
from tests.samples import one_in

NAMES = [
    "Bennett geometry with joints CRCR",
    "CCCC loop, general axes",
    "Sarrus with a P joint between base and platform",
    "Miura-ori, 3 x 3 vertices",
    "PPPP loop, general axes",
    "K(2,3)",
]


MECHANISMS = [mechanism_of_case(cases()[name]) for name in NAMES]
MECHANISMS += [one_of_each(), rods(), rods_and_a_leg()]
MECHANISMS += [framework(places_of("ABCDEF", 2), OCTAHEDRON)]
MECHANISMS += [rsrs(), platform(), platform((None, None, *(0.0,) * 4))]
MECHANISMS += [carried_by_legs(), platform_on_a_platform()]
MECHANISMS += [ring_with_rods(np.random.default_rng(seed)) for seed in (1, 2, 3)]


def near_solutions(problem, rng):
    """Random points within the limits at which the equations are nearly solved."""
    points, gaps = problem.project(samples(problem, rng, 60))
    points = points[(gaps < 1e-10) & (problem.domain.excess(points) <= 0.0)]
    sizes = np.array([0.0, 0.02, 0.1, 0.2])[:, None, None]
    near = points + sizes * rng.normal(size=(4, *points.shape))
    near = near.reshape(-1, problem.n)
    near = near[rng.permutation(len(near))]
    is_near = relative_gaps(problem, near) <= problem.curvature.residual
    near = near[is_near & (problem.domain.excess(near) <= 0.0)]
    assert len(near) > 5
    return near


def largest_value(hessian, rng):
    """The largest |F''(x, y)| seen over unit vectors x and y."""
    largest = 0.0
    for _ in range(5):
        x = rng.normal(size=hessian.shape[1])
        for _ in range(8):
            x /= np.linalg.norm(x)
            _, values, right = np.linalg.svd(hessian @ x)
            largest, x = max(largest, values[0]), right[0]
    return largest


@pytest.mark.parametrize("mechanism", MECHANISMS, ids=str)
def test_the_bound_near_solutions_holds_and_is_of_the_right_size(mechanism):
    problem = Closure(mechanism)
    rng = np.random.default_rng(4)
    near = near_solutions(problem, rng)[:16]
    bound = problem.curvature.bound
    seen = [largest_value(hessian_at(problem, point), rng) for point in near]
    assert max(seen) <= bound
    assert bound <= 400 * max(seen)


@pytest.mark.parametrize("mechanism", one_in(3, MECHANISMS))
def test_the_bound_at_complex_points_holds(mechanism):
    problem = Closure(mechanism)
    rng = np.random.default_rng(5)
    for reach in (1e-3, 0.3):
        bound = problem.curvature.at_complex_points(np.array([reach]))[0]
        for point in near_solutions(problem, rng)[:6]:
            direction = rng.normal(size=problem.n)
            direction *= reach / np.linalg.norm(direction)
            seen = largest_value(complex_hessian(problem, point, direction), rng)
            assert seen <= bound


def complex_hessian(problem, point, direction):
    """F'' at point + i direction: its interpolant along the direction, continued."""
    nodes = np.cos(np.pi * (np.arange(13) + 0.5) / 13)
    values = np.array([hessian_at(problem, point + x * direction) for x in nodes])
    coefficients = np.polynomial.chebyshev.chebfit(nodes, values.reshape(13, -1), 12)
    continued = np.polynomial.chebyshev.chebval(1j, coefficients)
    return continued.reshape(values.shape[1:])
