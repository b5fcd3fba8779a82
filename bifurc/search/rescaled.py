"""A problem with its unknowns counted in another unit, and the atlas of such a problem
in the unit of its own.

A search compares lengths with the scale of the unknowns, and residuals with what
rounding leaves of numbers about 1. It runs in a unit near the scale, so that nothing
depends on the unit in which a problem is written. Units are powers of 2: nothing is
lost on the way in and out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Surface
from bifurc.branch import Branch
from bifurc.curves.monitor import Profile
from bifurc.function_problem import FunctionProblem, NumericalProblem
from bifurc.problem import (
    Anchor,
    March,
    MarchSettings,
    PreciseResidual,
    Problem,
    SphereProjection,
)
from bifurc.seeds import Audit, Seeds
from bifurc.singular.point import SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas

if TYPE_CHECKING:
    import mpmath

    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import sparray

__all__ = ["RescaledProblem", "in_unit_of_problem", "seeds_in_unit", "unit_of"]


def unit_of(problem: FunctionProblem) -> float:
    """The power of 2 nearest to the scale of a problem."""
    return float(2.0 ** round(math.log2(problem.scale)))


class RescaledProblem(NumericalProblem):
    """``problem`` with its unknowns counted in a ``unit``.

    Residuals are over magnitude and unit then, which have no unit of their own; what
    the problem does compiled it does here as well.
    """

    def __init__(self, problem: FunctionProblem, unit: float):
        self._problem = problem
        self._unit = unit
        self.names = problem.names
        self.units = problem.units
        self.periods = problem.periods / unit
        self.bounds = problem.bounds / unit
        self.scale = problem.scale / unit
        self.magnitude = problem.magnitude * unit
        self.hessian_error = problem.hessian_error
        self.curvature_residual = problem.curvature_residual / unit
        self.derivatives = problem.derivatives
        self.equations = problem.equations

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self._problem.residuals(self._unit * np.atleast_2d(points))

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        return self._unit * self._problem.jacobians(self._unit * np.atleast_2d(points))

    def jacobian(self, point: np.ndarray) -> np.ndarray | sparray:
        """F' (m, n) at one point (n,), sparse where the problem makes it so."""
        jacobian: np.ndarray | sparray = self._unit * self._problem.jacobian(
            self._unit * point
        )
        return jacobian

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """F'' (m, n, n) at a point (n,)."""
        return self._unit**2 * self._problem.hessian(self._unit * point)

    def precise_residual(self) -> PreciseResidual | None:
        """F over mpmath numbers, where the problem has it."""
        own = self._problem.precise_residual()
        if own is None:
            return None

        def residual(unknowns: Sequence[mpmath.mpf]) -> Sequence[mpmath.mpf]:
            return own([self._unit * unknown for unknown in unknowns])

        return residual

    def curvature_bound(self) -> float | None:
        """A constant of Lipschitz for F' over the magnitude, where the problem has
        one."""
        bound = self._problem.curvature_bound()
        return None if bound is None else self._unit * bound

    def complex_curvature(self, reach: np.ndarray) -> np.ndarray | None:
        """Bounds (k,) on |F''| over the magnitude, where the problem has them."""
        bounds = self._problem.complex_curvature(self._unit * reach)
        return None if bounds is None else self._unit * bounds

    def seeds(self, rng: np.random.Generator, count: int) -> Seeds:
        """Solutions reached from ``count`` random starts, or those that the problem has
        in a way of its own."""
        has_own = type(self._problem).seeds is not NumericalProblem.seeds
        if not has_own:
            return super().seeds(rng, count)
        seeds = seeds_in_unit(self._problem.seeds(rng, count), self._unit)
        judge = seeds.audit
        if judge is None:
            return seeds
        periods, unit = self._problem.periods, self._unit

        def audit(branches: Sequence[Branch], seconds: float) -> Audit:
            own = [_branch(branch, periods, unit) for branch in branches]
            verdict = judge(own, seconds)
            return replace(verdict, starts=verdict.starts / unit)

        return replace(seeds, audit=audit)

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Pieces of the curve from ``start`` (n,) along ``tangent`` (n,)."""
        if not self._problem.is_compiled:
            return super().march(start, tangent, settings)
        unit = self._unit
        anchor = settings.anchor
        if anchor is not None:
            anchor = Anchor(unit * anchor.point, anchor.tangent, unit * anchor.within)
        own = replace(
            settings,
            shortest=unit * settings.shortest,
            longest=unit * settings.longest,
            closing=unit * settings.closing,
            misclosure=unit * settings.misclosure,
            anchor=anchor,
            length=unit * settings.length,
        )
        march = self._problem.march(unit * start, tangent, own)
        return replace(
            march,
            pieces=march.pieces / unit,
            steps=march.steps / unit,
            radii=march.radii / unit,
            residuals=march.residuals / unit,
        )

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the relative residual (k,) that is
        left at each."""
        if not self._problem.is_compiled:
            return super().project(starts)
        points, gaps = self._problem.project(self._unit * starts)
        return points / self._unit, gaps / self._unit

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection:
        """Solutions near starts (k, n) at distance ``radius`` from ``center`` (n,)."""
        if not self._problem.is_compiled:
            return super().project_to_sphere(starts, center, radius)
        unit = self._unit
        projection = self._problem.project_to_sphere(
            unit * starts, unit * center, unit * radius
        )
        return SphereProjection(*(values / unit for values in projection))


