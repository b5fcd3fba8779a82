"""The invariants of a singular point of a plane curve, from its branches.

They come from the series of all branches, the complex ones too: the order in x of the
difference of two roots y, summed over all of them, is that of the discriminant (Zariski
1965; Wall 2004, Singular Points of Plane Curves, chapters 4 and 6).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations, permutations, product
from typing import TypeAlias

import mpmath

from bifurc.decisions import is_same_coefficient
from bifurc.singular.point import Invariants
from bifurc.singular.puiseux import Series, Terms, branches, order_of

_Root: TypeAlias = dict[Fraction, mpmath.mpc]


def invariants_of(
    terms: Terms, degree: int, real_branches: Sequence[Series]
) -> Invariants | None:
    """The invariants of f = 0 at the origin, of ``terms`` as for
    `puiseux.half_branches`, with the real branches known from there; None where the
    terms do not tell all branches apart."""
    every = branches(terms, degree)
    if every is None:
        return None
    roots = [root for series in every for root in series.roots()]
    orders = [_order_of_difference(one, other) for one, other in permutations(roots, 2)]
    multiplicity = order_of(terms)
    twice_delta = sum(orders, Fraction(0)) - multiplicity + len(every)
    contacts = [
        intersection_number(one, other) for one, other in combinations(real_branches, 2)
    ]
    return Invariants(
        multiplicity=multiplicity,
        branches=len(every),
        delta=int(twice_delta / 2),
        contacts=tuple(sorted(contacts)),
    )


def intersection_number(one: Series, other: Series) -> int:
    """How many intersections come together at the origin of two branches that differ."""
    pairs = product(one.roots(), other.roots())
    return int(sum((_order_of_difference(*pair) for pair in pairs), Fraction(0)))


def _order_of_difference(one: _Root, other: _Root) -> Fraction:
    """The lowest exponent of x at which two roots y differ."""
    for exponent in sorted(one.keys() | other.keys()):
        a, b = one.get(exponent, mpmath.mpf(0)), other.get(exponent, mpmath.mpf(0))
        if not is_same_coefficient(float(abs(a - b)), float(max(abs(a), abs(b)))):
            return exponent
    raise ValueError("two roots are the same as far as they are known")
