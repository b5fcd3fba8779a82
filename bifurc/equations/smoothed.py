"""A polynomial next to noisy values, as a tape.

Curves cannot be followed in noise, but a smooth function under it can be known better
than any of its values: least squares of many in Chebyshev polynomials (Trefethen 2019,
Approximation Theory and Approximation Practice), of the lowest degree that leaves no
more than the noise at points that were not fitted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from bifurc.decisions import is_left_by_noise, may_be_left_by_noise
from bifurc.equations.tape import Tape, TapeWriter

DEGREES = (1, 2, 3, 4, 6, 8, 10, 12, 16, 20)
MOST_TERMS = 300  # of a polynomial
PER_TERM = 5  # values that are fitted
OTHERS = 50  # values at which a fit is tried out


class _Fit(NamedTuple):
    """The ``coefficients`` (j, m) of products of Chebyshev polynomials of the
    ``exponents`` (j, n), and the root mean square of what they ``left`` (m,)."""

    exponents: np.ndarray
    coefficients: np.ndarray
    left: np.ndarray


def smoothed(
    function: Callable[[np.ndarray], np.ndarray], bounds: np.ndarray, noise: np.ndarray
) -> Tape | None:
    """The polynomials next to the values (m,) of a ``function`` within ``bounds``
    (n, 2), which are noisy by a standard deviation ``noise`` (m,); None where some are
    not finite, or no polynomial of few terms is about as near to them as that."""
    middle, half = bounds.mean(axis=1), 0.5 * np.diff(bounds, axis=1)[:, 0]
    nearest, best = np.inf, None
    for fit in _fits(lambda place: function(middle + half * place), len(bounds)):
        worst = float((fit.left / noise).max())
        if worst < nearest:
            nearest, best = worst, fit
        if is_left_by_noise(worst):
            break
    if best is None or not may_be_left_by_noise(nearest):
        return None
    return _written(middle, half, best)


def _fits(function: Callable[[np.ndarray], np.ndarray], n: int) -> Iterator[_Fit]:
    """Polynomials of higher and higher degree next to the values (m,) of a ``function`` of
    places (n,) between -1 and 1, as long as these are finite."""
    rng = np.random.default_rng(0)
    places, values = np.empty((0, n)), []
    for degree in DEGREES:
        exponents = _exponents(n, degree)
        if len(exponents) > MOST_TERMS:
            return
        # dense towards the ends, as the zeros of Chebyshev polynomials are
        count = PER_TERM * len(exponents) + OTHERS - len(places)
        new = np.cos(np.pi * rng.uniform(size=(count, n)))
        places = np.vstack([places, new])
        values += [function(place) for place in new]
        given = np.array(values)
        if not np.all(np.isfinite(given)):
            return
        terms = _terms(places, exponents)
        fit, *_ = np.linalg.lstsq(terms[OTHERS:], given[OTHERS:], rcond=None)
        missed = (given - terms @ fit)[:OTHERS]
        yield _Fit(exponents, fit, np.sqrt(np.mean(missed**2, axis=0)))


def _exponents(n: int, degree: int) -> np.ndarray:
    """The exponents (k, n) of n unknowns up to a ``degree`` of them all."""
    every = product(range(degree + 1), repeat=n) if n <= 3 else ()
    few = [row for row in every if sum(row) <= degree]
    return np.array(few or np.empty((MOST_TERMS + 1, n)), dtype=int)


def _terms(places: np.ndarray, exponents: np.ndarray) -> np.ndarray:
    """The products of Chebyshev polynomials (k, j) of the ``exponents`` (j, n) at
    ``places`` (k, n) between -1 and 1."""
    single = chebvander(places, int(exponents.max()))
    terms = np.ones((len(places), len(exponents)))
    for number, column in enumerate(exponents.T):
        terms *= single[:, number, column]
    return terms


def _written(middle: np.ndarray, half: np.ndarray, fit: _Fit) -> Tape:
    """The tape of polynomials in the unknowns (n,) less the ``middle``, over ``half`` the
    widths."""
    writer = TapeWriter(len(middle))
    highest = int(fit.exponents.max())
    chains = [
        _chain(writer, number, float(start), float(size), highest)
        for number, (start, size) in enumerate(zip(middle, half, strict=True))
    ]
    outputs = []
    for column in fit.coefficients.T:
        total = writer.constant(0.0)
        for powers, coefficient in zip(fit.exponents, column, strict=True):
            term = writer.constant(float(coefficient))
            for chain, power in zip(chains, powers, strict=True):
                term = writer.multiply(term, chain[power])
            total = writer.add(total, term)
        outputs.append(total)
    return writer.tape(outputs)


def _chain(
    writer: TapeWriter, number: int, start: float, size: float, highest: int
) -> list[int]:
    """The slots of the Chebyshev polynomials up to the ``highest`` of an unknown."""
    shifted = writer.add(writer.unknown(number), writer.constant(-start))
    one = writer.divide(shifted, writer.constant(size))
    twice = writer.multiply(one, writer.constant(2.0))
    chain = [writer.constant(1.0), one]
    while len(chain) <= highest:
        chain.append(writer.subtract(writer.multiply(twice, chain[-1]), chain[-2]))
    return chain
