"""Bounds on second derivatives hold wherever they are looked at."""

import numpy as np
import pytest

from linkages.mechanisms.closure import MechanismClosure
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from tests.linkages.mechanisms.frameworks import OCTAHEDRON, framework, places_of
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case

NAMES = [
    "Bennett geometry with joints CRCR",
    "CCCC loop, general axes",
    "Sarrus with a P joint between base and platform",
    "Miura-ori, 3 x 3 vertices",
    "PPPP loop, general axes",
    "K(2,3)",
]


def one_of_each():
    """A loop with a helical, a universal, a planar and a spherical joint."""
    return Mechanism(
        (
            Joint("H", "helical", ("a", "b"), (0, 0, 0), (0, 0, 1), pitch=0.7),
            Joint("U", "universal", ("b", "c"), (1, 0, 0.3), (0, 1, 0), (1, 0, 1)),
            Joint("E", "planar", ("c", "d"), (1, 1, 0), (0, 0.6, 0.8)),
            Joint("S", "spherical", ("d", "a"), (0, 1.3, 0)),
        )
    )


def rods():
    """A plate on a hinge, and a rod from it to a slider."""
    return Mechanism(
        (
            Joint("R", "revolute", ("base", "plate"), (0, 0, 0), (1, 0, 0.2)),
            Joint("S1", "spherical", ("plate", "rod"), (0.3, 1, 0)),
            Joint("S2", "spherical", ("rod", "slider"), (0.4, 1.2, 1.5)),
            Joint("P", "prismatic", ("slider", "base"), direction=(0.1, 0, 1)),
        )
    )


def rods_and_a_leg():
    """Two rods of a plate to a point, which a leg carries."""
    return Mechanism(
        (
            Joint("A", "spherical", ("base", "a"), (0, 0, 0)),
            Joint("B", "spherical", ("base", "b"), (1, 0.2, 0)),
            Joint("C", "spherical", ("base", "c"), (0.3, 1, 0.1)),
            Joint("P", "prismatic", ("c", "d"), direction=(0.2, -0.6, 0.9)),
            Joint("D", "spherical", ("a", "b", "d"), (0.5, 0.4, 1)),
        )
    )


MECHANISMS = [mechanism_of_case(cases()[name]) for name in NAMES]
MECHANISMS += [one_of_each(), rods(), rods_and_a_leg()]
MECHANISMS += [framework(places_of("ABCDEF", 2), OCTAHEDRON)]


def samples(problem, rng, count):
    """Random points within the limits."""
    low, high = problem.bounds.T
    low = np.where(np.isfinite(low), low, -np.pi)
    high = np.where(np.isfinite(high), high, np.pi)
    return rng.uniform(low, high, (count, problem.n))


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
    problem = MechanismClosure(mechanism)
    rng = np.random.default_rng(4)
    points, gaps = problem.project(samples(problem, rng, 40))
    is_inside = problem.excess(points) <= 0.0
    near = points[(gaps < 1e-10) & is_inside]
    near = near + 0.02 * rng.normal(size=near.shape)
    near = near[problem.gaps(near) <= problem.curvature_residual][:12]
    assert len(near)
    bound = problem.curvature_bound()
    seen = [largest_value(problem.hessian(point), rng) for point in near]
    assert max(seen) <= bound
    assert bound <= 400 * max(seen)


@pytest.mark.parametrize("mechanism", MECHANISMS, ids=str)
def test_the_bound_at_complex_points_holds(mechanism):
    problem = MechanismClosure(mechanism)
    rng = np.random.default_rng(5)
    for reach in (1e-3, 0.3):
        bound = problem.complex_curvature(np.array([reach]))[0]
        for point in samples(problem, rng, 6):
            direction = rng.normal(size=problem.n)
            direction *= reach / np.linalg.norm(direction)
            seen = largest_value(complex_hessian(problem, point, direction), rng)
            assert seen <= bound


def complex_hessian(problem, point, direction):
    """F'' at point + i direction: its interpolant along the direction, continued."""
    nodes = np.cos(np.pi * (np.arange(13) + 0.5) / 13)
    values = np.array([problem.hessian(point + x * direction) for x in nodes])
    coefficients = np.polynomial.chebyshev.chebfit(nodes, values.reshape(13, -1), 12)
    continued = np.polynomial.chebyshev.chebval(1j, coefficients)
    return continued.reshape(values.shape[1:])
