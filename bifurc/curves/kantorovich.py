"""Arcs of a dense curve, held against the theorem of Newton and Kantorovich all along.

The theorem stands in `bifurc.curves.certificate`. Here is how it is checked between the
places at which F is evaluated. Along an arc u(s) is a polynomial, and

    H(s) = [G'(u(s)); u'(s)^T]    (n, n),    G = L^T F,

is analytic in s, L the left singular vectors in the middle of the arc. The determinant
of H and its adjugate, taken at Chebyshev nodes, are interpolated by a polynomial p and
a matrix of polynomials Q. H Q - p I vanishes at the nodes and is bounded between them
(`bifurc.numerics.chebyshev`), because F'' is bounded for complex unknowns. Where |p| is
larger, H is regular, and |H^-1| <= |Q| / (|p| - bound): next to a singular point, too,
of which p has the zero and Q no pole. G is bounded between the nodes in the same way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.branch import Branch
from bifurc.decisions import is_closed_to_rounding, is_unique
from bifurc.numerics.chebyshev import (
    CELL_EDGES,
    ERRORS,
    NODE_COUNT,
    NODES,
    TO_COEFFICIENTS,
    cell_slack,
    coefficients,
    largest_between,
    largest_by_norms,
    on_cell_edges,
    on_ellipses,
)
from bifurc.problem import Problem

__all__ = ["ArcChecks", "Joints", "check_arcs"]

PROMISING = 0.05  # omega |G| at a node: shorter arcs about it may hold
LONG = 1e-4  # arc, in scales, on which interpolation may be what is in the way
ROUNDING = 2e-15  # what F, over the magnitude, may be wrong by in doubles
ADJUGATE_ROUNDING = 1e-14  # of |H| |Q|: what rounding leaves of H Q - p I at the nodes
CAUCHY_REACH = 0.5  # of the scale: from F'' so far into the complex follows F'''
MIDDLE = NODE_COUNT // 2
WIDEST_JOINT = 1e-6  # between neighbouring pieces, in scales
TINY = 1e-150  # in a denominator: its square is still a double


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

    @staticmethod
    def of(nodes: _Nodes, inverse: _Inverse, doubts: _Doubts) -> ArcChecks:
        """The checks that follow from the ``doubts``."""
        is_clear = (inverse.lowest > 0.0) & is_unique(doubts.at_edges)
        signs = np.sign(inverse.determinants_at_edges)
        keeps_sign = signs[:, 1:] == signs[:, :-1]
        holds_at_nodes = np.any(doubts.at_nodes <= PROMISING, axis=1)
        # on a part of an arc that is neither, everything would be the same
        is_long = np.ptp(nodes.edges, axis=1) > LONG * nodes.problem.scale
        is_uneven = inverse.lowest.min(axis=1) < 0.5 * inverse.lowest.max(axis=1)
        is_solved = is_closed_to_rounding(nodes.largest_residuals)
        is_joined = is_closed_to_rounding(nodes.largest_steps)
        may_change = is_long | is_uneven | ~is_joined
        return ArcChecks(
            edges=nodes.edges,
            holds=is_clear[:, 1:] & is_clear[:, :-1] & keeps_sign,
            is_promising=holds_at_nodes & may_change,
            is_closed=is_solved & is_joined,
        )

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
    def of(problem: Problem, branch: Branch) -> Joints:
        """The joints of a branch."""
        ends = _points_of_pieces(branch, branch.breaks[1:])
        begins = _points_of_pieces(branch, branch.breaks[:-1])
        left, right = ends[:-1], begins[1:]
        arclengths = branch.breaks[1:-1]
        if branch.closed:
            left, right = ends, np.roll(begins, -1, axis=0)
            once = branch.breaks[1:]
            arclengths = np.concatenate([[0.0], once, once + branch.length])
        steps = problem.difference(right, left)
        jacobians = problem.relative_jacobians(ends)[: len(left)]
        images = np.einsum("jmn,jn->jm", jacobians, steps)
        is_wide = np.linalg.norm(steps, axis=1) > WIDEST_JOINT * problem.scale
        images[is_wide] = np.inf
        if branch.closed:
            images = np.concatenate([images[-1:], images, images])
        return Joints(arclengths, images)

    def at(self, s: np.ndarray) -> np.ndarray:
        """What F' makes of the steps (k, m) at arclengths (k,), 0 where there is no
        joint."""
        first = np.searchsorted(self.arclengths, s, side="left")
        last = np.searchsorted(self.arclengths, s, side="right")
        images = np.zeros((len(s), self.images.shape[1]))
        for k in np.flatnonzero(last > first):
            images[k] = self.images[first[k] : last[k]].sum(axis=0)
        return images


def _points_of_pieces(branch: Branch, s: np.ndarray) -> np.ndarray:
    """Points (p, n) of the p pieces at arclengths (p,), one for each."""
    x = (s - branch.centers) / branch.radii
    powers = x[:, None] ** np.arange(branch.pieces.shape[1])
    points: np.ndarray = np.einsum("pk,pkn->pn", powers, branch.pieces)
    return points


def check_arcs(
    problem: Problem, branch: Branch, arcs: np.ndarray, joints: Joints
) -> ArcChecks:
    """Where on the ``arcs`` (a, 2) of arclength, each within one piece, solutions
    across the curve are unique: by the bound on F'', and where that refuses by F''
    itself."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        nodes = _Nodes.on(problem, branch, arcs, joints)
        inverse = _Inverse.of(nodes)
        checks = ArcChecks.of(nodes, inverse, _doubts_by_bound(nodes, inverse))
        refused = np.flatnonzero(~checks.holds.all(axis=1))
        if len(refused):
            nodes = _Nodes.on(problem, branch, arcs[refused], joints)
            inverse = _Inverse.of(nodes)
            doubts = _doubts_by_second_derivative(nodes, inverse)
            checks.replace(refused, ArcChecks.of(nodes, inverse, doubts))
    return checks


