"""Problems whose solutions are curves in closed form."""

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.continuation import trace_branch
from bifurc.function_problem import FunctionProblem
from bifurc.numerics.null_spaces import null_vector

APART = 3.0  # of the two Watt linkages
SWING = 0.7  # rad, of every angle about its steady turning


class WindingCurve(FunctionProblem):
    """A closed curve of angles: with t the first of them, the k-th is
    ``winding[k]`` t + `SWING` sin(t + k); ``winding[0]`` is 1."""

    def __init__(self, *winding: int):
        turns = np.array(winding[1:])
        phases = np.arange(1, len(winding))

        def residuals(u):
            steady = u[1:] - turns * u[0]
            return np.sin(steady - SWING * np.sin(u[0] + phases))

        count = len(winding)
        circle = (-np.pi, np.pi)
        super().__init__(residuals, [circle] * count, periods=[2 * np.pi] * count)
        self.turns, self.phases = turns, phases

    def at(self, t: float) -> np.ndarray:
        """The point (n,) of the curve where the first angle is ``t``."""
        others = self.turns * t + SWING * np.sin(t + self.phases)
        return np.array([t, *others])

    def trace(self) -> Branch:
        """The whole curve."""
        return trace_branch(self, self.at(0.3))


def contradictory(error: float) -> FunctionProblem:
    """Four equations in three unknowns that agree but for an error."""

    def function(u):
        x, y, z = u
        sphere = x * x + y * y + z * z - 1.0
        plane = z - 0.3 * x * y
        return np.array(
            [sphere, plane, sphere + 2 * plane + error * x, plane + error * np.sin(y)]
        )

    return FunctionProblem(function, [[-2, 2]] * 3)


def double_watt(
    arm: float, half: float, room: float
) -> tuple[FunctionProblem, np.ndarray]:
    """Two Watt linkages with couplers 2 half, mirror images, whose middles are joined
    by a bar (Connelly and Servatius 1994), within ``room`` of the configuration in the
    middle; and that."""
    pivots = np.array(
        [[-arm, half], [arm, -half], [APART + arm, half], [APART - arm, -half]]
    )
    middle = np.array([0.0, half, 0.0, -half, APART, half, APART, -half])

    def lengths(u):
        p, q, r, s = u.reshape(4, 2)
        bars = [
            (p, pivots[0], arm),
            (p, q, 2 * half),
            (q, pivots[1], arm),
            (r, pivots[2], arm),
            (r, s, 2 * half),
            (s, pivots[3], arm),
            ((p + q) / 2, (r + s) / 2, APART),
        ]
        return np.array([(a - b) @ (a - b) - length**2 for a, b, length in bars])

    return FunctionProblem(lengths, [(x - room, x + room) for x in middle]), middle


class Bratu(FunctionProblem):
    """u'' + p exp(u) = 0 with n inner points, from u = 0 on: its unknowns are u and p."""

    def __init__(self, n: int):
        h2 = 1.0 / (n + 1) ** 2

        def residual(x):
            u = x[:-1]
            value = np.asarray(h2 * x[-1] * np.exp(u) - 2 * u)
            value[1:] += u[:-1]
            value[:-1] += u[1:]
            return value

        super().__init__(residual, [(-1.0, 20.0)] * n + [(0.0, 5.0)])
        self.residual = residual
        self.start = np.zeros(n + 1)
        self.tangent = null_vector(self, self.start, along=np.eye(n + 1)[-1])
