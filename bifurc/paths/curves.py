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

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc.decisions import (
    is_linear_trace,
    is_plainly_linear,
    solves_all_equations,
)
from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.follow import Paths, copy_of, distinct, follow_paths
from bifurc.paths.homogeneous import (
    Terms,
    degree_of,
    misfits,
    number_of_paths,
    write_homogeneous,
    write_linear,
)
from bifurc.paths.sparse import SparseFamily

MOST_LOOPS = 40  # closed ways on which all points of one curve are found
QUIET = 6  # closed ways in a row that join no points
CORNERS = 3  # of a closed way


class HyperplaneSection(NamedTuple):
    """The ``points`` (d, n) that curves have in common with a hyperplane, of which the
    coefficients are ``plane`` (n + 1,), the constant first."""

    plane: np.ndarray
    points: np.ndarray


@dataclass(frozen=True, eq=False)
class IrreducibleCurves:
    """The irreducible curves that meet a hyperplane ``plane`` (n + 1,): the ``points``
    (d, n) of each, and by how much their sums are not linear while it moves, over their
    change, the largest ``trace``. Points ``together`` may be of one curve, or of several
    that nearly meet, and count as one; 0 where all is told."""

    plane: np.ndarray
    points: tuple[np.ndarray, ...]
    trace: float
    together: int = 0

    @property
    def degrees(self) -> list[int]:
        """The degrees of the curves, the largest first."""
        return sorted(map(len, self.points), reverse=True)


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
        linear function of them is 1; its coefficients and those of the hyperplane are
        the parameters."""
        size = self.n + 1
        writer = TapeWriter(3 * size)
        places = [writer.unknown(k) for k in range(size)]
        outputs = [
            write_homogeneous(writer, one, places, degree_of(one))
            for one in self.polynomials
        ]
        outputs += _written_planes(writer, places, size)
        return Family(writer.tape(outputs), size, is_projective=True)

    @cached_property
    def from_powers(self) -> Family:
        """The `square` polynomials in such a hyperplane, times the parameter before the
        last, plus the last one times the powers of one coordinate each."""
        size = self.n + 1
        writer = TapeWriter(3 * size + 2)
        places = [writer.unknown(k) for k in range(size)]
        share, start = writer.unknown(3 * size), writer.unknown(3 * size + 1)
        outputs = []
        for place, one in zip(places[1:], self.square, strict=False):
            degree = degree_of(one)
            power = writer.constant(float(degree))
            before = writer.subtract(
                writer.power(place, power), writer.power(places[0], power)
            )
            given = write_homogeneous(writer, one, places, degree)
            both = writer.add(
                writer.multiply(share, given), writer.multiply(start, before)
            )
            outputs.append(both)
        outputs += _written_planes(writer, places, size)
        return Family(writer.tape(outputs), size, is_projective=True)

    def all_points(
        self, rng: np.random.Generator, deadline: Deadline, most: int
    ) -> tuple[np.ndarray, Paths] | None:
        """A generic hyperplane (n + 1,), and the paths to all points in it that solve
        the `square` polynomials; None where there would be more than ``most``, or it
        is not known how many."""
        plane = complex_normal(rng, self.n + 1)
        if number_of_paths(self.degrees) <= most:
            paths = self._from_powers(plane, rng, deadline)
            if not np.any(paths.is_lost):
                return plane, paths
        others = self._from_generic(plane, rng, deadline, most)
        return None if others is None else (plane, others)

    def _from_powers(
        self, plane: np.ndarray, rng: np.random.Generator, deadline: Deadline
    ) -> Paths:
        """The paths from the roots of unity."""
        roots = [np.exp(2j * np.pi * np.arange(d) / d) for d in self.degrees]
        firsts = np.array(list(itertools.product(*roots)), dtype=complex)
        firsts = firsts.reshape(-1, self.n - 1)
        last = -(plane[0] + firsts @ plane[1 : self.n]) / plane[self.n]
        starts = np.column_stack([firsts, last])
        patch = complex_normal(rng, self.n + 1)
        gamma = np.exp(2j * np.pi * rng.random())
        ends = (np.r_[patch, plane, 0.0, gamma], np.r_[patch, plane, 1.0, 0.0])
        starts = on_patch(starts, patch)
        paths = follow_paths(self.from_powers, starts, *ends, deadline)
        return with_affine_ends(paths, self.n)

    def _from_generic(
        self,
        plane: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
        most: int,
    ) -> Paths | None:
        """The paths from the solutions of polynomials with the same monomials."""
        units = [tuple(row) for row in np.eye(self.n, dtype=int).tolist()]
        terms = dict(zip([(0,) * self.n, *units], plane.tolist(), strict=True))
        family = SparseFamily.of([*self.square, terms])
        generic = family.generic_solutions(rng, deadline, most)
        if not generic.are_all or generic.count > most:
            return None
        member = family.member([*self.square, terms])
        starts = family.with_zeros_of(generic, member, rng, deadline)
        paths = family.follow(starts, member, rng, deadline)
        if family.has_curves(generic, member, rng, deadline) is not False:
            return None
        return paths

    def follow(
        self,
        section: HyperplaneSection,
        plane: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
        farthest: float = np.inf,
    ) -> Paths:
        """The paths of the points of a section to another hyperplane (n + 1,), as in
        `follow_paths`."""
        patch = complex_normal(rng, self.n + 1)
        starts = on_patch(section.points, patch)
        first, last = np.r_[patch, section.plane], np.r_[patch, plane]
        paths = follow_paths(
            self.sections, starts, first, last, deadline, farthest=farthest
        )
        return with_affine_ends(paths, self.n)

    # --- irreducible curves -----------------------------------------------------------

    def solve_all(self, points: np.ndarray) -> np.ndarray:
        """Which points (k, n) solve all polynomials (k,)."""
        return solves_all_equations(misfits(self.polynomials, points))

    def irreducible(
        self,
        section: HyperplaneSection,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> IrreducibleCurves | None:
        """The irreducible curves with all points of a generic section; None where paths
        were lost, or points are missing."""
        if not len(section.points):
            return IrreducibleCurves(section.plane, (), 0.0)
        moved = self._parallel(section, rng, deadline)
        if moved is None:
            return None
        group = np.arange(len(section.points))
        traces = _traces(moved, group)
        quiet = 0
        while quiet < QUIET and not _are_linear(traces) and not deadline.passed:
            joined = self._joined(section, group, rng, deadline)
            quiet = quiet + 1 if np.array_equal(joined, group) else 0
            group, traces = joined, _traces(moved, joined)
        # groups that no way joined, and whose sums are linear only together
        are_open = [k for k, trace in traces.items() if not is_plainly_linear(trace)]
        together = np.isin(group, are_open) & (len(are_open) > 1)
        group[together] = -1
        trace = max(_traces(moved, group).values())
        if not is_linear_trace(trace):
            return None
        points = tuple(section.points[group == k] for k in np.unique(group))
        return IrreducibleCurves(
            section.plane, points, trace, int(np.count_nonzero(together))
        )

    def curve_through(
        self, point: np.ndarray, rng: np.random.Generator, deadline: Deadline, most: int
    ) -> IrreducibleCurves | None:
        """The irreducible curve through a regular ``point`` (n,) of it; None where it
        has more than ``most`` points in a hyperplane, or is not known to have all."""
        normal = complex_normal(rng, self.n)
        through = np.r_[-(normal @ point), normal]
        section = HyperplaneSection(through, point.astype(complex)[None])
        plane = complex_normal(rng, self.n + 1)
        points = self.follow(section, plane, rng, deadline).regular
        for _ in range(MOST_LOOPS):
            if not 0 < len(points) <= most or deadline.passed:
                break
            section = HyperplaneSection(plane, points)
            moved = self._parallel(section, rng, deadline)
            if moved is not None and is_linear_trace(_trace(moved)):
                return IrreducibleCurves(plane, (points,), _trace(moved))
            back = self._round_trip(section, rng, deadline)
            points = distinct(np.concatenate([points, back.regular]))
        return None

    def _parallel(
        self,
        section: HyperplaneSection,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> np.ndarray | None:
        """The points (3, d, n) of a section, and of those on either side of it; None
        where paths were lost."""
        planes = [section.points]
        for sense in (1.0, -1.0):
            beside = section.plane.copy()
            beside[0] += sense
            paths = self.follow(section, beside, rng, deadline)
            if not np.all(paths.is_regular):
                return None
            planes.append(paths.points)
        return np.array(planes)

    def _round_trip(
        self,
        section: HyperplaneSection,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> Paths:
        """Where the points of a section come to when the hyperplane has moved on a
        closed way."""
        stops = complex_normal(rng, (CORNERS - 1, self.n + 1))
        here = section
        for plane in stops:
            paths = self.follow(here, plane, rng, deadline)
            here = HyperplaneSection(plane, paths.points)
        return self.follow(here, section.plane, rng, deadline)

    def _joined(
        self,
        section: HyperplaneSection,
        group: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> np.ndarray:
        """The groups (d,) of the points of a section, those as one between which a
        closed way leads."""
        count = len(group)
        back = self._round_trip(section, rng, deadline)
        copies = copy_of(np.concatenate([section.points, back.points]))[count:]
        joined = group.copy()
        for start, end in enumerate(copies.tolist()):
            if end < count and back.is_regular[start]:
                joined[joined == joined[start]] = joined[end]
        return joined


def on_patch(points: np.ndarray, patch: np.ndarray) -> np.ndarray:
    """Points (k, n) in homogeneous coordinates (k, n + 1) of which a linear function
    with the coefficients ``patch`` (n + 1,) is 1."""
    places = np.insert(points.astype(complex), 0, 1.0, axis=1)
    scaled: np.ndarray = places / (places @ patch)[:, None]
    return scaled


def with_affine_ends(paths: Paths, n: int) -> Paths:
    """Paths with their ends (k, n) no longer in homogeneous coordinates, which the
    first n + 1 of them are."""
    with np.errstate(all="ignore"):
        points = paths.points[:, 1 : n + 1] / paths.points[:, :1]
    return replace(paths, points=points)


def _written_planes(writer: TapeWriter, places: Sequence[int], first: int) -> list[int]:
    """The slots of a linear function of ``places`` less 1, and of another one, with the
    unknowns from ``first`` on as coefficients."""
    size = len(places)
    patch = [writer.unknown(first + k) for k in range(size)]
    plane = [writer.unknown(first + size + k) for k in range(size)]
    one = writer.constant(1.0)
    height = writer.subtract(write_linear(writer, patch, places), one)
    return [height, write_linear(writer, plane, places)]


def _trace(moved: np.ndarray) -> float:
    """By how much the sum of points (3, d, n), here, ahead and behind, is not linear,
    over its change."""
    here, ahead, behind = moved.sum(axis=1)
    change = max(np.abs(ahead - here).max(), np.abs(behind - here).max(), 1.0)
    return float(np.abs(ahead - 2.0 * here + behind).max() / change)


def _traces(moved: np.ndarray, group: np.ndarray) -> dict[int, float]:
    """That of the points (3, d, n) of each group, by its number in ``group`` (d,)."""
    return {k: _trace(moved[:, group == k]) for k in np.unique(group).tolist()}


def _are_linear(traces: dict[int, float]) -> bool:
    """Whether the sums of all groups are linear."""
    return is_plainly_linear(max(traces.values()))
