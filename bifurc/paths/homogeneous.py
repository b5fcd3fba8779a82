"""Polynomials as terms, written on tapes in homogeneous coordinates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from bifurc.equations.tape import TapeWriter

# Exponents of the unknowns, and the coefficient of each such term.
Exponents: TypeAlias = tuple[int, ...]
Terms: TypeAlias = Mapping[Exponents, float]


def degree_of(polynomial: Iterable[Exponents]) -> int:
    """The degree of a polynomial."""
    return max(map(sum, polynomial))


def derivative(polynomial: Terms, number: int) -> dict[Exponents, float]:
    """The derivative by the unknown with a ``number``."""
    terms = {}
    for exponents, value in polynomial.items():
        power = exponents[number]
        if power:
            lower = (*exponents[:number], power - 1, *exponents[number + 1 :])
            terms[lower] = power * value
    return terms


def misfits(polynomials: Sequence[Terms], points: np.ndarray) -> np.ndarray:
    """The largest of the polynomials at points (k, n), each over the sum of its
    coefficients times a power of the largest unknown, or of 1 (k,)."""
    largest = np.zeros(len(points))
    sizes = np.maximum(np.abs(points).max(axis=1, initial=0.0), 1.0)
    for polynomial in polynomials:
        exponents = np.array(list(polynomial))  # (t, n)
        values = np.array(list(polynomial.values()))
        terms = values * np.prod(points[:, None] ** exponents, axis=2)
        units = np.abs(values).sum() * sizes ** degree_of(polynomial)
        largest = np.maximum(largest, np.abs(terms.sum(axis=1)) / units)
    return largest


def write_monomial(
    writer: TapeWriter, factor: int, slots: Sequence[int], exponents: Sequence[int]
) -> int:
    """The slot of a ``factor`` times powers of what is in ``slots``."""
    term = factor
    for slot, exponent in zip(slots, exponents, strict=True):
        power = writer.power(slot, writer.constant(float(exponent)))
        term = writer.multiply(term, power)
    return term


def write_homogeneous(
    writer: TapeWriter, polynomial: Terms, slots: Sequence[int], degree: int
) -> int:
    """The slot of a polynomial, made homogeneous of a ``degree``, in coordinates in
    ``slots`` (n + 1), the first of which is zero at infinity."""
    total = writer.constant(0.0)
    for exponents, value in polynomial.items():
        powers = (degree - sum(exponents), *exponents)
        term = write_monomial(writer, writer.constant(value), slots, powers)
        total = writer.add(total, term)
    return total


def write_linear(
    writer: TapeWriter, factors: Iterable[int], slots: Sequence[int]
) -> int:
    """The slot of the sum of products of what is in ``slots`` and of the first
    ``factors``."""
    total = writer.constant(0.0)
    for slot, factor in zip(slots, factors, strict=False):
        total = writer.add(total, writer.multiply(factor, slot))
    return total
