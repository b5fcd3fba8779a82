"""The curves of solutions of polynomial equations, counted and found whole.

Over the complex numbers they are told by their degrees (`bifurc.paths.curves`). Every
real part of them inside the bounds that is closed holds a critical point of a linear
function, or a singular point (`bifurc.paths.critical`); every other one meets a bound,
which is a hyperplane section. Where there are no bounds, the function is the distance
from a point. What none of these points lies on does not exist. Sines and cosines of
unknowns are coordinates on circles.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bifurc.completeness import Claim, Level, Scope
from bifurc.decisions import (
    Decision,
    ends_beyond_reach,
    is_plainly_at_infinity,
    is_real_path_end,
    is_same_point,
    may_be_real_path_end,
)
from bifurc.equations.polynomials import PolynomialSystem
from bifurc.equations.tape import Operation
from bifurc.limits import Deadline
from bifurc.paths.critical import CriticalPoints
from bifurc.paths.curves import CurveEquations, HyperplaneSection, IrreducibleCurves
from bifurc.paths.family import complex_normal
from bifurc.paths.follow import PathEnd, Paths
from bifurc.search.answer.completeness import SearchClaim
from bifurc.search.isolated import with_turns

OUTSIDE = 1e3  # reaches from the bounds: paths that end there are of no interest
TRIES = 3  # to follow paths, each from other generic planes
SEED = 29  # of hyperplanes, and of the function that is critical


@dataclass(frozen=True, eq=False)
class CountedCurves:
    """The irreducible ``curves`` of solutions over the complex numbers, to whose points
    in a hyperplane so many ``paths`` lead. Some may have been ``lost``, or have ended so
    ``far`` away that it is not told from infinity; ``multiple`` ones came to points that
    are not of full rank."""

    curves: IrreducibleCurves
    function: CriticalPoints
    paths: int
    lost: int
    far: int
    multiple: int

    @property
    def section(self) -> HyperplaneSection:
        """All points in the hyperplane."""
        nothing = np.empty((0, len(self.curves.plane) - 1), dtype=complex)
        points = np.concatenate([nothing, *self.curves.points])
        return HyperplaneSection(self.curves.plane, points)

    @property
    def is_whole(self) -> bool:
        """Whether these are all curves, and no surface is among the solutions."""
        return not (self.lost or self.far or self.multiple)

    @property
    def data(self) -> dict[str, object]:
        """The numbers that claims state."""
        degrees = self.curves.degrees
        return {
            "curves": len(degrees),
            "degrees": degrees,
            "trace": self.curves.trace,
            "paths": self.paths,
        }

    def degrees_claims(self) -> list[Claim]:
        """What is said of the degrees alone."""
        kind, more = SearchClaim.DEGREES, {}
        if not self.is_whole:
            kind = SearchClaim.OTHER_CURVES
            more = {"multiple": self.multiple, "lost": self.lost + self.far}
        claim = kind.claim(Scope.MOTIONS, None, **self.data, **more)
        return [claim, *self._claims_of_parts()]

    def _claims_of_parts(self) -> list[Claim]:
        """What is said where points are not told to be of one curve or of several."""
        if not self.curves.together:
            return []
        kind, together = SearchClaim.MAY_SPLIT, self.curves.together
        return [kind.claim(Scope.MOTIONS, None, together=together)]

    def claims(self, parts: PointsOnParts, unlisted: int, outside: int) -> list[Claim]:
        """What is said of the real ``parts``, where so many of the points on them that
        are inside the bounds are ``unlisted``, and so many ``outside`` of bounds that
        were assumed."""
        data = self.data
        data["paths"] = self.paths + parts.paths
        if parts.lost or parts.far:
            kind, more = SearchClaim.PARTS_LOST, {"lost": parts.lost, "far": parts.far}
        elif unlisted:
            kind, more = SearchClaim.PARTS_UNLISTED, {"unlisted": unlisted}
        elif outside:
            kind, more = SearchClaim.PARTS_OUTSIDE, {"outside": outside}
        else:
            kind = SearchClaim.ALL_CURVES
            more = {"points": parts.count, "singular": parts.count_singular}
            data["least"] = is_same_point.threshold
        is_whole = kind is SearchClaim.ALL_CURVES
        level = Level.CERTIFIED if is_whole else Level.ESTIMATED
        claim = kind.claim(Scope.MOTIONS, level, **data, **more)
        return [claim, *self._claims_of_parts()]


@dataclass
class PointsOnParts:
    """Ends of paths to points on real parts of curves: batches of ``regular`` and of
    ``singular`` ones (k, c) that are real, how many ``paths`` there were, and how many
    were ``lost`` or ended too ``far`` away to be told from infinity, and not plainly
    beyond what is within ``reach``."""

    reach: float
    regular: list[np.ndarray] = field(default_factory=list)
    singular: list[np.ndarray] = field(default_factory=list)
    paths: int = 0
    lost: int = 0
    far: int = 0

    @property
    def count(self) -> int:
        """How many regular ones there are."""
        return sum(map(len, self.regular))

    @property
    def count_singular(self) -> int:
        """How many singular ones there are."""
        return sum(map(len, self.singular))

    def take(self, paths: Paths) -> None:
        """Add the ends of paths."""
        self.paths += len(paths.ends)
        self.lost += int(np.count_nonzero(paths.is_lost))
        at_infinity = paths.points[paths.ends == PathEnd.AT_INFINITY]
        self.far += int(np.count_nonzero(~_are_away(at_infinity, self.reach)))
        self.regular.append(_real(paths.regular, is_real_path_end))
        singular = paths.points[paths.ends == PathEnd.SINGULAR]
        self.singular.append(_real(singular, may_be_real_path_end))


class CurveCounter:
    """Counts the curves of a polynomial ``system`` within ``bounds`` (n, 2) in the units
    of the user, along ``most`` paths at each step."""

    def __init__(
        self,
        system: PolynomialSystem,
        bounds: np.ndarray,
        most: int,
        deadline: Deadline,
    ):
        self.system = system
        self.bounds = bounds
        self.most = most
        self.deadline = deadline
        count = len(system.coordinates)
        self.equations = CurveEquations(system.polynomials, count)
        self.rng = np.random.default_rng(SEED)

    def count(self, is_unbounded: bool) -> CountedCurves | None:
        """All curves; None where more paths would have to be followed, or the trace test
        fails. Where the system ``is_unbounded`` real parts are told by a distance."""
        found = self.equations.all_points(self.rng, self.deadline, self.most)
        if found is None or self.deadline.passed:
            return None
        plane, paths = found
        is_single = paths.is_regular & self.equations.solve_all(paths.points)
        section = HyperplaneSection(plane, paths.points[is_single])
        curves = self.equations.irreducible(section, self.rng, self.deadline)
        if curves is None or self.deadline.passed:
            return None
        of = self.rng.normal(size=self.equations.n)
        at_infinity = paths.points[paths.ends == PathEnd.AT_INFINITY]
        return CountedCurves(
            curves=curves,
            function=CriticalPoints(self.equations, of, is_unbounded),
            paths=len(paths.ends),
            lost=int(np.count_nonzero(paths.is_lost)),
            far=int(np.count_nonzero(~_are_away(at_infinity, np.inf))),
            multiple=int(np.count_nonzero(paths.ends == PathEnd.SINGULAR)),
        )

    # --- real parts -------------------------------------------------------------------

    def finds_points(self, found: CountedCurves) -> bool:
        """Whether points on all real parts of curves can be found along few enough
        paths."""
        degree = len(found.section.points)
        return found.is_whole and found.function.number_of_paths(degree) <= self.most

    def points_on_parts(self, found: CountedCurves) -> PointsOnParts | None:
        """Points on all real parts of the curves; None where there was no time. Where
        paths are lost others lead there."""
        parts = self._points_on_parts(found)
        for _ in range(TRIES - 1):
            if not parts.lost or self.deadline.passed:
                break
            parts = self._points_on_parts(found)
        return None if self.deadline.passed else parts

    def _points_on_parts(self, found: CountedCurves) -> PointsOnParts:
        parts = PointsOnParts(self._reach(found.function.is_distance))
        farthest = OUTSIDE * parts.reach
        critical, starts = found.function.paths(
            found.section, self.rng, self.deadline, farthest
        )
        parts.lost += int(np.count_nonzero(~starts.is_regular))
        parts.take(critical)
        for plane in self._planes():
            section = found.section
            paths = self.equations.follow(
                section, plane, self.rng, self.deadline, farthest
            )
            parts.take(paths)
        return parts

    def unknowns(self, batches: list[np.ndarray]) -> np.ndarray:
        """The unknowns (k, n) at points (k, c), angles at all whole turns within the
        bounds."""
        nothing = np.empty((0, self.equations.n))
        points = self.system.unknowns(np.concatenate([nothing, *batches]))
        return with_turns(points, self.system, self.bounds)

    def _reach(self, is_unbounded: bool) -> float:
        """The largest coordinate of a point within the bounds; infinite where there are
        none."""
        if is_unbounded:
            return np.inf
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

    def _is_on(self, section: HyperplaneSection, point: np.ndarray) -> bool:
        """Whether a point (c,) lies on a curve with the points of a generic section: one
        of these comes to it when the hyperplane comes to a generic one through it."""
        normal = complex_normal(self.rng, self.equations.n)
        through = np.r_[-(normal @ point), normal]
        paths = self.equations.follow(section, through, self.rng, self.deadline)
        gaps = np.abs(paths.points - point).max(axis=1, initial=0.0)
        return bool(np.any(may_be_real_path_end(gaps / (1.0 + np.abs(point).max()))))

    def degrees_through(self, points: np.ndarray) -> list[int]:
        """The degrees of the irreducible curves through regular points (k, n), each
        curve once; empty where one of them is not known."""
        known: list[HyperplaneSection] = []
        for point in self.system.places(points).astype(complex):
            if any(self._is_on(section, point) for section in known):
                continue
            curve = self.equations.curve_through(
                point, self.rng, self.deadline, self.most
            )
            if curve is None:
                return []
            known.append(HyperplaneSection(curve.plane, curve.points[0]))
        return sorted((len(section.points) for section in known), reverse=True)


def _real(points: np.ndarray, is_real: Decision) -> np.ndarray:
    """The real ones of points (k, c)."""
    sizes = 1.0 + np.abs(points).max(axis=1, initial=0.0)
    imaginary = np.abs(points.imag).max(axis=1, initial=0.0)
    real: np.ndarray = points[is_real(imaginary / sizes)].real
    return real


def _are_away(points: np.ndarray, reach: float) -> np.ndarray:
    """Which ends at infinity (k, c) are farther away than any point within ``reach``."""
    # at infinity a coordinate that is zero is none
    sizes = np.fmax.reduce(np.abs(points), axis=1, initial=1.0)
    are_away: np.ndarray = ends_beyond_reach(reach / sizes)
    if np.isinf(reach):
        are_away = is_plainly_at_infinity(1.0 / sizes)
    return are_away