# --- what is known of an arc ----------------------------------------------------------


@dataclass(frozen=True)
class _Nodes:
    """Arcs at their N nodes: ``points`` and the curve's ``slopes`` (a, N, n),
    ``residuals`` (a, N, m), ``jacobians`` (a, N, m, n), and ``left`` (a, m, n - 1), the
    combinations G of the equations, the weakest last. ``images`` (a, 2, m) are those of
    the steps at their ends, ``degree`` that of the pieces."""

    problem: Problem
    edges: np.ndarray
    points: np.ndarray
    slopes: np.ndarray
    residuals: np.ndarray
    jacobians: np.ndarray
    left: np.ndarray
    images: np.ndarray
    degree: int

    @staticmethod
    def on(
        problem: Problem, branch: Branch, arcs: np.ndarray, joints: Joints
    ) -> _Nodes:
        """Arcs (a, 2) of a branch at their nodes."""
        middles = arcs.mean(axis=1)[:, None]
        halves = 0.5 * np.diff(arcs, axis=1)
        s = (middles + halves * NODES).ravel()
        edges = middles + halves * CELL_EDGES
        edges[:, [0, -1]] = arcs  # joints are recognised to the last bit
        points = branch(s)
        shape = (len(arcs), NODE_COUNT)
        residuals = problem.relative_residuals(points)
        jacobians = problem.relative_jacobians(points)
        jacobians = jacobians.reshape(*shape, *jacobians.shape[1:])
        left, _, _ = np.linalg.svd(jacobians[:, MIDDLE], full_matrices=False)
        return _Nodes(
            problem=problem,
            edges=edges,
            points=points.reshape(*shape, -1),
            slopes=branch(s, 1).reshape(*shape, -1),
            residuals=residuals.reshape(*shape, -1),
            jacobians=jacobians,
            left=left[:, :, : problem.n - 1],
            images=np.stack([joints.at(arcs[:, 0]), joints.at(arcs[:, 1])], axis=1),
            degree=branch.pieces.shape[1] - 1,
        )

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return self.problem.n

    @cached_property
    def curvature_bound(self) -> float:
        """K."""
        bound = self.problem.curvature_bound()
        assert bound is not None
        return bound

    @cached_property
    def components(self) -> np.ndarray:
        """G (a, N, n - 1)."""
        components: np.ndarray = self.residuals @ self.left
        return components

    @cached_property
    def steps(self) -> np.ndarray:
        """G' times the steps at the ends (a, 2, n - 1)."""
        steps: np.ndarray = self.images @ self.left
        return steps

    @cached_property
    def largest_residuals(self) -> np.ndarray:
        """|F| at the nodes at most (a,)."""
        largest: np.ndarray = np.linalg.norm(self.residuals, axis=2).max(axis=1)
        return largest

    @property
    def largest_steps(self) -> np.ndarray:
        """F' times the steps at the ends, at most (a,)."""
        largest: np.ndarray = np.linalg.norm(self.images, axis=2).max(axis=1)
        return largest

    # bounds on ellipses about the arcs, (a, e)

    @cached_property
    def travel(self) -> np.ndarray:
        """How far u is there from where it is in the middle."""
        sizes = self._polynomial_sizes(self.points)
        sizes[:, 0] = 0.0
        from_mean = on_ellipses(sizes)
        middle = np.abs(sizes).sum(axis=1)[:, None]
        travel: np.ndarray = from_mean + middle
        return travel

    @cached_property
    def curvature(self) -> np.ndarray:
        """|F''|."""
        bounds = self.problem.complex_curvature(self.travel.ravel())
        assert bounds is not None
        return bounds.reshape(self.travel.shape)

    @cached_property
    def jacobian_sizes(self) -> np.ndarray:
        """|F'|."""
        in_the_middle = np.linalg.norm(self.jacobians[:, MIDDLE], axis=(1, 2))
        sizes: np.ndarray = in_the_middle[:, None] + self.curvature * self.travel
        return sizes

    @cached_property
    def residual_sizes(self) -> np.ndarray:
        """|F|."""
        travelled = self.jacobian_sizes * self.travel
        sizes: np.ndarray = self.largest_residuals[:, None] + travelled
        return sizes

    @cached_property
    def frame_sizes(self) -> np.ndarray:
        """|H|."""
        slopes = on_ellipses(self._polynomial_sizes(self.slopes))
        sizes: np.ndarray = np.hypot(self.jacobian_sizes, slopes)
        return sizes

    def _polynomial_sizes(self, values: np.ndarray) -> np.ndarray:
        """Sizes (a, j) of the Chebyshev coefficients of polynomials in s."""
        polynomials = coefficients(values)[:, : self.degree + 1]
        sizes: np.ndarray = np.linalg.norm(polynomials, axis=2)
        return sizes


