"""The solution set next to a singular point, cut with a small sphere.

Every branch through the point leaves along its null space. The reduced equations of
Liapunov and Schmidt live on that space alone, and their zeros on a small circle or
sphere are the half-branches: two for every branch that passes, whatever the order at
which their tangents or curvatures separate.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.decisions import (
    fills_circle,
    is_null,
    is_on_circle,
    is_on_sphere,
    may_be_null,
)
from bifurc.numerics.binary_forms import unit_vectors
from bifurc.numerics.singular_values import Factors, factors_of, singular_values
from bifurc.problem import Problem
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.second_order import forms_on_null_space
from bifurc.singular.tangent_cone import (
    TangentCone,
    spread_directions,
    tangent_cone,
    without_duplicates,
)
from bifurc.system import relative_jacobians, relative_residuals

UNSEEN = -1  # dimension of a section that could not be made

# Samples on the circle of a null space of dimension 2, and the angle of the first.
COUNT, FIRST = 96, 0.01
ANGLES = FIRST + 2 * np.pi * np.arange(COUNT) / COUNT
CIRCLE = unit_vectors(ANGLES)
BEFORE, AFTER = np.arange(COUNT) - 1, (np.arange(COUNT) + 1) % COUNT  # their neighbours
# Rounding of the equations, of size 1, and how many times that counts as zero.
ROUNDING, MARGIN = 4e-15, 8.0
# Of the largest value on the circle: where a function touches zero, and what counts as
# zero in the other equations at a root and at a touching point, which has half the
# digits.
TOUCHES, ROOT, TOUCH = 1e-9, 1e-10, 1e-6
ROOT_TOLERANCE = 1e-12
# Rounds of the chord iteration, and the step over the scale at which it ends.
ROUNDS, LAST_STEP = 40, 1e-15
# Of a point on a sphere, over the radius: last step of the iteration.
SETTLED = 1e-4
# Residual of a point on a sphere, over the radius squared, and rounding.
SOLVED, SOLVED_ROUNDING = 1e-8, 5e-15
# Solutions of higher nullity on a sphere whose local dimension is looked at, and starts
# that are enough where all of them come to such.
MOST_TESTED, MOST_ALIKE = 40, 100
# How often solutions on a sphere are moved to within the bounds, and how far within, over
# the radius.
TIMES_LED, MARGINS = 30, np.array([0.3, 0.1, 0.03, 0.01])
# Radius, over the scale, of the section that says whether a point is on a surface.
SURFACE_RADIUS = 2e-2


@dataclass(frozen=True)
class Section:
    """Solutions on a small sphere about a point.

    ``points`` (h, n), one for each half-branch of a curve, and the local ``dimension``
    of the solution set: where it is 2 or more, the sphere meets more than the curves, and
    `UNSEEN` where the independent equations have no solution on the sphere.
    ``doubtful`` says whether one of the points is a zero but for rounding, which may
    stand for two half-branches or for none.
    """

    points: np.ndarray
    dimension: int
    doubtful: bool = False


def section(
    problem: Problem, point: np.ndarray, null_space: np.ndarray, radius: float
) -> Section:
    """Intersection of the solution set with a sphere of ``radius`` about a singular
    point (n,)."""
    return Sections(problem, point, null_space).of_radius(radius)


class Sections:
    """The sections about a singular ``point`` (n,) with the ``null_space`` (n, k), each
    made once."""

    def __init__(self, problem: Problem, point: np.ndarray, null_space: np.ndarray):
        self.problem = problem
        self.point = point
        self.null_space = null_space
        self._by_radius: dict[float, Section] = {}

    def of_radius(self, radius: float) -> Section:
        """That with a sphere of a ``radius``."""
        if radius not in self._by_radius:
            self._by_radius[radius] = self._made(radius)
        return self._by_radius[radius]

    def _made(self, radius: float) -> Section:
        if self.null_space.shape[1] == 2:
            return _circle_section(_ReducedEquations(self, self._factors, radius))
        return _sphere_section(self, radius)

    @cached_property
    def directions(self) -> np.ndarray:
        """Unit vectors (d, k) of the null space, in all directions."""
        k = self.null_space.shape[1]
        return spread_directions(k, np.random.default_rng(k))

    @cached_property
    def cone(self) -> TangentCone:
        """Unit vectors of the null space to which second order leads, and others, from
        which solutions on spheres are looked for."""
        forms = forms_on_null_space(self.problem, self.point, self.null_space)
        return tangent_cone(forms, self.directions)

    def are_counted(self, cut: Section) -> bool:
        """Whether the half-branches of a section are all: of those found from starts on a
        sphere, where curves alone are open, if second order tells all."""
        is_circle = self.null_space.shape[1] == 2
        return is_circle or cut.dimension > 1 or self.cone.is_whole

    @cached_property
    def _factors(self) -> Factors:
        """Those of F' at the point."""
        return factors_of(relative_jacobians(self.problem, self.point[None])[0])


