"""Curves on which methods fail, each with the answer that is right and a test that does
not depend on any method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.optimize import brentq

from bifurc import Curvature, FunctionProblem, Problem, trace_branch
from linkages import Loop, LoopClosure
from linkages.catalogue import entry

Test = Callable[[np.ndarray], bool]


@dataclass(frozen=True)
class Ladder:
    """A near miss that an ``imperfection`` makes, and the ``width`` that this leaves
    between the arcs: from ``start`` along ``tangent`` for ``length``; ``stays`` tells
    whether points (k, n) all lie on the true arc, ``arrives`` whether the last of them
    is at its end. ``parameter`` is the unknown that natural-parameter stepping sets,
    over ``travel``.

    Both are 1 in order of magnitude in their equations, so that rounding in doubles is
    an imperfection of 1e-16 to 1e-15: what is smaller is no near miss but a crossing
    there.
    """

    name: str
    imperfection: float
    width: float
    problem: Problem
    start: np.ndarray
    tangent: np.ndarray
    length: float
    stays: Test
    arrives: Test
    parameter: int
    travel: float


@dataclass(frozen=True)
class Crossing:
    """A curve from ``start`` with ``count`` bifurcations on it; ``whole`` is the number
    of all branches that hang together with it. ``length`` is how far to follow the
    curve, ``start`` lies in the middle of it where it is open."""

    name: str
    problem: Problem
    start: np.ndarray
    length: float
    count: int


# --- near misses of any width -------------------------------------------------------------------------


class _Pitchfork(FunctionProblem):
    """lambda x - x^3 + e, with the bound on its second derivative that a certificate
    needs."""

    def __init__(self, e: float):
        super().__init__(
            lambda u: np.array([u[0] * u[1] - u[1] ** 3 + e]),
            [[-1.0, 1.0], [-1.5, 1.5]],
            jacobian=lambda u: np.array([[u[1], u[0] - 3 * u[1] ** 2]]),
        )

    @property
    def curvature(self) -> Curvature:
        """The norm of [[0, 1], [1, -6 x]] where |x| <= 1.5 and, at complex points, where
        |x| is more by how far these may be, over the magnitude."""

        def at_complex_points(reach: np.ndarray) -> np.ndarray:
            diagonal = 3.0 * (1.5 + reach)
            largest: np.ndarray = diagonal + np.hypot(diagonal, 1.0)
            return largest / self.magnitude

        bound = (4.5 + sqrt(4.5**2 + 1.0)) / self.magnitude
        return Curvature(bound, at_complex_points)


def pitchfork(e: float) -> Ladder:
    """The imperfect pitchfork lambda x - x^3 + e = 0, along the arc with x > 0.

    At the corner it is the hyperbola lambda x = -e, whose two arcs are 2 sqrt(2 e)
    apart.
    """
    x = brentq(lambda x: -0.9 * x - x**3 + e, 0.0, 1.0, xtol=1e-300, rtol=1e-15)
    tangent = np.array([0.9 + 3 * x * x, x])
    return Ladder(
        "imperfect pitchfork",
        e,
        2 * sqrt(2 * e),
        _Pitchfork(e),
        np.array([-0.9, x]),
        tangent / np.linalg.norm(tangent),
        2.2,
        stays=lambda u: bool(np.all(u[:, 1] > 0)),
        arrives=lambda u: bool(abs(u[-1, 1]) > 0.7),
        parameter=0,
        travel=1.7,
    )


def near_parallelogram(e: float) -> Ladder:
    """The four-bar 1, 2, 1 + e, 2, whose two circuits come within sqrt(3 e) (rad at
    joint 3).

    On each circuit sin(theta3) keeps its sign, since links 23 and 34 cannot be flat for
    any e > 0.
    """
    zero = (0.0,) * 4
    problem = LoopClosure(Loop((1.0, 2.0, 1.0 + e, 2.0), zero, zero))
    angle = 0.7  # the parallelogram itself, then corrected
    start = problem.project(np.array([[angle, np.pi - angle, angle, np.pi - angle]]))[
        0
    ][0]
    tangent = np.linalg.svd(problem.jacobians(start[None])[0])[2][-1]
    tangent *= np.sign(tangent[0])
    sign = np.sign(np.sin(start[2]))
    return Ladder(
        "near-parallelogram",
        e,
        sqrt(3 * e),
        problem,
        start,
        tangent,
        12.0,
        stays=lambda u: bool(np.all(sign * np.sin(u[:, 2]) > 0)),
        arrives=lambda u: bool(abs(u[-1, 0] - u[0, 0]) > 5.0),
        parameter=0,
        travel=2 * np.pi,
    )


def ladders(imperfections: np.ndarray) -> list[Ladder]:
    """Both ladders."""
    return [
        make(float(e))
        for make in (pitchfork, near_parallelogram)
        for e in imperfections
    ]


# --- points that are there, or only seem to be --------------------------------------------------------


# singular point of the plane curves: at the origin rounding would vanish
CENTER = np.array([0.1234, -0.0567])
MISS = 2.5e-7  # the square of half the width of the near miss among the plane curves
Equation = Callable[[float, float], float]


def _curve(
    name: str, equation: Equation, start: tuple[float, float], length: float, count: int
) -> Crossing:
    """A plane curve whose singular point is moved from the origin to `CENTER`, and its
    ``start`` with it."""

    def moved(u: np.ndarray) -> np.ndarray:
        x, y = u - CENTER
        return np.array([equation(x, y)])

    problem = FunctionProblem(moved, [[-1.1, 1.0], [-1.05, 1.2]])
    return Crossing(name, problem, np.array(start) + CENTER, length, count)


def _line_and_parabola(x: float, y: float) -> float:
    above = y - 0.5 * x
    return above * (above - x**2 + 0.04)


def _point_and_line(x: float, y: float) -> float:
    return (x**2 + y**2) * (x - 0.05)


def _oval_and_line(x: float, y: float) -> float:
    return (x**2 + y**2 - 1e-4) * (x - 0.05)


def _near_miss(x: float, y: float) -> float:
    return x**2 - y**2 - MISS


def crossings() -> list[Crossing]:
    """Plane curves with a known singular point, and linkages with known maps."""
    plane = [
        _curve("transcritical", lambda x, y: x * y - y**2, (0.5, 0.5), 1.6, 1),
        _curve(
            "pitchfork from the side", lambda x, y: x * y - y**3, (0.49, 0.7), 2.0, 1
        ),
        _curve("triple crossing", lambda x, y: y * (y**2 - x**2), (0.5, 0.5), 1.6, 1),
        _curve("tacnode", lambda x, y: y**2 - x**4, (0.6, 0.36), 1.5, 1),
        _curve("double crossing", _line_and_parabola, (0.6, 0.3), 1.2, 2),
        _curve("cusp", lambda x, y: y**2 - x**3, (0.64, 0.512), 1.6, 0),
        _curve("isolated point beside a line", _point_and_line, (0.05, 0.5), 1.0, 0),
        _curve("small oval beside a line", _oval_and_line, (0.05, 0.5), 1.0, 0),
        _curve("near miss 1e-3", _near_miss, (0.5, sqrt(0.25 - MISS)), 1.4, 0),
    ]
    return plane + [_loop(*case) for case in LOOPS]


# Beta and delta are almost equal: at a rank drop two equations of second order differ
# by 2e-8 of their size (singular values 0.419 and 2.29e-8 of their coefficients at 50
# digits), so that one of two tangents solves both, but nearly two.
ALMOST_TWO = {
    "a": 2.144874646208794,
    "alpha": 1.5668555382374716,
    "beta": 0.5795111767234356,
    "gamma": 1.5921695469201371,
    "delta": 0.5790264703154796,
}
LOOPS: tuple[tuple[str, str, int, dict[str, float]], ...] = (
    ("Bennett, raw", "bennett", 0, {}),
    ("serial Goldberg 6R", "serial-goldberg-6r", 0, {}),
    ("double collapse (rank drops)", "bricard-octahedral-doubly-collapsible", 0, {}),
    ("rank drop, almost a crossing", "mixed-double-goldberg-type-ii", 0, ALMOST_TWO),
    ("parallelogram", "parallelogram", 2, {}),
    ("special double-Goldberg", "special-double-subtractive-goldberg", 2, {}),
)


def _loop(title: str, name: str, count: int, values: dict[str, float]) -> Crossing:
    """A linkage of the catalogue, once around the first form that random starts reach
    far from singular points."""
    problem = LoopClosure(entry(name).build(**values))
    n = problem.n
    rng = np.random.default_rng(0)
    points, gaps = problem.project(rng.uniform(-3, 3, (60, n)))
    points = points[gaps < 1e-13]
    sigma = np.linalg.svd(problem.jacobians(points), compute_uv=False)
    if sigma.shape[1] >= n:
        is_on_curve = sigma[:, n - 1] < 1e-9
        points = points[is_on_curve]
        sigma = sigma[is_on_curve]
    start = points[np.argmax(sigma[:, n - 2])]
    length = trace_branch(problem, start).length
    return Crossing(title, problem, start, length, count)