@dataclass(frozen=True)
class _Columns:
    """Some columns of Q: their norms ``at_nodes`` (a, N), and ``in_coefficients`` (a,
    N) of their interpolants."""

    at_nodes: np.ndarray
    in_coefficients: np.ndarray

    @cached_property
    def largest(self) -> np.ndarray:
        """Bounds (a,) all along the arcs."""
        return largest_by_norms(self.at_nodes, self.in_coefficients)

    @cached_property
    def on_ellipses(self) -> np.ndarray:
        """Bounds (a, e) on the ellipses."""
        return on_ellipses(self.in_coefficients)


@dataclass(frozen=True)
class _Inverse:
    """H^-1 on arcs, as Q / p.

    ``determinants`` (a, N) and ``adjugates`` (a, N, n, n) at the nodes,
    ``determinants_at_edges`` (a, c + 1) of p; ``columns`` are all those of Q,
    ``strong`` and ``weak`` those that belong to strong components and to the weakest
    one. ``interpolation`` (a,) and ``rounding`` (a,) bound H Q - p I,
    ``interpolation_of_strong`` (a,) its strong columns, and ``lowest`` (a, c + 1) is
    what |p| is at least in the cells beside an edge, less that. ``frame_sizes`` (a,)
    are those of H.
    """

    determinants: np.ndarray
    adjugates: np.ndarray
    determinants_at_edges: np.ndarray
    columns: _Columns
    strong: _Columns
    weak: _Columns
    interpolation: np.ndarray
    interpolation_of_strong: np.ndarray
    rounding: np.ndarray
    lowest: np.ndarray
    frame_sizes: np.ndarray

    @staticmethod
    def of(nodes: _Nodes) -> _Inverse:
        determinants, adjugates, frame_norms, at_nodes, in_coefficients = (
            _core.adjugates(
                slopes=nodes.slopes,
                jacobians=nodes.jacobians,
                left=np.ascontiguousarray(nodes.left),
                to_coefficients=TO_COEFFICIENTS,
            )
        )
        columns, strong, weak = (
            _Columns(at_nodes[:, group], in_coefficients[:, group])
            for group in range(3)
        )
        p = coefficients(determinants[..., None])[..., 0]
        interpolation = _interpolation(nodes, columns, p)
        rounding = ADJUGATE_ROUNDING * (frame_norms * columns.at_nodes).max(axis=1)
        at_edges = on_cell_edges(p)
        slack = cell_slack(p) + interpolation + rounding
        return _Inverse(
            determinants=determinants,
            adjugates=adjugates,
            determinants_at_edges=at_edges,
            columns=columns,
            strong=strong,
            weak=weak,
            interpolation=interpolation,
            interpolation_of_strong=_interpolation(nodes, strong, p),
            rounding=rounding,
            lowest=np.abs(at_edges) - slack[:, None],
            frame_sizes=frame_norms.max(axis=1),
        )

    @cached_property
    def sizes(self) -> np.ndarray:
        """Bounds on |H^-1| in the cells beside an edge (a, c + 1)."""
        return self._over_lowest(self.columns.largest)

    @cached_property
    def strong_sizes(self) -> np.ndarray:
        """Bounds (a, c + 1) on the columns of H^-1 that belong to strong components."""
        return self._over_lowest(self.largest_strong)

    @cached_property
    def weak_sizes(self) -> np.ndarray:
        """Bounds (a, c + 1) on the column of H^-1 that belongs to the weakest
        component."""
        return self._over_lowest(self.largest_weak)

    @cached_property
    def largest_strong(self) -> np.ndarray:
        """Bounds (a,) on the columns of Q that belong to strong components."""
        largest: np.ndarray = np.maximum(self.strong.largest, self._floor)
        return largest

    @cached_property
    def largest_weak(self) -> np.ndarray:
        """Bounds (a,) on the column of Q that belongs to the weakest component."""
        largest: np.ndarray = np.maximum(self.weak.largest, self._floor)
        return largest

    @cached_property
    def growth_on_ellipses(self) -> np.ndarray:
        """How much larger these columns are on the ellipses (a, e)."""
        strong = self.strong.on_ellipses / self.largest_strong[:, None]
        weak = self.weak.on_ellipses / self.largest_weak[:, None]
        growth: np.ndarray = np.maximum(strong, weak)
        return growth

    @property
    def relative_errors(self) -> np.ndarray:
        """How far (a, c + 1) a column of Q / p may be from that of H^-1, over its
        size."""
        all_columns = self.interpolation[:, None] / self.weak_sizes
        strong_columns = self.interpolation_of_strong[:, None] / self.strong_sizes
        amplified = self.sizes * np.maximum(all_columns, strong_columns)
        lowest = np.maximum(self.lowest, TINY)
        errors: np.ndarray = (amplified + self.rounding[:, None]) / lowest
        return errors

    @property
    def _floor(self) -> np.ndarray:
        """Where there are no strong components (a,)."""
        floor: np.ndarray = np.abs(self.determinants).max(axis=1) / self.frame_sizes
        return floor

    def _over_lowest(self, largest: np.ndarray) -> np.ndarray:
        sizes: np.ndarray = largest[:, None] / np.maximum(self.lowest, TINY)
        return sizes

    @cached_property
    def sizes_at_nodes(self) -> np.ndarray:
        """|H^-1| at the nodes (a, N)."""
        sizes: np.ndarray = self.columns.at_nodes / np.abs(self.determinants)
        return sizes


