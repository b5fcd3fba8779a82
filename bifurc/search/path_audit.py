"""What paths of complex solutions say of polynomial equations: how many isolated
solutions and curves there are, and where their real parts are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from bifurc.completeness import Claim, Level, Scope
from bifurc.decisions import is_start_solved
from bifurc.function_problem import FunctionProblem
from bifurc.search.answer.completeness import SearchClaim
from bifurc.search.findings import Run
from bifurc.search.own_units.unit_problem import UnitProblem
from bifurc.search.point_search import BRANCH_REACH, PointSearch
from bifurc.search.records import Start, half_branch_starts
from bifurc.seeds import Audit, Seeds
from bifurc.settings import USUAL_PATHS

if TYPE_CHECKING:
    from bifurc.domain import Domain
    from bifurc.equations.polynomials import PolynomialSystem
    from bifurc.equations.tape import Tape
    from bifurc.search.curves_by_paths import CountedCurves, CurveCounter
    from bifurc.search.isolated import IsolatedSolutions

Starts: TypeAlias = Iterator[Sequence[Start]]

# How exactly a singular point is known to which paths come, over the scale.
ERROR_OF_SINGULAR = 1e-5
# Coordinates from which on fewer paths are followed: a step of each takes longer with the
# square of their number at least.
SMALL = 8
SAMPLE = 0.37  # of the length of a form: where its curve is looked at
MOST_FORMS = 20  # of which the curves are looked at


class _Isolated(NamedTuple):
    """What is known of isolated ``solutions``, with so many ``inside`` the bounds."""

    solutions: IsolatedSolutions
    inside: int


def system_of(domain: Domain, tape: Tape | None) -> PolynomialSystem | None:
    """The equations of a tape as polynomials in all unknowns of a ``domain``; None where
    they are none."""
    if tape is None:
        return None
    # sympy and flint take longer to import than a small problem to solve
    from bifurc.equations.polynomials import polynomial_system, simplest_ratio

    system = polynomial_system(tape, simplest_ratio)
    if system is None or np.any(np.isfinite(domain.periods) & ~system.are_angles):
        return None
    numbers = {number for number, _ in system.coordinates}
    return system if len(numbers) == len(domain.periods) else None


class PathAudit:
    """The audit of a ``run`` by paths; what it finds are seeds, which ``add_seeds``
    takes."""

    def __init__(
        self, run: Run, points: PointSearch, add_seeds: Callable[[Seeds], None]
    ):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings
        self.points = points
        self.add_seeds = add_seeds
        self.isolated: _Isolated | None = None

    # --- isolated solutions -----------------------------------------------------------

    def count_isolated(self) -> Starts:
        """Take all isolated solutions of as many polynomials as unknowns for seeds, and
        say how many there are."""
        users = self._users()
        system = None if users is None else self._square_system(users)
        if users is None or system is None:
            return
        from bifurc.search.isolated import isolated_solutions  # few searches need it

        most, deadline = self._most_paths(system), self.run.deadline
        found = isolated_solutions(system, users.domain.bounds, most, deadline)
        if found is None:
            return
        inside, gaps = self._inside(found.points)
        self._add(np.concatenate([inside, self._inside(found.singular)[0]]))
        yield []
        findings = self.findings
        solved = int(np.count_nonzero(is_start_solved(gaps)))
        self.isolated = _Isolated(found, solved)
        claim = found.claim(solved)
        has_all = claim.level is Level.CERTIFIED
        moves = bool(findings.traced or findings.components.seeds)
        if has_all and (moves or len(findings.rigid) != solved):
            return  # doubles do not tell them apart, or from what is nearly solved
        findings.set_audit(Audit((claim,), np.empty((0, self.problem.n)), has_all))

    # --- curves -----------------------------------------------------------------------

    def count_curves(self) -> Starts:
        """Say of which degrees the curves of polynomials are, and, where that is open,
        take points on all their real parts for seeds, and hold them against the
        forms."""
        counter = self._counter()
        if counter is None:
            return
        found = counter.count()
        if found is None:
            self._take_claims(self._claims_of_forms(counter))
            return
        claims, is_unbounded = found.claims(), self._is_unbounded()
        parts = (
            counter.points_on_parts(found, is_unbounded) if self._is_open() else None
        )
        if parts is not None and not self.run.is_over:
            points = counter.unknowns(parts.regular)
            singular = counter.unknowns(parts.singular)
            inside, _ = self._inside(points)
            near, _ = self._inside(singular, is_exact=False)
            yield from self._look_at(inside, near)
            unlisted = sum(not self._is_singular_point(place) for place in near)
            unlisted += int(np.count_nonzero(~self._are_listed(inside)))
            beyond = len(points) - len(inside) + len(singular) - len(near)
            claims.append(parts.claim(unlisted, beyond if is_unbounded else 0))
            claims += self._claims_beside_curves(found, counter)
        self._take_claims(claims)

    def _counter(self) -> CurveCounter | None:
        """What counts the curves; None where they are not asked for, or there are
        none."""
        users, findings = self._users(), self.findings
        if users is None or findings.components.seeds or self._has_no_curves():
            return None
        if not self._is_open() and self.run.settings.paths <= USUAL_PATHS:
            return None  # the degrees alone take as long as a simple search
        system = system_of(self.problem.domain, self._tape_of_curves(users))
        if system is None or len(system.polynomials) < len(system.coordinates) - 1:
            return None
        from bifurc.search.curves_by_paths import CurveCounter  # few searches need it

        most, deadline = self._most_paths(system), self.run.deadline
        return CurveCounter(system, self._bounds(), most, deadline)

    def _look_at(self, inside: np.ndarray, near: np.ndarray) -> Starts:
        """Take points (k, n) of real parts for seeds, and look for singular points
        ``near`` others (j, n)."""
        self._add(inside)
        yield []
        for place in near:
            if not self._is_singular_point(place) and not self.run.is_over:
                sighting = self.points.near(place, 2, BRANCH_REACH)
                if sighting is not None and sighting.is_new:
                    yield half_branch_starts(sighting.point)

    def _is_open(self) -> bool:
        """Whether something may still be missing."""
        audit = self.findings.audit
        return audit is None or audit.level is Level.ESTIMATED

    def _take_claims(self, claims: Sequence[Claim]) -> None:
        """Add to what is claimed; what was said of isolated solutions gives way to what
        is said of them now."""
        audit = self.findings.audit
        former = () if audit is None else audit.claims
        if any(claim.scope is Scope.ASSEMBLIES for claim in claims):
            former = tuple(one for one in former if one.scope is not Scope.ASSEMBLIES)
        if former or claims:
            nowhere = np.empty((0, self.problem.n))
            self.findings.set_audit(Audit((*former, *claims), nowhere))

    def _claims_of_forms(self, counter: CurveCounter) -> list[Claim]:
        """What is said of the curves on which the forms lie, where not all are
        counted."""
        middles = [one(SAMPLE * one.length) for one in self.findings.branches]
        if not middles or len(middles) > MOST_FORMS:
            return []
        points = self._outwards(np.array(middles))
        degrees = counter.degrees_through(points)
        if not degrees:
            return []
        kind = SearchClaim.DEGREES_OF_FORMS
        data = {"curves": len(degrees), "degrees": degrees}
        return [kind.claim(Scope.MOTIONS, None, **data)]

    def _claims_beside_curves(
        self, found: CountedCurves, counter: CurveCounter
    ) -> list[Claim]:
        """What is said of isolated solutions beside the curves, where there are more
        equations than these need."""
        system = counter.system
        if len(system.polynomials) < len(system.coordinates):
            return []
        if self.isolated is not None and system.is_square:
            return [
                self.isolated.solutions.claim(
                    self.isolated.inside, partial(counter.are_on, found)
                )
            ]
        kind = SearchClaim.ISOLATED_NOT_COUNTED
        return [kind.claim(Scope.ASSEMBLIES, Level.ESTIMATED)]

    def _has_no_curves(self) -> bool:
        """Whether it is known that there are none."""
        isolated = self.isolated
        return isolated is not None and isolated.solutions.has_curves is False

    # --- the problem ------------------------------------------------------------------

    def _users(self) -> FunctionProblem | None:
        """The user's problem; None where paths are not asked for."""
        problem = self.problem
        users = problem.problem if isinstance(problem, UnitProblem) else problem
        is_asked = self.run.settings.paths > 0 and not self.run.is_over
        has_own = self.findings.book.seeds.audit is not None
        if not is_asked or has_own or not isinstance(users, FunctionProblem):
            return None
        if type(users).residuals is not FunctionProblem.residuals:
            return None
        return users

    def _tape_of_curves(self, users: FunctionProblem) -> Tape | None:
        """The equations of which curves are counted, in the units of the user: those
        with every factor once. None where they have rims."""
        if self.problem.domain.rim is not None:
            return None
        if isinstance(self.problem, UnitProblem):
            return self.problem.tape
        return users.recording.tape

    def _square_system(self, users: FunctionProblem) -> PolynomialSystem | None:
        """The equations as as many polynomials as there are unknowns."""
        tape = users.recording.tape
        if tape is None or tape.m != tape.n:
            return None
        system = system_of(self.problem.domain, tape)
        return system if system and system.is_square else None

    def _most_paths(self, system: PolynomialSystem) -> int:
        """Along how many paths solutions are looked for."""
        share = min(1.0, (SMALL / len(system.coordinates)) ** 2)
        return int(self.run.settings.paths * share)

    def _is_unbounded(self) -> bool:
        """Whether the search chose bounds where there are none."""
        return bool(np.any(self.problem.domain.has_assumed_bounds))

    def _bounds(self) -> np.ndarray:
        """The bounds (n, 2), in the units of the user."""
        return self._outwards(self.problem.domain.bounds.T).T

    def _outwards(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n) of the search in the units of the user."""
        if isinstance(self.problem, UnitProblem):
            return self.problem.own_units.outwards(points)
        return points

    def _inside(
        self, points: np.ndarray, is_exact: bool = True
    ) -> tuple[np.ndarray, np.ndarray]:
        """Those of points (k, n) of the user that are inside the bounds, as the search
        counts them, and where they ``are exact`` corrected; and the residuals."""
        if isinstance(self.problem, UnitProblem):
            points = self.problem.own_units.inwards(points)
        gaps = np.zeros(len(points))
        if is_exact:
            points, gaps = self.problem.project(points)
        is_inside = self.problem.domain.are_inside(points)
        return points[is_inside], gaps[is_inside]

    def _add(self, points: np.ndarray) -> None:
        """Take points (k, n) for seeds."""
        if len(points):
            self.add_seeds(self.findings.book.seeds.with_constructed(points))

    def _is_singular_point(self, place: np.ndarray) -> bool:
        """Whether a singular point is listed where paths come to one, (n,)."""
        error = ERROR_OF_SINGULAR * self.problem.domain.scale
        return self.findings.point_at(place, error) is not None

    def _are_listed(self, points: np.ndarray) -> np.ndarray:
        """Which points (k, n) lie on forms, or are singular points (k,)."""
        are_listed = self.findings.are_on_branches(points)
        for k in np.flatnonzero(~are_listed):
            are_listed[k] = self._is_singular_point(points[k])
        return are_listed
