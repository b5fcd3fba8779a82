"""Problems whose solutions are surfaces of known size and shape."""

from collections.abc import Callable

import numpy as np

from bifurc.function_problem import NumericalProblem
from bifurc.problem import Problem
from linkages.axes import loop_from_axes
from linkages.closure.loop_closure import LoopClosure
from linkages.families.double_goldberg import double_subtractive_goldberg
from linkages.loop import Loop


class Level(NumericalProblem):
    """The surface, in a cube, where a function of three unknowns is zero."""

    def __init__(self, function: Callable, gradient: Callable, size: float):
        self.names = ("x", "y", "z")
        self.units = ("",) * 3
        self.periods = np.full(3, np.inf)
        self.bounds = np.full((3, 2), [-size, size])
        self.function = function
        self.gradient = gradient

    def residuals(self, points: np.ndarray) -> np.ndarray:
        return self.function(*points.T)[:, None]

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        return np.stack(self.gradient(*points.T), axis=1)[:, None]


class Union(NumericalProblem):
    """The union, in a cube, of sets: each given by functions (p, k) of x, y, z (k,)
    whose common zeros it is."""

    def __init__(self, *sets: Callable, size: float = 2.0):
        self.names = ("x", "y", "z")
        self.units = ("",) * 3
        self.periods = np.full(3, np.inf)
        self.bounds = np.full((3, 2), [-size, size])
        self.sets = sets

    def residuals(self, points: np.ndarray) -> np.ndarray:
        count = len(points)
        out = np.ones((count, 1))
        for functions in self.sets:
            values = functions(*points.T).T
            out = (out[:, :, None] * values[:, None]).reshape(count, -1)
        return out

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        columns = []
        for step in np.eye(3):
            shifted = self.residuals(points + 1e-100j * step)
            columns.append(shifted.imag / 1e-100)
        return np.stack(columns, axis=2)


SPHERE = Level(
    lambda x, y, z: (x * x + y * y + z * z - 1) / 2, lambda x, y, z: (x, y, z), 2.0
)
CONE = Level(
    lambda x, y, z: z * z - x * x - y * y, lambda x, y, z: (-2 * x, -2 * y, 2 * z), 1.0
)


def torus(tube: float) -> Level:
    """The torus about the z-axis with radii 1 and ``tube``."""

    def function(x, y, z):
        return ((np.hypot(x, y) - 1) ** 2 + z * z - tube**2) / 2

    def gradient(x, y, z):
        r = np.hypot(x, y)
        return (r - 1) * x / r, (r - 1) * y / r, z

    return Level(function, gradient, 2.0)


def two_spheres(distance: float) -> Level:
    """A sphere of radius 0.5 about (-distance, 0, 0) and one of radius 0.6 about
    (distance, 0, 0)."""

    def factors(x, y, z):
        left = (x + distance) ** 2 + y * y + z * z - 0.25
        right = (x - distance) ** 2 + y * y + z * z - 0.36
        return left, right

    def gradient(x, y, z):
        left, right = factors(x, y, z)
        along_x = 2 * (x + distance) * right + 2 * (x - distance) * left
        return along_x, 2 * y * (left + right), 2 * z * (left + right)

    return Level(lambda *u: np.prod(factors(*u), axis=0), gradient, 2.0)


def seeds(problem: Problem, count: int = 20) -> np.ndarray:
    """Solutions of the problem, from as many random starts."""
    return problem.seeds(np.random.default_rng(1), count).points


# --- linkages -------------------------------------------------------------------------


def planar(*lengths: float) -> LoopClosure:
    zeros = (0,) * len(lengths)
    return LoopClosure(Loop(lengths, zeros, zeros))


def spherical(*twists: float) -> LoopClosure:
    zeros = (0,) * len(twists)
    return LoopClosure(Loop(zeros, twists, zeros))


def general(n: int) -> LoopClosure:
    """A loop of n joints without any special proportions."""
    rng = np.random.default_rng(n)
    lengths = rng.uniform(0.5, 1.5, n)
    twists = rng.uniform(0.4, 2.6, n)
    offsets = rng.uniform(-0.5, 0.5, n)
    return LoopClosure(Loop(tuple(lengths), tuple(twists), tuple(offsets)))


def equal_double_goldberg() -> LoopClosure:
    """The double-subtractive-Goldberg loop whose links 23, 34, 56, 61 are alike (b =
    d): two forms, and a torus that they never meet."""
    alpha, beta, gamma = np.radians([66, 50, 28])
    return LoopClosure(
        double_subtractive_goldberg(1.7 * np.sin(alpha), alpha, beta, gamma, beta)
    )


def sarrus() -> LoopClosure:
    """Two legs of three parallel joints each, with links that are alike in each leg."""
    points = [(0, 1, 0), (0, 1.5, 1), (0, 1, 2), (1, 0, 2), (1.7, 0, 1), (1, 0, 0)]
    directions = [(1, 0, 0)] * 3 + [(0, 1, 0)] * 3
    return LoopClosure(loop_from_axes(points, directions)[0])
