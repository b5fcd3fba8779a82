"""The kind of a singular point: what leaves it, seen in two ways that must agree."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.problem import Problem
from bifurc.singular.locate import LocatedPoint
from bifurc.singular.point import SingularPoint
from bifurc.singular.second_order import second_order_tangents
from bifurc.singular.sphere import Section, section

__all__ = ["classify_singular_point"]

# Radii of the sections, over the scale, in the order in which they are tried: at a
# larger one branches that touch separate, at a smaller one other singular points stay
# outside.
FIRST_RADIUS = 2e-2
OTHER_RADII = (4e-2, 8e-2, 5e-3, 1.25e-3)


def classify_singular_point(problem: Problem, located: LocatedPoint) -> SingularPoint:
    """The located point with its half-branches, tangents and local dimension.

    The half-branches are those of a section with a small sphere, at whose radius and
    at half of it the same is seen; both are larger than the error of the point.
    Tangents of second order are kept where their number agrees with the section.
    """
    cut = _choose_sections(problem, located)
    no_directions = np.empty((0, problem.n))
    half_branches, dimension = no_directions, -1
    if cut.agree:
        half_branches = (cut.outer.points - located.u) / cut.radius
        dimension = cut.outer.dimension
    tangents = second_order_tangents(problem, located.u, located.null_space)
    if not cut.agree or tangents is None or 2 * len(tangents) != len(half_branches):
        order, tangents = 0, no_directions
    else:
        order = 2
    return SingularPoint(
        u=located.u,
        rank=problem.n - located.null_space.shape[1],
        null_space=located.null_space,
        error=located.error,
        half_branches=half_branches,
        tangents=tangents,
        dimension=dimension,
        order=order,
        radius=cut.radius,
    )


class _Sections(NamedTuple):
    """The sections with a sphere of ``radius`` and with one half as large.

    They ``agree`` where both show the same dimension and as many half-branches, and the
    exact point lies inside both spheres; they ``are_clear`` where neither is in doubt.
    """

    radius: float
    outer: Section
    agree: bool
    are_clear: bool


def _choose_sections(problem: Problem, located: LocatedPoint) -> _Sections:
    """The first sections that agree and are clear; else the first that agree; else
    those of the first radius."""
    best = _cut(problem, located, FIRST_RADIUS)
    for radius in OTHER_RADII:
        if best.agree and best.are_clear:
            break
        if radius * problem.scale / 2 < located.error:
            continue  # the exact point may lie outside of the smaller sphere
        cut = _cut(problem, located, radius)
        if cut.agree and (cut.are_clear or not best.agree):
            best = cut
    return best


def _cut(problem: Problem, located: LocatedPoint, radius: float) -> _Sections:
    """The sections at a ``radius`` over the problem's scale, and at half of it."""
    size = radius * problem.scale
    outer = section(problem, located.u, located.null_space, size)
    inner = section(problem, located.u, located.null_space, size / 2)
    same_dimension = outer.dimension == inner.dimension
    same_count = len(outer.points) == len(inner.points)
    holds_point = size / 2 > located.error
    return _Sections(
        radius=size,
        outer=outer,
        agree=same_dimension and same_count and holds_point,
        are_clear=not (outer.doubtful or inner.doubtful),
    )
