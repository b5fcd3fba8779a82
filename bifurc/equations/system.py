"""A tape at the scale of a problem: what the compiled methods make of it.

Inside, unknowns are counted in a ``unit`` and equations in ``magnitude`` times that
unit, so that nothing depends on either. The unit is a power of 2: nothing is lost on
the way in and out.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, cached_property, partial
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from bifurc import _core
from bifurc.checks import rows_of
from bifurc.domain import Domain
from bifurc.equations.tape import Tape, real_values
from bifurc.system import (
    CurveNodes,
    March,
    MarchSettings,
    MarchStatus,
    PreciseResidual,
    Shortcuts,
    Solver,
    SphereProjection,
    compiled_march,
)

if TYPE_CHECKING:
    import mpmath

    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csc_array

LARGEST_DENSE = 100  # unknowns up to which dense matrices are factored
LARGEST_FACTORED_DENSE = 40  # the same, in compiled code
# up to which pieces of a curve are made in compiled code: the factors of a net of more
# unknowns take longer than collocation with SuperLU
LARGEST_SPARSE = 250
# unknowns up to which rounding is measured at solutions near random points, which for more
# are seldom reached, with factors that fill
LARGEST_PROJECTED = 400
SINGULAR = 1e-12  # a singular value of F', over the magnitude, that is left to pivoting
SPARSE = 0.25  # share of entries of a larger Jacobian up to which it is sparse
ROUNDING = 4e-16  # below this residual a projection has nothing left to gain
PROJECTION_STEPS = 80
# unit of what is held, over that of the rest: its columns of F' are so small that the
# damping of a projection, 1e-14 at least, leaves next to nothing of its steps
QUICK = 0.05  # s between two looks at the clock
HELD = 2.0**-40
SPHERE_STEPS = 25
ROUNDING_OF_MARCH = 1e-15  # what a march takes it to be, over magnitude and unit
SAMPLES, BESIDE = 20, 0.3  # places at which it is measured, so far, over the scale, off
NEXT_TO = 1e-3  # the same where it is measured at one place
# the same for many equations, whose roundings make a mean of their own, by the unknowns
FEWEST_SAMPLES, SAMPLED = 4, 200
SOLVED = 1e-9  # residual of a solution
SMALLEST_SHARE = 1e-8  # of the magnitude, with which a curve is followed


class CompiledSystem(Protocol):
    """A system of equations as compiled code: what `bifurc.problem.Problem` asks of a
    system, in the words of that.

    Compiled marches and projections are fast enough where it ``is_marched``, and sections
    with spheres where it ``is_small``.
    """

    @property
    def is_small(self) -> bool: ...

    @property
    def is_marched(self) -> bool: ...

    @property
    def shortcuts(self) -> Shortcuts: ...

    @property
    def precise_residual(self) -> PreciseResidual: ...

    def residuals(self, points: np.ndarray) -> np.ndarray: ...

    def jacobians(self, points: np.ndarray) -> np.ndarray: ...

    def hessians(self, points: np.ndarray) -> np.ndarray: ...

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March: ...

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]: ...

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection: ...


class _Pattern(NamedTuple):
    """Where F' has entries: the ``order`` (e,) by columns of those by rows, their
    ``rows`` (e,), and the ``starts`` (n + 1,) of the columns."""

    order: np.ndarray
    rows: np.ndarray
    starts: np.ndarray


class ScaledTape:
    """The compiled methods of a ``tape`` whose F' is of size ``magnitude``, in its
    ``domain``; solutions are looked for in the ``region`` (n, 2), that of the bounds
    unless given. Immutable.

    It ``is_small`` where compiled methods with dense matrices are fast enough: up to
    the unknowns ``largest_dense``; with sparse ones up to ``largest_sparse``. Where it
    ``is_bordered`` sparse systems with F' and a row under it are solved in compiled code.
    """

    def __init__(
        self,
        tape: Tape,
        magnitude: float,
        domain: Domain,
        region: np.ndarray | None = None,
        largest_dense: float = LARGEST_DENSE,
        largest_sparse: float = LARGEST_SPARSE,
        is_bordered: bool = False,
    ):
        self.tape = tape
        self.is_small = tape.n <= largest_dense
        self._largest_sparse = largest_sparse
        self._is_bordered = is_bordered
        self._domain = domain
        self._scale = domain.scale
        self._magnitude = magnitude
        self._unit = 2.0 ** round(math.log2(domain.scale))
        self._units = np.full(tape.n, self._unit)
        self._weights = np.full(tape.m, 1.0 / (magnitude * self._unit))
        self._region = domain.bounds if region is None else region

    # --- values and derivatives -------------------------------------------------------

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self.tape.compiled.residuals(_contiguous(points))

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        return self.tape.compiled.jacobians(_contiguous(points))

    @cached_property
    def shortcuts(self) -> Shortcuts:
        """What is done in one call; F' is made sparse where it is large and has few
        entries."""
        is_sparse = self.tape.n > LARGEST_DENSE and self._has_few_entries
        is_bordered = self._is_bordered and self.is_factored_sparse
        return Shortcuts(
            m=self.tape.m,
            jacobian=self.sparse_jacobian if is_sparse else None,
            bordered_solver=self.bordered_solver if is_bordered else None,
            valley_corrector=self.valley_points_at_nodes if self.is_small else None,
            equations=cache(partial(_core.tape_equations, self.tape.compiled)),
            smallest_value=self.smallest_value if is_bordered else None,
        )

    def sparse_jacobian(self, point: np.ndarray) -> csc_array:
        """F' (m, n) at one point (n,), by columns, as it is factored."""
        from scipy.sparse import csc_array

        pattern = self._pattern
        entries = self.tape.compiled.entries(_contiguous(point))
        by_columns = (entries[pattern.order], pattern.rows, pattern.starts)
        return csc_array(by_columns, shape=(self.tape.m, self.tape.n))

    @cached_property
    def is_factored_sparse(self) -> bool:
        """Whether the compiled methods factor F' as the sparse matrix that it is."""
        return self.tape.n > LARGEST_FACTORED_DENSE and self._has_few_entries

    @property
    def is_marched(self) -> bool:
        """Whether marches and projections are to be made in compiled code."""
        if self.is_small:
            return True
        return self.tape.n <= self._largest_sparse and self.is_factored_sparse

    @cached_property
    def _has_few_entries(self) -> bool:
        return len(self._pattern.rows) <= SPARSE * self.tape.m * self.tape.n

    @cached_property
    def _pattern(self) -> _Pattern:
        by_rows, columns = self.tape.compiled.pattern()
        rows = np.repeat(np.arange(self.tape.m), np.diff(by_rows))
        order = np.argsort(columns, kind="stable")
        starts = np.searchsorted(columns[order], np.arange(self.tape.n + 1))
        return _Pattern(order, rows[order].astype(np.int32), starts.astype(np.int32))

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) at points (k, n)."""
        hessian = self.tape.compiled.hessian
        return np.array([hessian(point) for point in _contiguous(points)])

    def precise_residual(self, unknowns: Sequence[mpmath.mpf]) -> list[mpmath.mpf]:
        """F (m,) over mpmath numbers (n,), the constants being the doubles of the tape.
        Raises `ValueError` where F is not real."""
        import mpmath  # it takes long to import

        return real_values(self.tape.over(unknowns, mpmath))

    def bordered_solver(self, point: np.ndarray, tangent: np.ndarray) -> Solver | None:
        """What solves systems with F' (m, n) at a point (n,), over the magnitude, and
        under it the row ``tangent`` (n,), in the least-squares sense; None where F' is
        not factored as a sparse matrix, and where it has too low a rank."""
        if not self.is_factored_sparse:
            return None
        factored = self._factored(point, tangent)
        if not factored.smallest_singular_value() > SINGULAR:
            return None
        return factored.solve

    def smallest_value(self, point: np.ndarray, tangent: np.ndarray) -> float:
        """The smallest singular value of F' at a point (n,) across the unit ``tangent``
        (n,), over the magnitude, about."""
        return self._factored(point, tangent).smallest_singular_value()

    def _factored(self, point: np.ndarray, tangent: np.ndarray) -> _core.FactoredTape:
        return _core.FactoredTape(
            self.tape.compiled,
            self._units,
            self._weights,
            _contiguous(point) / self._unit,
            _contiguous(tangent),
        )

    # --- curves and solutions ---------------------------------------------------------

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Taylor pieces of the curve from ``start`` (n,) along ``tangent`` (n,).

        Rounding is taken to be that at most solutions. Where no piece comes of it and
        it is more at the start, it is taken to be that.
        """
        share = self._share_of_magnitude(start)
        march = self._march_above(share, start, tangent, settings)
        if march.status is MarchStatus.STALLED and not len(march.pieces):
            beside = np.tile(start, (self._sample_count, 1))
            larger = self._share_about(beside, NEXT_TO)
            if larger > share:
                march = self._march_above(larger, start, tangent, settings)
        return march

    def _march_above(
        self,
        share: float,
        start: np.ndarray,
        tangent: np.ndarray,
        settings: MarchSettings,
    ) -> March:
        """The same, rounding being what it is to a ``share`` of the magnitude."""
        outer = self._domain.bounds + self._domain.slack * np.array([-1.0, 1.0])
        return compiled_march(
            self.tape.compiled.march,
            replace(settings, tolerance=settings.tolerance * self._scale / self._unit),
            # a march along one of the bounds need not end after every piece
            replace(self._domain, bounds=outer),
            self._unit,
            share,
            units=self._units,
            weights=self._weights / share,
            start=_contiguous(start) / self._unit,
            tangent=_contiguous(tangent),
            is_sparse=self.is_factored_sparse,
        )

    def valley_points_at_nodes(self, nodes: CurveNodes) -> np.ndarray | None:
        """Points (k, n) at the nodes of a piece of the valley along which the equations
        are nearly solved; None where one of them cannot be corrected."""
        units = np.ones(self.tape.n)
        weights = np.full(self.tape.m, 1.0 / self._magnitude)
        return self.tape.compiled.valley_points_at_nodes(units, weights, *nodes)

    def _share_of_magnitude(self, start: np.ndarray) -> float:
        """The magnitude of F' over which rounding is what a march takes it to be, over
        that of the problem; 1 at most.

        F may be far smaller beside its solutions than elsewhere within the bounds.
        Rounding is measured there; where none are known, about the ``start`` (n,). At
        some solutions it happens to be nothing: a little way off it is not.
        """
        if self.tape.n <= LARGEST_PROJECTED and len(self._solutions):
            return self._share_at_solutions
        return self._share_about(np.tile(start, (self._sample_count, 1)), BESIDE)

    @property
    def _sample_count(self) -> int:
        """At how many places rounding is measured."""
        return min(max(SAMPLED // self.tape.n, FEWEST_SAMPLES), SAMPLES)

    @cached_property
    def _share_at_solutions(self) -> float:
        """That share, as it is at the known solutions."""
        return self._share_about(self._solutions, BESIDE)

    def _share_about(self, centers: np.ndarray, off: float) -> float:
        """That share, as it is about points (k, n), so far ``off`` them in scales."""
        rng = np.random.default_rng(0)
        points = centers + off * self._scale * rng.normal(size=centers.shape)
        lowest, highest = self.tape.compiled.value_bounds(points, points)
        widths = np.linalg.norm(highest - lowest, axis=1)
        widths = widths[np.isfinite(widths) & (widths > 0.0)]
        if not len(widths):
            return 1.0
        magnitude = np.median(widths) / (ROUNDING_OF_MARCH * self._unit)
        return float(np.clip(magnitude / self._magnitude, SMALLEST_SHARE, 1.0))

    @cached_property
    def _solutions(self) -> np.ndarray:
        """Solutions (k, n) near random points in the middle of the region."""
        low, high = self._region.T
        low = np.where(np.isfinite(low), low, -self._scale)
        high = np.where(np.isfinite(high), high, self._scale)
        rng = np.random.default_rng(0)
        inner = rng.uniform(0.25, 0.75, (self._sample_count, self.tape.n))
        points, gaps = self.project(low + inner * (high - low))
        return points[gaps <= SOLVED * self._unit]

    def project(
        self, starts: np.ndarray, is_held: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the residual (k,), over the
        magnitude, that is left at each; unknowns that are held (n,) stay where they are
        but for rounding."""
        starts = rows_of("starts", starts, self.tape.n)
        units = self._units
        if is_held is not None:
            units = np.where(is_held, HELD * self._unit, self._unit)

        def project(some: np.ndarray) -> tuple[np.ndarray, ...]:
            points, gaps = self.tape.compiled.project(
                units,
                self._weights,
                _contiguous(some) / units,
                ROUNDING,
                PROJECTION_STEPS,
                self.is_factored_sparse,
            )
            return units * points, self._unit * gaps

        points, gaps = _in_parts(project, starts)
        return points, gaps

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection:
        """Solutions near starts (k, n) at distance ``radius`` from ``center`` (n,)."""
        unit = self._unit

        def project(some: np.ndarray) -> tuple[np.ndarray, ...]:
            points, gaps, last_steps = self.tape.compiled.project_to_sphere(
                self._units,
                self._weights,
                _contiguous(some) / unit,
                _contiguous(center) / unit,
                radius / unit,
                SPHERE_STEPS,
            )
            return unit * points, unit * gaps, unit * last_steps

        return SphereProjection(*_in_parts(project, starts))


def _in_parts(
    project: Callable[[np.ndarray], tuple[np.ndarray, ...]], starts: np.ndarray
) -> tuple[np.ndarray, ...]:
    """What a compiled function makes of starts (k, n), row by row: a few at a time, as
    Ctrl-C and the end of the time get through between two calls only."""
    if len(starts) <= 1:
        return project(starts)
    parts = []
    begin, count = 0, 1
    while begin < len(starts):
        began = time.perf_counter()
        parts.append(project(starts[begin : begin + count]))
        begin += count
        if time.perf_counter() - began < QUICK:
            count *= 2
    return tuple(np.concatenate(columns) for columns in zip(*parts, strict=True))


def _contiguous(values: np.ndarray) -> np.ndarray:
    """``values`` as the floats in one block of memory that compiled code takes."""
    return np.ascontiguousarray(values, dtype=float)
