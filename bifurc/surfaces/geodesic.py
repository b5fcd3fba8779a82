"""Short paths on a surface: the shortest chain of charts, pulled tight.

A path of points x_i, evenly spread, is shortest where sum |x_(i+1) - x_i|^2 is
smallest. Every round moves the inner points in their tangent planes T_i by the y_i that
minimise that sum to first order in the bend of the surface: one linear system, block
tridiagonal with 2 I on the diagonal and -T_i^T T_(i+1) beside it. Then the points are
corrected onto the surface straight above where they went. As the bend is left out of
the system, the share of the step that is taken comes from how the sum went down in the
round before. The number of rounds does not grow with that of the points.
"""

from __future__ import annotations

from collections.abc import Hashable

import networkx as nx
import numpy as np
from scipy.linalg import solveh_banded

from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import tangent_planes
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas

__all__ = ["entrances", "path_length", "resample", "shortest_path"]

ROUNDS, FINAL_ROUNDS = 40, 4
TIGHT = 1e-11  # share of the sum of squares still to be gained at which a path is tight
# how much longer a second chain of charts may be: chains are longer than geodesics by
# up to a sixth
DETOUR = 1.4
SOLVED = 1e-10  # relative residual above which a point could not be corrected


def shortest_path(
    problem: Problem,
    charts: ChartAtlas,
    start: np.ndarray,
    goal: np.ndarray,
    spacing: float,
) -> np.ndarray:
    """Solutions (k, n) about ``spacing`` apart from ``start`` to ``goal`` (n,), as
    short as pulling makes them.

    The shorter one of the geodesics near the shortest chain of charts and near another
    chain beside it: where there are more ways round holes, nearly as long, it may not
    be the shortest of all. The goal comes out shifted by whole periods, k is odd.
    Raises `ValueError` where an end lies beside the charts, no chain of them leads from
    one end to the other, or points cannot be corrected onto the surface.
    """
    paths = [
        _pulled(problem, charts, start, goal, chain, spacing)
        for chain in _chains(problem, charts, start, goal)
    ]
    path = min(paths, key=path_length)
    intervals = _intervals(path, spacing)
    return (
        resample(problem, charts, path, intervals)
        if 2 * len(path) < 3 * intervals
        else path
    )


def _pulled(
    problem: Problem,
    charts: ChartAtlas,
    start: np.ndarray,
    goal: np.ndarray,
    chain: list[int],
    spacing: float,
) -> np.ndarray:
    """The path along a chain of charts, pulled tight; its points lie ``spacing`` apart,
    or as far as charts allow."""
    points = np.array([start, *charts.centers[chain[1:-1]], goal], dtype=float)
    points[1:] = points[0] + np.cumsum(charts.apart(points[1:], points[:-1]), axis=0)
    spacing = max(spacing, 0.3 * float(np.median(charts.radii[chain])))
    return _tightened(
        problem,
        charts,
        _lifted(problem, charts, _evenly(points, _intervals(points, spacing))),
        ROUNDS,
    )


def resample(
    problem: Problem, charts: ChartAtlas, path: np.ndarray, intervals: int
) -> np.ndarray:
    """A path (intervals + 1, n) on the surface along a tight one (k, n), evenly spread
    and tight as well.

    Raises `ValueError` where points cannot be corrected onto the surface.
    """
    return _tightened(
        problem,
        charts,
        _lifted(problem, charts, _evenly(path, intervals)),
        FINAL_ROUNDS,
    )


def path_length(path: np.ndarray) -> float:
    """Length of a smooth curve through points (k, n), evenly spread: of the chords,
    extrapolated where k is odd."""
    fine = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    if len(path) % 2 == 0 or len(path) < 5:
        return float(fine)
    return float(
        (4.0 * fine - np.linalg.norm(np.diff(path[::2], axis=0), axis=1).sum()) / 3.0
    )


def entrances(problem: Problem, charts: ChartAtlas, point: np.ndarray) -> np.ndarray:
    """Numbers (k,) of the charts in which a solution (n,) lies.

    Where there is none, as at the tip of a cone, those next to it whose centres are
    joined to it by solutions: these stay near the straight line, the nearer the closer
    to it.
    """
    found = charts.holding(point)
    if len(found):
        return found
    found = charts.beside(point)
    if not len(found):
        return found
    share = np.geomspace(1e-3, 1.0, 12)
    steps = (
        share[:, None] * charts.apart(charts.centers[found], point)[:, None]
    )  # (k, 12, n)
    lines = (point + steps).reshape(-1, len(point))
    ends, gaps = correct_normal(
        problem, lines, np.repeat(charts.bases[found], len(share), axis=0)
    )
    off = np.linalg.norm(ends - lines, axis=1) / np.linalg.norm(steps, axis=2).ravel()
    return found[
        np.all(((gaps < SOLVED) & (off < 0.3)).reshape(steps.shape[:2]), axis=1)
    ]


