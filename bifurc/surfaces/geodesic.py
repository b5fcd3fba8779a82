"""Short paths on a surface: the shortest chain of charts, pulled tight.

A path of points x_i, evenly spread, is shortest where sum |x_(i+1) - x_i|^2 is
smallest. Every round moves the inner points in their tangent planes T_i by the y_i that
minimise that sum to first order in the bend of the surface: one linear system, block
tridiagonal with 2 I on the diagonal and -T_i^T T_(i+1) next to it. Then the points are
corrected onto the surface straight above where they went. As the bend is left out of
the system, the share of the step that is taken comes from how the sum went down in the
round before. The number of rounds does not grow with that of the points.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING

import numpy as np

from bifurc.errors import BifurcError
from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import tangent_planes
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas

if TYPE_CHECKING:
    # a map without surfaces needs no graph of charts
    import networkx as nx

ROUNDS, FINAL_ROUNDS = 40, 4
# Share of the sum of squares still to be gained at which a path is tight.
TIGHT = 1e-11
# How much longer a second chain of charts may be: chains are longer than geodesics by
# up to a sixth.
DETOUR = 1.4
# Relative residual above which a point could not be corrected.
SOLVED = 1e-10
# Height above a plane, over the largest radius, above which a point was corrected onto
# another sheet; the longest step of a round is no longer either.
TOO_FAR = 0.5
# Share of a path below which a point is its end but for rounding.
AT_END = 1e-12
# Shortest spacing of points while they are pulled, over the median radius of charts.
COARSE = 0.3
# Shares of the way from a singular point to a chart at which solutions are looked for,
# and how far these may lie from the straight line, over the distance.
SHARES = np.geomspace(1e-3, 1.0, 12)
OFF_LINE = 0.3
# Distance of a solution from the surface above a chart, over its height above the chart's
# plane, and over the scale: where sheets cross Newton's method comes down to it slowly.
OFF_POINT, AT_POINT = 0.2, 1e-7

START, GOAL = "start", "goal"  # nodes of the graph of charts: the charts are numbers


class SurfacePathError(BifurcError, ValueError):
    """There is no path on a surface: an end lies outside its charts, no chain of them
    leads from one end to the other, or points cannot be corrected onto it."""


def shortest_path(
    problem: Problem,
    charts: ChartAtlas,
    start: np.ndarray,
    goal: np.ndarray,
    spacing: float,
) -> np.ndarray:
    """Solutions (k, n) about ``spacing`` from each other, from ``start`` to ``goal``
    (n,), as short as pulling makes them.

    The shorter one of the geodesics near the shortest chain of charts and near another
    chain next to it: where there are more ways round holes, nearly as long, it may not
    be the shortest of all. The goal comes out shifted by whole periods, k is odd.
    Raises `SurfacePathError`.
    """
    paths = []
    for chain in _chart_chains(problem, charts, start, goal):
        points = _points_along(charts, chain, start, goal)
        radius = float(np.median(charts.radii[chain]))
        coarse = max(spacing, COARSE * radius)
        intervals = _count_intervals(points, coarse)
        paths.append(spread(problem, charts, points, intervals, ROUNDS))
    path = min(paths, key=path_length)
    intervals = _count_intervals(path, spacing)
    if 2 * len(path) < 3 * intervals:
        return spread(problem, charts, path, intervals)
    return path


def place_at(
    problem: Problem, charts: ChartAtlas, path: np.ndarray, shares: np.ndarray
) -> np.ndarray:
    """Solutions (k, n) at shares (k,) of the length of an evenly spread path on the
    surface; raises `SurfacePathError`."""
    points = _place_along(path, shares)
    # the ends are solutions already, and may be singular: nothing is corrected there
    is_inner = (shares > AT_END) & (shares < 1.0 - AT_END)
    points[is_inner] = _lifted(problem, charts, points[is_inner])
    return points


def path_length(path: np.ndarray) -> float:
    """Length of a smooth curve through points (k, n), evenly spread: of the chords,
    extrapolated where k is odd."""
    fine = float(_chord_lengths(path).sum())
    if len(path) % 2 == 0 or len(path) < 5:
        return fine
    coarse = float(_chord_lengths(path[::2]).sum())
    return (4.0 * fine - coarse) / 3.0


# --- chains of charts -----------------------------------------------------------------


def chart_graph(charts: ChartAtlas) -> nx.Graph:
    """The charts by their numbers, neighbours joined by edges that have the distance of
    their centres as ``weight``."""
    import networkx as nx

    i, j = charts.neighbours.T
    gaps = charts.difference(charts.centers[i], charts.centers[j])
    distances = np.linalg.norm(gaps, axis=1)
    columns = (i.tolist(), j.tolist(), distances.tolist())
    graph = nx.Graph()
    graph.add_weighted_edges_from(zip(*columns, strict=True))
    return graph


def entrances(problem: Problem, charts: ChartAtlas, point: np.ndarray) -> np.ndarray:
    """Numbers (k,) of the charts in which a solution (n,) lies.

    Where there is none, as at the tip of a cone, those next to it whose centres are
    joined to it by solutions: these stay near the straight line, the nearer the closer
    to it.
    """
    entries = charts.charts_about(point)
    if len(entries) or charts.passes_beside(point):
        return _leading_to(problem, charts, entries, point)
    joined = charts.charts_next_to(point)
    for share in SHARES:  # most charts that are not joined drop out next to the point
        if not len(joined):
            break
        steps = share * charts.difference(charts.centers[joined], point)
        line = point + steps
        ends, gaps = correct_normal(problem, line, charts.bases[joined])
        off_line = np.linalg.norm(ends - line, axis=1)
        length = np.linalg.norm(steps, axis=1)
        joined = joined[(gaps < SOLVED) & (off_line / length < OFF_LINE)]
    return joined


def _leading_to(
    problem: Problem, charts: ChartAtlas, entries: np.ndarray, point: np.ndarray
) -> np.ndarray:
    """Those of the charts (k,) above whose planes the surface comes up to a solution
    (n,): another one may pass below or above it."""
    bases = charts.bases[entries]
    offsets = charts.difference(point, charts.centers[entries])
    in_plane = np.einsum("kij,klj,kl->ki", bases, bases, offsets)
    flat = charts.centers[entries] + in_plane
    ends, _ = correct_normal(problem, flat, bases)
    misses = np.linalg.norm(charts.difference(ends, point), axis=1)
    heights = np.linalg.norm(offsets - in_plane, axis=1)
    most = OFF_POINT * heights + AT_POINT * problem.domain.scale
    leading: np.ndarray = entries[misses <= most]
    return leading


def _chart_chains(
    problem: Problem, charts: ChartAtlas, start: np.ndarray, goal: np.ndarray
) -> list[list[int]]:
    """Numbers of the charts on the shortest way, from one about the start to one about
    the goal.

    Then those on the shortest way that keeps off them, where it is not much longer.
    """
    import networkx as nx

    graph = chart_graph(charts)
    _add_end(graph, problem, charts, START, start)
    _add_end(graph, problem, charts, GOAL, goal)
    try:
        first = nx.shortest_path(graph, START, GOAL, weight="weight")
    except nx.NetworkXNoPath:
        message = "no chain of charts leads from the start to the goal"
        raise SurfacePathError(message) from None
    on_first = set(first[1:-1])

    def weight_off_first(a: Hashable, b: Hashable, edge: dict[str, float]) -> float:
        touches = a in on_first or b in on_first
        return edge["weight"] * (DETOUR if touches else 1.0)

    second = nx.shortest_path(graph, START, GOAL, weight=weight_off_first)
    keeps_off = on_first.isdisjoint(second[2:-2])
    limit = DETOUR * nx.path_weight(graph, first, "weight")
    if keeps_off and nx.path_weight(graph, second, "weight") < limit:
        return [first[1:-1], second[1:-1]]
    return [first[1:-1]]


def _add_end(
    graph: nx.Graph,
    problem: Problem,
    charts: ChartAtlas,
    name: str,
    point: np.ndarray,
) -> None:
    """Join a node for an end (n,) of the path to the charts in which it lies."""
    entries = entrances(problem, charts, point)
    if not len(entries):
        raise SurfacePathError(f"the {name} lies in no chart of the surface")
    gaps = charts.difference(charts.centers[entries], point)
    distances = np.linalg.norm(gaps, axis=1)
    for k, distance in zip(entries.tolist(), distances.tolist(), strict=True):
        graph.add_edge(name, k, weight=distance)


def _points_along(
    charts: ChartAtlas, chain: list[int], start: np.ndarray, goal: np.ndarray
) -> np.ndarray:
    """The start, the centres of the inner charts of a chain, and the goal (k, n),
    without jumps of a period."""
    inner = charts.centers[chain[1:-1]]
    points = np.array([start, *inner, goal], dtype=float)
    steps = charts.difference(points[1:], points[:-1])
    points[1:] = points[0] + np.cumsum(steps, axis=0)
    return points


# --- pulling --------------------------------------------------------------------------


def spread(
    problem: Problem,
    charts: ChartAtlas,
    points: np.ndarray,
    intervals: int,
    rounds: int = FINAL_ROUNDS,
) -> np.ndarray:
    """A path (intervals + 1, n) on the surface, evenly spread along the chords between
    ``points`` (k, n), after up to so many rounds of pulling: few where the points are
    those of a tight path. Raises `SurfacePathError`."""
    path = _place_along(points, np.linspace(0.0, 1.0, intervals + 1))
    path[1:-1] = _lifted(problem, charts, path[1:-1])
    if len(path) < 3 or _chord_lengths(path).mean() == 0:
        return path
    tight_path = _PulledPath(problem, charts, path)
    for _ in range(rounds):
        if not tight_path.pull():
            break
    return tight_path.path


def _lifted(problem: Problem, charts: ChartAtlas, points: np.ndarray) -> np.ndarray:
    """Points (k, n) corrected onto the surface, straight above the planes of the
    nearest charts."""
    if not len(points):
        return points
    planes = charts.bases[charts.nearest_charts(points)]
    feet, are_solutions = _correct(problem, charts, points, planes)
    if not np.all(are_solutions):
        raise SurfacePathError(
            "the path between the charts cannot be corrected onto the surface"
        )
    return feet


class _PulledPath:
    """A ``path`` (k, n) that is pulled tight round by round. Its ends stay, and points
    that would leave surface or bounds."""

    def __init__(self, problem: Problem, charts: ChartAtlas, path: np.ndarray):
        self.path = path
        self._problem = problem
        self._charts = charts
        self._planes = charts.bases[charts.nearest_charts(path[1:-1])]  # (k - 2, n, d)
        self._share = 1.0  # of the pull that is taken
        self._energy = _energy(path)

    def pull(self) -> bool:
        """Pull once; False where the path is tight already."""
        inner = self.path[1:-1]
        self._planes = tangent_planes(self._problem, inner, self._planes)
        force = _force(self.path, self._planes)
        pull = _solve_for_pull(force, self._planes)
        slope = -2.0 * float(np.sum(force * pull))  # of the energy, by the share
        if -slope < TIGHT * self._energy:
            return False
        step = np.einsum("kij,kj->ki", self._planes, pull)
        size = np.linalg.norm(step, axis=1).max()
        longest = TOO_FAR * self._charts.radii.max()
        share = min(self._share, longest / size)
        path = self._path_through(inner + share * step)
        energy = _energy(path)
        self._share = _next_share(energy - self._energy, slope, share)
        if energy <= self._energy:
            self.path = path
            self._energy = energy
        return True

    def _path_through(self, points: np.ndarray) -> np.ndarray:
        """The path with the inner points above ``points`` (k - 2, n), where these are
        solutions inside the bounds."""
        feet, are_solutions = _correct(
            self._problem, self._charts, points, self._planes
        )
        is_movable = are_solutions & self._problem.domain.are_inside(feet)
        path = self.path.copy()
        path[1:-1][is_movable] = feet[is_movable]
        return path


def _energy(path: np.ndarray) -> float:
    """The sum that is smallest for a tight path."""
    return float(np.sum(np.diff(path, axis=0) ** 2))


def _force(path: np.ndarray, planes: np.ndarray) -> np.ndarray:
    """The forces (k - 2, d) on the inner points in their ``planes`` (k - 2, n, d)."""
    before = path[:-2]
    inner = path[1:-1]
    after = path[2:]
    bend = after - 2.0 * inner + before
    forces: np.ndarray = np.einsum("kij,ki->kj", planes, bend)
    return forces


def _solve_for_pull(force: np.ndarray, planes: np.ndarray) -> np.ndarray:
    """The steps y (k - 2, d) in their ``planes`` that the ``force`` asks for."""
    # With C_i = T_i^T T_(i+1), of d rows and columns:
    #
    #     [  2 I    -C_1                 ] [ y_1 ]   [ f_1 ]
    #     [ -C_1^T   2 I   -C_2          ] [ y_2 ] = [ f_2 ]
    #     [         -C_2^T  2 I   -C_3   ] [ y_3 ]   [ f_3 ]
    #     [                  :     :     ] [  :  ]   [  :  ]
    from scipy.linalg import solveh_banded

    count, d = len(planes), planes.shape[2]
    across = np.swapaxes(planes[:-1], 1, 2)
    coupling = -across @ planes[1:]
    # the upper bands of the matrix, the diagonal last
    bands = np.zeros((2 * d, d * count))
    bands[-1] = 2.0
    for a in range(d):
        for b in range(d):
            bands[d - 1 + a - b, d + b :: d] = coupling[:, a, b]
    flat_steps = solveh_banded(bands, force.ravel())
    steps: np.ndarray = flat_steps.reshape(count, d)
    return steps


def _next_share(gain: float, slope: float, share: float) -> float:
    """The share of the next pull: where the parabola through the energy, whose
    ``slope`` is known and which rose by ``gain`` at ``share``, is lowest."""
    bend = (gain - slope * share) / share**2
    if bend > 0:
        return float(np.clip(-0.5 * slope / bend, 0.1, 2.0))
    return 1.0


def _correct(
    problem: Problem, charts: ChartAtlas, points: np.ndarray, planes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) straight above ``points`` of ``planes`` (k, n, d), and which
    (k,) are solutions nearby."""
    feet, gaps = correct_normal(problem, points, planes)
    height = np.linalg.norm(feet - points, axis=1)
    is_near = height < TOO_FAR * charts.radii.max()
    return feet, (gaps < SOLVED) & is_near


# --- chords ---------------------------------------------------------------------------


def _chord_lengths(points: np.ndarray) -> np.ndarray:
    """Distances (k - 1,) between neighbouring points (k, n)."""
    chords = np.diff(points, axis=0)
    lengths: np.ndarray = np.linalg.norm(chords, axis=1)
    return lengths


def _count_intervals(points: np.ndarray, spacing: float) -> int:
    """How many intervals of about ``spacing`` the chords make: an even number, from which
    a length can be extrapolated."""
    length = float(_chord_lengths(points).sum())
    return 2 * max(2, round(length / (2.0 * spacing)))


def _place_along(points: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Points (m, n) at shares (m,) of the length of the chords between ``points`` (k,
    n)."""
    arclengths = np.concatenate([[0.0], np.cumsum(_chord_lengths(points))])
    at = shares * arclengths[-1]
    columns = [np.interp(at, arclengths, column) for column in points.T]
    return np.stack(columns, axis=1)
