"""The parts of the closure of a loop: the screws of its joints in compiled code, and
bounds from the lengths of its links."""

from __future__ import annotations

from functools import cached_property, partial

import numpy as np

from bifurc.checks import check_number, point_of, rows_of
from bifurc.domain import Domain
from bifurc.errors import ProblemError
from bifurc.function_problem import EXACT_HESSIAN
from bifurc.system import (
    Accuracy,
    Curvature,
    CurveNodes,
    March,
    MarchSettings,
    PreciseResidual,
    Shortcuts,
    SphereProjection,
    compiled_march,
)
from linkages import _core
from linkages.closure.parts import NEARLY_CLOSED, ClosureParts
from linkages.loop import Loop

ROUNDING = 4e-16  # below this residual norm a projection has nothing left to gain
PROJECTION_STEPS = 60
SPHERE_STEPS = 25
LARGEST_EXPONENT = 300.0  # beyond it a bound is of no use


def parts_of_loop(loop: Loop) -> ClosureParts:
    """Six closure equations in the n joint angles (rad) of a ``loop``.

    Translations are measured in its characteristic length.
    """
    domain = Domain(
        names=tuple(f"theta{i + 1}" for i in range(loop.n)),
        units=("rad",) * loop.n,
        periods=np.full(loop.n, 2 * np.pi),
        bounds=np.full((loop.n, 2), [-np.inf, np.inf]),
    )
    accuracy = Accuracy(
        data_rounding=loop.rounding / loop.characteristic_length,
        hessian_error=EXACT_HESSIAN,
    )
    return ClosureParts(
        domain=domain,
        accuracy=accuracy,
        compiled=ScrewSystem(loop, domain),
        bounds=partial(bounds_of_loop, loop),
    )


class ScrewSystem:
    """The closure of a ``loop`` in its ``domain``, compiled. Columns of the Jacobian are
    the joint screws, second derivatives their Lie brackets, all exact."""

    is_small = is_marched = True

    def __init__(self, loop: Loop, domain: Domain):
        self.loop = loop
        self.n = loop.n
        self.geometry = loop.link_geometry
        self._domain = domain

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """Closure residuals (k, 6): rotation, then translation over the characteristic
        length."""
        return _core.residuals(points, self.geometry)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (k, 6, n) of `residuals`."""
        return _core.jacobians(points, self.geometry)

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """Second derivatives (k, 6, n, n) of the residual."""
        return _core.hessians(rows_of("points", points, self.n), self.geometry)

    @property
    def precise_residual(self) -> PreciseResidual:
        """Closure residuals over mpmath numbers, of the loop's own numbers."""
        from linkages.closure.precise import precise_residual  # it imports mpmath

        return precise_residual(self.loop)

    @cached_property
    def shortcuts(self) -> Shortcuts:
        """How points at the nodes of a piece of the valley are corrected along which the
        loop nearly closes."""
        return Shortcuts(
            valley_corrector=self._valley_points_at_nodes,
            equations=partial(_core.equations, self.geometry),
        )

    def _valley_points_at_nodes(self, nodes: CurveNodes) -> np.ndarray | None:
        return _core.valley_points_at_nodes(self.geometry, *nodes)

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Taylor pieces of the motion from ``start`` (n,) along ``tangent`` (n,)."""
        return compiled_march(
            _core.march,
            settings,
            self._domain,
            start=start,
            tangent=tangent,
            geometry=self.geometry,
        )

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Closed configurations (k, n) near ``starts`` and the residual (k,) left at
        each."""
        starts = rows_of("starts", starts, self.n)
        return _core.project(starts, self.geometry, ROUNDING, PROJECTION_STEPS)

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
            starts, center, radius, self.geometry, SPHERE_STEPS
        )
        return SphereProjection(*projected)


def bounds_of_loop(loop: Loop) -> Curvature:
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
    table = loop.arrays
    size = loop.characteristic_length
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
        exponents = np.minimum(np.sqrt(loop.n) * reach, LARGEST_EXPONENT)
        growth: np.ndarray = np.exp(exponents)
        return of_all_orders * growth

    bound = _bound_from_distances(np.minimum(near, after))
    return Curvature(bound, at_complex_points, NEARLY_CLOSED)


def _bound_from_distances(distance: np.ndarray) -> float:
    """A bound on the second derivative where the end point is no farther from axis j
    than ``distance`` (n,): the largest eigenvalue of the matrix of bounds by two
    joints."""
    joints = np.arange(len(distance))
    later = np.maximum.outer(joints, joints)
    bounds = np.sqrt(0.25 + distance[later] ** 2)
    return float(np.linalg.eigvalsh(bounds)[-1])
