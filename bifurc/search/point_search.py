"""From a place where a singular point may lie to the point that is there."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.decisions import (
    closes_to_rounding,
    is_double_assembly,
    is_lost_in_rounding,
    is_precise_enough,
)
from bifurc.numerics.singular_values import singular_values
from bifurc.search.findings import Run
from bifurc.search.records import PointSighting
from bifurc.singular.classify import classify_from_nearby, classify_singular_point
from bifurc.singular.locate import (
    MOST_FOR_GERM,
    LocatedPoint,
    locate_singular_point,
)
from bifurc.singular.point import Kind
from bifurc.singular.sphere import Sections, is_on_surface
from bifurc.system import relative_gaps, relative_jacobians

if TYPE_CHECKING:
    from bifurc.singular.germ import Germ

# Over the problem's scale.
SEED_REACH = 1e-2  # how far from a seed its singular point may lie
BRANCH_REACH = 0.05  # how far from a minimum on a branch its singular point may lie
MOST_MISSED = 6  # places at which a germ is looked for, and is not there
# A point that a curve passes is looked at from so many times nearer, until that shows, and
# from no nearer than so many errors.
NEARER, NEAREST_ERRORS = 4.0, 1e3


class _Settled(NamedTuple):
    """A ``located`` point, and where it is ``exactly``, None where there is none."""

    located: LocatedPoint
    exactly: LocatedPoint | None


class PointSearch:
    """The search for singular points in a ``run``.

    `near` locates one from a place nearby, `sight` classifies a located one. What is
    new joins the findings of the run.
    """

    def __init__(self, run: Run):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings
        self._germs_missed = 0
        self._settled: list[_Settled] = []

    def near(
        self, near: np.ndarray, nullity: int, reach: float, misclosure: float = 0.0
    ) -> PointSighting | None:
        """The singular point of a curve at less than ``reach`` scales from a solution
        ``near`` (n,); ``nullity`` is the most likely one."""
        problem = self.problem
        is_refuted = False
        equations = len(problem.residuals(near[None])[0])
        fewest = max(2, problem.n - equations)
        nullities = {max(nullity, fewest), fewest, fewest + 1}
        for k in sorted(nullities, key=lambda k: abs(k - nullity)):
            if k > problem.n:
                continue
            located = locate_singular_point(
                problem, near, k, reach * problem.domain.scale, misclosure
            )
            if located is None:
                continue
            known = self.findings.point_at(located.u, located.error)
            if known is not None and known.point.dimension == 1:
                return known
            sections = Sections(problem, located.u, located.null_space)
            if not is_on_surface(sections):
                sighting = self._sight_exactly(located, misclosure, sections)
                if sighting is not None:
                    return sighting
                is_refuted = True
        hidden = self.findings.point_hidden_at(near)
        if hidden is not None or is_refuted:
            return hidden
        return self._by_germ(near, reach)

    def _by_germ(self, near: np.ndarray, reach: float) -> PointSighting | None:
        """The singular point at less than ``reach`` scales from a place ``near`` (n,) at
        which rounding hides that F' is regular, if the exact equations have its germ:
        at a point of high order the iteration in doubles does not settle."""
        problem = self.problem
        is_possible = problem.accuracy.is_exact and 2 <= problem.n <= MOST_FOR_GERM
        if not is_possible or self._germs_missed >= MOST_MISSED or self.run.is_over:
            return None
        values = singular_values(problem, near[None])[0]
        if not is_lost_in_rounding(float(values[problem.n - 2])):
            return None
        # mpmath takes longer to import than an ordinary search
        from bifurc.singular.germ import germ_at, placed_at

        _, _, right = np.linalg.svd(relative_jacobians(problem, near[None])[0])
        null_space = right[problem.n - 2 :].T
        place = LocatedPoint(near, null_space, reach * problem.domain.scale)
        germ = germ_at(problem, place)
        moved = np.inf
        if germ is not None:
            moved = float(np.linalg.norm(problem.domain.difference(germ.u, near)))
        if germ is None or moved > reach * problem.domain.scale:
            self._germs_missed += 1
            return None
        located = placed_at(LocatedPoint(near, null_space, moved), germ)
        return self._record(located, germ)

    def at_assembly(self, point: np.ndarray) -> PointSighting | None:
        """The isolated singular point at which two solutions next to
        ``point`` (n,) come together, as far as rounding tells; None where there is
        none."""
        reach = SEED_REACH * self.problem.domain.scale
        located = locate_singular_point(self.problem, point, 1, reach)
        if located is None:
            return None
        gap = float(relative_gaps(self.problem, located.u[None])[0])
        if not closes_to_rounding(gap):
            return None  # beside two that rounding tells apart
        if not is_double_assembly(located.error, self.problem.domain.scale):
            return None  # more than two
        sighting = self._sight_exactly(located)
        if sighting is None or sighting.point.kind is not Kind.ISOLATED:
            return None
        return sighting

    def seen_on_curve(self, sighting: PointSighting) -> PointSighting:
        """A singular point that a curve passes, seen from ever nearer where the sections
        show nothing that leaves it: other singular points may be about."""
        point = sighting.point
        radius = point.radius / NEARER
        while point.dimension == 0 and radius > NEAREST_ERRORS * point.error:
            closer = classify_from_nearby(self.problem, point, radius)
            if closer is not None and len(closer.half_branches):
                self.findings.points[sighting.number] = closer
                return sighting._replace(point=closer, is_new=True)
            radius /= NEARER
        return sighting

    def sight(self, located: LocatedPoint) -> PointSighting:
        """The known singular point that a located one is, or a new one, classified."""
        sighting = self._sight_exactly(located)
        if sighting is None:
            return self._record(located._replace(is_confirmed=False), None)
        return sighting

    def _sight_exactly(
        self,
        located: LocatedPoint,
        misclosure: float = 0.0,
        sections: Sections | None = None,
    ) -> PointSighting | None:
        """The known singular point that a located one is, or a new one, classified;
        None where the exact equations have none there, beside curves with a
        ``misclosure``. Some ``sections`` about it may have been made before."""
        known = self._known(located)
        if known is not None:
            return known
        if closes_to_rounding(misclosure):
            misclosure = 0.0
        exactly, germ = self._in_more_digits(located, misclosure)
        if exactly is None:
            return None
        if exactly is located:
            return self._add(exactly, germ, sections)
        return self._record(exactly, germ)

    def _record(self, located: LocatedPoint, germ: Germ | None) -> PointSighting:
        """The known singular point that a located one is, or a new one, classified; its
        ``germ`` may be known."""
        known = self._known(located)
        return self._add(located, germ) if known is None else known

    def _add(
        self,
        located: LocatedPoint,
        germ: Germ | None,
        sections: Sections | None = None,
    ) -> PointSighting:
        """A located point, classified and recorded; its ``germ`` may be known, and some
        ``sections`` made before."""
        point = classify_singular_point(
            self.problem, located, germ=germ, sections=sections
        )
        return self.findings.add_point(point, germ)

    def _known(self, located: LocatedPoint) -> PointSighting | None:
        """The known singular point that a located one is, or on whose branches it lies
        where doubles lose them."""
        known = self.findings.point_at(located.u, located.error)
        if known is not None or is_precise_enough(
            located.error, self.problem.domain.scale
        ):
            return known
        hidden = self.findings.point_hidden_at(located.u)
        if hidden is None or not self.problem.accuracy.is_exact or self.run.is_over:
            return hidden
        # more digits may show it to be none of those known
        exactly = self._settle(located, 0.0)
        if exactly is None or not exactly.is_confirmed:
            return hidden
        is_other = self.findings.point_at(exactly.u, exactly.error) is None
        return None if is_other else hidden

    def _settle(self, located: LocatedPoint, misclosure: float) -> LocatedPoint | None:
        """What `precisely_located` says of a located point, or said before."""
        before = self._settled_before(located)
        if before is not None:
            return before.exactly
        from bifurc.singular.precise_location import precisely_located

        exactly = precisely_located(self.problem, located, misclosure)
        self._settled.append(_Settled(located, exactly))
        return exactly

    def _settled_before(self, located: LocatedPoint) -> _Settled | None:
        """What is known of a located point that is this one, as far as its error
        tells; None where there is none."""
        for settled in self._settled:
            before = settled.located
            is_same_rank = before.null_space.shape == located.null_space.shape
            apart = np.linalg.norm(self.problem.domain.difference(before.u, located.u))
            if is_same_rank and apart < min(before.error, located.error):
                return settled
        return None

    def _in_more_digits(
        self, located: LocatedPoint, misclosure: float
    ) -> tuple[LocatedPoint | None, Germ | None]:
        """The located point, in more digits where these tell more, None where they tell
        that there is none; and the germ of the curves there, where the exact equations
        give it."""
        if not self.problem.accuracy.is_exact:
            return located, None
        # mpmath takes longer to import than an ordinary search
        from bifurc.singular.precise_location import held_to_exact_equations

        if is_precise_enough(located.error, self.problem.domain.scale):
            return held_to_exact_equations(self.problem, located, misclosure), None
        from bifurc.singular.germ import germ_at, placed_at

        before = self._settled_before(located)
        if before is not None and before.exactly is None:
            return None, None
        germ = germ_at(self.problem, located)
        if germ is None and not self.run.is_over:
            exactly = self._settle(located, misclosure)
            if exactly is None:
                return None, None
            located = exactly
            germ = germ_at(self.problem, located)
        return (located if germ is None else placed_at(located, germ)), germ
