"""The curves of solutions of polynomial equations, counted and found whole.

Over the complex numbers they are told by their degrees (`bifurc.paths.curves`). Every
real part of them inside the bounds that is closed holds a critical point of a linear
function, or a singular point (`bifurc.paths.critical`); every other one meets a bound,
which is a hyperplane section. Where there are no bounds, the function is the distance
from a point. What none of these points lies on does not exist. Sines and cosines of
unknowns are coordinates on circles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.completeness import Claim, Level, Scope
from bifurc.decisions import (
    Decision,
    is_real_path_end,
    is_same_point,
    may_be_real_path_end,
)
from bifurc.equations.polynomials import PolynomialSystem
from bifurc.equations.tape import Operation
from bifurc.limits import Deadline
from bifurc.paths.critical import CriticalPoints
from bifurc.paths.curves import CurveEquations, IrreducibleCurves
from bifurc.paths.follow import Paths
from bifurc.paths.monodromy import Fibre
from bifurc.search.answer.completeness import SearchClaim
from bifurc.search.isolated import with_turns

OUTSIDE = 1e3  # reaches from the bounds: paths that end there are of no interest
TRIES = 3  # to follow paths, each from other generic planes
SEED = 29  # of hyperplanes, and of the function that is critical


@dataclass(frozen=True, eq=False)
class CountedCurves:
    """The irreducible ``curves`` of solutions over the complex numbers, all of their
    points in a hyperplane, a ``section``, and the ``paths`` to that. Where some of these
    were lost, or ended far away or at what is not of full rank, it is not all curves."""

    curves: IrreducibleCurves
    section: Fibre
    paths: Paths

    @property
    def is_whole(self) -> bool:
        """Whether these are all curves, and no surface is among the solutions."""
        return not (self.paths.lost or self.paths.far() or len(self.paths.singular))

    def claims(self) -> list[Claim]:
        """What is said of the degrees."""
        curves, paths = self.curves, self.paths
        data = {"curves": len(curves.degrees), "degrees": curves.degrees}
        kind, more = SearchClaim.DEGREES, {"paths": len(paths.ends)}
        if not self.is_whole:
            kind = SearchClaim.OTHER_CURVES
            more["multiple"] = len(paths.singular)
            more["lost"] = paths.lost + paths.far()
        claims = [kind.claim(Scope.MOTIONS, None, trace=curves.trace, **data, **more)]
        if curves.together:
            # points are not told to be of one curve or of several
            kind, together = SearchClaim.MAY_SPLIT, curves.together
            claims.append(kind.claim(Scope.MOTIONS, None, together=together))
        return claims


@dataclass(frozen=True, eq=False)
class PointsOnParts:
    """The ``paths`` to points on all real parts of curves; what is not within ``reach`` is
    of no interest."""

    paths: Paths
    reach: float

    @property
    def regular(self) -> np.ndarray:
        """Real ends (k, c) of full rank."""
        return _real(self.paths.regular, is_real_path_end)

    @property
    def singular(self) -> np.ndarray:
        """Ends (k, c) that may be real points at which the curves are singular."""
        return _real(self.paths.singular, may_be_real_path_end)

    def claim(self, unlisted: int, outside: int) -> Claim:
        """What is said where so many of the points that are inside the bounds are
        ``unlisted``, and so many ``outside`` of bounds that were assumed."""
        lost, far = self.paths.lost, self.paths.far(self.reach)
        data = {"points": len(self.regular), "singular": len(self.singular)}
        data["paths"] = len(self.paths.ends)
        kind, level = SearchClaim.ALL_PARTS, Level.CERTIFIED
        more: dict[str, float] = {"least": is_same_point.threshold}
        if lost or far or unlisted or outside:
            kind, level = SearchClaim.PARTS_OPEN, Level.ESTIMATED
            more = {"lost": lost, "far": far, "unlisted": unlisted, "outside": outside}
        return kind.claim(Scope.MOTIONS, level, **data, **more)


class CurveCounter:
    """Counts the curves of a polynomial ``system`` within ``bounds`` (n, 2) in the units
    of the user, along ``most`` paths at each step."""

    def __init__(
        self,
        system: PolynomialSystem,
        bounds: np.ndarray,
        most: int,
        deadline: Deadline,
        seed: int = SEED,
    ):
        self.system = system
        self.bounds = bounds
        self.most = most
        self.deadline = deadline
        count = len(system.coordinates)
        self.equations = CurveEquations(system.polynomials, count)
        self.rng = np.random.default_rng(seed)

    def count(self) -> CountedCurves | None:
        """All curves; None where more paths would have to be followed, or the trace test
        fails."""
        found = self.equations.whole_section(self.rng, self.deadline, self.most)
        if found is None or self.deadline.passed:
            return None
        section, paths = found
        curves = self.equations.irreducible(section, self.rng, self.deadline)
        if curves is None or self.deadline.passed:
            return None
        return CountedCurves(curves, section, paths)

    # --- real parts -------------------------------------------------------------------

    def points_on_parts(
        self, found: CountedCurves, is_unbounded: bool
    ) -> PointsOnParts | None:
        """Points on all real parts of the curves; None where these are not all, more
        paths lead there, or there was no time. Where paths are lost others are followed.
        Where the system ``is_unbounded`` the function is a distance."""
        of = self.rng.normal(size=self.equations.n)
        function = CriticalPoints(self.equations, of, is_unbounded)
        degree = len(found.section.solutions)
        if not found.is_whole or function.number_of_paths(degree) > self.most:
            return None
        reach = np.inf if is_unbounded else self._reach()
        farthest = OUTSIDE * reach
        for _ in range(TRIES):
            batches = [function.paths(found.section, self.rng, self.deadline, farthest)]
            batches += [
                self.equations.follow(found.section, plane, self.deadline, farthest)
                for plane in self._planes()
            ]
            parts = PointsOnParts(Paths.joined(batches), reach)
            if not parts.paths.lost or self.deadline.passed:
                break
        return None if self.deadline.passed else parts

    def unknowns(self, points: np.ndarray) -> np.ndarray:
        """The unknowns (j, n) at points (k, c), angles at all whole turns within the
        bounds."""
        return with_turns(self.system.unknowns(points), self.system, self.bounds)

    def _reach(self) -> float:
        """The largest coordinate of a point within the bounds."""
        sizes = dict(zip(self.system.coordinates, self.system.sizes, strict=True))
        widest = [
            float(np.abs(self.bounds[number]).max() / size)
            for (number, kind), size in sizes.items()
            if kind is Operation.UNKNOWN
        ]
        return max([1.0, *widest])

    def _planes(self) -> list[np.ndarray]:
        """The hyperplanes (c + 1,) of the bounds; that of an angle goes through the
        origin of its circle."""
        columns = {one: k for k, one in enumerate(self.system.coordinates, start=1)}
        sizes = np.insert(self.system.sizes, 0, 1.0)
        planes = []
        for number, side in np.argwhere(np.isfinite(self.bounds)).tolist():
            value = float(self.bounds[number, side])
            plane = np.zeros(len(sizes), dtype=complex)
            if self.system.are_angles[number]:
                plane[columns[number, Operation.COS]] = np.sin(value)
                plane[columns[number, Operation.SIN]] = -np.cos(value)
            else:
                plane[columns[number, Operation.UNKNOWN]] = 1.0
                plane[0] = -value
            plane *= sizes
            planes.append(plane / np.abs(plane).max())
        return planes

    # --- what lies on curves ----------------------------------------------------------

    def are_on(self, found: CountedCurves, points: np.ndarray) -> bool:
        """Whether points (k, c) all lie on the curves."""
        if not found.is_whole or len(points) > self.most:
            return False
        return all(self._is_on(found.section, point) for point in points)

    def _is_on(self, section: Fibre, point: np.ndarray) -> bool:
        """Whether a point (c,) lies on a curve with the points of a generic section."""
        gap = self.equations.gap_to(section, point, self.rng, self.deadline)
        return bool(may_be_real_path_end(gap))

    def degrees_through(self, points: np.ndarray) -> list[int]:
        """The degrees of the irreducible curves through regular points (k, n), each
        curve once; empty where one of them is not known."""
        known: list[Fibre] = []
        for point in self.system.places(points).astype(complex):
            if any(self._is_on(section, point) for section in known):
                continue
            curve = self.equations.curve_through(
                point, self.rng, self.deadline, self.most
            )
            if curve is None:
                return []
            known.append(curve)
        return sorted((len(section.solutions) for section in known), reverse=True)


def _real(points: np.ndarray, is_real: Decision) -> np.ndarray:
    """The real ones of points (k, c)."""
    sizes = 1.0 + np.abs(points).max(axis=1, initial=0.0)
    imaginary = np.abs(points.imag).max(axis=1, initial=0.0)
    real: np.ndarray = points[is_real(imaginary / sizes)].real
    return real