def _interpolation(nodes: _Nodes, columns: _Columns, p: np.ndarray) -> np.ndarray:
    """A bound (a,) on H Q - p I between the nodes, for some ``columns`` of Q and the
    coefficients (a, N) of p."""
    p_sizes = on_ellipses(np.abs(p))
    products = nodes.frame_sizes * columns.on_ellipses + np.sqrt(nodes.n) * p_sizes
    bounds: np.ndarray = np.min(ERRORS * products, axis=1)
    return bounds


def _norms(matrices: np.ndarray) -> np.ndarray:
    """Frobenius norms (...) of matrices (..., n, n)."""
    norms: np.ndarray = np.linalg.norm(matrices, axis=(-2, -1))
    return norms


# --- how far from a contraction Newton's method is ------------------------------------


class _Doubts(NamedTuple):
    """Bounds on omega |G|, or what stands for it, in the cells beside an edge (a, c +
    1), and its values at the nodes (a, N)."""

    at_edges: np.ndarray
    at_nodes: np.ndarray


def _doubts_by_bound(nodes: _Nodes, inverse: _Inverse) -> _Doubts:
    """omega = K |H^-1|^2, where F stays small enough for K."""
    bound = nodes.curvature_bound
    gaps = _gaps_between(nodes, slice(None))
    gaps_at_nodes = _gaps_at_nodes(nodes.components)
    doubts = bound * inverse.sizes**2 * gaps
    radius = 2.0 * inverse.sizes * gaps
    slopes = _norms(nodes.jacobians).max(axis=1)[:, None] + bound * radius
    residuals = nodes.largest_residuals[:, None] + slopes * radius
    is_valid = residuals <= nodes.problem.curvature_residual
    return _Doubts(
        at_edges=np.where(is_valid, doubts, np.inf),
        at_nodes=bound * inverse.sizes_at_nodes**2 * gaps_at_nodes,
    )


