"""Arcs of a dense curve, held against the theorem of Newton and Kantorovich all along.

The theorem stands in `bifurc.curves.certificate`. Here is how it is checked between the
places at which F is evaluated. Along an arc u(s) is a polynomial, and

    H(s) = [G'(u(s)); u'(s)^T]    (n, n),    G = L^T F,

is analytic in s, L the left singular vectors in the middle of the arc. The determinant
of H and its adjugate, taken at Chebyshev nodes, are interpolated by a polynomial p and
a matrix of polynomials Q. H Q - p I vanishes at the nodes and is bounded between them
(Hermite's formula, below), because F'' is bounded for complex unknowns. Where |p| is
larger, H is regular, and |H^-1| <= |Q| / (|p| - bound): next to a singular point, too,
of which p has the zero and Q no pole. G is bounded between the nodes in the same way.

With the nodes those of T_N, of which the largest is not 1, an analytic f minus its
interpolant of degree N - 1 is

    (1 / 2 pi i) * integral of T_N(x) / T_N(z) f(z) / (z - x) dz    (Hermite's formula)

round an ellipse about [-1, 1]. With rho the sum of its half-axes, a the longer one and
M a bound on |f| there, that is at most 2 a M / ((a - 1) (rho^N - rho^-N)), as |T_N| is
at least (rho^N - rho^-N) / 2 on the ellipse, 2 pi a bounds its length, and a - 1 is its
distance from the interval (Trefethen 2013, chapter 8).

Formulas and bounds are in `bifurc/core/kantorovich.hpp`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc import _core
from bifurc._core import Chebyshev
from bifurc.branch import Branch
from bifurc.decisions import is_closed_to_rounding, is_unique
from bifurc.system import System, relative_jacobians, relative_residuals

NODE_COUNT = 32  # more than the degree of any piece
# parts of [-1, 1], shorter towards its ends, on which interpolants are judged
CELLS = 192
RHOS = np.array([2.0, 3.0, 4.0, 6.0, 8.0, 12.0])  # ellipses, of which the best counts

_DEGREES = np.arange(NODE_COUNT)
_NODE_ANGLES = np.pi * (_DEGREES[::-1] + 0.5) / NODE_COUNT
_EDGE_ANGLES = np.pi * np.arange(CELLS, -1, -1) / CELLS
NODES = np.cos(_NODE_ANGLES)  # (N,), from -1 to 1
CELL_EDGES = np.cos(_EDGE_ANGLES)  # (CELLS + 1,), from -1 to 1
# (N, N) from values at the nodes to coefficients
_TO_COEFFICIENTS = np.cos(np.outer(_DEGREES, _NODE_ANGLES)) * 2.0 / NODE_COUNT
_TO_COEFFICIENTS[0] /= 2.0
_LONGER_AXES = 0.5 * (RHOS + 1.0 / RHOS)
# (e,) of a bound on the ellipses: how far an interpolant may be off on [-1, 1]
ERRORS = (
    2.0 * _LONGER_AXES / ((_LONGER_AXES - 1.0) * (RHOS**NODE_COUNT - RHOS**-NODE_COUNT))
)
CHEBYSHEV = Chebyshev(
    to_coefficients=_TO_COEFFICIENTS,
    to_edges=np.cos(np.outer(_DEGREES, _EDGE_ANGLES)),
    powers=RHOS ** _DEGREES[:, None],
    errors=ERRORS,
    # how much larger an interpolant may be than at the nodes (Rivlin 1974)
    lebesgue=2.0 / np.pi * np.log(NODE_COUNT) + 1.0,
    # linear interpolation over a cell, by the second derivative in the angle
    bend=(np.pi / CELLS) ** 2 / 8.0,
)

PROMISING = 0.05  # omega |G| at a node: shorter arcs about it may hold
LONG = 1e-4  # arc, in scales, on which interpolation may be what is in the way
CAUCHY_REACH = 0.5  # of the scale: from F'' so far into the complex follows F'''
MIDDLE = NODE_COUNT // 2
WIDEST_JOINT = 1e-6  # between neighbouring pieces, in scales


@dataclass(frozen=True)
class ArcChecks:
    """What was seen of arcs.

    ``edges`` (a, c + 1) are arclengths that divide them, ``holds`` (a, c) says between
    which of these the theorem holds, ``is_promising`` (a,) whether it may hold on
    shorter arcs, ``is_closed`` (a,) whether F is zero there as far as doubles tell.
    """

    edges: np.ndarray
    holds: np.ndarray
    is_promising: np.ndarray
    is_closed: np.ndarray

    @property
    def refused(self) -> np.ndarray:
        """Numbers (r,) of the arcs on which the theorem does not hold all along."""
        return np.flatnonzero(~self.holds.all(axis=1))

    def replace(self, rows: np.ndarray, others: ArcChecks) -> None:
        """Put ``others`` in the place of the arcs ``rows``."""
        self.holds[rows] |= others.holds
        self.is_promising[rows] |= others.is_promising


@dataclass(frozen=True)
class Joints:
    """Where the pieces of a curve meet: ``arclengths`` (j,) in order, over two turns of
    a closed one, and ``images`` (j, m), F' times the steps from one piece to the
    next."""

    arclengths: np.ndarray
    images: np.ndarray

    @staticmethod
    def of(problem: System, branch: Branch) -> Joints:
        """The joints of a branch."""
        begins, ends = branch.compiled.ends_of_pieces(0)
        left, right = ends[:-1], begins[1:]
        arclengths = branch.breaks[1:-1]
        if branch.closed:
            left, right = ends, np.roll(begins, -1, axis=0)
            once = branch.breaks[1:]
            arclengths = np.concatenate([[0.0], once, once + branch.length])
        steps = problem.domain.difference(right, left)
        jacobians = relative_jacobians(problem, ends)[: len(left)]
        images = np.einsum("jmn,jn->jm", jacobians, steps)
        is_wide = np.linalg.norm(steps, axis=1) > WIDEST_JOINT * problem.domain.scale
        images[is_wide] = np.inf
        if branch.closed:
            images = np.concatenate([images[-1:], images, images])
        return Joints(arclengths, images)

    def at(self, s: np.ndarray) -> np.ndarray:
        """What F' makes of the steps (k, m) at arclengths (k,), 0 where there is no
        joint."""
        number = np.searchsorted(self.arclengths, s)
        is_joint = np.append(self.arclengths, np.inf)[number] == s
        images = np.zeros((len(s), self.images.shape[1]))
        images[is_joint] = self.images[number[is_joint]]
        return images


def check_arcs(
    problem: System, branch: Branch, arcs: np.ndarray, joints: Joints
) -> ArcChecks:
    """Where on the ``arcs`` (a, 2) of arclength, each within one piece, solutions
    across the curve are unique: by the bound on F'', and where that refuses, also on
    shorter arcs, by F'' itself, which takes many times as long."""
    nodes = _Nodes.on(problem, branch, arcs, joints)
    checks = nodes.checks()
    refused = checks.refused
    refused = refused[~checks.is_promising[refused]]
    if len(refused):
        checks.replace(refused, nodes.part(refused).checks_by_second_derivative())
    return checks


@dataclass(frozen=True)
class _Nodes:
    """Arcs at their N nodes: ``points`` (a, N, n), and by name the ``arrays`` of
    `bifurc._core.Arcs`: ``slopes`` (a, N, n) of the curve, ``residuals`` (a, N, m),
    ``jacobians`` (a, N, m, n), ``left`` (a, m, n - 1), the combinations G of the
    equations, the weakest last, ``images`` (a, 2, m) of the steps at their ends. On
    ellipses (a, e) about the arcs ``travel`` bounds how far u is from where it is in the
    middle, ``curvature`` |F''|. ``degree`` is that of the pieces."""

    problem: System
    edges: np.ndarray
    points: np.ndarray
    arrays: dict[str, np.ndarray]
    degree: int

    @staticmethod
    def on(problem: System, branch: Branch, arcs: np.ndarray, joints: Joints) -> _Nodes:
        """Arcs (a, 2) of a branch at their nodes."""
        middles = arcs.mean(axis=1)[:, None]
        halves = 0.5 * np.diff(arcs, axis=1)
        s = (middles + halves * NODES).ravel()
        edges = middles + halves * CELL_EDGES
        edges[:, [0, -1]] = arcs  # joints are recognised to the last bit
        shape = (len(arcs), NODE_COUNT)
        flat = branch(s)
        points = flat.reshape(*shape, -1)
        residuals = relative_residuals(problem, flat)
        jacobians = relative_jacobians(problem, flat)
        jacobians = jacobians.reshape(*shape, *jacobians.shape[1:])
        left, _, _ = np.linalg.svd(jacobians[:, MIDDLE], full_matrices=False)
        degree = branch.pieces.shape[1] - 1
        travel = _core.travel_of_arcs(CHEBYSHEV, points, degree)
        assert problem.curvature is not None
        curvature = problem.curvature.at_complex_points(travel.ravel())
        arrays = {
            "slopes": branch(s, 1).reshape(*shape, -1),
            "residuals": residuals.reshape(*shape, -1),
            "jacobians": jacobians,
            "left": np.ascontiguousarray(left[:, :, : problem.n - 1]),
            "images": joints.at(arcs.ravel()).reshape(len(arcs), 2, -1),
            "travel": travel,
            "curvature": curvature.reshape(travel.shape),
        }
        return _Nodes(problem, edges, points, arrays, degree)

    def part(self, rows: np.ndarray) -> _Nodes:
        """The arcs ``rows`` (r,) of these."""
        arrays = {name: array[rows] for name, array in self.arrays.items()}
        edges, points = self.edges[rows], self.points[rows]
        return _Nodes(self.problem, edges, points, arrays, self.degree)

    def checks_by_second_derivative(self) -> ArcChecks:
        """What follows from F'' at the nodes: near a surface it is small where H^-1 is
        large."""
        flat = self.points.reshape(-1, self.problem.n)
        hessians = self.problem.hessians(flat) / self.problem.magnitude
        return self.checks(hessians.reshape(len(flat), -1, self.problem.n))

    def checks(self, hessians: np.ndarray | None = None) -> ArcChecks:
        """What follows from omega = K |H^-1|^2, where F stays small enough for K; or from
        F'' itself, of which ``hessians`` are the values at the nodes."""
        doubts, least_at_a_node, is_uneven = _core.doubts_of_arcs(
            CHEBYSHEV,
            self._second_derivative,
            _core.Arcs(**self.arrays),
            self.degree,
            hessians,
        )
        # on a part of an arc that is neither, everything would be the same
        lengths = self.edges[:, -1] - self.edges[:, 0]
        is_long = lengths > LONG * self.problem.domain.scale
        is_solved = is_closed_to_rounding(_largest_rows(self.arrays["residuals"]))
        is_joined = is_closed_to_rounding(_largest_rows(self.arrays["images"]))
        may_change = is_long | is_uneven | ~is_joined
        return ArcChecks(
            edges=self.edges,
            holds=is_unique(doubts),
            is_promising=(least_at_a_node <= PROMISING) & may_change,
            is_closed=is_solved & is_joined,
        )

    @property
    def _second_derivative(self) -> _core.SecondDerivative:
        """What is known of F''; by how much it changes is Cauchy's estimate."""
        problem = self.problem
        curvature = problem.curvature
        reach = CAUCHY_REACH * problem.domain.scale
        assert curvature is not None
        largest = curvature.at_complex_points(np.array([reach]))
        return _core.SecondDerivative(
            bound=curvature.bound,
            residual=curvature.residual,
            growth=2.0 * float(largest[0]) / reach,
            reach=reach,
            error=problem.accuracy.hessian_error,
        )


def _largest_rows(values: np.ndarray) -> np.ndarray:
    """The largest norm (a,) of vectors (a, k, q)."""
    squares = np.einsum("akq,akq->ak", values, values)
    return np.asarray(np.sqrt(squares.max(axis=1)))
