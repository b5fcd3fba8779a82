"""All isolated solutions of as many polynomials as unknowns, along paths.

Every complex one is the end of a path (`bifurc.paths.sparse`); the real ones are those
that are their own conjugates. Sines and cosines of unknowns are coordinates on circles.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from bifurc.completeness import Claim, Level, Scope
from bifurc.decisions import is_plainly_at_infinity
from bifurc.equations.polynomials import (
    PolynomialSystem,
    polynomial_system,
    simplest_ratio,
)
from bifurc.function_problem import FunctionProblem
from bifurc.limits import Deadline
from bifurc.paths.follow import PathEnd, Paths, copy_of
from bifurc.paths.sparse import SparseFamily
from bifurc.search.answer.completeness import SearchClaim

SEED = 28  # of the generic system from which paths begin
MOST_POINTS = 20_000  # with whole turns of angles within bounds


@dataclass(frozen=True, eq=False)
class IsolatedSolutions:
    """What became of the paths to the solutions of a problem.

    ``points`` (k, n) are solutions in the units of the user: all real ones of full
    rank, and then ends of paths that are singular, next to real ones or not. ``real``
    and ``complex`` count those of full rank, angles up to whole turns, ``trace`` is the
    test of the generic ones. ``has_curves``: whether complex ones are not isolated;
    None where that is not known.
    """

    points: np.ndarray
    real: int
    complex: int
    paths: Paths
    trace: float
    has_curves: bool | None

    def claim(self, inside: int) -> Claim:
        """What is said of the isolated solutions, of which so many are ``inside`` the
        bounds."""
        ends = self.paths.ends
        singular = int(np.count_nonzero(ends == PathEnd.SINGULAR))
        lost = int(np.count_nonzero(self.paths.is_lost))
        data = {
            "real": self.real,
            "complex": self.complex,
            "inside": inside,
            "paths": len(ends),
            "trace": self.trace,
        }
        if lost:
            reasons = ", ".join(self.paths.reasons())
            kind, more = SearchClaim.PATHS_LOST, {"lost": lost, "reasons": reasons}
        elif far := self._are_far():
            kind, more = SearchClaim.PATHS_FAR_AWAY, {"far": far}
        elif singular or self.has_curves:
            kind, more = SearchClaim.PATHS_TO_SINGULAR, {"singular": singular}
        elif self.has_curves is None:
            kind, more = SearchClaim.PATHS_LEAVE_CURVES, {}
        else:
            kind = SearchClaim.ALL_ISOLATED
            return kind.claim(Scope.ASSEMBLIES, Level.CERTIFIED, **data)
        return kind.claim(Scope.ASSEMBLIES, Level.ESTIMATED, **data, **more)

    def _are_far(self) -> int:
        """How many paths ended so far away that rounding may hide a solution there."""
        is_far = self.paths.ends == PathEnd.AT_INFINITY
        sizes = np.abs(self.paths.points[is_far]).max(axis=1, initial=1.0)
        return int(np.count_nonzero(~is_plainly_at_infinity(1.0 / sizes)))


def isolated_solutions(
    problem: FunctionProblem, most: int, deadline: Deadline
) -> IsolatedSolutions | None:
    """Those of a problem that has as many polynomials as unknowns, which are angles
    where only their sines and cosines stand there; None where it has not, where the
    trace test failed, or where there are more than ``most`` complex ones."""
    system = _system_of(problem)
    if system is None:
        return None
    family = SparseFamily.of(system.polynomials)
    rng = np.random.default_rng(SEED)
    generic = family.generic_solutions(rng, deadline, most)
    if not generic.are_all or generic.trace is None or generic.count > most:
        return None
    member = family.member(system.polynomials)
    starts = family.with_zeros_of(generic, member, rng, deadline)
    paths = family.follow(starts, member, rng, deadline)
    has_curves = family.has_curves(generic, member, rng, deadline)
    if deadline.passed:
        return None
    regular = paths.regular
    count = len(regular)
    partners = copy_of(np.concatenate([regular, regular.conj()]))[count:]
    real = regular[partners == np.arange(count)].real
    singular = paths.points[paths.ends == PathEnd.SINGULAR].real
    points = system.unknowns(np.concatenate([real, singular]))
    points = _with_turns(points, system, problem.domain.bounds)
    return IsolatedSolutions(points, len(real), count, paths, generic.trace, has_curves)


def _system_of(problem: FunctionProblem) -> PolynomialSystem | None:
    """The equations as polynomials, as many as coordinates."""
    tape = problem.recording.tape
    has_own = type(problem).residuals is not FunctionProblem.residuals
    if tape is None or has_own:
        return None
    system = polynomial_system(tape, simplest_ratio)
    is_circle = np.isfinite(problem.domain.periods)
    if system is None or np.any(is_circle & ~system.are_angles):
        return None
    return system if system.is_square else None


def _with_turns(
    points: np.ndarray, system: PolynomialSystem, bounds: np.ndarray
) -> np.ndarray:
    """The points (k, n) with angles at all whole turns within finite bounds."""
    turn = 2.0 * np.pi
    is_moved = system.are_angles & np.all(np.isfinite(bounds), axis=1)
    found = []
    for point in points:
        first = np.where(is_moved, np.ceil((bounds[:, 0] - point) / turn), 0.0)
        last = np.where(is_moved, np.floor((bounds[:, 1] - point) / turn), 0.0)
        ranges = [
            np.arange(low, high + 1) for low, high in zip(first, last, strict=True)
        ]
        for turns in itertools.islice(itertools.product(*ranges), MOST_POINTS):
            found.append(point + turn * np.array(turns))
    return np.array(found).reshape(-1, points.shape[1])
