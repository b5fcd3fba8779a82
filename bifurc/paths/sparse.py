"""Polynomials with given monomials: all isolated solutions of a square system.

The parameters of the family are the coefficients. Each polynomial has a constant besides
its own monomials. So the solutions of all members are one irreducible variety, which a
constant on each fibre parametrises, and every isolated solution of a member is the end
of a path (Li and Wang 1996; Sommese and Wampler 2005, chapter 8). All polynomials but
one, the `pencil`, leave a curve, which is irreducible where so many of them depend on
more directions of the exponents than they are (Khovanskii 2016). The pencil has all
unknowns among its monomials, and while its constant moves no solution grows faster than
that: the sum of the solutions is linear in that constant, and of no part of them (the
trace test, as in `bifurc.paths.monodromy`). Where the curve would not be irreducible
another polynomial has all unknowns as well.

The first k polynomials leave nothing but what has the dimension n - k, if the next one
is zero on no part of what the first k - 1 leave. Whether it is shows at the points that
this has in common with generic hyperplanes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
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
    misfits,
    write_linear,
    write_monomial,
)
from bifurc.paths.monodromy import Effort, Fibre, GenericSolutions, solve_generic

FEW = 32  # paths that are followed faster than a generic member is solved


class SolvedPolynomials(NamedTuple):
    """The ``paths`` to all isolated solutions of polynomials, and by how much the test of
    the generic ones from which they begin failed, ``trace``."""

    paths: Paths
    trace: float


@dataclass(frozen=True)
class SparseFamily:
    """n polynomials in n unknowns, each with the monomials of its support, the constant
    first; the one with the number ``pencil`` has all unknowns. Parameters are all
    coefficients, polynomial by polynomial."""

    supports: tuple[tuple[Exponents, ...], ...]
    pencil: int

    @staticmethod
    def of(polynomials: Sequence[Mapping[Exponents, complex]]) -> SparseFamily:
        """The family with the monomials of ``polynomials``, and others that it needs."""
        n = len(polynomials)
        constant = {(0,) * n}
        unknowns = {tuple(row) for row in np.eye(n, dtype=int).tolist()}
        supports = [set(polynomial) | constant for polynomial in polynomials]
        missing = [len(unknowns - support) for support in supports]
        pencil = int(np.argmin(missing))
        supports[pencil] |= unknowns
        others = [k for k in range(n) if k != pencil]
        while others:
            reducible = _reducible_part([supports[k] for k in others])
            if not len(reducible):
                break
            supports[others[reducible[0]]] |= unknowns
        ordered = [(*constant, *sorted(support - constant)) for support in supports]
        return SparseFamily(tuple(ordered), pencil)

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
        moving = int(self.constants[self.pencil])
        effort = Effort.for_solutions(most, deadline)
        return solve_generic(self.family, start, parameters, rng, effort, most, moving)

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
        return SolvedPolynomials(paths, generic.trace)

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
    solved = SparseFamily.of(polynomials).solve(polynomials, rng, deadline, most)
    return None if solved is None else solved.paths


def _reducible_part(supports: Sequence[Collection[Exponents]]) -> np.ndarray:
    """Polynomials (k,), by number, that keep a curve from being irreducible of which n - 1
    generic ones with these ``supports`` are the equations; none where it is."""
    rng = np.random.default_rng(0)
    exponents = [np.array(list(support), dtype=float) for support in supports]
    rows = np.array([rng.normal(size=len(one)) @ one for one in exponents])
    left, values, right = np.linalg.svd(rows)
    if np.isclose(values[-1], 0.0):
        return np.flatnonzero(~np.isclose(left[:, -1], 0.0))
    heights = [np.abs(one @ right[-1]).max() for one in exponents]
    return np.flatnonzero(np.isclose(heights, 0.0))


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
