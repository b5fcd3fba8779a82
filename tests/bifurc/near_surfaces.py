"""Problems that nearly have a surface of solutions."""

import numpy as np

from bifurc.domain import Domain
from bifurc.function_problem import NumericalProblem


class CirclesBesideSphere(NumericalProblem):
    """Two curves on the unit sphere, a great circle and one that crosses it at both
    poles, where a bilinear function is zero.

    Both equations are that of the sphere, the second one ``e`` times that function
    more: as e goes to 0 the sphere is all that is left.
    """

    def __init__(self, e: float):
        bounds = np.full((3, 2), [-2.0, 2.0])
        self.domain = Domain(("x", "y", "z"), ("",) * 3, np.full(3, np.inf), bounds)
        self.e = e

    def residuals(self, points: np.ndarray) -> np.ndarray:
        x, y, z = points.T
        sphere = x**2 + y**2 + z**2 - 1
        again = (z**2 - 0.7) + (y**2 - 0.3) + x**2  # its rounding is another
        return np.stack([sphere, again + self.e * x * self.other(x, y, z)], axis=1)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        x, y, z = points.T
        sphere = 2 * points
        own = np.stack([self.other(x, y, z) + x * (0.1 - 0.2 * z), x, -0.2 * x**2], 1)
        return np.stack([sphere, sphere + self.e * own], axis=1)

    def other(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Zero on the second curve."""
        return y + 0.1 * x - 0.2 * x * z

    def points(self, count: int) -> np.ndarray:
        """Points (count, 3) of the great circle x = 0, none near a pole."""
        angles = np.linspace(0.3, np.pi - 0.3, count)
        return np.stack([np.zeros(count), np.sin(angles), np.cos(angles)], axis=1)
