"""The kind of a singular point: what leaves it, seen in two ways that must agree."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.decisions import settles
from bifurc.problem import Problem
from bifurc.singular.locate import LocatedPoint
from bifurc.singular.point import CROSSING, LONE_POINT, Invariants, SingularPoint
from bifurc.singular.second_order import second_order_tangents
from bifurc.singular.sphere import UNSEEN, Section, Sections

if TYPE_CHECKING:
    from bifurc.singular.germ import Germ  # mpmath takes long to import

# Radii of the sections, over the scale, in the order in which they are tried: at a
# larger one branches that touch separate, at a smaller one other singular points stay
# outside.
FIRST_RADIUS = 2e-2
OTHER_RADII = (4e-2, 8e-2, 5e-3, 1.25e-3)
# Where all of these are in doubt the equations may be known exactly: then branches that
# touch to a higher order are looked at from farther away.
FARTHER_RADII = (0.16, 0.32)


def classify_singular_point(
    problem: Problem,
    located: LocatedPoint,
    within: float = np.inf,
    germ: Germ | None = None,
    sections: Sections | None = None,
) -> SingularPoint:
    """The located point with its half-branches, tangents and local dimension, seen from
    no farther away than ``within``, where other singular points are.

    The half-branches are those of a section with a small sphere, at whose radius and
    at half of it the same is seen; both are larger than the error of the point.
    Tangents of second order are kept where their number agrees with the section. Where
    exact equations give the ``germ``, the section shows its half-branches; where rounding
    hides them from every section, they are those of the germ. Some ``sections`` about the
    point may have been made before.
    """
    if sections is None:
        sections = Sections(problem, located.u, located.null_space)
    count = None if germ is None else len(germ.directions)
    cut = _choose_sections(sections, located.error, within, count)
    no_directions = np.empty((0, problem.n))
    half_branches, dimension = no_directions, -1
    if germ is not None and not cut.are_clear:
        half_branches, dimension = germ.directions, min(len(germ.directions), 1)
    elif cut.agree:
        half_branches = (cut.outer.points - located.u) / cut.radius
        dimension = cut.outer.dimension
    tangents = second_order_tangents(problem, located.u, located.null_space)
    if not cut.agree or tangents is None or 2 * len(tangents) != len(half_branches):
        order, tangents = 0, no_directions
    else:
        order = 2
    point = SingularPoint(
        u=located.u,
        rank=problem.n - located.null_space.shape[1],
        null_space=located.null_space,
        error=located.error,
        half_branches=half_branches,
        tangents=tangents,
        dimension=dimension,
        order=order,
        radius=cut.radius,
        is_clear=germ is not None
        or (cut.agree and cut.are_clear and sections.are_counted(cut.outer)),
        is_confirmed=located.is_confirmed,
        is_through=None if germ is None else germ.is_through,
    )
    if germ is not None:
        return replace(point, invariants=germ.invariants)
    return replace(point, invariants=_second_order_invariants(problem, point))


def _second_order_invariants(
    problem: Problem, point: SingularPoint
) -> Invariants | None:
    """The invariants of a point on curves to which one equation on a plane leads, where
    its second order tells all."""
    equations = len(problem.residuals(point.u[None])[0])
    is_plane = point.null_space.shape[1] == 2 and equations == problem.n - 1
    if point.order != 2 or not is_plane or not 0 <= point.dimension <= 1:
        return None
    return CROSSING if len(point.tangents) else LONE_POINT


def classify_from_nearby(
    problem: Problem, point: SingularPoint, within: float
) -> SingularPoint | None:
    """A singular point classified again from no farther away than ``within``: by clear
    sections, else by its tangents of second order; None where rounding hides them."""
    place = (point.u, point.null_space, point.error, point.is_confirmed)
    located = LocatedPoint(*place)
    closer = classify_singular_point(problem, located, within)
    if closer.is_clear and closer.dimension <= 1:
        return replace(closer, invariants=closer.invariants or point.invariants)
    tangents = second_order_tangents(problem, point.u, point.null_space)
    if tangents is None or not len(tangents) or within < point.error:
        return None
    crossing = replace(
        point,
        half_branches=np.concatenate([tangents, -tangents]),
        tangents=tangents,
        dimension=1,
        order=2,
        radius=within,
    )
    return replace(crossing, invariants=_second_order_invariants(problem, crossing))


class _SectionPair(NamedTuple):
    """The sections with a sphere of ``radius`` and with one half as large.

    They ``agree`` where both show the same dimension and as many half-branches, and the
    exact point lies inside both spheres. They ``are_clear`` where neither is in doubt;
    where the number of half-branches is known, where they agree and show it. Where it
    is not, two half-branches have to settle for the sections to agree.
    """

    radius: float
    outer: Section
    agree: bool
    are_clear: bool


def _choose_sections(
    sections: Sections, error: float, within: float, count: int | None = None
) -> _SectionPair:
    """The first sections, of radii up to ``within``, that agree and are clear; else the
    first that agree; else those of the first radius. Where the ``count`` of half-branches
    is known only those are clear that show it, and they are. The exact point lies within
    the ``error``."""
    problem = sections.problem
    farther = FARTHER_RADII if problem.accuracy.is_exact else ()
    radii = [FIRST_RADIUS, *OTHER_RADII, *farther]
    largest = within / problem.domain.scale
    radii = [radius for radius in radii if radius <= largest]
    if len(radii) < 2:
        radii = [largest, largest / 4]
    best = _cut(sections, error, radii[0], count)
    for radius in radii[1:]:
        if best.agree and best.are_clear:
            break
        if radius * problem.domain.scale / 2 < error:
            continue  # the exact point may lie outside of the smaller sphere
        cut = _cut(sections, error, radius, count)
        if _is_better(cut, best):
            best = cut
    return best


def _is_better(cut: _SectionPair, best: _SectionPair) -> bool:
    """Whether sections say more than the ``best`` ones so far.

    What fills a smaller sphere and not a larger one is rounding: a surface through the
    point meets both.
    """
    if not cut.agree:
        return False
    if not best.agree:
        return True
    is_rounding = (
        cut.radius < best.radius and cut.outer.dimension > best.outer.dimension
    )
    return cut.are_clear and not is_rounding


def _cut(
    sections: Sections, error: float, radius: float, count: int | None
) -> _SectionPair:
    """Of the ``sections`` about a point with an ``error`` those at a ``radius`` over the
    problem's scale, and at half of it; the ``count`` of half-branches may be known."""
    size = radius * sections.problem.domain.scale
    outer = sections.of_radius(size)
    inner = sections.of_radius(size / 2)
    same_dimension = outer.dimension == inner.dimension
    same_count = len(outer.points) == len(inner.points)
    holds_point = size / 2 > error
    is_seen = outer.dimension != UNSEEN
    agree = is_seen and same_dimension and same_count and holds_point
    if count is None:
        agree = agree and _settle(sections.point, outer, inner)
        are_clear = not (outer.doubtful or inner.doubtful)
    else:
        are_clear = agree and len(outer.points) == count
    return _SectionPair(size, outer, agree, are_clear)


def _settle(point: np.ndarray, outer: Section, inner: Section) -> bool:
    """Whether two half-branches of a point (n,) get nearer to one direction, or to
    opposite ones, from a sphere to a smaller one."""
    if not len(outer.points) == len(inner.points) == 2:
        return True
    before = _cosine(outer.points - point)
    after = _cosine(inner.points - point)
    turn = before - after if before > 0 else after - before
    return settles(turn)


def _cosine(pair: np.ndarray) -> float:
    """The cosine of the angle between two vectors (2, n)."""
    one, other = pair
    return float(one @ other / (np.linalg.norm(one) * np.linalg.norm(other)))
