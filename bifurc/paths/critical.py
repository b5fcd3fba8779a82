"""Critical points of a function on complex curves, and the singular points of these.

At a point x of a curve F(x) = 0 a vector v with F'(x) v = 0 is tangent, and h, linear or
the square of a distance, is critical where h'(x) v = 0 as well. These n equations are
linear in v, and of degrees e in x. On pairs of a point of a curve of degree d and a
direction they have d times the sum of all e solutions, as many as if each were a product
of e linear functions of x and one of v; from the solutions of such products paths lead
to all isolated ones, singular points of the curve among them, at which v is normal to
that of h (Hauenstein, Sommese and Wampler 2011, regeneration; Rouillier, Roy and Safey
El Din 2000 and Hauenstein 2013 for the use of it: of every connected real part that is
bounded, or of which the function is a distance, one of them is a point).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np

from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.curves import CurveEquations
from bifurc.paths.family import Family, complex_normal, on_patch
from bifurc.paths.follow import PathEnd, Paths, follow_paths, with_affine_ends
from bifurc.paths.homogeneous import (
    Terms,
    degree_of,
    derivative,
    write_homogeneous,
    write_linear,
)
from bifurc.paths.monodromy import Fibre


@dataclass(frozen=True, eq=False)
class CriticalPoints:
    """The critical points of a function on the curves of ``equations``: of the linear
    one with real coefficients ``of`` (n,), or where ``is_distance`` of the distance from
    the point ``of``."""

    equations: CurveEquations
    of: np.ndarray
    is_distance: bool

    @property
    def degrees(self) -> list[int]:
        """In x, of the n equations that are linear in v."""
        own = [degree - 1 for degree in self.equations.degrees]
        return [*own, int(self.is_distance)]

    def number_of_paths(self, degree: int) -> int:
        """How many paths lead to those of curves of this ``degree`` together."""
        return degree * sum(self.degrees)

    @cached_property
    def family(self) -> Family:
        """The family of pairs of homogeneous coordinates (n + 1) and directions (n);
        parameters are two linear functions that are 1, one of each, the shares of the
        equations and of the products, and the factors of these: of x, then of v."""
        n, size, factors = self.equations.n, self.equations.n + 1, sum(self.degrees)
        writer = TapeWriter(2 * (size + n) + 2 + factors * size + n * n)
        slots = map(writer.unknown, range(writer.n))
        places, along = list(islice(slots, size)), list(islice(slots, n))
        units = [write_linear(writer, slots, k) for k in (places, along)]
        shares = list(islice(slots, 2))
        products = self._products(writer, slots, places, along)
        outputs = self.equations.written(writer, places)
        one = writer.constant(1.0)
        outputs += [writer.subtract(unit, one) for unit in units]
        for pair in zip(self._written(writer, places, along), products, strict=True):
            outputs.append(write_linear(writer, pair, shares))
        return Family(writer.tape(outputs), size + n, True, size)

    def _products(
        self,
        writer: TapeWriter,
        slots: Iterator[int],
        places: list[int],
        along: list[int],
    ) -> list[int]:
        """The slots of the products, with the coefficients of their factors in further
        ``slots``."""
        factors = [
            write_linear(writer, slots, places) for _ in range(sum(self.degrees))
        ]
        directions = [write_linear(writer, slots, along) for _ in along]
        products, others = [], iter(factors)
        for degree, product in zip(self.degrees, directions, strict=True):
            for factor in islice(others, degree):
                product = writer.multiply(product, factor)
            products.append(product)
        return products

    def _written(
        self, writer: TapeWriter, places: list[int], along: list[int]
    ) -> list[int]:
        """The slots of F'(x) v and h'(x) v."""
        rows = [
            _written_gradient(writer, one, places, along)
            for one in self.equations.square
        ]
        slopes = [writer.constant(float(value)) for value in self.of]
        if self.is_distance:
            slopes = [
                writer.subtract(place, writer.multiply(center, places[0]))
                for place, center in zip(places[1:], slopes, strict=True)
            ]
        return [*rows, write_linear(writer, slopes, along)]

    def paths(
        self,
        section: Fibre,
        rng: np.random.Generator,
        deadline: Deadline,
        farthest: float = np.inf,
    ) -> Paths:
        """The paths to all of them on curves with the points of a generic section, as in
        `follow_paths`; those whose starts are not known are lost."""
        n, follow = self.equations.n, self.equations.follow
        planes = complex_normal(rng, (sum(self.degrees), n + 1))
        if not len(planes):  # the curves are lines
            return follow(section, section.parameters[n + 1 :], deadline)
        ends = Paths.joined([follow(section, plane, deadline) for plane in planes])
        directions, unit = complex_normal(rng, (n, n)), complex_normal(rng, n)
        patch = section.parameters[: n + 1]
        starts = self._pairs(ends, patch, _kernels(directions, unit))
        shares = np.array([[0.0, complex_normal(rng, ())], [1.0, 0.0]])
        factors = np.r_[planes.ravel(), directions.ravel()]
        first, last = (np.r_[patch, unit, pair, factors] for pair in shares)
        family = self.family
        paths = follow_paths(family, starts, first, last, deadline, farthest=farthest)
        return _continued(ends, with_affine_ends(family, paths))

    def _pairs(self, ends: Paths, patch: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        """The regular ends of paths to zeros of factors, each with that of the
        ``vectors`` (n, n) at which the other products are zero."""
        each = len(ends.ends) // sum(self.degrees)
        along = np.repeat(vectors, each * np.array(self.degrees), axis=0)
        both = np.hstack([on_patch(ends.points, patch), along])
        starts: np.ndarray = both[ends.is_regular]
        return starts


def _continued(before: Paths, after: Paths) -> Paths:
    """Paths of which those that came to regular ends went on; the others are lost."""
    goes_on = np.flatnonzero(before.is_regular)
    before.ends[~before.is_regular] = PathEnd.NO_START
    before.replace(goes_on, after, np.arange(len(goes_on)))
    return before


def _kernels(directions: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Vectors (n, n), at each of which all linear functions ``directions`` (n, n) but one
    are zero, so that all products but one vanish, and another one, ``unit``, is 1."""
    n = len(unit)
    vectors = []
    for number in range(n):
        rows = np.vstack([np.delete(directions, number, axis=0), unit])
        vectors.append(np.linalg.solve(rows, np.eye(n)[n - 1]))
    return np.array(vectors)


def _written_gradient(
    writer: TapeWriter, polynomial: Terms, places: list[int], along: list[int]
) -> int:
    """The slot of the derivative of a polynomial along a direction."""
    degree = degree_of(polynomial) - 1
    total = writer.constant(0.0)
    for number, component in enumerate(along):
        slope = derivative(polynomial, number)
        if slope:
            value = write_homogeneous(writer, slope, places, degree)
            total = writer.add(total, writer.multiply(value, component))
    return total
