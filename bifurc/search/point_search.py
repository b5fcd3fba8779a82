"""From a place where a singular point may lie to the point that is there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bifurc.decisions import closes_to_rounding, is_precise_enough
from bifurc.search.findings import PointSighting
from bifurc.search.run import Run
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import LocatedPoint, locate_singular_point
from bifurc.singular.point import Kind
from bifurc.singular.sphere import is_on_surface

if TYPE_CHECKING:
    from bifurc.singular.germ import Germ

__all__ = ["BRANCH_REACH", "SEED_REACH", "PointSearch"]

# Over the problem's scale.
SEED_REACH = 1e-2  # how far from a seed its singular point may lie
BRANCH_REACH = 0.05  # how far from a minimum on a branch its singular point may lie


class PointSearch:
    """The search for singular points in a ``run``.

    `near` locates one from a place nearby, `sight` classifies a located one. What is
    new joins the findings of the run.
    """

    def __init__(self, run: Run):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings

    def near(
        self, near: np.ndarray, nullity: int, reach: float, misclosure: float = 0.0
    ) -> PointSighting | None:
        """The singular point of a curve at less than ``reach`` scales from a solution
        ``near`` (n,); ``nullity`` is the most likely one."""
        problem = self.problem
        hidden = self.findings.point_hidden_at(near)
        if hidden is not None:
            return hidden
        nullities = {max(nullity, 2), 2, 3}
        for k in sorted(nullities, key=lambda k: abs(k - nullity)):
            if k > problem.n:
                continue
            located = locate_singular_point(
                problem, near, k, reach * problem.scale, misclosure
            )
            if located is None:
                continue
            known = self.findings.point_at(located.u, located.error)
            if known is not None and known.point.dimension == 1:
                return known
            if not is_on_surface(problem, located.u):
                return self.sight(located)
        return None

    def at_assembly(self, point: np.ndarray) -> int | None:
        """The number of the isolated singular point at which solutions next to
        ``point`` (n,) come together, as far as rounding tells; None where there is
        none."""
        reach = SEED_REACH * self.problem.scale
        located = locate_singular_point(self.problem, point, 1, reach)
        if located is None:
            return None
        gap = float(self.problem.gaps(located.u[None])[0])
        if not closes_to_rounding(gap):
            return None  # beside two that rounding tells apart
        sighting = self.sight(located)
        return sighting.number if sighting.point.kind is Kind.ISOLATED else None

    def sight(self, located: LocatedPoint) -> PointSighting:
        """The known singular point that a located one is, or a new one, classified."""
        known = self._known(located)
        if known is not None:
            return known
        located, germ = self._in_more_digits(located)
        known = self._known(located)
        if known is not None:
            return known
        point = classify_singular_point(self.problem, located, germ=germ)
        if germ is not None:
            self.findings.add_germ(germ)
        return self.findings.add_point(point)

    def _known(self, located: LocatedPoint) -> PointSighting | None:
        """The known singular point that a located one is, or on whose branches it lies
        where doubles lose them."""
        known = self.findings.point_at(located.u, located.error)
        if known is not None or is_precise_enough(located.error, self.problem.scale):
            return known
        return self.findings.point_hidden_at(located.u)

    def _in_more_digits(
        self, located: LocatedPoint
    ) -> tuple[LocatedPoint, Germ | None]:
        """The located point, in more digits where these tell more, and the germ of the
        curves there, where the exact equations give it."""
        is_open = not is_precise_enough(located.error, self.problem.scale)
        if not (is_open and self.problem.is_exact):
            return located, None
        # mpmath takes longer to import than an ordinary search
        from bifurc.singular.germ import germ_at, placed_at
        from bifurc.singular.precise_location import precisely_located

        germ = germ_at(self.problem, located)
        if germ is None and not self.run.is_over:
            located = precisely_located(self.problem, located)
            germ = germ_at(self.problem, located)
        return (located if germ is None else placed_at(located, germ)), germ