def is_on_surface(sections: Sections) -> bool:
    """Whether the point of ``sections`` lies on a component of dimension 2 or more with
    the rank that belongs to it.

    A circle about the point of which only single places are solutions tells that it
    does not. Where many branches meet, F is so flat that probes nearby look like
    solutions: the section has the last word.
    """
    problem, place = sections.problem, sections.point[None]
    nullity = int(np.count_nonzero(may_be_null(singular_values(problem, place))))
    radius = SURFACE_RADIUS * problem.domain.scale
    is_circle = nullity == sections.null_space.shape[1] == 2
    if is_circle and 0 <= sections.of_radius(radius).dimension <= 1:
        return False
    if local_dimensions(problem, place).dimension[0] != nullity or nullity < 2:
        return False
    if nullity != sections.null_space.shape[1]:
        right = factors_of(problem.jacobians(place)[0]).right
        null_space = right[problem.n - nullity :].T
        sections = Sections(problem, sections.point, null_space)
    return sections.of_radius(radius).dimension > 1


# --- the reduced equations ------------------------------------------------------------


class _ReducedEquations:
    """The Liapunov-Schmidt reduction at a singular point, on the sphere of ``radius``
    in its null space.

    For a unit vector x of the null space V (n, k) the point is u + radius V x + w(x),
    where w solves the independent equations; what is left is W^T F / radius^2, with W
    the left null space. The chord iteration for w uses the ``factors`` of F' there
    and gains a factor of about the radius each time. ``noise`` is the rounding of the
    reduced equations.
    """

    def __init__(self, sections: Sections, factors: Factors, radius: float):
        left, sigma, right = factors
        problem = sections.problem
        rank = problem.n - sections.null_space.shape[1]
        self._problem = problem
        self._point = sections.point
        self._null_space = sections.null_space
        self._radius = radius
        row_space = right[:rank].T  # (n, rank)
        column_space = left[:, :rank]  # (m, rank)
        self._inverse = (row_space / sigma[:rank]) @ column_space.T
        self._left_null_space = left[:, rank:]
        self.noise = ROUNDING / radius**2
        self.n = problem.n

    def points(self, x: np.ndarray) -> np.ndarray:
        """Points (k, n) that solve the independent equations above unit vectors x (k,
        nullity)."""
        base = self._point + self._radius * x @ self._null_space.T
        smallest = LAST_STEP * self._problem.domain.scale
        w = np.zeros_like(base)
        with np.errstate(over="ignore", invalid="ignore"):  # where it diverges
            for _ in range(ROUNDS):
                step = relative_residuals(self._problem, base + w) @ self._inverse.T
                w -= step
                if np.abs(step).max(initial=0.0) < smallest:
                    break
        points: np.ndarray = base + w
        return points

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The reduced equations (k, codimension) at unit vectors x (k, nullity)."""
        return self.reduced(self.points(x))

    def reduced(self, points: np.ndarray) -> np.ndarray:
        """The reduced equations (k, codimension) at `points` (k, n)."""
        residuals = relative_residuals(self._problem, points)
        reduced: np.ndarray = residuals @ self._left_null_space / self._radius**2
        return reduced


# --- nullity 2: every zero on a circle ------------------------------------------------


def _circle_section(equations: _ReducedEquations) -> Section:
    """All zeros on the circle: those of the leading combination of the equations at
    which the other equations hold as well."""
    no_points = np.empty((0, equations.n))
    values = equations(CIRCLE)
    if not np.isfinite(values).all():
        return Section(no_points, UNSEEN, doubtful=True)  # nothing solves them there
    sizes = np.linalg.norm(values, axis=1)
    size = float(sizes.max())
    noise = MARGIN * equations.noise
    if fills_circle(size, noise):
        return Section(no_points, 2)
    _, _, right = np.linalg.svd(values, full_matrices=False)
    leading = _FourierSeries(values @ right[0])
    zeros = _find_zeros(leading, noise + TOUCHES * size)
    angles = np.concatenate([zeros.crossings, zeros.contacts])
    if not len(angles):
        return Section(no_points, 0)
    # a root is exact to rounding, so that all equations hold there or not
    is_crossing = np.arange(len(angles)) < len(zeros.crossings)
    limit = np.where(is_crossing, ROOT, TOUCH) * size + noise
    points = equations.points(unit_vectors(angles))
    left_over = np.linalg.norm(equations.reduced(points), axis=1)
    in_doubt = is_crossing & (left_over > limit) & (left_over < TOUCH * size + noise)
    if in_doubt.any():
        condition = _conditions(values, leading, angles[in_doubt])
        limit[in_doubt] += noise * condition
    is_solution = is_on_circle(left_over, limit)
    points = points[is_solution]
    is_doubtful = bool((is_solution & ~is_crossing).any())
    return Section(points, 1 if len(points) else 0, is_doubtful)


def _conditions(
    values: np.ndarray, leading: _FourierSeries, angles: np.ndarray
) -> np.ndarray:
    """By what (k,) an error of the leading combination is multiplied in the equations
    at its roots ``angles`` (k,): the rates of all of them over its own. ``values``
    (`COUNT`, codimension) are those of the equations on the circle."""
    rates = [_FourierSeries(column).rates(angles) for column in values.T]
    own = np.abs(leading.rates(angles))
    all_rates = np.linalg.norm(rates, axis=0)
    return np.asarray(all_rates / np.maximum(own, np.finfo(float).tiny))


class _FourierSeries:
    """A function on the circle through ``samples`` (`COUNT`,) at the `ANGLES`.

    On a small circle term k of the series is of the order of radius^(k - 2): the
    samples hold all of it.
    """

    def __init__(self, samples: np.ndarray):
        self.samples = samples
        self._coefficients = np.fft.rfft(samples) / COUNT
        self._coefficients[1:-1] *= 2
        self._orders = np.arange(len(self._coefficients))

    def __call__(self, angles: np.ndarray) -> np.ndarray:
        """Values at angles (...)."""
        return (self._waves(angles) @ self._coefficients).real

    def rates(self, angles: np.ndarray) -> np.ndarray:
        """Derivatives at angles (...)."""
        rates: np.ndarray = (self._waves(angles) @ self._terms_of_rates).real
        return rates

    @property
    def _terms_of_rates(self) -> np.ndarray:
        return np.asarray(1j * self._orders * self._coefficients)

    def _waves(self, angles: np.ndarray) -> np.ndarray:
        """The terms of the series (..., k) at angles (...), without coefficients."""
        offsets = np.asarray(angles) - FIRST
        phases = offsets[..., None] * self._orders
        waves: np.ndarray = np.exp(1j * phases)
        return waves

    def roots(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Angles (k,), one between each of ``low`` and ``high`` (k,), at which the
        function, which has opposite signs there, is zero."""
        return FIRST + _core.roots_of_waves(
            self._coefficients, low - FIRST, high - FIRST, ROOT_TOLERANCE
        )

    def level_near(self, at: np.ndarray, reach: float) -> np.ndarray:
        """Angles (k,), one within ``reach`` of each of those ``at`` (k,), at which the
        function is level; these themselves where it is steep on one side only, as far as
        rounding tells."""
        low, high = at - reach, at + reach
        has_one = self.rates(low) * self.rates(high) < 0
        level = at.copy()
        level[has_one] = FIRST + _core.roots_of_waves(
            self._terms_of_rates,
            low[has_one] - FIRST,
            high[has_one] - FIRST,
            ROOT_TOLERANCE,
        )
        return level