def seeds_in_unit(seeds: Seeds, unit: float) -> Seeds:
    """Given seeds with their unknowns counted in a ``unit``."""
    return replace(
        seeds,
        points=seeds.points / unit,
        gaps=seeds.gaps / unit,
        missed=seeds.missed / unit,
    )


# --- the atlas ------------------------------------------------------------------------


def in_unit_of_problem(atlas: Atlas, problem: Problem, unit: float) -> Atlas:
    """The atlas of a `RescaledProblem` with unknowns and lengths as the problem counts
    them; residuals stay over magnitude and unit."""
    periods = problem.periods
    return replace(
        atlas,
        periods=periods,
        forms=tuple(_form(form, periods, unit) for form in atlas.forms),
        points=tuple(_meeting_point(point, unit) for point in atlas.points),
        near_misses=tuple(_event(event, unit) for event in atlas.near_misses),
        dead_points=tuple(_event(event, unit) for event in atlas.dead_points),
        rigid=unit * atlas.rigid,
        surfaces=tuple(_surface(one, periods, unit) for one in atlas.surfaces),
        near_motions=tuple(
            replace(near, length=unit * near.length, sample=unit * near.sample)
            for near in atlas.near_motions
        ),
    )


def _form(form: Form, periods: np.ndarray, unit: float) -> Form:
    certificate = form.certificate
    if certificate is not None:
        certificate = replace(
            certificate,
            gaps=unit * certificate.gaps,
            blurred=unit * certificate.blurred,
            bound=certificate.bound / unit,
        )
    profile = form.profile
    return replace(
        form,
        branch=_branch(form.branch, periods, unit),
        profile=Profile(unit * profile.arclength, profile.values, profile.rank),
        certificate=certificate,
    )


def _branch(branch: Branch, periods: np.ndarray, unit: float) -> Branch:
    return replace(
        branch,
        pieces=unit * branch.pieces,
        centers=unit * branch.centers,
        radii=unit * branch.radii,
        breaks=unit * branch.breaks,
        periods=periods,
    )


def _meeting_point(meeting: MeetingPoint, unit: float) -> MeetingPoint:
    point: SingularPoint = replace(
        meeting.point,
        u=unit * meeting.point.u,
        error=unit * meeting.point.error,
        radius=unit * meeting.point.radius,
    )
    passes = tuple((form, unit * s) for form, s in meeting.passes)
    return replace(meeting, point=point, passes=passes)


def _event(event: Event, unit: float) -> Event:
    return replace(event, s=unit * event.s, u=unit * event.u)


def _surface(surface: Surface, periods: np.ndarray, unit: float) -> Surface:
    charts: ChartAtlas | None = surface.charts
    if charts is not None:
        charts = replace(
            charts,
            centers=unit * charts.centers,
            radii=unit * charts.radii,
            vertices=unit * charts.vertices,
            periods=periods,
        )
    return replace(surface, samples=unit * surface.samples, charts=charts)
