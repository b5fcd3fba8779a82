"""Problems whose solutions are surfaces of known size and shape."""

from collections.abc import Callable
from itertools import product
from math import prod

import numpy as np

from bifurc.domain import Domain
from bifurc.function_problem import FunctionProblem, NumericalProblem
from bifurc.problem import Problem


class Level(NumericalProblem):
    """The surface, in a cube, where a function of three unknowns is zero."""

    def __init__(self, function: Callable, gradient: Callable, size: float):
        bounds = np.full((3, 2), [-size, size])
        self.domain = Domain(("x", "y", "z"), ("",) * 3, np.full(3, np.inf), bounds)
        self.function = function
        self.gradient = gradient

    def residuals(self, points: np.ndarray) -> np.ndarray:
        return self.function(*points.T)[:, None]

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        return np.stack(self.gradient(*points.T), axis=1)[:, None]


def union(*sets: Callable, size: float = 2.0) -> Problem:
    """The union, in a cube, of sets: each given by functions of x, y, z whose common
    zeros it is."""

    def products(u: np.ndarray) -> np.ndarray:
        values = [functions(*u) for functions in sets]
        return np.array([prod(one) for one in product(*values)])

    return FunctionProblem(products, [[-size, size]] * 3, names=("x", "y", "z"))


SPHERE = Level(
    lambda x, y, z: (x * x + y * y + z * z - 1) / 2, lambda x, y, z: (x, y, z), 2.0
)
CONE = Level(
    lambda x, y, z: z * z - x * x - y * y, lambda x, y, z: (-2 * x, -2 * y, 2 * z), 1.0
)


def level(function: Callable, size: float) -> Problem:
    """The same, with derivatives of the recorded function."""
    return union(lambda *u: [function(*u)], size=size)


def torus(tube: float) -> Problem:
    """The torus about the z-axis with radii 1 and ``tube``."""
    return level(
        lambda x, y, z: ((np.sqrt(x * x + y * y) - 1) ** 2 + z * z - tube**2) / 2,
        2.0,
    )


def two_spheres(distance: float) -> Problem:
    """A sphere of radius 0.5 about (-distance, 0, 0) and one of radius 0.6 about
    (distance, 0, 0)."""

    def product(x, y, z):
        left = (x + distance) ** 2 + y * y + z * z - 0.25
        right = (x - distance) ** 2 + y * y + z * z - 0.36
        return left * right

    return level(product, 2.0)


def spheres(center: np.ndarray, radius: float, other: np.ndarray, other_radius: float):
    """Two spheres, each about a centre (3,) with a radius."""

    def product(u: np.ndarray) -> np.ndarray:
        first = (u - center) @ (u - center) - radius**2
        second = (u - other) @ (u - other) - other_radius**2
        return np.array([first * second])

    return FunctionProblem(product, [(-1.5, 1.5)] * 3)


def seeds(problem: Problem, count: int = 20) -> np.ndarray:
    """Solutions of the problem, from as many random starts."""
    return problem.seeds(np.random.default_rng(1), count).points