def _gaps_between(nodes: _Nodes, which: slice) -> np.ndarray:
    """Bounds (a, 1) on some of the components of G all along the arcs, and on the steps
    at their ends."""
    interpolation = np.min(ERRORS * nodes.residual_sizes, axis=1)
    along = largest_between(nodes.components[..., which])
    steps = np.linalg.norm(nodes.steps[..., which], axis=2).max(axis=1)
    gaps: np.ndarray = along + interpolation + steps + ROUNDING
    return gaps[:, None]


def _gaps_at_nodes(components: np.ndarray) -> np.ndarray:
    """Bounds (a, 1) on some of the components (a, N, q) of G at the nodes."""
    gaps: np.ndarray = np.linalg.norm(components, axis=2).max(axis=1) + ROUNDING
    return gaps[:, None]


def _doubts_by_second_derivative(nodes: _Nodes, inverse: _Inverse) -> _Doubts:
    """How far Newton's method is from a contraction of a box, narrow along the strong
    components of G and wide along the weakest one: near a surface F'' is small where
    H^-1 is large."""
    problem = nodes.problem
    forms = _second_derivatives(nodes, inverse)
    strong, weak = slice(None, -1), slice(-1, None)
    between = _contraction(
        problem,
        _Blocks.between(forms, inverse.lowest),
        _Gaps(_gaps_between(nodes, strong), _gaps_between(nodes, weak)),
        _sizes_between(nodes, inverse),
    )
    at_nodes = _contraction(
        problem,
        _Blocks.at_nodes(forms, inverse.determinants),
        _Gaps(
            _gaps_at_nodes(nodes.components[..., strong]),
            _gaps_at_nodes(nodes.components[..., weak]),
        ),
        _sizes_at_nodes(nodes, inverse),
    )
    return _Doubts(between, at_nodes)


def _contraction(
    problem: Problem, blocks: _Blocks, gaps: _Gaps, sizes: _Sizes
) -> np.ndarray:
    """Half the Lipschitz constant of Newton's method in a box about the curve, in which
    F'' is what the ``blocks`` say to within the error of ``sizes``, and what it changes
    by off the curve."""
    box = blocks.box(gaps)
    radius = 2.0 * sizes.reach(box)
    doubt = _change_of_second_derivative(problem, radius) + sizes.error
    widened = blocks.widened(doubt, sizes)
    wider_box = widened.box(gaps)
    is_inside = sizes.reach(wider_box) <= radius
    return np.where(is_inside, widened.contraction(wider_box), np.inf)


def _change_of_second_derivative(problem: Problem, radius: np.ndarray) -> np.ndarray:
    """What F'' may change by within a ``radius``, by Cauchy's estimate of the third
    derivative."""
    reach = CAUCHY_REACH * problem.scale
    largest = problem.complex_curvature(np.array([reach]))
    assert largest is not None
    changes = 2.0 * largest[0] / reach * radius
    return np.where(radius < 0.5 * reach, changes, np.inf)


def _second_derivatives(nodes: _Nodes, inverse: _Inverse) -> np.ndarray:
    """L^T F''(Q y, Q z) (a, N, n - 1, n - 1, n - 1) at the nodes."""
    problem = nodes.problem
    flat = nodes.points.reshape(-1, nodes.n)
    hessians = np.array([problem.hessian(point) for point in flat])
    hessians = hessians.reshape(*nodes.points.shape[:2], *hessians.shape[1:])
    across = inverse.adjugates[..., :-1]  # (a, N, n, n - 1)
    of_left = np.einsum("ami,akmpq->akipq", nodes.left, hessians / problem.magnitude)
    halfway = of_left @ across[:, :, None]
    forms: np.ndarray = np.swapaxes(across, 2, 3)[:, :, None] @ halfway
    return forms


class _Sizes(NamedTuple):
    """Sizes of the columns of H^-1 that belong to the strong components of G and to the
    weakest one, and how far F''(H^-1 y, H^-1 z) may be, over |H^-1 y| |H^-1 z|, from
    what is known of it."""

    strong: np.ndarray
    weak: np.ndarray
    error: np.ndarray

    def reach(self, box: _Gaps) -> np.ndarray:
        """How far from the curve a box reaches."""
        reach: np.ndarray = self.strong * box.strong + self.weak * box.weak
        return reach


