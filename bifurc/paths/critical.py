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

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np

from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.curves import (
    CurveEquations,
    HyperplaneSection,
    on_patch,
    with_affine_ends,
)
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.follow import Paths, follow_paths
from bifurc.paths.homogeneous import (
    Terms,
    degree_of,
    derivative,
    write_homogeneous,
    write_linear,
    write_product,
)


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
        n, factors = self.equations.n, sum(self.degrees)
        size = n + 1
        writer = TapeWriter(2 * (size + n) + 2 + factors * size + n * n)
        slots = map(writer.unknown, range(writer.n))
        places, along = list(islice(slots, size)), list(islice(slots, n))
        units = [write_linear(writer, slots, one) for one in (places, along)]
        share, start = islice(slots, 2)
        of_places = [write_linear(writer, slots, places) for _ in range(factors)]
        of_directions = [write_linear(writer, slots, along) for _ in range(n)]
        products = self._products(writer, of_places, of_directions)
        outputs = self._written_curves(writer, places)
        outputs += [writer.subtract(unit, writer.constant(1.0)) for unit in units]
        for pair in zip(self._written(writer, places, along), products, strict=True):
            outputs.append(write_linear(writer, pair, (share, start)))
        return Family(writer.tape(outputs), size + n, True, size)

    def _written_curves(self, writer: TapeWriter, places: list[int]) -> list[int]:
        """The slots of F."""
        return [
            write_homogeneous(writer, polynomial, places, degree_of(polynomial))
            for polynomial in self.equations.polynomials
        ]

    def _products(
        self, writer: TapeWriter, of_places: list[int], of_directions: list[int]
    ) -> list[int]:
        """The slots of the products, from linear functions of x and of v."""
        products, first = [], 0
        for degree, direction in zip(self.degrees, of_directions, strict=True):
            factors = [*of_places[first : first + degree], direction]
            products.append(write_product(writer, factors))
            first += degree
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
        section: HyperplaneSection,
        rng: np.random.Generator,
        deadline: Deadline,
        farthest: float = np.inf,
    ) -> tuple[Paths, Paths]:
        """The paths to all of them on curves with the points of a generic section, as in
        `follow_paths`; and those to the starts. Their ends (k, n) are points."""
        n = self.equations.n
        planes = complex_normal(rng, (sum(self.degrees), n + 1))
        directions = complex_normal(rng, (n, n))
        patch, unit = complex_normal(rng, n + 1), complex_normal(rng, n)
        before = [self.equations.follow(section, one, rng, deadline) for one in planes]
        vectors = np.repeat(_kernels(directions, unit), self.degrees, axis=0)
        starts = _pairs(before, vectors, patch)
        shares = np.array([[0.0, complex_normal(rng, ())], [1.0, 0.0]])
        products = np.concatenate([planes.ravel(), directions.ravel()])
        first, last = (np.r_[patch, unit, pair, products] for pair in shares)
        paths = follow_paths(
            self.family,
            starts,
            first,
            last,
            deadline,
            farthest=farthest,
        )
        return with_affine_ends(paths, n), _together(before, n)


def _pairs(
    paths: Sequence[Paths], vectors: np.ndarray, patch: np.ndarray
) -> np.ndarray:
    """Ends (k, n) of each of the ``paths`` in homogeneous coordinates, with the direction
    that is in ``vectors`` (p, n) at its place."""
    pairs = [np.empty((0, len(patch) + vectors.shape[1]))]
    for ends, vector in zip(paths, vectors, strict=True):
        along = np.tile(vector, (len(ends.points), 1))
        pairs.append(np.hstack([on_patch(ends.points, patch), along]))
    return np.concatenate(pairs)


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


def _together(paths: list[Paths], n: int) -> Paths:
    """Several paths as one record."""
    if not paths:
        nothing = np.empty(0)
        whole = np.empty(0, dtype=int)
        return Paths(
            np.empty((0, n)), nothing, whole, whole, whole, np.empty(0, dtype=bool)
        )
    names = list(vars(paths[0]))
    return Paths(
        **{name: np.concatenate([vars(one)[name] for one in paths]) for name in names}
    )
