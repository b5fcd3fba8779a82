"""Polynomials with given monomials: all isolated solutions of a square system.

The parameters of the family are the coefficients. Each polynomial has a constant besides
its own monomials. So the solutions of all members are one irreducible variety, which a
constant on each fibre parametrises, and every isolated solution of a member is the end
of a path (Li and Wang 1996; Sommese and Wampler 2005, chapter 8). Those of a generic
member are as many as the volume of the mixed cells (`bifurc.paths.mixed_cells`).

The first k polynomials leave nothing but what has the dimension n - k, if the next one
is zero on no part of what the first k - 1 leave. Whether it is shows at the points that
this has in common with generic hyperplanes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np

from bifurc.decisions import solves_all_equations
from bifurc.equations.tape import Operation, TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal, on_patch
from bifurc.paths.follow import PathEnd, Paths, follow_paths, with_affine_ends
from bifurc.paths.homogeneous import (
    Exponents,
    degree_of,
    misfits,
    write_linear,
    write_monomial,
)
from bifurc.paths.mixed_cells import MixedCells
from bifurc.paths.monodromy import Fibre

TRIES = 3  # to follow all paths to generic solutions, each with other numbers
FEW = 32  # paths that are followed faster than a generic member is solved


@dataclass(frozen=True)
class SparseFamily:
    """n polynomials in n unknowns, each with the monomials of its support, the constant
    first. Parameters are all coefficients, polynomial by polynomial."""

    supports: tuple[tuple[Exponents, ...], ...]

    @staticmethod
    def of(polynomials: Sequence[Mapping[Exponents, complex]]) -> SparseFamily:
        """The family with the monomials of ``polynomials``, and constants."""
        constant = (0,) * len(polynomials)
        ordered = [(constant, *sorted(set(one) - {constant})) for one in polynomials]
        return SparseFamily(tuple(ordered))

    @property
    def n(self) -> int:
        """The number of unknowns."""
        return len(self.supports)

    @cached_property
    def lowering(self) -> Family:
        """The polynomials with each coefficient times exp(-h), h its height; the
        parameters are all coefficients, and then all -h."""
        writer = TapeWriter(self.n + 2 * self.coefficients)
        slots = map(writer.unknown, range(writer.n))
        unknowns = list(islice(slots, self.n))
        numbers = list(islice(slots, self.coefficients))
        factors = [
            writer.multiply(number, writer.apply(Operation.EXP, depth))
            for number, depth in zip(numbers, slots, strict=True)
        ]
        outputs = self._written(writer, unknowns, factors)
        return Family(writer.tape(outputs), self.n, has_regular_ends=True)

    @cached_property
    def projective(self) -> Family:
        """The same in homogeneous coordinates, the first of which is zero at infinity,
        on the hyperplane where a linear function of them, its coefficients further
        parameters, is 1."""
        size = self.n + 1
        writer = TapeWriter(size + self.coefficients + size)
        slots = map(writer.unknown, range(writer.n))
        first, *unknowns = islice(slots, size)
        numbers = list(islice(slots, self.coefficients))
        outputs = self._written(writer, unknowns, numbers, first)
        of_plane = list(slots)
        height = write_linear(writer, of_plane, [first, *unknowns])
        outputs.append(writer.subtract(height, writer.constant(1.0)))
        return Family(writer.tape(outputs), size, is_projective=True)

    def _written(
        self,
        writer: TapeWriter,
        unknowns: Sequence[int],
        coefficients: Sequence[int],
        first: int | None = None,
    ) -> list[int]:
        """The slots of the polynomials in slots ``unknowns`` (n), with these slots of
        ``coefficients``; homogeneous with another one."""
        slots = [*unknowns] if first is None else [*unknowns, first]
        factors, outputs = iter(coefficients), []
        for support in self.supports:
            degree = max(map(sum, support))
            total = writer.constant(0.0)
            for exponents in support:
                powers = (*exponents, degree - sum(exponents))[: len(slots)]
                term = write_monomial(writer, next(factors), slots, powers)
                total = writer.add(total, term)
            outputs.append(total)
        return outputs

    @property
    def coefficients(self) -> int:
        """The number of coefficients."""
        return sum(map(len, self.supports))

    def member(self, polynomials: Sequence[Mapping[Exponents, complex]]) -> np.ndarray:
        """The parameters (q,) of ``polynomials``."""
        both = zip(polynomials, self.supports, strict=True)
        return np.array(
            [one.get(term, 0.0) for one, support in both for term in support], complex
        )

    def generic_solutions(
        self, rng: np.random.Generator, deadline: Deadline, most: int
    ) -> Fibre | None:
        """Those of a member with random coefficients; None where there are more than
        ``most``, or not all were found."""
        for _ in range(TRIES):
            cells = MixedCells.of(self.supports, rng, deadline, most)
            if cells is None:
                return None
            numbers = _on_unit_circle(rng, self.coefficients)
            starts, heights = cells.starts(numbers)
            first = np.hstack([np.broadcast_to(numbers, heights.shape), -heights])
            last = np.r_[numbers, np.zeros(self.coefficients)]
            paths = follow_paths(self.lowering, starts, first, last, deadline)
            if np.all(paths.is_regular):
                return Fibre(numbers, paths.points)
        return None

    def solve(
        self,
        polynomials: Sequence[Mapping[Exponents, complex]],
        rng: np.random.Generator,
        deadline: Deadline,
        most: int,
    ) -> Paths | None:
        """The paths to all isolated solutions of ``polynomials`` of the family; None
        where there are more than ``most`` generic ones, or not all were found."""
        generic = self.generic_solutions(rng, deadline, most)
        if generic is None:
            return None
        member = self.member(polynomials)
        starts = self._with_zeros_of(generic, member, rng, deadline)
        return self.follow(starts, member, rng, deadline)

    def _with_zeros_of(
        self,
        generic: Fibre,
        member: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> Fibre:
        """The solutions of a member with random coefficients, but zeros where those (q,)
        of another one are zero; the ``generic`` ones where there are as many, or those
        are not all regular.

        Fewer paths lead from there, and those that still go to infinity do so because
        of what the coefficients are, and not which.
        """
        left = iter((member != 0.0).tolist())
        present = [[one for one in row if next(left)] for row in self.supports]
        count = len(generic.solutions)
        cells = MixedCells.of(present, rng, deadline, count)
        if cells is None or cells.volume == count:
            return generic
        parameters = np.where(member == 0.0, 0.0, _on_unit_circle(rng, len(member)))
        paths = self.follow(generic, parameters, rng, deadline)
        is_at_end = paths.is_regular | (paths.ends == PathEnd.AT_INFINITY)
        if not np.all(is_at_end) or paths.far():
            return generic
        return Fibre(parameters, paths.regular)

    def follow(
        self,
        starts: Fibre,
        member: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> Paths:
        """The paths from the solutions of one member to those of another one."""
        plane = complex_normal(rng, self.n + 1)
        places = on_patch(starts.solutions, plane)
        first, last = (np.r_[one, plane] for one in (starts.parameters, member))
        paths = follow_paths(self.projective, places, first, last, deadline)
        return with_affine_ends(self.projective, paths)


def _on_unit_circle(rng: np.random.Generator, count: int) -> np.ndarray:
    """Complex numbers of size 1."""
    numbers: np.ndarray = np.exp(2j * np.pi * rng.random(count))
    return numbers


def have_curves(
    polynomials: Sequence[Mapping[Exponents, float]],
    rng: np.random.Generator,
    deadline: Deadline,
    most: int,
) -> bool | None:
    """Whether n ``polynomials`` in n unknowns have complex solutions that are not
    isolated; None where that is not known."""
    n = len(polynomials)
    ordered = sorted(polynomials, key=lambda one: (degree_of(one), len(one)))
    units = [(0,) * n, *(tuple(row) for row in np.eye(n, dtype=int).tolist())]
    for count in range(1, n):
        planes = complex_normal(rng, (n - count, n + 1)).tolist()
        linear = [dict(zip(units, plane, strict=True)) for plane in planes]
        given = [*ordered[:count], *linear]
        paths = paths_to_isolated(given, rng, deadline, most, FEW)
        if paths is None or paths.far():
            return None
        points = paths.regular
        if np.any(solves_all_equations(misfits(ordered, points))):
            return True
        are_known = len(points) == np.count_nonzero(paths.is_finite)
        is_zero = solves_all_equations(misfits([ordered[count]], points))
        if not are_known or np.any(is_zero):
            return None
    return False


def paths_to_isolated(
    polynomials: Sequence[Mapping[Exponents, complex]],
    rng: np.random.Generator,
    deadline: Deadline,
    most: int,
    few: int,
) -> Paths | None:
    """The paths to all isolated solutions of as many ``polynomials`` as unknowns: from
    powers where so ``few`` are enough and none is lost, or from a generic member with
    ``most`` solutions; None where it has more or they are not known."""
    if math.prod(map(degree_of, polynomials)) <= few:
        paths = paths_from_powers(polynomials, rng, deadline)
        if not paths.lost:
            return paths
    return SparseFamily.of(polynomials).solve(polynomials, rng, deadline, most)


def paths_from_powers(
    polynomials: Sequence[Mapping[Exponents, complex]],
    rng: np.random.Generator,
    deadline: Deadline,
) -> Paths:
    """The paths to all isolated solutions of n ``polynomials`` in n unknowns from those
    of x^d = 1, d the degree of each (Bezout)."""
    n = len(polynomials)
    degrees = [degree_of(one) for one in polynomials]
    powers = [tuple(row) for row in np.diag(degrees).tolist()]
    given = [
        {power: 0.0, **one} for power, one in zip(powers, polynomials, strict=True)
    ]
    family = SparseFamily.of(given)
    gamma = np.exp(2j * np.pi * rng.random())
    first = family.member([{power: gamma, (0,) * n: -gamma} for power in powers])
    roots = [np.exp(2j * np.pi * np.arange(degree) / degree) for degree in degrees]
    starts = np.array(list(itertools.product(*roots)), dtype=complex)
    return family.follow(Fibre(first, starts), family.member(given), rng, deadline)
