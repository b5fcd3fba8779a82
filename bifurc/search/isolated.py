"""All isolated solutions of as many polynomials as unknowns, along paths.

Every complex one is the end of a path (`bifurc.paths.sparse`); the real ones are those
that are their own conjugates. Sines and cosines of unknowns are coordinates on circles.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from bifurc.completeness import Claim, Level, Scope
from bifurc.equations.polynomials import PolynomialSystem
from bifurc.limits import Deadline
from bifurc.paths.follow import Paths, copy_of
from bifurc.paths.sparse import SparseFamily, have_curves
from bifurc.search.answer.completeness import SearchClaim

# Whether points (k, c) all lie on curves.
AreOnCurves: TypeAlias = Callable[[np.ndarray], bool]

SEED = 28  # of the generic system from which paths begin
MOST_POINTS = 20_000  # with whole turns of angles within bounds


@dataclass(frozen=True, eq=False)
class IsolatedSolutions:
    """What became of the paths to the solutions of a problem.

    ``points`` (k, n) are solutions in the units of the user, all real ones of full
    rank, and ``singular`` (j, n) ends of paths, next to real ones or not. ``real``
    and ``complex`` count those of full rank, angles up to whole turns. ``has_curves``:
    whether complex ones are not isolated; None where that is not known.
    """

    points: np.ndarray
    singular: np.ndarray
    real: int
    complex: int
    paths: Paths
    has_curves: bool | None

    def claim(self, inside: int, are_on_curves: AreOnCurves | None = None) -> Claim:
        """What is said of the isolated solutions, of which so many are ``inside`` the
        bounds; ``are_on_curves`` tells of points (k, c) whether all of them lie on
        curves that are known."""
        singular, lost = len(self.paths.singular), self.paths.lost
        data = {
            "real": self.real,
            "complex": self.complex,
            "inside": inside,
            "paths": len(self.paths.ends),
        }
        if lost:
            reasons = ", ".join(self.paths.reasons())
            kind, more = SearchClaim.PATHS_LOST, {"lost": lost, "reasons": reasons}
        elif far := self.paths.far():
            kind, more = SearchClaim.PATHS_FAR_AWAY, {"far": far}
        elif are_on_curves is not None and are_on_curves(self.paths.singular):
            kind = SearchClaim.ALL_ISOLATED_BESIDE_CURVES
            level = Level.CERTIFIED
            return kind.claim(Scope.ASSEMBLIES, level, **data, singular=singular)
        elif singular or self.has_curves:
            kind, more = SearchClaim.PATHS_TO_SINGULAR, {"singular": singular}
        elif self.has_curves is None:
            kind, more = SearchClaim.PATHS_LEAVE_CURVES, {}
        else:
            kind = SearchClaim.ALL_ISOLATED
            return kind.claim(Scope.ASSEMBLIES, Level.CERTIFIED, **data)
        return kind.claim(Scope.ASSEMBLIES, Level.ESTIMATED, **data, **more)


def isolated_solutions(
    system: PolynomialSystem,
    bounds: np.ndarray,
    most: int,
    deadline: Deadline,
    seed: int = SEED,
) -> IsolatedSolutions | None:
    """Those of as many polynomials as coordinates, with angles at all whole turns within
    ``bounds`` (n, 2); None where a generic system has more than ``most``, or not all of
    these were found. The generic system is that of a ``seed``."""
    family = SparseFamily.of(system.polynomials)
    rng = np.random.default_rng(seed)
    paths = family.solve(system.polynomials, rng, deadline, most)
    if paths is None or deadline.passed:
        return None
    has_curves = None
    if not paths.lost:
        has_curves = have_curves(system.polynomials, rng, deadline, most)
    regular = paths.regular
    count = len(regular)
    partners = copy_of(np.concatenate([regular, regular.conj()]))[count:]
    real = regular[partners == np.arange(count)].real
    singular = paths.singular.real
    return IsolatedSolutions(
        points=with_turns(system.unknowns(real), system, bounds),
        singular=with_turns(system.unknowns(singular), system, bounds),
        real=len(real),
        complex=count,
        paths=paths,
        has_curves=has_curves,
    )


def with_turns(
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
