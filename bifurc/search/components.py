"""Components of dimension 2 and more in a search: which seeds lie on them, their charts,
their singular points.

All along a curve of singular points on a surface, as one in which it crosses itself or
another, F' has one rank, lower than on the surface about it. That F = 0 and that F' has
no higher rank are equations of which the curve is a regular solution
(`bifurc.curves.deflation`) where sheets cross at an angle: it is traced like a form.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Surface
from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import RankDeflated
from bifurc.decisions import (
    closes_to_rounding,
    is_same_point,
    may_be_null,
    may_be_singular,
)
from bifurc.limits import Deadline
from bifurc.numerics.null_spaces import null_spaces
from bifurc.numerics.singular_values import factors_of, singular_values
from bifurc.problem import Problem
from bifurc.search.own_units.unit_problem import UnitProblem
from bifurc.search.records import Components, SingularCurve
from bifurc.seeding import random_seeds
from bifurc.settings import TraceSettings
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.locate import LocatedPoint, locate_singular_point
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.crossing_sheets import is_on_singular_curve, sign_changes
from bifurc.surfaces.geodesic import entrances
from bifurc.surfaces.joined import joined_parts
from bifurc.surfaces.products import products_among, solutions_beside
from bifurc.surfaces.walk import reached_charts
from bifurc.system import relative_jacobians, relative_residuals

# Places at which it is seen whether charts lie between sheets, with how many digits, and
# what is missed there by rounding, over the magnitude.
LOOKS, DIGITS, ROUNDING = 8, 50, 1e-13
# What is missed, over the magnitude, along a curve in which sheets meet: the square of
# the distance of its samples from it.
OFF_CURVE = 1e-20
WHOLE = (Outcome.CLOSED, Outcome.LEFT_REGION)


# Share of the time that is left in which charts are made; they are measured in the rest.
GROWING = 0.35
GROWING_OTHERS = 0.6  # the same, of more dimensions, where none is measured
RECOGNISING = 0.2  # the same, to find products
JOINING = 0.1  # and to see which samples are joined
RADIUS = 0.7  # of the largest charts of surfaces, over the problem's scale
# Singular value, over the median on the surface, below which a singular point is looked
# for.
SMALL = 0.2
# Singular points of surfaces that are located, and places at which those of components of
# more dimensions are looked for.
MOST_POINTS, MOST_LOOKS = 200, 24
# Those among them that are samples of curves of singular points, which have no end.
MOST_SAMPLES = 24
NULLITY = 3  # of F' at a singular point of a surface
# What else the null space may have there besides the dimension of the component: where
# two share nothing but a point, their planes span that.
MOST_WIDER = 2
# Charts over components of five dimensions, over those that surfaces may have, and
# the factor from five dimensions to four, and to three. They are not measured, which takes
# most of the time of a surface, and the more dimensions, the longer a cell takes to cut.
OF_FIVE, FEWER = 1, 2.5
# Random starts by which it is checked that their charts leave no gaps, and distance from
# bounds, over the scale, within which that is not asked.
CHECKS, BESIDE_BOUNDS = 1000, 1e-3
# Distance from a chart's centre at which its singular point is looked for: over the
# chart's radius, which counts as no smaller than a share of the problem's scale.
REACH = 4.0
SMALLEST_RADIUS = 0.05
# Distance of a known curve, over the radius of a chart, at which a crossing is on it.
BESIDE = 1.5
# Of the reach: a point that is located no better lies on a curve of such points.
BLURRED = 0.1
# Along such a curve there is nothing to locate, and that is all that the error says:
# the error across it, over the scale, is at most this.
ACROSS = 1e-6
# Distance, over the scale, and over the error of a point, below which two singular points
# of surfaces are one.
APART, ERRORS = 1e-5, 10
# How far beside a singular point of such a surface it is looked for, over the scale, and
# how often.
PROBE, PROBES = 1e-2, 3


def _is_on_curve(problem: Problem, curve: SingularCurve, u: np.ndarray) -> bool:
    """Whether a singular point (n,) of its rank is one of a curve of such points."""
    places, are_solved = RankDeflated(problem, curve.rank).next_to(u[None])
    distance, _ = curve.branch.nearest(places)
    return bool(are_solved[0] and is_same_point(distance[0], problem.domain.scale))


def singular_curve_through(
    problem: Problem,
    components: Components,
    u: np.ndarray,
    rank: int,
    tracing: TraceSettings,
    deadline: Deadline,
) -> SingularCurve | None:
    """The curve of singular points of one ``rank`` on which a singular point ``u`` (n,)
    lies, one that is known or is traced now; None where it lies on none that is regular and can be
    followed to its end."""
    for known in components.notes[2].all_curves():
        if known.rank == rank and _is_on_curve(problem, known, u):
            return known
    if problem.domain.is_large or deadline.passed:
        return None
    deflated = RankDeflated(problem, rank)
    places, are_solved = deflated.next_to(u[None])
    if not are_solved[0]:
        return None
    local = local_dimensions(deflated, places, deadline)
    if local.dimension[0] != 1 or local.nullity[0] != 1 or not local.regular[0]:
        return None
    branch = trace_branch(deflated, places[0], settings=tracing, deadline=deadline)
    # a point beyond a bound starts no curve inside
    if branch.outcome not in WHOLE or not branch.length > 0.0:
        return None
    places = branch.sample(LOOKS)
    if _miss_in_more_digits(problem, places, rank, OFF_CURVE):
        return None  # sheets come near to each other, and do not meet
    return SingularCurve(branch, rank)


def components_of_seeds(
    problem: Problem, points: np.ndarray, values: np.ndarray, deadline: Deadline
) -> Components:
    """The components that those of the seeds ``points`` (k, n) lie on about which the
    solutions are of dimension 2 and more.

    ``values`` (k, n) are the singular values at the seeds. Singular points of surfaces
    are left out: they are looked at one by one.
    """
    components = Components()
    if problem.n < 2:
        return components
    doubtful = np.flatnonzero(may_be_null(values[:, problem.n - 2]))
    local = local_dimensions(problem, points[doubtful], deadline)
    for dimension in np.unique(local.dimension[local.dimension >= 2]):
        # of singular points at a bound, what leaves the region may be all of it
        is_sample = (dimension > 2) & ~problem.domain.are_at_bounds(points[doubtful])
        is_sample |= local.nullity == dimension
        numbers = doubtful[(local.dimension == dimension) & is_sample]
        if len(numbers):
            components.seeds[int(dimension)] = numbers.tolist()
    if 2 not in components.seeds and not problem.domain.is_large:
        deflated = RankDeflated(problem, problem.n - NULLITY)
        # about these fewer solutions may lie than fill the null space
        is_open = (local.nullity == NULLITY) & (local.dimension < NULLITY)
        numbers = doubtful[is_open]
        on_surfaces = _are_on_surfaces(deflated, points[numbers], deadline)
        if np.any(on_surfaces):
            rest = np.setdiff1d(doubtful, numbers[on_surfaces])
            singular = rest[may_be_singular(values[rest, problem.n - NULLITY - 1])]
            is_next = _are_next_to_surfaces(deflated, points[singular], deadline)
            numbers = np.concatenate([numbers[on_surfaces], singular[is_next]])
            components.seeds[2] = numbers.tolist()
            components.deflated = deflated
    if components.deflated is None:
        on_shaky = (local.dimension == 2) & local.shaky
        components.on_shaky = doubtful[on_shaky].tolist()
    return components


def recognise_products(
    components: Components,
    problem: Problem,
    points: np.ndarray,
    tracing: TraceSettings,
    deadline: Deadline,
) -> None:
    """Find which of the components on which seeds ``points`` (k, n) lie are products."""
    for dimension in components.seeds:
        is_double = dimension == 2 and components.deflated is not None
        if is_double or problem.domain.is_large or deadline.passed:
            continue
        samples = components.samples(points, dimension)
        share = deadline.share(RECOGNISING)
        products = products_among(problem, samples, dimension, tracing, share)
        if products.components:
            components.products[dimension] = products


def cover_components(
    components: Components,
    problem: Problem,
    points: np.ndarray,
    charts: int,
    deadline: Deadline,
) -> list[int]:
    """Numbers of the seeds that turn out to lie on no surface: no chart fits about
    any of them.

    Up to ``charts`` charts are made over the surfaces on which those of the seeds
    ``points`` (k, n) lie, and, in about the time that these take, over components of
    each higher dimension. Where the covering is unfinished, the seeds beside the charts
    walk over the component to find out which they belong to.
    """
    if charts <= 0:
        return []
    for dimension in sorted(components.seeds):
        samples = components.samples(points, dimension)
        if deadline.passed:
            return []
        if dimension > 2:
            samples = solutions_beside(problem, samples, dimension)
        covering = _covered(components, problem, samples, dimension, charts, deadline)
        if covering is not None and len(covering):
            _take_charts(components, problem, samples, covering, deadline)
        elif covering is not None and dimension == 2:
            is_known = bool(components.are_on_products(2).any())
            return [] if deadline.passed or is_known else components.seeds.pop(2)
    return []


def _take_charts(
    components: Components,
    problem: Problem,
    samples: np.ndarray,
    covering: ChartAtlas,
    deadline: Deadline,
) -> None:
    """Record the charts over components of a dimension, and on which part of them each of
    the ``samples`` (k, n) lies."""
    dimension = covering.dimension
    regular = problem
    if dimension == 2 and components.deflated is not None:
        regular = components.deflated
        if covering.complete and _are_several(problem, covering):
            covering = replace(covering, outcome=Covering.UNDECIDED)
    # where a walk is cut off, it is not known on which part samples are
    components.part_of[dimension] = np.full(len(samples), -1)
    components.charts[dimension] = covering
    chart = covering.chart_at(samples)
    # also beside charts that are complete: where surfaces cross they leave slivers
    beside = (chart < 0) & (dimension == 2 or covering.is_finished)
    if dimension > 2:
        beside &= ~components.are_on_products(dimension)
    chart[beside] = reached_charts(regular, covering, samples[beside], deadline)
    part_of = np.where(chart >= 0, covering.part[chart], -1)
    components.part_of[dimension] = part_of
    if not covering.is_finished:
        _join_to_charts(components, regular, samples, dimension, deadline)


def _covered(
    components: Components,
    problem: Problem,
    samples: np.ndarray,
    dimension: int,
    charts: int,
    deadline: Deadline,
) -> ChartAtlas | None:
    """Charts over the components of a ``dimension`` on which the ``samples`` (k, n) lie;
    over surfaces that are products last, and over others that are none: there they show
    nothing that is not known. None where there is no time, or none are made."""
    # what assembles the charts at the end is imported before: an import is not cut off
    import scipy.sparse.csgraph
    import scipy.spatial  # noqa: F401

    from bifurc.surfaces.covering import (
        MOST_DIMENSIONS,
        cover_component,
        cover_surface,
    )

    share = GROWING if dimension == 2 else GROWING_OTHERS
    seconds = share * deadline.left
    if not seconds or dimension > MOST_DIMENSIONS:
        return None
    are_on_products = components.are_on_products(dimension)
    if dimension == 2:
        others_first = np.argsort(are_on_products, kind="stable")
        return cover_surface(
            components.deflated or problem,
            samples[others_first],
            radius=RADIUS,
            charts=charts,
            seconds=seconds,
            metric=_metric_of(problem),
        )
    sigma, _ = null_spaces(problem, samples)
    is_regular = np.count_nonzero(may_be_null(sigma), axis=1) == dimension
    seeds = samples[is_regular & ~are_on_products]
    if not len(seeds) or problem.domain.is_large:
        return None
    most = math.ceil(charts * OF_FIVE * FEWER ** (MOST_DIMENSIONS - dimension))
    made = cover_component(problem, seeds, dimension, charts=most, seconds=seconds)
    has_gaps = not are_on_products.any() and _has_gaps(problem, made, deadline)
    return replace(made, outcome=Covering.UNFIT) if has_gaps else made


def _has_gaps(problem: Problem, covering: ChartAtlas, deadline: Deadline) -> bool:
    """Whether solutions from random starts before a deadline, not just beside bounds, lie
    in no chart of finished components: in narrow corners of the bounds charts may end too
    early."""
    if not covering.is_finished:
        return False
    rng = np.random.default_rng(0)
    drawn = random_seeds(problem, rng, CHECKS, deadline=deadline).points
    if not len(drawn):
        return False
    sigma, _ = null_spaces(problem, drawn)
    nullity = np.count_nonzero(may_be_null(sigma), axis=1)
    depths = -problem.domain.excess(drawn)
    is_inner = depths > BESIDE_BOUNDS * problem.domain.scale
    drawn = drawn[is_inner & (nullity == covering.dimension)]
    return bool(len(drawn)) and not covering.covers(drawn).all()


def _join_to_charts(
    components: Components,
    problem: Problem,
    samples: np.ndarray,
    dimension: int,
    deadline: Deadline,
) -> None:
    """Count ``samples`` (k, n) beside charts that ran out to those parts of them on
    which others lie that they are joined to."""
    part_of = components.part_of[dimension]
    beside = np.flatnonzero((part_of < 0) & ~components.are_on_products(dimension))
    if not len(beside):
        return
    joined = joined_parts(problem, samples, dimension, deadline.share(JOINING))
    for number in beside[joined[beside] >= 0].tolist():
        known = part_of[(joined == joined[number]) & (part_of >= 0)]
        if len(known):
            part_of[number] = np.bincount(known).argmax()


def join_samples(
    components: Components, problem: Problem, points: np.ndarray, deadline: Deadline
) -> None:
    """See which of the seeds ``points`` (k, n) are joined on components that have no
    charts."""
    for dimension in components.seeds:
        is_double = dimension == 2 and components.deflated is not None
        is_charted = dimension in components.charts or is_double
        if is_charted or problem.domain.is_large or deadline.passed:
            continue
        samples = components.samples(points, dimension)
        left = np.flatnonzero(~components.are_on_products(dimension))
        parts = np.full(len(samples), -1)
        share = deadline.share(JOINING)
        parts[left] = joined_parts(problem, samples[left], dimension, share)
        components.joined[dimension] = parts


def _metric_of(problem: Problem) -> np.ndarray:
    """Factors (n,) by which areas are those of the user's unknowns, but for one factor
    for all."""
    if not isinstance(problem, UnitProblem):
        return np.ones(problem.n)
    sizes = problem.own_units.sizes
    metric: np.ndarray = sizes / sizes.max()
    return metric


def _are_several(problem: Problem, charts: ChartAtlas) -> bool:
    """Whether charts along which F' has a lower rank but for rounding may lie between
    sheets that are very near to each other: what of F the rank leaves out vanishes with
    the square of the distance on a double surface, and not between two."""
    step = max(1, len(charts) // LOOKS)
    places = charts.centers[::step]
    return _miss_in_more_digits(problem, places, problem.n - NULLITY, ROUNDING**2)


def _miss_in_more_digits(
    problem: Problem, places: np.ndarray, rank: int, most: float
) -> bool:
    """Whether what of F a ``rank`` leaves out is at some of the places (k, n) more than
    ``most``, over the magnitude; than rounding, where there are no more digits."""
    import mpmath  # it takes longer to import than a small problem to solve

    precise = problem.precise_residual()
    for place in places:
        left, *_ = factors_of(relative_jacobians(problem, place[None]))
        missed = relative_residuals(problem, place[None])[0]
        if precise is not None:
            with mpmath.workdps(DIGITS):
                values = precise([mpmath.mpf(float(x)) for x in place])
            missed = np.array(values, dtype=float) / problem.magnitude
        allowed = ROUNDING if precise is None else most
        if np.linalg.norm(left[0, :, rank:].T @ missed) > allowed:
            return True
    return False


def parts_through(
    components: Components, problem: Problem, point: np.ndarray
) -> list[int]:
    """The parts of the charts on which a singular point (n,) lies; -1 alone where
    there are no charts."""
    if 2 not in components.charts:
        return [-1]
    return [
        k
        for k, part in enumerate(components.charts[2].parts())
        if len(entrances(problem, part, point))
    ]


def _are_on_surfaces(
    deflated: RankDeflated, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Whether solutions (k,) next to ``points`` (k, n) lie on surfaces along which F'
    has the lower rank of the ``deflated`` problem, and no lower one."""
    on_surfaces = np.zeros(len(points), dtype=bool)
    if not len(points) or deadline.passed:
        return on_surfaces
    solutions, are_solved = deflated.next_to(points)
    local = local_dimensions(deflated, solutions[are_solved], deadline)
    is_surface = (local.dimension == 2) & (local.nullity == 2) & local.regular
    on_surfaces[are_solved] = is_surface
    return on_surfaces


