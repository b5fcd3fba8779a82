"""Polynomials with given monomials: all isolated solutions of a square system.

The parameters of the family are the coefficients. Each polynomial has, besides its own
monomials, a constant and the unknowns themselves. So the solutions of all members are
one irreducible variety, which a constant on each fibre parametrises, and every isolated
solution of a member is the end of a path (Sommese and Wampler 2005, chapter 8). All
polynomials but one leave an irreducible curve, on which the last one, while its constant
moves, is a hyperplane that moves parallel to itself: the sum of the solutions is linear
in that constant (the trace test, as in `bifurc.paths.monodromy`).

A component of solutions of dimension k meets k generic hyperplanes. These are zero at
isolated solutions of the polynomials plus generic multiples of the hyperplanes
(Sommese and Verschelde 2000), and that is a member of the same family.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc.decisions import solves_all_equations
from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal, on_patch
from bifurc.paths.follow import PathEnd, Paths, follow_paths, with_affine_ends
from bifurc.paths.homogeneous import (
    Exponents,
    degree_of,
    write_linear,
    write_monomial,
)
from bifurc.paths.monodromy import Fibre, GenericSolutions, solve_generic


class SolvedPolynomials(NamedTuple):
    """The ``paths`` to all isolated solutions of polynomials, by how much the test of the
    generic ones from which they begin failed, ``trace``, and whether there are complex
    solutions that are not isolated, ``has_curves``; None where that is not known."""

    paths: Paths
    trace: float
    has_curves: bool | None


@dataclass(frozen=True)
class SparseFamily:
    """n polynomials in n unknowns, each with the monomials of its support: the constant,
    the unknowns in order, and others. Parameters are all coefficients, polynomial by
    polynomial."""

    supports: tuple[tuple[Exponents, ...], ...]

    @staticmethod
    def of(polynomials: Sequence[Mapping[Exponents, complex]]) -> SparseFamily:
        """The family with the monomials of ``polynomials``."""
        n = len(polynomials)
        always = [(0,) * n, *(tuple(row) for row in np.eye(n, dtype=int).tolist())]
        return SparseFamily(
            tuple(
                (*always, *sorted(set(polynomial) - set(always)))
                for polynomial in polynomials
            )
        )

    @property
    def n(self) -> int:
        """The number of unknowns."""
        return len(self.supports)

    @cached_property
    def family(self) -> Family:
        """The polynomials on a tape."""
        writer = TapeWriter(self.n + self.coefficients)
        unknowns = [writer.unknown(number) for number in range(self.n)]
        return Family(writer.tape(self._written(writer, unknowns)), self.n)

    @cached_property
    def projective(self) -> Family:
        """The same in homogeneous coordinates, the first of which is zero at infinity,
        on the hyperplane where a linear function of them, its coefficients further
        parameters, is 1."""
        size = self.n + 1
        writer = TapeWriter(size + self.coefficients + size)
        first, *unknowns = (writer.unknown(number) for number in range(size))
        outputs = self._written(writer, unknowns, first)
        of_plane = map(writer.unknown, range(size + self.coefficients, writer.n))
        height = write_linear(writer, of_plane, [first, *unknowns])
        outputs.append(writer.subtract(height, writer.constant(1.0)))
        return Family(writer.tape(outputs), size, is_projective=True)

    def _written(
        self, writer: TapeWriter, unknowns: Sequence[int], first: int | None = None
    ) -> list[int]:
        """The slots of the polynomials in slots ``unknowns`` (n), with the coefficients
        after them; homogeneous with another one."""
        slots = [*unknowns] if first is None else [*unknowns, first]
        number = len(slots)
        outputs = []
        for support in self.supports:
            degree = max(map(sum, support))
            total = writer.constant(0.0)
            for exponents in support:
                powers = (*exponents, degree - sum(exponents))[: len(slots)]
                term = write_monomial(writer, writer.unknown(number), slots, powers)
                total = writer.add(total, term)
                number += 1
            outputs.append(total)
        return outputs

    @property
    def coefficients(self) -> int:
        """The number of coefficients."""
        return sum(map(len, self.supports))

    @cached_property
    def constants(self) -> np.ndarray:
        """The numbers (n,) of the parameters that are constants."""
        sizes = [len(support) for support in self.supports]
        first: np.ndarray = np.cumsum([0, *sizes[:-1]])
        return first

    def member(self, polynomials: Sequence[Mapping[Exponents, complex]]) -> np.ndarray:
        """The parameters (q,) of ``polynomials``."""
        both = zip(polynomials, self.supports, strict=True)
        return np.array(
            [one.get(term, 0.0) for one, support in both for term in support], complex
        )

    def generic_solutions(
        self, rng: np.random.Generator, deadline: Deadline, most: int
    ) -> GenericSolutions:
        """Those of a member with random coefficients; more than ``most`` are not
        looked for."""
        start = complex_normal(rng, self.n)
        parameters = complex_normal(rng, self.family.parameters)
        parameters[self.constants] -= self.family.residuals(start[None], parameters)[0]
        return solve_generic(
            self.family, start, parameters, rng, deadline, most, int(self.constants[0])
        )

    def solve(
        self,
        polynomials: Sequence[Mapping[Exponents, complex]],
        rng: np.random.Generator,
        deadline: Deadline,
        most: int,
    ) -> SolvedPolynomials | None:
        """The isolated solutions of ``polynomials`` of the family; None where the trace
        test failed, or there are more than ``most`` generic ones."""
        generic = self.generic_solutions(rng, deadline, most)
        if not generic.are_all or generic.trace is None or generic.count > most:
            return None
        member = self.member(polynomials)
        starts = self._with_zeros_of(generic.fibre, member, rng, deadline)
        paths = self.follow(starts, member, rng, deadline)
        has_curves = self._has_curves(generic.fibre, member, rng, deadline)
        return SolvedPolynomials(paths, generic.trace, has_curves)

    def _with_zeros_of(
        self,
        generic: Fibre,
        member: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> Fibre:
        """The solutions of a member with random coefficients, but zeros where those (q,)
        of another one are zero; the ``generic`` ones where those are not all regular.

        Fewer paths lead from there, and those that still go to infinity do so because
        of what the coefficients are, and not which.
        """
        chosen = complex_normal(rng, len(member))
        parameters = np.where(member == 0.0, 0.0, chosen)
        paths = self.follow(generic, parameters, rng, deadline)
        if not np.all(paths.is_regular | (paths.ends == PathEnd.AT_INFINITY)):
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

    def _has_curves(
        self,
        generic: Fibre,
        member: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> bool | None:
        """Whether the member with these parameters (q,) has complex solutions that are
        not isolated; None where paths to that were lost."""
        for dimension in range(1, self.n):
            planes = complex_normal(rng, (dimension, self.n + 1))
            added = complex_normal(rng, (self.n, dimension)) @ planes
            last = member.copy()
            for constant, row in zip(self.constants.tolist(), added, strict=True):
                last[constant : constant + self.n + 1] += row
            paths = self.follow(generic, last, rng, deadline)
            if np.any(paths.ends == PathEnd.SINGULAR):
                return True
            ends = paths.regular
            heights = np.abs(planes[:, 0] + ends @ planes[:, 1:].T).max(axis=1)
            sizes = 1.0 + np.abs(ends).max(axis=1, initial=0.0)
            if np.any(solves_all_equations(heights / sizes)):
                return True
            if np.any(paths.is_lost):
                return None
        return False


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