class _Zeros(NamedTuple):
    """Angles (k,) at which a function crosses zero, and angles (t,) at which it only
    touches it, but for rounding."""

    crossings: np.ndarray
    contacts: np.ndarray


def _find_zeros(function: _FourierSeries, zero: float) -> _Zeros:
    """All zeros on the circle: sign changes from sample to sample, and those that dips
    between samples reveal. A value below ``zero`` may be zero."""
    step = ANGLES[1] - ANGLES[0]
    signs = np.sign(function.samples)
    changes = ANGLES[signs * signs[AFTER] < 0]
    low, high = changes, changes + step
    contacts = np.empty(0)
    dips = _dips(function.samples)
    if len(dips):
        at = ANGLES[dips]
        bottoms = function.level_near(at, step)
        depths = signs[dips] * function(bottoms)
        # a dip that goes through zero has a sign change on either side
        is_crossed = depths < -zero
        middle = bottoms[is_crossed]
        low = np.concatenate([low, at[is_crossed] - step, middle])
        high = np.concatenate([high, middle, at[is_crossed] + step])
        contacts = bottoms[np.abs(depths) <= zero]
    crossings = np.empty(0)
    if len(low):
        crossings = function.roots(low, high)
    return _Zeros(crossings, contacts)


def _dips(samples: np.ndarray) -> np.ndarray:
    """Numbers (d,) of the samples on the circle that are nearer to zero than their
    neighbours, which have the same sign."""
    before, after = samples[BEFORE], samples[AFTER]
    size = np.abs(samples)
    is_lowest = (size <= np.abs(before)) & (size < np.abs(after))
    sign = np.sign(samples)
    same_sign = (sign == np.sign(before)) & (sign == np.sign(after))
    return np.flatnonzero(is_lowest & same_sign)