def _are_next_to_surfaces(
    deflated: RankDeflated, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Whether singular solutions ``points`` (k, n) have solutions beside them, as far as
    a probe goes, that lie on such surfaces."""
    is_next = np.zeros(len(points), dtype=bool)
    rng = np.random.default_rng(0)
    for _ in range(PROBES):
        steps = rng.normal(size=points.shape)
        steps *= PROBE * deflated.domain.scale / np.linalg.norm(steps, axis=1)[:, None]
        ends, gaps = deflated.project(points + steps)
        beside = np.linalg.norm(deflated.domain.difference(ends, points), axis=1)
        is_near = closes_to_rounding(gaps) & (
            beside < 2 * PROBE * deflated.domain.scale
        )
        waiting = np.flatnonzero(is_near & ~is_next)
        is_next[waiting] = _are_on_surfaces(deflated, ends[waiting], deadline)
    return is_next


class SurfacePoint(NamedTuple):
    """A ``located`` singular point of a surface, and whether it ``is_sample`` of a
    curve of such points."""

    located: LocatedPoint
    is_sample: bool


def singular_points_of(
    problem: Problem, components: Components, deadline: Deadline
) -> Iterator[SurfacePoint]:
    """Points of components of dimension d that charts cover where the rank of F' is
    lower than n - d, of each dimension nothing twice.

    They are looked for at the charts where the smallest regular singular value is
    smaller than at all neighbours, the clearest first, and then between charts among
    which it passes through zero; at most `MOST_POINTS`, and `MOST_SAMPLES` of those
    that form curves; of more dimensions than two, at `MOST_LOOKS` charts. At how many
    places none was looked for becomes a note on the component.
    """
    for dimension, charts in components.charts.items():
        is_double = dimension == 2 and components.deflated is not None
        if problem.n <= dimension or is_double:
            continue
        candidates = _lowest_charts(problem, charts)
        points: list[SurfacePoint] = []
        looked_at = samples = 0
        for chart in candidates:
            is_enough = len(points) >= MOST_POINTS
            is_enough |= dimension > 2 and looked_at >= MOST_LOOKS
            if deadline.passed or is_enough:
                break
            looked_at += 1
            place, radius = charts.centers[chart], float(charts.radii[chart])
            point = _point_next_to(problem, place, radius, dimension)
            if point is None or (point.is_sample and samples >= MOST_SAMPLES):
                continue
            if not _is_listed(problem, points, point):
                points.append(point)
                samples += point.is_sample
        unseen = charts.part[candidates[looked_at:]]
        components.notes[dimension].places.update(unseen.tolist())
        yield from points


def crossings_beside_curves(
    problem: Problem, components: Components, deadline: Deadline
) -> Iterator[SurfacePoint]:
    """Samples of curves in which a charted surface crosses itself or another, off the
    curves of singular points that are known when they are asked for; at most
    `MOST_SAMPLES`.

    Where no equation is redundant F' changes its orientation on a sheet only in curves
    of singular points. Where there are none, charts went over to another sheet, and the
    surface is `Covering.UNDECIDED`.
    """
    charts = components.charts.get(2)
    if charts is None or problem.n < NULLITY or components.deflated is not None:
        return
    is_redundant = problem.jacobians(charts.centers[:1]).shape[1] > problem.n - 2
    samples = 0
    crossings = sign_changes(problem, charts)
    radii = np.array([charts.radii[crossing.pair].max() for crossing in crossings])
    # where charts are large no other singular point is near
    for k in np.argsort(-radii, kind="stable"):
        if deadline.passed:
            return
        crossing, radius = crossings[k], float(radii[k])
        if components.notes[2].is_beside_curve(crossing.place, BESIDE * radius):
            continue
        point = None
        if not is_redundant:
            point = _crossing_next_to(problem, crossing.place, radius)
        if point is None:
            point = _point_next_to(problem, crossing.place, radius, 2)
        if point is not None and point.is_sample:
            samples += 1
            if samples <= MOST_SAMPLES:
                yield point
        elif not is_redundant:
            components.charts[2] = replace(charts, outcome=Covering.UNDECIDED)
            return


def _crossing_next_to(
    problem: Problem, place: np.ndarray, radius: float
) -> SurfacePoint | None:
    """The point of a curve of singular points next to a ``place`` (n,) between charts
    of a ``radius``: where F = 0 and F' has no higher rank, which has no need to go to
    where the curve itself is singular."""
    points, gaps = RankDeflated(problem, problem.n - NULLITY).project(place[None])
    distance = float(np.linalg.norm(problem.domain.difference(points[0], place)))
    if not closes_to_rounding(float(gaps[0])) or distance > REACH * radius:
        return None
    null_space = factors_of(problem.jacobians(points)[0]).right[problem.n - NULLITY :].T
    located = LocatedPoint(points[0], null_space, ACROSS * problem.domain.scale)
    return SurfacePoint(located, is_sample=True)


def _point_next_to(
    problem: Problem, place: np.ndarray, radius: float, dimension: int
) -> SurfacePoint | None:
    """The singular point of a component of a ``dimension`` next to a ``place`` (n,) on
    a chart of a ``radius``."""
    reach = REACH * max(radius, SMALLEST_RADIUS * problem.domain.scale)
    most = min(problem.n, dimension + MOST_WIDER)
    nullities = range(dimension + 1, most + 1)
    located = (locate_singular_point(problem, place, k, reach) for k in nullities)
    point = next((one for one in located if one is not None), None)
    if point is None:
        return None
    is_blurred = point.error > BLURRED * reach
    if not (is_blurred or is_on_singular_curve(problem, point)):
        return SurfacePoint(point, is_sample=False)
    error = min(point.error, ACROSS * problem.domain.scale)
    return SurfacePoint(point._replace(error=error), is_sample=True)


def _lowest_charts(problem: Problem, charts: ChartAtlas) -> np.ndarray:
    """Numbers (k,) of the charts at which the smallest regular singular value is small
    and smaller than at all neighbours, the smallest first."""
    sigma = singular_values(problem, charts.centers)[:, -charts.dimension - 1]
    lowest_beside = np.full(len(charts), np.inf)
    one, other = charts.neighbours.T
    np.minimum.at(lowest_beside, one, sigma[other])
    np.minimum.at(lowest_beside, other, sigma[one])
    # the median over the surface: next to singular points there are many small charts
    order = np.argsort(sigma, kind="stable")
    sizes = charts.areas if charts.is_measured else charts.radii**charts.dimension
    covered = np.cumsum(sizes[order])
    middle = np.searchsorted(covered, 0.5 * covered[-1])
    is_small = sigma < SMALL * sigma[order[min(middle, len(order) - 1)]]
    numbers = np.flatnonzero((sigma <= lowest_beside) & is_small)
    return numbers[np.argsort(sigma[numbers], kind="stable")]


def _is_listed(
    problem: Problem, points: list[SurfacePoint], point: SurfacePoint
) -> bool:
    """Whether a point is one of those in a list."""
    u, error = point.located.u, point.located.error
    unit = (APART * problem.domain.scale + ERRORS * error) / is_same_point.threshold
    gaps = [problem.domain.difference(other.located.u, u) for other in points]
    return any(is_same_point(float(np.linalg.norm(gap)), unit) for gap in gaps)


def surfaces_through(
    problem: Problem, surfaces: tuple[Surface, ...], point: np.ndarray
) -> tuple[int, ...]:
    """Indices of the surfaces with charts on which a singular point (n,) of dimension 2
    or more lies."""
    return tuple(
        index
        for index, surface in enumerate(surfaces)
        if surface.charts is not None and len(entrances(problem, surface.charts, point))
    )
