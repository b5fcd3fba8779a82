"""Components that are products: groups of unknowns that move independently of each other.

Where every tangent space of a component is a sum of spaces along groups of unknowns, the
component is a product of what each group runs over while the others are held: a form
beside a free slide, or forms that have nothing to do with each other. The tangent space
at one point shows the groups, a curve of each group is traced alone, and points of
which each group stands somewhere on its own curve show that all of their product are
solutions. A product of closed curves, and of curves from bound to bound, that has the
dimension of the component is all of it: so components are counted without charts.
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.decisions import (
    are_independent,
    is_point_of_product,
    is_same_point,
    is_start_solved,
    may_be_null,
)
from bifurc.domain import Domain
from bifurc.function_problem import NumericalProblem
from bifurc.limits import Deadline
from bifurc.numerics.connected_parts import connected_parts
from bifurc.numerics.null_spaces import null_spaces
from bifurc.problem import Problem
from bifurc.settings import TraceSettings
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.factor import Factor
from bifurc.system import relative_gaps

WHOLE = (Outcome.CLOSED, Outcome.LEFT_REGION)
ASIDE = 0.05  # scales from a sample at which it is seen what moves
DRAWS = 64  # points of a product at which it is seen whether they are solutions
# Points through which no product goes although unknowns seem independent there, after
# which no others are looked for.
MOST_FAILURES = 3
MOST_PRODUCTS = 1000  # of curves that are known, which are put together anew
RADIUS = 0.7  # of charts of a factor, over the scale
CHARTS = 1000  # of a factor that is a surface


class HeldProblem(NumericalProblem):
    """A ``problem`` with all unknowns held as at a ``point`` (n,) but those of a
    ``group`` (g,), its numbers."""

    def __init__(self, problem: Problem, group: np.ndarray, point: np.ndarray):
        self._problem, self._group, self._point = problem, group, point
        domain = problem.domain
        self.domain = Domain(
            names=tuple(domain.names[k] for k in group),
            units=tuple(domain.units[k] for k in group),
            periods=domain.periods[group],
            bounds=domain.bounds[group],
            scale=domain.scale,
        )
        self.magnitude, self.accuracy = problem.magnitude, problem.accuracy

    def with_others(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n) of the problem, with the unknowns of the group at these
        (k, g)."""
        outer = np.empty((len(points), len(self._point)))
        outer[:] = self._point
        outer[:, self._group] = points
        return outer

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, g)."""
        return self._problem.residuals(self.with_others(points))

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """The columns of F' (k, m, g) at points (k, g)."""
        return self._problem.jacobians(self.with_others(points))[:, :, self._group]

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """The second derivatives (k, m, g, g) at points (k, g)."""
        hessians = self._problem.hessians(self.with_others(points))
        return hessians[:, :, self._group[:, None], self._group]


class _Groups(NamedTuple):
    """Groups of unknowns, by their numbers, that move independently of each other, each
    in so many ``dimensions``, and the unknowns that are ``held`` (h,)."""

    moving: tuple[tuple[int, ...], ...]
    dimensions: tuple[int, ...]
    held: np.ndarray