# --- nullity 3 and more: many starts on a sphere --------------------------------------


def _sphere_section(sections: Sections, radius: float) -> Section:
    """What Gauss-Newton reaches from starts spread over the sphere."""
    problem, point = sections.problem, sections.point
    ends = _reached(sections, radius)
    cone = sections.cone
    if not len(ends):  # there is nothing, or what leaves comes back within the sphere
        return Section(ends, 0, cone.is_whole and len(cone.lone) > 0)
    if not problem.domain.are_inside(ends).any():
        inside = _led_inside(problem, ends, point, radius)
        ends = np.concatenate([ends, inside])
    cut = _separate_surfaces(problem, ends)
    points = without_duplicates(cut.points, radius)
    is_doubtful = cone.is_whole and len(points) != len(cone.lone)
    return replace(cut, points=points, doubtful=is_doubtful)


def _reached(sections: Sections, radius: float) -> np.ndarray:
    """The solutions (h, n) on a sphere from starts in all directions. Of those that second
    order does not tell apart a part is enough where all of it comes to surfaces."""
    problem, point = sections.problem, sections.point

    def from_directions(directions: np.ndarray) -> np.ndarray:
        starts = point + radius * directions @ sections.null_space.T
        return _on_sphere(problem, starts, point, radius)

    lone, others, is_whole = sections.cone
    ends = from_directions(lone)
    if len(ends) < len(lone):  # so far away they are not what second order says
        others = sections.directions
    elif is_whole:
        return ends
    stride = max(1, len(others) // MOST_ALIKE)
    some = from_directions(others[::stride])
    if stride > 1 and not (len(some) and _are_of_higher_nullity(problem, some).all()):
        some = from_directions(others)
    return np.concatenate([ends, some])


def _on_sphere(
    problem: Problem, starts: np.ndarray, point: np.ndarray, radius: float
) -> np.ndarray:
    """The solutions (h, n) on the sphere that are reached from starts (k, n)."""
    ends, gaps, last_steps = problem.project_to_sphere(starts, point, radius)
    # next to the point F is of order radius^2 whatever the direction: the residual must
    # be far below that
    limit = SOLVED * (radius / problem.domain.scale) ** 2 + SOLVED_ROUNDING
    missed = np.maximum(gaps / limit, last_steps / (SETTLED * radius))
    reached: np.ndarray = ends[is_on_sphere(missed)]
    return reached


def _led_inside(
    problem: Problem, ends: np.ndarray, point: np.ndarray, radius: float
) -> np.ndarray:
    """Solutions (h, n) on the sphere within the region, from those outside of it (k, n):
    of many bounds that meet in the point what is within all may be a small part of the
    sphere. Moved to within the bounds and onto the solutions in turn (von Neumann 1950),
    each by a margin of its own."""
    low, high = problem.domain.bounds.T
    inside: np.ndarray = np.empty((0, problem.n))
    for _ in range(TIMES_LED):
        if not len(ends):
            break
        margins = radius * MARGINS[np.arange(len(ends)) % len(MARGINS), None]
        beside = np.clip(ends, low + margins, high - margins)
        ends = _on_sphere(problem, beside, point, radius)
        is_inside = problem.domain.are_inside(ends)
        inside = ends[is_inside]
        if len(inside):
            break
    return inside


def _separate_surfaces(problem: Problem, points: np.ndarray) -> Section:
    """The section of solutions (h, n) on a sphere: those on curves are its points,
    those on surfaces its dimension.

    A curve may be shaky, and a solution of higher nullity on it; the dimension of the
    nearby solutions decides. Surfaces outside the region do not count.
    """
    is_of_higher_nullity = _are_of_higher_nullity(problem, points)
    counts = problem.domain.are_inside(points) | ~is_of_higher_nullity
    points, is_of_higher_nullity = points[counts], is_of_higher_nullity[counts]
    candidates = np.flatnonzero(is_of_higher_nullity)
    stride = max(1, len(candidates) // MOST_TESTED)
    sample = candidates[::stride]
    dimension = local_dimensions(problem, points[sample]).dimension
    if np.all(dimension < 2):
        return Section(points, 1)
    return Section(points[~is_of_higher_nullity], int(dimension.max()))


def _are_of_higher_nullity(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Whether F' has a null space of dimension 2 or more at each of points (h, n)."""
    return np.asarray(is_null(singular_values(problem, points)[:, -2]))