def _sizes_between(nodes: _Nodes, inverse: _Inverse) -> _Sizes:
    """Bounds (a, c + 1) in the cells beside an edge."""
    bound = nodes.curvature_bound
    products = nodes.curvature * inverse.growth_on_ellipses**2
    interpolation = np.min(ERRORS * products, axis=1)
    of_inverse = 2.0 * bound * inverse.relative_errors
    of_hessian = bound * nodes.problem.hessian_error
    error = interpolation[:, None] + of_inverse + of_hessian
    return _Sizes(inverse.strong_sizes, inverse.weak_sizes, error)


def _sizes_at_nodes(nodes: _Nodes, inverse: _Inverse) -> _Sizes:
    """Values (a, N) at the nodes."""
    bound = nodes.curvature_bound
    determinants = np.abs(inverse.determinants)
    strong = inverse.strong.at_nodes / determinants
    weak = inverse.weak.at_nodes / determinants
    of_inverse = 2.0 * bound * inverse.rounding[:, None] / determinants
    of_hessian = bound * nodes.problem.hessian_error
    return _Sizes(strong, weak, of_inverse + of_hessian)


class _Gaps(NamedTuple):
    """Bounds on the strong components of G and on the weakest, or the half-widths of a
    box of them; each (a, 1) or (a, c + 1)."""

    strong: np.ndarray
    weak: np.ndarray


@dataclass(frozen=True)
class _Blocks:
    """Norms of the blocks of symmetric bilinear forms: ``weak_strong_weak`` is that of
    the weak component of the form at a strong and a weak argument."""

    strong_strong_strong: np.ndarray
    strong_strong_weak: np.ndarray
    strong_weak_weak: np.ndarray
    weak_strong_strong: np.ndarray
    weak_strong_weak: np.ndarray
    weak_weak_weak: np.ndarray

    @staticmethod
    def at_nodes(forms: np.ndarray, determinants: np.ndarray) -> _Blocks:
        """Of forms (a, N, n - 1, n - 1, n - 1) over squares of determinants (a, N)."""
        squares = np.maximum(determinants**2, TINY)
        norms = [np.linalg.norm(block, axis=2) / squares for block in _parts(forms)]
        return _Blocks(*norms)

    @staticmethod
    def between(forms: np.ndarray, lowest: np.ndarray) -> _Blocks:
        """Bounds (a, c + 1) between the nodes, where determinants are at least
        ``lowest`` (a, c + 1)."""
        squares = np.maximum(lowest, TINY) ** 2
        norms = [largest_between(block)[:, None] / squares for block in _parts(forms)]
        return _Blocks(*norms)

    def widened(self, doubt: np.ndarray, sizes: _Sizes) -> _Blocks:
        """Norms larger by the ``doubt`` times the sizes of both arguments."""
        strong, weak = sizes.strong, sizes.weak
        of_arguments = (strong * strong, strong * weak, weak * weak)
        norms = []
        for field, size in zip(fields(self), of_arguments * 2, strict=True):
            norms.append(getattr(self, field.name) + doubt * size)
        return _Blocks(*norms)

    def box(self, gaps: _Gaps) -> _Gaps:
        """Half-widths of a box that is large enough for a contraction."""
        weak = 2.0 * gaps.weak
        strong = 2.0 * gaps.strong + 8.0 * self.strong_weak_weak * weak**2
        return _Gaps(strong, weak)

    def contraction(self, box: _Gaps) -> np.ndarray:
        """Half the Lipschitz constant of Newton's method in a box, which is the unit of
        length along each component: comparable with omega |G|."""
        strong, weak = box
        of_strong = (
            self.strong_strong_strong * strong
            + 2.0 * self.strong_strong_weak * weak
            + self.strong_weak_weak * weak * (weak / strong)
        )
        of_weak = (
            self.weak_strong_strong * strong * (strong / weak)
            + 2.0 * self.weak_strong_weak * strong
            + self.weak_weak_weak * weak
        )
        halved: np.ndarray = 0.5 * np.maximum(of_strong, of_weak)
        return halved


def _parts(forms: np.ndarray) -> Iterator[np.ndarray]:
    """The blocks of forms (a, N, n - 1, n - 1, n - 1), flat (a, N, q)."""
    strong = slice(None, -1)
    weak = slice(-1, None)
    for component in (strong, weak):
        for first, second in ((strong, strong), (strong, weak), (weak, weak)):
            block = forms[:, :, component, first, second]
            yield block.reshape(*forms.shape[:2], -1)
