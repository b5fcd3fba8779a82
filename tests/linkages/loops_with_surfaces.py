"""Loops whose configurations form surfaces, or components of higher dimension."""

import numpy as np

from linkages.axes import loop_from_axes
from linkages.closure.closure import Closure
from linkages.families.double_goldberg import double_subtractive_goldberg
from linkages.loop import Loop


def planar(*lengths: float) -> Closure:
    zeros = (0,) * len(lengths)
    return Closure(Loop(lengths, zeros, zeros))


def spherical(*twists: float) -> Closure:
    zeros = (0,) * len(twists)
    return Closure(Loop(zeros, twists, zeros))


def general(n: int) -> Closure:
    """A loop of n joints without any special proportions."""
    rng = np.random.default_rng(n)
    lengths = rng.uniform(0.5, 1.5, n)
    twists = rng.uniform(0.4, 2.6, n)
    offsets = rng.uniform(-0.5, 0.5, n)
    return Closure(Loop(tuple(lengths), tuple(twists), tuple(offsets)))


def equal_double_goldberg() -> Closure:
    """The double-subtractive-Goldberg loop whose links 23, 34, 56, 61 are alike (b =
    d): two forms, and a torus that they never meet."""
    alpha, beta, gamma = np.radians([66, 50, 28])
    return Closure(
        double_subtractive_goldberg(1.7 * np.sin(alpha), alpha, beta, gamma, beta)
    )


def sarrus() -> Closure:
    """Two legs of three parallel joints each, with links that are alike in each leg."""
    points = [(0, 1, 0), (0, 1.5, 1), (0, 1, 2), (1, 0, 2), (1.7, 0, 1), (1, 0, 0)]
    directions = [(1, 0, 0)] * 3 + [(0, 1, 0)] * 3
    return Closure(loop_from_axes(points, directions)[0])
