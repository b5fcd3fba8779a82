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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from bifurc.decisions import solves_all_equations
from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.follow import PathEnd, Paths, follow_paths
from bifurc.paths.monodromy import Fibre, GenericSolutions, solve_generic

Exponents: TypeAlias = tuple[int, ...]


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
        height = writer.constant(-1.0)
        for number, unknown in enumerate([first, *unknowns]):
            factor = writer.unknown(size + self.coefficients + number)
            height = writer.add(height, writer.multiply(factor, unknown))
        return Family(writer.tape([*outputs, height]), size, is_projective=True)

    def _written(
        self, writer: TapeWriter, unknowns: Sequence[int], first: int | None = None
    ) -> list[int]:
        """The slots of the polynomials in slots ``unknowns`` (n), with the coefficients
        after them; homogeneous with another one."""
        number = len(unknowns) + (first is not None)
        outputs = []
        for support in self.supports:
            degree = max(map(sum, support))
            total = writer.constant(0.0)
            for exponents in support:
                term = writer.unknown(number)
                factors = list(zip(unknowns, exponents, strict=True))
                if first is not None:
                    factors.append((first, degree - sum(exponents)))
                for slot, exponent in factors:
                    power = writer.power(slot, writer.constant(float(exponent)))
                    term = writer.multiply(term, power)
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

    def with_zeros_of(
        self,
        generic: GenericSolutions,
        member: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> GenericSolutions:
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
        return replace(generic, fibre=Fibre(parameters, paths.regular))

    def follow(
        self,
        generic: GenericSolutions,
        member: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ) -> Paths:
        """The paths from the solutions of a generic member to those of another one."""
        starts = np.insert(generic.fibre.solutions, 0, 1.0, axis=1)
        plane = complex_normal(rng, self.n + 1)
        starts /= (starts @ plane)[:, None]
        first, last = (
            np.concatenate([coefficients, plane])
            for coefficients in (generic.fibre.parameters, member)
        )
        paths = follow_paths(self.projective, starts, first, last, deadline)
        points = paths.points[:, 1:] / paths.points[:, :1]
        return replace(paths, points=points)

    def has_curves(
        self,
        generic: GenericSolutions,
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
