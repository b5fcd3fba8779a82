"""The discretised boundary value problems of TEST_CON, by functions of their unknowns."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from bifurc import FunctionProblem


def torsion_by_differences() -> FunctionProblem:
    """Torsion of a square rod (Rheinboldt 1976), TEST_CON 10, option 1: stiffness
    exp(5 |grad u|^2), 6 by 6 inner points."""
    side = 6
    step = 1.0 / (side + 1)

    def residual(unknowns: Any) -> Any:
        u = _with_zero_border(unknowns[:-1], side)
        load = unknowns[-1]
        return [
            _torsion_at(u, i, j, step) - load * step**2
            for j in range(1, side + 1)
            for i in range(1, side + 1)
        ]

    bounds = [(-0.04, 0.04)] * side**2 + [(-0.4, 0.4)]
    return FunctionProblem(residual, bounds, names=_names(side**2, "load"))


def _torsion_at(u: Any, i: int, j: int, step: float) -> Any:
    """The flow out of point (i, j) to its four neighbours, each with the stiffness of
    the two triangles beside the way to it."""
    centre = u[j][i]
    west, east, south, north = u[j][i - 1], u[j][i + 1], u[j - 1][i], u[j + 1][i]
    south_west, north_east = u[j - 1][i - 1], u[j + 1][i + 1]
    ways = [
        (west, south_west, north),
        (east, north_east, south),
        (south, south_west, east),
        (north, north_east, west),
    ]
    total = 0.0
    for neighbour, corner, across in ways:
        along = (neighbour - centre) ** 2
        first = np.exp(5 * (along + (neighbour - corner) ** 2) / step**2)
        second = np.exp(5 * (along + (centre - across) ** 2) / step**2)
        total = total + 0.5 * (first + second) * (centre - neighbour)
    return total


def torsion_by_elements() -> FunctionProblem:
    """The same rod by 4 by 4 bilinear elements with 4 Gauss points each, TEST_CON 11,
    option 1. The nodes on the border, where u is 0, are left out."""
    cells = 4
    inner = cells - 1
    h = 1.0 / cells
    abscissas = 0.5 + np.array([-1.0, 1.0]) / (2 * np.sqrt(3.0))

    def residual(unknowns: Any) -> Any:
        u = _with_zero_border(unknowns[:-1], inner)
        forces = [[0.0 for _ in range(cells + 1)] for _ in range(cells + 1)]
        for row in range(cells):
            for column in range(cells):
                for x in abscissas:
                    for y in abscissas:
                        _add_element(forces, u, unknowns[-1], (row, column), (x, y), h)
        return [forces[j][i] for j in range(1, cells) for i in range(1, cells)]

    bounds = [(-0.2, 0.2)] * inner**2 + [(-2.0, 2.0)]
    return FunctionProblem(residual, bounds, names=_names(inner**2, "load"))


def _add_element(
    forces: list[list[Any]],
    u: list[list[Any]],
    load: Any,
    cell: tuple[int, int],
    place: tuple[float, float],
    h: float,
) -> None:
    """Adds what one Gauss point at a ``place`` in a ``cell`` gives to the forces at its
    four corners."""
    (row, column), (x, y) = cell, place
    corners = [(0, 0), (0, 1), (1, 0), (1, 1)]  # up, right
    shapes = [(y if up else 1 - y) * (x if right else 1 - x) for up, right in corners]
    along_x = [(1 if right else -1) * (y if up else 1 - y) / h for up, right in corners]
    along_y = [(1 if up else -1) * (x if right else 1 - x) / h for up, right in corners]
    values = [u[row + up][column + right] for up, right in corners]
    ux = sum(value * slope for value, slope in zip(values, along_x, strict=True))
    uy = sum(value * slope for value, slope in zip(values, along_y, strict=True))
    stiffness = np.exp(5 * (ux * ux + uy * uy))
    for k, (up, right) in enumerate(corners):
        force = stiffness * (ux * along_x[k] + uy * along_y[k]) - 5 * load * shapes[k]
        at = forces[row + up]
        at[column + right] = at[column + right] + 0.25 * h * h * force


def materially_nonlinear() -> FunctionProblem:
    """u'' + p sin(u + u^2 + u^3) = 0 between zeros (Babuska and Rheinboldt 1980),
    TEST_CON 12, option 1: 8 linear elements with 8 Gauss points each.

    The collection couples discontinuous pieces by multipliers; here the 7 inner nodes
    are the unknowns, which gives the same solutions.
    """
    cells = 8
    h = 1.0 / cells
    abscissas, weights = np.polynomial.legendre.leggauss(8)
    places = (abscissas + 1) / 2

    def residual(unknowns: Any) -> Any:
        u = [0.0, *unknowns[:-1], 0.0]
        values = [0.0] * (cells + 1)
        for k in range(cells):
            slope = (u[k + 1] - u[k]) / h
            values[k] = values[k] + slope
            values[k + 1] = values[k + 1] - slope
            for x, weight in zip(places, weights, strict=True):
                v = (1 - x) * u[k] + x * u[k + 1]
                force = unknowns[-1] * np.sin(v + v**2 + v**3) * weight * h / 2
                values[k] = values[k] + (1 - x) * force
                values[k + 1] = values[k + 1] + x * force
        return values[1:-1]

    bounds = [(-1.0, 1.0)] * (cells - 1) + [(0.0, 60.0)]
    return FunctionProblem(residual, bounds, names=_names(cells - 1, "p"))


def simpson(side: int, source: Callable[[Any], Any]) -> FunctionProblem:
    """Simpson's mildly nonlinear problem on a square (1975), TEST_CON 13: the
    nine-point Laplacian of u plus p times a ``source`` f(u), smoothed by the five-point
    one, on ``side`` by ``side`` inner points.

    The collection's programs have 8, 12 and 16 of them; the points that it prints are
    those of so many steps, with one inner point less."""
    h = 1.0 / (side + 1)
    inner = slice(1, -1)
    before, after = slice(None, -2), slice(2, None)

    def residual(unknowns: Any) -> Any:
        rows = _with_zero_border(unknowns[:-1], side)
        u = np.stack([np.stack([0.0 * unknowns[0] + x for x in row]) for row in rows])
        f = source(u)
        sides = u[inner, before] + u[inner, after] + u[before, inner] + u[after, inner]
        corners = (
            u[before, before] + u[before, after] + u[after, before] + u[after, after]
        )
        around = f[inner, before] + f[inner, after] + f[before, inner] + f[after, inner]
        centre, force = u[inner, inner], f[inner, inner]
        laplacian = (corners + 4 * sides - 20 * centre) / 6
        smoothed = force + (around - 4 * force) / 12
        return (laplacian + h * h * unknowns[-1] * smoothed).ravel()

    bounds = [(-1.0, 8.0)] * side**2 + [(0.0, 10.0)]
    return FunctionProblem(residual, bounds, names=_names(side**2, "p"))


def rational_source(u: Any) -> Any:
    """The second source of Simpson's problem."""
    return (100 + 100 * u + 51 * u * u) / (100 + u * u)


