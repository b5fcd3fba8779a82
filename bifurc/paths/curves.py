"""Complex curves of polynomial equations, by the points that hyperplanes have in common
with them.

A generic hyperplane meets a curve in as many points as its degree. They are isolated
solutions of the equations with that of the hyperplane, and ends of paths: from as many
solutions as the product of the degrees (Bezout), or as polynomials with the same
monomials have (`bifurc.paths.sparse`). While the hyperplane moves on a closed way,
points go over to others of the same irreducible curve, and where it moves parallel to
itself their sum is linear over each irreducible curve, and over no part of one
(Sommese, Verschelde and Wampler 2002).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import NamedTuple

import numpy as np

from bifurc.decisions import (
    is_linear_trace,
    is_plainly_linear,
    solves_all_equations,
)
from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal, on_patch
from bifurc.paths.follow import Paths, copy_of, follow_paths, with_affine_ends
from bifurc.paths.homogeneous import (
    Terms,
    degree_of,
    misfits,
    write_homogeneous,
    write_linear,
)
from bifurc.paths.monodromy import Effort, Fibre, Projection, solve_generic, trace_of
from bifurc.paths.sparse import have_curves, paths_to_isolated

QUIET = 6  # closed ways in a row that join no points
CORNERS = 3  # of a closed way


class IrreducibleCurves(NamedTuple):
    """The ``degrees`` of irreducible curves, the largest first, and by how much the sums
    of their points in a hyperplane are not linear while it moves, over their change, the
    largest ``trace``. So many points ``together`` may be of one curve, or of several that
    nearly meet, and count as one; 0 where all is told."""

    degrees: list[int]
    trace: float
    together: int = 0


@dataclass(frozen=True, eq=False)
class CurveEquations:
    """``polynomials`` in n unknowns, n - 1 or more, with curves of solutions."""

    polynomials: tuple[Terms, ...]
    n: int

    def __post_init__(self) -> None:
        if len(self.polynomials) < self.n - 1:
            raise ValueError(
                f"polynomials: {len(self.polynomials)} are not allowed for {self.n} "
                f"unknowns; there must be {self.n - 1} or more"
            )

    @cached_property
    def square(self) -> tuple[Terms, ...]:
        """n - 1 polynomials, where there are more each with generic multiples of those
        of lower degree that are left over: what they solve besides is of dimension
        1."""
        ordered = sorted(self.polynomials, key=degree_of, reverse=True)
        first, others = ordered[: self.n - 1], ordered[self.n - 1 :]
        rng = np.random.default_rng(len(ordered))
        sums = []
        for polynomial in first:
            total = dict(polynomial)
            for other in others:
                factor = float(rng.normal())
                for term, value in other.items():
                    total[term] = total.get(term, 0.0) + factor * value
            sums.append(total)
        return tuple(sums)

    @property
    def degrees(self) -> list[int]:
        """Those of the `square` polynomials."""
        return [degree_of(one) for one in self.square]

    # --- sections ---------------------------------------------------------------------

    @cached_property
    def sections(self) -> Family:
        """The family of the points in hyperplanes, in homogeneous coordinates, where a
        linear function of them is 1; its coefficients and those of the hyperplane, the
        constant first, are the parameters."""
        size = self.n + 1
        writer = TapeWriter(3 * size)
        slots = map(writer.unknown, range(writer.n))
        places = list(islice(slots, size))
        outputs = self.written(writer, places)
        height = write_linear(writer, slots, places)
        outputs.append(writer.subtract(height, writer.constant(1.0)))
        outputs.append(write_linear(writer, slots, places))
        return Family(writer.tape(outputs), size, is_projective=True)

    def written(self, writer: TapeWriter, places: list[int]) -> list[int]:
        """The slots of the polynomials, in homogeneous coordinates in slots ``places``
        (n + 1)."""
        return [
            write_homogeneous(writer, one, places, degree_of(one))
            for one in self.polynomials
        ]

    def section(
        self, plane: np.ndarray, points: np.ndarray, rng: np.random.Generator
    ) -> Fibre:
        """The one with ``points`` (d, n) of a hyperplane with the coefficients ``plane``
        (n + 1,)."""
        patch = complex_normal(rng, self.n + 1)
        return Fibre(np.r_[patch, plane], on_patch(points, patch))

    def points(self, section: Fibre) -> np.ndarray:
        """The points (d, n) of a section."""
        return self.sections.affine(section.solutions)

    def follow(
        self,
        section: Fibre,
        plane: np.ndarray,
        deadline: Deadline,
        farthest: float = np.inf,
    ) -> Paths:
        """The paths of the points of a section to another hyperplane (n + 1,), as in
        `follow_paths`."""
        first = section.parameters
        last = np.r_[first[: self.n + 1], plane]
        starts, family = section.solutions, self.sections
        paths = follow_paths(family, starts, first, last, deadline, farthest=farthest)
        return with_affine_ends(family, paths)

    def whole_section(
        self, rng: np.random.Generator, deadline: Deadline, most: int
    ) -> tuple[Fibre, Paths] | None:
        """A generic section with all its regular points that solve all equations, and
        all paths that lead to such points; None where there would be more than ``most``,
        or it is not known how many."""
        plane = complex_normal(rng, self.n + 1)
        units = [tuple(row) for row in np.eye(self.n, dtype=int).tolist()]
        terms = dict(zip([(0,) * self.n, *units], plane.tolist(), strict=True))
        polynomials = [*self.square, terms]
        paths = paths_to_isolated(polynomials, rng, deadline, most, most)
        if paths is None:
            return None
        # but from powers no path need come to a surface
        is_of_powers = len(paths.ends) == math.prod(self.degrees)
        if (
            not is_of_powers
            and have_curves(polynomials, rng, deadline, most) is not False
        ):
            return None
        solves_all = solves_all_equations(misfits(self.polynomials, paths.points))
        points = paths.points[paths.is_regular & solves_all]
        return self.section(plane, points, rng), paths

    # --- irreducible curves -----------------------------------------------------------

    def irreducible(
        self, section: Fibre, rng: np.random.Generator, deadline: Deadline
    ) -> IrreducibleCurves | None:
        """The irreducible curves with all points of a generic section; None where paths
        were lost, or points are missing."""
        if not len(section.solutions):
            return IrreducibleCurves([], 0.0)
        moved = self._moved(section, deadline)
        if moved is None:
            return None
        group, quiet = np.arange(len(section.solutions)), 0
        while quiet < QUIET and not deadline.passed:
            if not np.any(_are_open(moved, group)):
                break
            joined = self._joined(section, group, rng, deadline)
            quiet = quiet + 1 if np.array_equal(joined, group) else 0
            group = joined
        # those that no way joined, and whose sums are linear only together
        are_open = _are_open(moved, group)
        together = int(np.count_nonzero(are_open))
        if len(np.unique(group[are_open])) < 2:
            together = 0
        group[are_open] = -1
        trace = max(_traces(moved, group).values())
        if not is_linear_trace(trace):
            return None
        degrees = np.unique(group, return_counts=True)[1].tolist()
        return IrreducibleCurves(sorted(degrees, reverse=True), trace, together)

    def _moved(self, section: Fibre, deadline: Deadline) -> np.ndarray | None:
        """The points (3, d, n) of a section, and of those on either side of it; None
        where paths were lost."""
        planes = [self.points(section)]
        for sense in (1.0, -1.0):
            beside = section.parameters[self.n + 1 :].copy()
            beside[0] += sense
            paths = self.follow(section, beside, deadline)
            if not np.all(paths.is_regular):
                return None
            planes.append(paths.points)
        return np.array(planes)

    def _joined(
        self,
        section: Fibre,
        group: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> np.ndarray:
        """The groups (d,) of the points of a section, those as one between which a
        closed way leads."""
        count = len(group)
        stops = complex_normal(rng, (CORNERS - 1, self.n + 1))
        planes = [*stops, section.parameters[self.n + 1 :]]
        patch = section.parameters[: self.n + 1]
        here = section
        is_back = np.ones(count, dtype=bool)
        for plane in planes:
            paths = self.follow(here, plane, deadline)
            is_back &= paths.is_regular
            here = Fibre(np.r_[patch, plane], on_patch(paths.points, patch))
        both = np.concatenate([section.solutions, here.solutions])
        copies = copy_of(both)[count:].tolist()
        joined = group.copy()
        for start, end in enumerate(copies):
            if end < count and is_back[start]:
                joined[joined == joined[start]] = joined[end]
        return joined

    def curve_through(
        self, point: np.ndarray, rng: np.random.Generator, deadline: Deadline, most: int
    ) -> Fibre | None:
        """A section with all points of the irreducible curve through a regular ``point``
        (n,) of it; None where it has more than ``most``, or is not known to have
        all."""
        start = self.section(_plane_through(point, rng), point[None], rng)
        is_plane = np.arange(2 * self.n + 2) > self.n
        try:
            generic = solve_generic(
                self.sections,
                start.solutions[0],
                start.parameters,
                rng,
                Effort.for_solutions(most, deadline),
                most,
                linear_in=self.n + 1,
                projection=Projection(is_plane, ()),
            )
        except ValueError:  # the point is not regular, or not known well enough
            return None
        return generic.fibre if generic.are_all and generic.count <= most else None

    def gap_to(
        self,
        section: Fibre,
        point: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> float:
        """How far from a ``point`` (n,), over 1 + its size, the nearest of the points of
        a section is when the hyperplane has come to a generic one through it."""
        paths = self.follow(section, _plane_through(point, rng), deadline)
        gaps = np.abs(paths.points - point).max(axis=1, initial=0.0)
        return float(gaps.min(initial=np.inf) / (1.0 + np.abs(point).max()))


def _plane_through(point: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A generic hyperplane (n + 1,) through a point (n,)."""
    normal = complex_normal(rng, len(point))
    plane: np.ndarray = np.insert(normal, 0, -(normal @ point))
    return plane


def _traces(moved: np.ndarray, group: np.ndarray) -> dict[int, float]:
    """By how much the sums of the points (3, d, n) of each group, by its number in
    ``group`` (d,), are not linear."""
    numbers = np.unique(group).tolist()
    return {k: trace_of(moved[:, group == k].sum(axis=1)) for k in numbers}


def _are_open(moved: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Which points (d,) are in groups the sums of which are not plainly linear."""
    traces = _traces(moved, group)
    numbers = [k for k, one in traces.items() if not is_plainly_linear(one)]
    are_open: np.ndarray = np.isin(group, numbers)
    return are_open
