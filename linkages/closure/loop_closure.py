"""The closure of a loop as a problem for `bifurc`: compiled kernels behind its
interface."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from bifurc.checks import check_number, check_type, point_of, rows_of
from bifurc.decisions import is_start_solved
from bifurc.domain import Domain
from bifurc.errors import ProblemError
from bifurc.function_problem import EXACT_HESSIAN, NumericalProblem
from bifurc.limits import Deadline
from bifurc.seeding import random_seeds
from bifurc.seeds import Seeds
from bifurc.system import (
    Accuracy,
    Curvature,
    CurveNodes,
    March,
    MarchSettings,
    MarchStatus,
    Shortcuts,
    SphereProjection,
)
from linkages import _core
from linkages.kinematics import Number
from linkages.loop import Loop
from linkages.slices.completeness import slice_all_joints

ROUNDING = 4e-16  # below this residual norm a projection has nothing left to gain
PROJECTION_STEPS = 60
SPHERE_STEPS = 25
LARGEST_EXPONENT = 300.0  # beyond it a bound is of no use
NEARLY_CLOSED = 0.2  # the largest residual at which bounds on F'' hold


class LoopClosure(NumericalProblem):
    """Six closure equations in the n joint angles (rad) of a loop.

    Translations are measured in the loop's characteristic length. The derivatives are
    exact: columns of the Jacobian are the joint screws, second derivatives their Lie
    brackets.
    """

    def __init__(self, loop: Loop):
        check_type("loop", loop, Loop)
        n = loop.n
        self.loop = loop
        self.domain = Domain(
            names=tuple(f"theta{i + 1}" for i in range(n)),
            units=("rad",) * n,
            periods=np.full(n, 2 * np.pi),
            bounds=np.full((n, 2), [-np.inf, np.inf]),
        )
        self.accuracy = Accuracy(
            data_rounding=loop.rounding / loop.characteristic_length,
            hessian_error=EXACT_HESSIAN,
        )
        self._geometry = loop.link_geometry

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """Closure residuals (k, 6): rotation, then translation over the characteristic
        length."""
        return _core.residuals(rows_of("points", points, self.n), self._geometry)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (k, 6, n) of `residuals`."""
        return _core.jacobians(rows_of("points", points, self.n), self._geometry)

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """Second derivatives (k, 6, n, n) of the residual."""
        return _core.hessians(rows_of("points", points, self.n), self._geometry)

    def precise_residual(self) -> Callable[[Sequence[Number]], list[Number]]:
        """Closure residuals over mpmath numbers, of the loop's own numbers."""
        from linkages.closure.precise import precise_residual  # it imports mpmath

        return precise_residual(self.loop)

    @cached_property
    def curvature(self) -> Curvature:
        """Bounds on F'' from the geometry: from how far the base point and the end point
        can be from the axis of every joint (n,), by the links before it and after it.

        The second derivative by joints i <= j is at most 1/2 for the rotation and the
        distance of the end point from axis j for the translation. Where the loop is
        nearly closed the end point is the base point, which the links before j and
        those after it reach; the shorter way bounds the distance, with
        `NEARLY_CLOSED` to spare.

        Derivatives of every order are iterated products of screws: those by joints i <=
        ... <= j are at most 1/2 for the rotation and the distance of the end point from
        axis j for the translation, however many they are. The Taylor series in the
        imaginary parts y then sums up to exp(|y_1| + ... + |y_n|) times the bound for
        real points.
        """
        table = self.loop.arrays
        size = self.loop.characteristic_length
        lengths = np.abs(table.lengths) / size
        offsets = np.abs(table.offsets) / size
        # along the axis of joint 1, a link, the next axis, and so on, up to axis j
        link = lengths + np.roll(offsets, -1)
        links_before = np.concatenate([[0.0], np.cumsum(link)[:-1]])
        before = links_before - offsets + offsets[0]
        # from axis j on to the end of the loop
        after = np.cumsum((lengths + offsets)[::-1])[::-1] - offsets
        near = np.maximum(before, 0.0) + NEARLY_CLOSED
        of_all_orders = _bound_from_distances(after)

        def at_complex_points(reach: np.ndarray) -> np.ndarray:
            exponents = np.minimum(np.sqrt(self.n) * reach, LARGEST_EXPONENT)
            growth: np.ndarray = np.exp(exponents)
            return of_all_orders * growth

        bound = _bound_from_distances(np.minimum(near, after))
        return Curvature(bound, at_complex_points, NEARLY_CLOSED)

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Taylor pieces of the motion from ``start`` (n,) along ``tangent`` (n,)."""
        anchor, within = np.empty((0, self.n)), 0.0
        if settings.anchor is not None:
            anchor, within = np.array(settings.anchor[:2]), settings.anchor.within
        status, pieces, steps, radii, residuals, _ = _core.march(
            start=start,
            tangent=tangent,
            geometry=self._geometry,
            order=settings.order,
            tolerance=settings.tolerance,
            shortest=settings.shortest,
            longest=settings.longest,
            count=settings.count,
            closing=settings.closing,
            misclosure=settings.misclosure,
            anchor=anchor,
            within=within,
            periods=self.domain.periods,
            bounds=self.domain.bounds,
            length=settings.length,
        )
        return March(MarchStatus(status), pieces, steps, radii, residuals)

    @property
    def shortcuts(self) -> Shortcuts:
        """How points at the nodes of a piece of the valley are corrected along which the
        loop nearly closes."""
        return Shortcuts(valley_corrector=self._valley_points_at_nodes)

    def _valley_points_at_nodes(self, nodes: CurveNodes) -> np.ndarray | None:
        return _core.valley_points_at_nodes(self._geometry, *nodes)

    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """Closed configurations to start from: complete slices of every joint of a 4R,
        5R or 6R loop, and what is reached from ``count`` random starts."""
        drawn = random_seeds(self, rng, count, deadline=deadline)
        slices = slice_all_joints(self.loop, rng)
        if slices is None:
            return drawn
        near, gaps = self.project(slices.nearly_real)
        closed = near[is_start_solved(gaps)]
        constructed = np.concatenate([slices.configurations, closed])
        is_random = np.zeros(len(constructed), dtype=bool)
        return replace(
            drawn,
            points=np.concatenate([constructed, drawn.points]),
            random=np.concatenate([is_random, drawn.random]),
            audit=slices,
        )

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Closed configurations (k, n) near ``starts`` and the residual (k,) left at
        each."""
        starts = rows_of("starts", starts, self.n)
        return _core.project(starts, self._geometry, ROUNDING, PROJECTION_STEPS)

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection:
        """Closed configurations near ``starts`` (k, n) at distance ``radius`` from
        ``center`` (n,)."""
        check_number("radius", radius)
        if not 0.0 < radius < np.inf:
            raise ProblemError("radius", radius, "positive and finite")
        starts = rows_of("starts", starts, self.n)
        center = point_of("center", center, self.n)
        projected = _core.project_to_sphere(
            starts, center, radius, self._geometry, SPHERE_STEPS
        )
        return SphereProjection(*projected)


def _bound_from_distances(distance: np.ndarray) -> float:
    """A bound on the second derivative where the end point is no farther from axis j
    than ``distance`` (n,): the largest eigenvalue of the matrix of bounds by two
    joints."""
    joints = np.arange(len(distance))
    later = np.maximum.outer(joints, joints)
    bounds = np.sqrt(0.25 + distance[later] ** 2)
    return float(np.linalg.eigvalsh(bounds)[-1])