def _chains(
    problem: Problem, charts: ChartAtlas, start: np.ndarray, goal: np.ndarray
) -> list[list[int]]:
    """Numbers of the charts on the shortest way, from one about the start to one about
    the goal.

    Then those on the shortest way that keeps off them, where it is not much longer.
    """
    graph = nx.Graph()
    i, j = charts.neighbours.T
    lengths = np.linalg.norm(charts.apart(charts.centers[i], charts.centers[j]), axis=1)
    graph.add_weighted_edges_from(
        zip(i.tolist(), j.tolist(), lengths.tolist(), strict=True)
    )
    for name, point in (("start", start), ("goal", goal)):
        about = entrances(problem, charts, point)
        if not len(about):
            raise ValueError(f"the {name} lies in no chart of the surface")
        away = np.linalg.norm(charts.apart(charts.centers[about], point), axis=1)
        graph.add_weighted_edges_from(
            (name, k, d) for k, d in zip(about.tolist(), away.tolist(), strict=True)
        )
    try:
        first = nx.shortest_path(graph, "start", "goal", weight="weight")
    except nx.NetworkXNoPath:
        raise ValueError(
            "no chain of charts leads from the start to the goal"
        ) from None
    used = set(first[1:-1])

    def keeping_off(a: Hashable, b: Hashable, edge: dict[str, float]) -> float:
        return edge["weight"] * (DETOUR if a in used or b in used else 1.0)

    other = nx.shortest_path(graph, "start", "goal", weight=keeping_off)
    lengths_of = [nx.path_weight(graph, chain, "weight") for chain in (first, other)]
    worth = used.isdisjoint(other[2:-2]) and lengths_of[1] < DETOUR * lengths_of[0]
    return [first[1:-1], other[1:-1]] if worth else [first[1:-1]]


def _lifted(problem: Problem, charts: ChartAtlas, points: np.ndarray) -> np.ndarray:
    """The points (k, n) with the inner ones corrected onto the surface straight above
    the planes of the charts."""
    out = points.copy()
    if len(points) > 2:
        out[1:-1], solved = _corrected(
            problem, charts, points[1:-1], charts.bases[charts.nearest(points[1:-1])]
        )
        if not np.all(solved):
            raise ValueError(
                "the path between the charts cannot be corrected onto the surface"
            )
    return out


def _tightened(
    problem: Problem, charts: ChartAtlas, path: np.ndarray, rounds: int
) -> np.ndarray:
    """The path after up to so many rounds of pulling. Its ends stay, and points that
    would leave surface or bounds."""
    spacing = np.linalg.norm(np.diff(path, axis=0), axis=1).mean()
    if len(path) < 3 or spacing == 0:
        return path
    path = path.copy()
    inner, (low, high) = path[1:-1], problem.bounds.T
    planes, share, energy = charts.bases[charts.nearest(inner)], 1.0, _energy(path)
    for _ in range(rounds):
        planes = tangent_planes(problem, inner, planes)
        force, pull = _pull(path, planes)
        slope = -2.0 * float(
            np.sum(force * pull)
        )  # of the energy, by the share of the pull
        if -slope < TIGHT * energy:
            break
        step = np.einsum("kij,kj->ki", planes, pull)
        size = np.linalg.norm(step, axis=1).max()
        share = min(share, 0.5 * charts.radii.max() / size)
        moved, good = _corrected(problem, charts, inner + share * step, planes)
        good &= np.all((moved >= low) & (moved <= high), axis=1)
        before = inner.copy()
        inner[good] = moved[good]
        bend = (_energy(path) - energy - slope * share) / share**2
        if _energy(path) > energy:
            inner[:] = before
        energy = _energy(path)
        share = float(np.clip(-0.5 * slope / bend, 0.1, 2.0)) if bend > 0 else 1.0
    return path


def _energy(path: np.ndarray) -> float:
    """The sum that is smallest for a tight path."""
    return float(np.sum(np.diff(path, axis=0) ** 2))


def _pull(path: np.ndarray, planes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The forces (k - 2, 2) on the inner points in their ``planes`` (k - 2, n, 2), and
    the steps y that follow."""
    count = len(planes)
    bands = np.zeros((4, 2 * count))  # the upper ones of the matrix, the diagonal last
    bands[3] = 2.0
    beside = -np.swapaxes(planes[:-1], 1, 2) @ planes[1:]
    for a in range(2):
        for b in range(2):
            bands[1 + a - b, 2 + b :: 2] = beside[:, a, b]
    force = np.einsum("kij,ki->kj", planes, path[2:] - 2.0 * path[1:-1] + path[:-2])
    return force, solveh_banded(bands, force.ravel()).reshape(count, 2)


def _corrected(
    problem: Problem, charts: ChartAtlas, points: np.ndarray, planes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) straight above ``points`` of ``planes`` (k, n, 2), and which
    (k,) are solutions nearby."""
    found, gaps = correct_normal(problem, points, planes)
    return found, (gaps < SOLVED) & (
        np.linalg.norm(found - points, axis=1) < 0.5 * charts.radii.max()
    )


def _intervals(points: np.ndarray, spacing: float) -> int:
    """How many intervals of about ``spacing`` the chords make: an even number."""
    return 2 * max(
        1,
        round(np.linalg.norm(np.diff(points, axis=0), axis=1).sum() / (2.0 * spacing)),
    )


def _evenly(points: np.ndarray, intervals: int) -> np.ndarray:
    """Points (intervals + 1, n) evenly spread along the chords between ``points`` (k,
    n), the ends included."""
    s = np.concatenate(
        [[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    )
    at = np.linspace(0.0, s[-1], intervals + 1)
    return np.stack([np.interp(at, s, column) for column in points.T], axis=1)