class _Course(ABC):
    """What a ``group`` of unknowns (g,) runs over while all others are held."""

    group: np.ndarray

    @property
    @abstractmethod
    def factor(self) -> Factor:
        """What is listed of it."""

    @abstractmethod
    def holds(self, places: np.ndarray) -> np.ndarray:
        """Which places (k, g) of the group are on it (k,)."""

    @abstractmethod
    def drawn(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """So many places (count, g) on it."""


@dataclass(frozen=True, eq=False)
class _Curve(_Course):
    """A curve in the unknowns of the group, which have a ``scale``."""

    group: np.ndarray
    branch: Branch
    scale: float

    @property
    def factor(self) -> Factor:
        branch = self.branch
        return Factor(tuple(self.group.tolist()), 1, branch.closed, branch.length)

    def holds(self, places: np.ndarray) -> np.ndarray:
        distances, _ = self.branch.nearest(places)
        return is_same_point(distances, self.scale)

    def drawn(self, rng: np.random.Generator, count: int) -> np.ndarray:
        return self.branch(rng.uniform(0.0, self.branch.length, count))


@dataclass(frozen=True, eq=False)
class _Charted(_Course):
    """A surface under charts in the unknowns of the group."""

    group: np.ndarray
    charts: ChartAtlas

    @property
    def factor(self) -> Factor:
        charts = self.charts
        return Factor(tuple(self.group.tolist()), 2, charts.border == 0, charts.area)

    def holds(self, places: np.ndarray) -> np.ndarray:
        return self.charts.covers(places)

    def drawn(self, rng: np.random.Generator, count: int) -> np.ndarray:
        chosen: np.ndarray = rng.choice(self.charts.centers, count)
        return chosen


@dataclass(frozen=True, eq=False)
class _Flat(_Course):
    """The part of a plane through a ``place`` (g,) along a ``basis`` (d, g) that lies
    within ``bounds`` (g, 2), which is convex."""

    group: np.ndarray
    place: np.ndarray
    basis: np.ndarray
    bounds: np.ndarray
    scale: float

    @property
    def factor(self) -> Factor:
        return Factor(tuple(self.group.tolist()), len(self.basis), False, None)

    def holds(self, places: np.ndarray) -> np.ndarray:
        offsets = places - self.place
        across = offsets - offsets @ self.basis.T @ self.basis
        distances: np.ndarray = np.linalg.norm(across, axis=1)
        return is_same_point(distances, self.scale)

    def drawn(self, rng: np.random.Generator, count: int) -> np.ndarray:
        directions = rng.normal(size=(count, len(self.basis))) @ self.basis
        limits = self.bounds - self.place[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = limits.T / directions[:, None, :]  # (count, 2, g)
        farthest = np.nanmax(steps, axis=1).min(axis=1)
        reach = np.minimum(farthest, self.scale)
        shares = rng.uniform(size=count) * reach
        places: np.ndarray = self.place + shares[:, None] * directions
        return places


@dataclass(frozen=True, eq=False)
class Product:
    """A component of solutions: all unknowns but those of its ``courses`` stand as at a
    ``point`` (n,) of it."""

    problem: Problem
    point: np.ndarray
    courses: tuple[_Course, ...]
    held: np.ndarray

    @property
    def factors(self) -> tuple[Factor, ...]:
        """What is listed of what it is made of."""
        return tuple(course.factor for course in self.courses)

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Which solutions (k, n) are on it (k,)."""
        gaps = self.problem.domain.difference(points, self.point)[:, self.held]
        distances = np.linalg.norm(gaps, axis=1)
        on_it: np.ndarray = is_same_point(distances, self.problem.domain.scale)
        for course in self.courses:
            on_it[on_it] = course.holds(points[on_it][:, course.group])
        return on_it

    def drawn(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """So many points (count, n) of it."""
        points = np.tile(self.point, (count, 1))
        for course in self.courses:
            points[:, course.group] = course.drawn(rng, count)
        return points

    def is_solved(self) -> bool:
        """Whether points of which each group is anywhere on its own course are
        solutions."""
        points = self.drawn(np.random.default_rng(0), DRAWS)
        ends, gaps = self.problem.project(points)
        moved = np.linalg.norm(self.problem.domain.difference(ends, points), axis=1)
        scale = self.problem.domain.scale
        are_there = is_start_solved(gaps) & is_point_of_product(moved, scale)
        return bool(np.all(are_there))


class Products(NamedTuple):
    """The ``components`` of a problem that are products, and on which of them each of
    the samples lies, (k,), -1 where it is on none."""

    components: list[Product]
    of_sample: np.ndarray


def products_among(
    problem: Problem,
    samples: np.ndarray,
    dimension: int,
    tracing: TraceSettings,
    deadline: Deadline,
) -> Products:
    """The components of a ``dimension`` that are products, of those on which solutions
    ``samples`` (k, n) lie, and others that are put together of the same curves."""
    components: list[Product] = []
    of_sample = np.full(len(samples), -1)
    found = Products(components, of_sample)
    if problem.domain.rim is not None or problem.domain.is_large:
        return found
    places = solutions_beside(problem, samples, dimension)
    sigma, right = null_spaces(problem, places)
    is_plain = np.count_nonzero(may_be_null(sigma), axis=1) == dimension
    tangents = right[:, problem.n - dimension :]
    failures = 0
    for number in np.flatnonzero(is_plain).tolist():
        if deadline.passed or failures >= MOST_FAILURES:
            break
        if of_sample[number] >= 0:
            continue
        groups = _groups_of(tangents[number])
        if groups is None:
            continue
        place, sample = places[number], samples[number : number + 1]
        product = _product_through(problem, place, groups, tracing, deadline)
        if product is None or not product.holds(sample)[0]:
            failures += 1
            continue
        is_open = of_sample < 0
        is_open[is_open] = product.holds(samples[is_open])
        of_sample[is_open] = len(components)
        components.append(product)
    components += list(_put_together(components, deadline))
    return found


def solutions_beside(
    problem: Problem, points: np.ndarray, dimension: int
) -> np.ndarray:
    """Solutions (k, n) in no special direction from others (k, n) of components of this
    ``dimension``: where an unknown just turns back, as symmetric places have it, it seems
    to depend on nothing."""
    _, right = null_spaces(problem, points)
    rng = np.random.default_rng(0)
    shares = rng.normal(size=(len(points), 1, dimension))
    shares /= np.linalg.norm(shares, axis=2, keepdims=True)
    along = (shares @ right[:, problem.n - dimension :])[:, 0]
    ends, gaps = problem.project(points + ASIDE * problem.domain.scale * along)
    are_there = is_start_solved(gaps) & problem.domain.are_inside(ends)
    return np.where(are_there[:, None], ends, points)


def _groups_of(tangents: np.ndarray) -> _Groups | None:
    """The groups of unknowns that move independently where a tangent space has a basis
    (d, n); None where they are one."""
    projector = tangents.T @ tangents
    pairs = np.argwhere(~are_independent(np.abs(projector))).tolist()
    labels = np.array(connected_parts(tangents.shape[1], pairs))
    shares = np.bincount(labels, weights=np.diag(projector))
    dimensions = np.round(shares).astype(int)
    moving = np.flatnonzero(dimensions)
    if len(moving) < 2:
        return None
    return _Groups(
        moving=tuple(tuple(np.flatnonzero(labels == k).tolist()) for k in moving),
        dimensions=tuple(dimensions[moving].tolist()),
        held=np.flatnonzero(~np.isin(labels, moving)),
    )


def _product_through(
    problem: Problem,
    point: np.ndarray,
    groups: _Groups,
    tracing: TraceSettings,
    deadline: Deadline,
) -> Product | None:
    """The product through a solution (n,), with these groups of unknowns; None where the
    course of a group cannot be followed to its end, or not all of the product are
    solutions."""
    courses = []
    for group, dimension in zip(groups.moving, groups.dimensions, strict=True):
        numbers = np.array(group)
        course = _course(problem, point, numbers, dimension, tracing, deadline)
        if course is None:
            return None
        courses.append(course)
    product = Product(problem, point, tuple(courses), groups.held)
    return product if product.is_solved() else None


def _course(
    problem: Problem,
    point: np.ndarray,
    group: np.ndarray,
    dimension: int,
    tracing: TraceSettings,
    deadline: Deadline,
) -> _Course | None:
    """What a group of unknowns runs over from a solution (n,) with the others held."""
    alone = HeldProblem(problem, group, point)
    start, scale = point[group], problem.domain.scale
    if dimension == 1:
        branch = trace_branch(alone, start, settings=tracing, deadline=deadline)
        is_whole = branch.outcome in WHOLE and branch.length > 0.0
        return _Curve(group, branch, scale) if is_whole else None
    flat = _flat_through(alone, start, group, dimension)
    if flat is not None or dimension > 2 or not deadline.left:
        return flat
    charts = cover_surface(
        alone, start[None], radius=RADIUS, charts=CHARTS, seconds=deadline.left
    )
    return _Charted(group, charts) if charts.complete else None


def _flat_through(
    alone: HeldProblem, start: np.ndarray, group: np.ndarray, dimension: int
) -> _Flat | None:
    """The plane of solutions through one (g,) in the unknowns of a group, none of which
    is periodic; None where there is none. Whether what is drawn of it is solved is seen
    with that of the other groups."""
    if np.any(np.isfinite(alone.domain.periods)):
        return None
    _, right = null_spaces(alone, start[None])
    basis = right[0, alone.n - dimension :]
    flat = _Flat(group, start, basis, alone.domain.bounds, alone.domain.scale)
    places = flat.drawn(np.random.default_rng(0), DRAWS)
    is_plane = bool(np.all(is_start_solved(relative_gaps(alone, places))))
    return flat if is_plane else None


def _put_together(known: Sequence[Product], deadline: Deadline) -> Iterator[Product]:
    """Products, other than those ``known``, of courses of several of these."""
    rng = np.random.default_rng(0)
    for alike in _with_the_same_groups(known):
        courses = [_different(of_group) for of_group in _by_group(alike)]
        made = list(alike)
        choices = itertools.product(*courses)
        for choice in itertools.islice(choices, MOST_PRODUCTS):
            if deadline.passed:
                return
            first = alike[0]
            product = Product(first.problem, first.point, choice, first.held)
            (place,) = product.drawn(rng, 1)
            if any(one.holds(place[None])[0] for one in made):
                continue
            product = Product(first.problem, place, choice, first.held)
            if product.is_solved():
                made.append(product)
                yield product


def _with_the_same_groups(products: Sequence[Product]) -> list[list[Product]]:
    """The products, those together in which the same unknowns run over something and the
    others are held at the same values."""
    classes: list[list[Product]] = []
    for product in products:
        key = [course.group.tolist() for course in product.courses]
        for alike in classes:
            first = alike[0]
            gap = first.problem.domain.difference(product.point, first.point)
            distance = float(np.linalg.norm(gap[first.held]))
            is_same = is_same_point(distance, first.problem.domain.scale)
            if is_same and key == [course.group.tolist() for course in first.courses]:
                alike.append(product)
                break
        else:
            classes.append([product])
    return classes


def _by_group(products: Sequence[Product]) -> list[list[_Course]]:
    """The courses of products with the same groups, those of each group together."""
    return [
        list(courses)
        for courses in zip(*(one.courses for one in products), strict=True)
    ]


def _different(courses: Sequence[_Course]) -> list[_Course]:
    """Each course of a group once."""
    rng = np.random.default_rng(0)
    others: list[_Course] = []
    for course in courses:
        place = course.drawn(rng, 1)
        if not any(other.holds(place)[0] for other in others):
            others.append(course)
    return others