def keller() -> FunctionProblem:
    """Keller's diffusion and kinetics in a ball, TEST_CON 14: 12 points, of which the
    first mirrors the third and the last is 1; the other 10 are the unknowns."""
    count = 12
    h = 1.0 / (count - 2)

    def residual(unknowns: Any) -> Any:
        p = unknowns[-1]
        u = [unknowns[1], *unknowns[:-1], 1.0]
        values = []
        for i in range(1, count - 1):
            radius = (i - 1) * h
            value = 0.0
            for near, way in ((u[i - 1], -0.5), (u[i + 1], 0.5)):
                between = radius + way * h
                diffusion = 1 + p / (0.5 * (u[i] + near) + 0.1) ** 2
                value = value + (u[i] - near) * between**2 * diffusion
            kinetics = u[i] / (0.1 * (u[i] + 0.1))
            values.append(value + h * h * radius**2 * kinetics)
        return values

    bounds = [(0.0, 1.2)] * (count - 2) + [(-0.005, 2.0)]
    return FunctionProblem(residual, bounds, names=_names(count - 2, "p"))


def chemical_reaction(points: int) -> FunctionProblem:
    """Moore and Spence's integral equation (1980), TEST_CON 16: the trapezoidal rule
    on so many ``points``."""
    h = 1.0 / (points - 1)
    t = h * np.arange(points)
    weights = np.full(points, h)
    weights[[0, -1]] = h / 2
    kernel = weights * (np.maximum.outer(t, t) - 1.0)

    def residual(unknowns: Any) -> Any:
        y = unknowns[:-1]
        rate = y * np.exp(8.0 * (1 - y) / (1 + 0.4 * (1 - y)))
        return y - 1 - unknowns[-1] * (kernel @ rate)

    bounds = [(-0.2, 1.2)] * points + [(0.0, 0.3)]
    return FunctionProblem(residual, bounds, names=_names(points, "p"))


def semiconductor() -> FunctionProblem:
    """The potential in a semiconductor (Polak and others 1979), TEST_CON 18: 11 points
    as the collection's program has them, of which the first is 0 and the last 25 p."""
    count = 11
    h = 1.0 / (count - 1)
    low, high = 1e6, 1e7

    def residual(unknowns: Any) -> Any:
        p = unknowns[-1]
        u = [0.0, *unknowns[:-1], 25.0 * p]
        values = []
        for i in range(1, count - 1):
            curvature = (u[i - 1] - 2 * u[i] + u[i + 1]) / (2 * h)
            holes = low * np.exp(-20.0 * p * u[i])
            electrons = high * np.exp(20.0 * p * (u[i] - 25.0 * p))
            values.append(curvature - p * (high + holes - electrons))
        return values

    bounds = [(-5.0, 30.0)] * (count - 2) + [(-0.1, 1.0)]
    return FunctionProblem(residual, bounds, names=_names(count - 2, "p"))


def _with_zero_border(values: Any, side: int) -> list[list[Any]]:
    """Rows of a square of ``side`` by ``side`` values, with zeros around it."""
    zeros = [0.0] * (side + 2)
    rows = [
        [0.0, *[values[j * side + i] for i in range(side)], 0.0] for j in range(side)
    ]
    return [zeros, *rows, zeros]


def _names(count: int, parameter: str) -> list[str]:
    return [*(f"u{k}" for k in range(1, count + 1)), parameter]


DISCRETISED: dict[str, Callable[[], FunctionProblem]] = {
    "torsion by differences": torsion_by_differences,
    "torsion by elements": torsion_by_elements,
    "materially nonlinear": materially_nonlinear,
    "simpson 7 exp": partial(simpson, 7, np.exp),
    "simpson 7 rational": partial(simpson, 7, rational_source),
    "simpson 11 exp": partial(simpson, 11, np.exp),
    "simpson 11 rational": partial(simpson, 11, rational_source),
    "simpson 15 exp": partial(simpson, 15, np.exp),
    "simpson 15 rational": partial(simpson, 15, rational_source),
    "keller": keller,
    "chemical reaction 16": partial(chemical_reaction, 16),
    "chemical reaction 33": partial(chemical_reaction, 33),
    "semiconductor": semiconductor,
}
