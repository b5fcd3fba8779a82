"""The branches of a plane curve through the origin, by the Newton polygon.

Every branch of f(x, y) = 0 there is x = +-s^q, y = a power series in s (Puiseux 1850;
Walker 1950, Algebraic Curves, chapter IV), real or complex. The lower edges of the Newton polygon give
the first exponents, the real roots of the polynomial on an edge the coefficients; a
root that is not simple is taken off, and the rest looked at again.

The coefficients of f are known to many digits: those that vanish are told from the
others by tens of decades, or nothing is said where they decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, permutations, product
from math import comb
from typing import NamedTuple, TypeAlias

import mpmath

from bifurc.decisions import is_same_coefficient, is_zero_coefficient
from bifurc.singular.point import Invariants

Terms: TypeAlias = Mapping[tuple[int, int], mpmath.mpf]
"""The coefficients of a polynomial, by the exponents of x and y."""
_RootsOf: TypeAlias = Callable[[Sequence[mpmath.mpf], int], list[mpmath.mpf] | None]
# of a polynomial on an edge, of which the denominator of the slope is given

ROOT_STEPS = 80  # of the iteration for the roots on an edge
IN_DOUBT = 1e25  # times larger than what is zero, and not plainly none
DEEPEST = 40  # substitutions along one branch
_Root: TypeAlias = dict[Fraction, mpmath.mpc]


@dataclass(frozen=True)
class HalfBranch:
    """x = ``side`` s^``ramification`` and y = the sum of ``coefficients`` (k,) times s to
    the ``exponents`` (k,), for small s > 0: as many terms as tell it from the others."""

    side: int
    ramification: int
    exponents: tuple[int, ...]
    coefficients: tuple[mpmath.mpf, ...]

    @property
    def slope(self) -> mpmath.mpf:
        """y over x at the origin."""
        if self.exponents and self.exponents[0] == self.ramification:
            return self.side * self.coefficients[0]
        return mpmath.mpf(0)

    @property
    def returns(self) -> bool:
        """Whether its branch leaves the origin on the side from which it came."""
        return self.ramification % 2 == 0

    def other_half(self) -> HalfBranch:
        """The other half of the branch: that for s < 0."""
        signs = [(-1) ** exponent for exponent in self.exponents]
        pairs = zip(signs, self.coefficients, strict=True)
        side = self.side if self.returns else -self.side
        coefficients = tuple(sign * value for sign, value in pairs)
        return HalfBranch(side, self.ramification, self.exponents, coefficients)

    def series(self) -> Series:
        """The branch of which it is a half, as a series in x."""
        coefficients = self.coefficients
        if self.side < 0:
            turn = mpmath.expjpi(mpmath.mpf(1) / self.ramification)  # s over |x|^(1/q)
            coefficients = tuple(
                value * turn**exponent
                for exponent, value in zip(self.exponents, coefficients, strict=True)
            )
        return Series(self.ramification, self.exponents, coefficients)

    def is_same_as(self, other: HalfBranch) -> bool:
        """Whether two half-branches have the same terms."""
        mine = (self.side, self.ramification, self.exponents)
        if mine != (other.side, other.ramification, other.exponents):
            return False
        return all(
            is_same_coefficient(float(abs(a - b)), float(max(abs(a), abs(b))))
            for a, b in zip(self.coefficients, other.coefficients, strict=True)
        )


@dataclass(frozen=True)
class Series:
    """A branch, real or complex: y = the sum of ``coefficients`` (k,) times x to the
    ``exponents`` (k,) over the ``ramification``, as many terms as tell it from the
    others. Every value of x to the power 1 / ``ramification`` gives one of its roots
    y."""

    ramification: int
    exponents: tuple[int, ...]
    coefficients: tuple[mpmath.mpc, ...]

    def roots(self) -> Iterator[dict[Fraction, mpmath.mpc]]:
        """The coefficients of each root y, by the exponents of x."""
        for k in range(self.ramification):
            turn = mpmath.expjpi(mpmath.mpf(2 * k) / self.ramification)
            yield {
                Fraction(exponent, self.ramification): value * turn**exponent
                for exponent, value in zip(
                    self.exponents, self.coefficients, strict=True
                )
            }


def order_of(terms: Terms) -> int:
    """The degree of the lowest terms that plainly do not vanish, 0 where none is: the
    multiplicity of the origin."""
    return min((i + j for i, j in terms_above(terms, IN_DOUBT)), default=0)


def half_branches(terms: Terms, degree: int) -> tuple[HalfBranch, ...] | None:
    """The real half-branches of f = 0 at the origin, of which the ``terms`` up to a total
    ``degree`` are known and none but those that vanish are left out; None where they do
    not separate the branches. No branch may be tangent to x = 0."""
    if (0, order_of(terms)) not in terms_above(terms, IN_DOUBT):
        return None
    halves: list[HalfBranch] = []
    for side in (1, -1):
        mirrored = {(i, j): side**i * value for (i, j), value in terms.items()}
        own = _separated(_Remainder(mirrored, degree + 1), _real_roots)
        if own is None:
            return None
        halves += [
            HalfBranch(side, one.ramification, one.exponents, one.coefficients)
            for one in own
        ]
    return tuple(halves)


def branches(terms: Terms, degree: int) -> tuple[Series, ...] | None:
    """All branches of f = 0 at the origin, real and complex, each once, of ``terms`` as
    for `half_branches`; None where these do not separate them."""
    if (0, order_of(terms)) not in terms_above(terms, IN_DOUBT):
        return None
    own = _separated(_Remainder(terms, degree + 1), _roots_of_branches)
    if own is None:
        return None
    return tuple(
        Series(one.ramification, one.exponents, one.coefficients) for one in own
    )


def pairs_of(halves: Sequence[HalfBranch]) -> tuple[tuple[int, int], ...] | None:
    """The numbers of the two halves of every branch; None where they do not match."""
    pairs: list[tuple[int, int]] = []
    for number, half in enumerate(halves):
        other_half = half.other_half()
        others = [k for k, one in enumerate(halves) if one.is_same_as(other_half)]
        if len(others) != 1 or others[0] == number:
            return None
        pairs.append((number, others[0]))
    is_mutual = all((other, number) in pairs for number, other in pairs)
    return tuple(pair for pair in pairs if pair[0] < pair[1]) if is_mutual else None


# --- one step of the polygon ----------------------------------------------------------


class _Remainder(NamedTuple):
    """What is left of f in s and y once the first terms of a branch are taken off.

    Coefficients ``terms`` by the exponents of s and y, of which those of s from
    ``known`` on are not known; x = +-s^``ramification``, and the ``exponents`` and
    ``coefficients`` of y so far."""

    terms: Terms
    known: int
    ramification: int = 1
    exponents: tuple[int, ...] = ()
    coefficients: tuple[mpmath.mpf, ...] = ()


class _Edge(NamedTuple):
    """A lower edge of a Newton polygon: y goes with s to the power ``slope``, the terms
    on it have the ``weight`` i + slope j, and the exponents of y from ``low`` to
    ``high``."""

    slope: Fraction
    weight: Fraction
    low: int
    high: int

    def is_met_by(self, exponents: Iterable[tuple[int, int]]) -> bool:
        """Whether some of the ``exponents`` lie on it or below it."""
        return any(
            self.low <= j <= self.high and i + self.slope * j <= self.weight
            for i, j in exponents
        )


def _separated(first: _Remainder, roots_of: _RootsOf) -> list[_Remainder] | None:
    """What is left along each branch of a remainder, by way of the roots on the edges
    that are asked for; None where its terms do not separate the branches."""
    separated: list[_Remainder] = []
    waiting = [first]
    for _ in range(DEEPEST):
        if not waiting:
            return separated
        remainder = waiting.pop()
        plain = terms_above(remainder.terms, IN_DOUBT)
        multiplicity = min(j for i, j in plain if i == 0)
        if multiplicity == 1:
            separated.append(remainder)
            continue
        edges = _edges(plain, remainder.known, multiplicity)
        lowest = edges[-1].low if edges else multiplicity
        doubtful = remainder.terms.keys() - plain.keys()
        if lowest > 1 or any(edge.is_met_by(doubtful) for edge in edges):
            return None  # two branches agree in all that is known
        if lowest == 1:
            # y is smaller on it than on any other
            separated.append(remainder)
        for edge in edges:
            following = _beyond(remainder, edge, roots_of)
            if following is None:
                return None
            waiting += following
    return None


def _edges(terms: Terms, known: int, multiplicity: int) -> list[_Edge]:
    """The lower edges of the polygon of ``terms`` from s^0 y^``multiplicity`` on, as far
    as what is not ``known`` lies above them."""
    least: dict[int, int] = {}
    for i, j in terms:
        least[j] = min(i, least.get(j, i))
    edges: list[_Edge] = []
    high, at = multiplicity, 0
    while high > 0:
        slopes = {j: Fraction(i - at, high - j) for j, i in least.items() if j < high}
        if not slopes:
            break
        slope = min(slopes.values())
        weight = at + slope * high
        if weight >= known:
            break
        low = min(j for j, value in slopes.items() if value == slope)
        edges.append(_Edge(slope, weight, low, high))
        high, at = low, least[low]
    return edges


def _beyond(
    remainder: _Remainder, edge: _Edge, roots_of: _RootsOf
) -> list[_Remainder] | None:
    """What is left along each root on an edge; None where the roots do not tell."""
    polynomial = [mpmath.mpf(0)] * (edge.high - edge.low + 1)
    for (i, j), value in remainder.terms.items():
        if i + edge.slope * j == edge.weight and edge.low <= j <= edge.high:
            polynomial[j - edge.low] = value
    roots = roots_of(polynomial, edge.slope.denominator)
    if roots is None:
        return None
    return [_substituted(remainder, edge, root) for root in roots]


def _substituted(remainder: _Remainder, edge: _Edge, root: mpmath.mpf) -> _Remainder:
    """The remainder with s^b for s and s^a (``root`` + y) for y, a / b the slope of an
    edge, over the power of s on that edge."""
    a, b = edge.slope.numerator, edge.slope.denominator
    weight = int(edge.weight * b)
    known = remainder.known * b - weight
    terms: dict[tuple[int, int], mpmath.mpf] = {}
    for (i, j), value in remainder.terms.items():
        power = i * b + a * j - weight
        if not 0 <= power < known:
            continue  # below the edge there is nothing but rounding
        for k in range(j + 1):
            share = comb(j, k) * value * root ** (j - k)
            terms[power, k] = terms.get((power, k), mpmath.mpf(0)) + share
    return _Remainder(
        terms_above(terms),
        known,
        remainder.ramification * b,
        (*(b * e for e in remainder.exponents), _exponent(remainder, edge)),
        (*remainder.coefficients, root),
    )


def _exponent(remainder: _Remainder, edge: _Edge) -> int:
    """The exponent of s, after the substitution, of the term that an edge adds to y."""
    before = remainder.exponents[-1] if remainder.exponents else 0
    return before * edge.slope.denominator + edge.slope.numerator


def terms_above(terms: Terms, unit: float = 1.0) -> dict[tuple[int, int], mpmath.mpf]:
    """The terms that do not vanish beside the largest, in doubt or not; in the ``unit``
    `IN_DOUBT` those that plainly do not."""
    largest = max((abs(value) for value in terms.values()), default=mpmath.mpf(0))
    return {
        key: value
        for key, value in terms.items()
        if value and not is_zero_coefficient(float(abs(value) / largest), unit)
    }


# --- roots ----------------------------------------------------------------------------


def _distinct_roots(polynomial: Sequence[mpmath.mpf]) -> list[mpmath.mpc] | None:
    """The distinct roots of a polynomial, lowest coefficient first; None where it is
    open which they are."""
    simple = _with_simple_roots(list(polynomial))
    if simple is None:
        return None
    try:
        roots = mpmath.polyroots(simple[::-1], maxsteps=ROOT_STEPS, extraprec=200)
    except mpmath.libmp.NoConvergence:
        return None
    return list(roots)


def _roots_of_branches(
    polynomial: Sequence[mpmath.mpf], denominator: int
) -> list[mpmath.mpc] | None:
    """Of the distinct roots of which the powers to a ``denominator`` agree one: all of
    them lead along the same branch."""
    roots = _distinct_roots(polynomial)
    if roots is None:
        return None
    kept: list[mpmath.mpc] = []
    for root in roots:
        power = root**denominator
        gaps = [float(abs(power - one**denominator)) for one in kept]
        if not any(is_same_coefficient(gap, float(abs(power))) for gap in gaps):
            kept.append(root)
    return kept


def _real_roots(
    polynomial: Sequence[mpmath.mpf], _denominator: int
) -> list[mpmath.mpf] | None:
    """The distinct real roots of a polynomial, lowest coefficient first; None where it
    is open which they are."""
    roots = _distinct_roots(polynomial)
    if roots is None:
        return None
    real = []
    for root in roots:
        share = float(abs(mpmath.im(root)) / abs(root))
        if is_zero_coefficient(share):
            real.append(mpmath.re(root))
        elif is_zero_coefficient(share, IN_DOUBT):
            return None
    return real


def _with_simple_roots(polynomial: list[mpmath.mpf]) -> list[mpmath.mpf] | None:
    """The polynomial with the same roots, each of them once: over the greatest common
    divisor with its derivative. None where that is open."""
    divisor, rest = polynomial, _derivative(polynomial)
    while rest:
        _, remainder = _divided(divisor, rest)
        reduced = _reduced(remainder, divisor)
        if reduced is None:
            return None
        divisor, rest = rest, reduced
    return _divided(polynomial, divisor)[0]


def _derivative(polynomial: Sequence[mpmath.mpf]) -> list[mpmath.mpf]:
    return [k * value for k, value in enumerate(polynomial)][1:]


def _divided(
    polynomial: Sequence[mpmath.mpf], divisor: Sequence[mpmath.mpf]
) -> tuple[list[mpmath.mpf], list[mpmath.mpf]]:
    """Quotient and remainder of two polynomials."""
    rest = list(polynomial)
    quotient: list[mpmath.mpf] = []
    for _ in range(len(polynomial) - len(divisor) + 1):
        factor = rest[-1] / divisor[-1]
        quotient.append(factor)
        begin = len(rest) - len(divisor)
        for k, value in enumerate(divisor):
            rest[begin + k] -= factor * value
        rest.pop()
    return quotient[::-1], rest


def _reduced(
    remainder: Sequence[mpmath.mpf], dividend: Sequence[mpmath.mpf]
) -> list[mpmath.mpf] | None:
    """A remainder without leading coefficients that vanish beside those of the
    ``dividend``, its largest coefficient 1; None where it is open whether they do."""
    largest = max(abs(value) for value in dividend)
    rest = list(remainder)
    while rest:
        share = float(abs(rest[-1]) / largest)
        if not is_zero_coefficient(share, IN_DOUBT):
            break
        if not is_zero_coefficient(share):
            return None
        rest.pop()
    size = max((abs(value) for value in rest), default=mpmath.mpf(1))
    return [value / size for value in rest]


# --- invariants -----------------------------------------------------------------------


def invariants_of(
    terms: Terms, degree: int, real_branches: Sequence[Series]
) -> Invariants | None:
    """The invariants of f = 0 at the origin, of ``terms`` as for
    `half_branches`, with the real branches known from there; None where the terms do
    not tell all branches apart.

    They come from the series of all branches, the complex ones too: the order in x of
    the difference of two roots y, summed over all of them, is that of the discriminant
    (Zariski 1965; Wall 2004, Singular Points of Plane Curves, chapters 4 and 6).
    """
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
