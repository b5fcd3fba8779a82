"""The germ of the curves at a singular point: what the exact equations say of it.

The reduction of Liapunov and Schmidt leaves one equation f(x, y) = 0 on a null space of
dimension 2. Its Taylor polynomial, to many digits, comes from values on a fine grid;
the place where all of its coefficients vanish that vanish at the point is found with it
(deflation by derivatives: Leykin, Verschelde and Zhao 2006), and the Newton polygon
gives the half-branches, and which of them are one branch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import comb, factorial
from typing import NamedTuple

import mpmath
import numpy as np

from bifurc.errors import NOT_DEFINED
from bifurc.singular.confirm import Differences
from bifurc.singular.local_branches import (
    LiftedEquation,
    Neighbourhood,
    neighbourhood_of,
)
from bifurc.singular.locate import MOST_FOR_GERM, LocatedPoint
from bifurc.singular.point import Invariants
from bifurc.singular.puiseux import (
    HalfBranch,
    Terms,
    half_branches,
    invariants_of,
    pairs_of,
    terms_above,
)
from bifurc.system import PreciseResidual, System, relative_jacobians

DEGREE = 13  # of the Taylor polynomial
# Digits of the spacing of the grid, over the scale, in the rounds in which the place is
# found, and of that on which it is judged.
ROUNDS, LAST = (12, 24, 48), 60
SPARE = 60  # digits worked to, beside those that differences cost
SPARE_OF_POINT = 10  # digits of these that a point is not solved to
ANGLE = 1.0  # rad: between the null vectors and the axes, so that no tangent is one
# Directions of y that are looked at, and the mean sine of the angle to the tangents over
# that of the best of them, from which on the branches are not steep.
TURNS, STEEP = 24, 0.8
RADII = 10.0 ** np.arange(-14, 0, 0.25)  # of circles in which roots are counted
ROOT_STEPS = 6  # of Newton's method for their common place
FARTHEST_MEAN = 0.5  # from the place in doubles, in units of the germ, is their mean
SETTLING = 4  # steps for a power series beyond its degree
FARTHEST = 4.0  # errors of the point in doubles, and at least this share of the scale:
NEAREST = 0.02  # no farther away is the place
AMISS = 2.0  # times the distance from the place in doubles is its error
# Distance, over the scale, up to which crossings beside a point of two branches are
# looked for, and a share of the terms of f there that is 0. What is left out begins with
# degree 14: where coefficients are alike it is 0.01^(14 - d) of a first term of degree d,
# 1e-12 of one of degree 8. Where it is more crossings may be overlooked.
BESIDE, VANISHING = 0.01, 1e-10


@dataclass(frozen=True, eq=False)
class Germ:
    """The exact point ``u`` (n,), the tangents ``directions`` (h, n) of its
    half-branches, the numbers of the two halves of each of its ``branches``, these
    themselves, in the ``neighbourhood`` in which doubles lose them, and its
    ``invariants``, None where the terms known do not tell its complex branches apart.
    ``others`` (k, n) are singular points beside it: where both of two branches meet
    again."""

    u: np.ndarray
    directions: np.ndarray
    branches: tuple[tuple[int, int], ...]
    neighbourhood: Neighbourhood
    invariants: Invariants | None
    others: np.ndarray

    @property
    def radius(self) -> float:
        """How far from the point doubles lose its branches; 0 where that is not
        known."""
        return self.neighbourhood.radius

    @property
    def is_through(self) -> bool | None:
        """Whether the two halves of the only branch leave to opposite sides; None where
        there are more branches, or none."""
        if len(self.branches) != 1:
            return None
        one, other = self.directions
        return bool(one @ other < 0)


def germ_at(problem: System, located: LocatedPoint) -> Germ | None:
    """The germ at a located point; None where the equations are not known exactly, have
    more than `MOST_FOR_GERM`, leave more than one equation on the null space or have no
    singular point there, or where the terms of degree `DEGREE` and less do not separate
    the branches."""
    if problem.n > MOST_FOR_GERM:
        return None
    residual = problem.precise_residual()
    if residual is None or located.null_space.shape[1] != 2:
        return None
    if len(problem.residuals(located.u[None])[0]) != problem.n - 1:
        return None
    try:
        return _germ(problem, located, residual)
    except NOT_DEFINED:
        return None  # the grid leaves where the function is defined


def placed_at(located: LocatedPoint, germ: Germ) -> LocatedPoint:
    """The located point where its germ is.

    The error stays what curves in doubles may pass it by, and is at least that by which
    it was amiss.
    """
    moved = float(np.linalg.norm(germ.u - located.u))
    error = max(located.error, AMISS * moved)
    return LocatedPoint(germ.u, located.null_space, error)


def _germ(
    problem: System, located: LocatedPoint, residual: PreciseResidual
) -> Germ | None:
    reduction = _Reduction(problem, located, residual)
    straight = _settled_terms(problem, located, reduction)
    if straight is None:
        return None
    with mpmath.workdps(LAST + SPARE):
        halves = half_branches(straight.terms, DEGREE)
        pairs = None if halves is None else pairs_of(halves)
        if halves is None or pairs is None:
            return None
        slope = float(straight.bend[1])
        directions = _directions(reduction, halves, slope)
        place = reduction.place()
        invariants = invariants_of(
            straight.terms, DEGREE, [halves[one].series() for one, _ in pairs]
        )
        equation = reduction.lifted(straight)
        around = neighbourhood_of(problem, place, equation, halves, pairs)
        offsets = [equation.offset(x, mpmath.mpf(0)) for x in _meet_again(straight)]
        others = place + np.array(offsets).reshape(-1, problem.n)
        return Germ(place, directions, pairs, around, invariants, others)


def _meet_again(straight: _Straightened) -> list[mpmath.mpf]:
    """The x, other than 0, at which two branches about y = 0 meet next to the point.

    f has no term with y alone then, and is A(x) + C(x) y^2 + ...: they cross where A and
    its derivative vanish. None where f is of a higher order.
    """
    terms = straight.terms
    zero = mpmath.mpf(0)
    series = [terms.get((k, 0), zero) for k in range(DEGREE + 1)]
    powers = [k for k, value in enumerate(series) if value]
    if not powers or not terms.get((0, 2), zero):
        return []
    rates = [k * series[k] for k in range(powers[0], powers[-1] + 1)]
    try:
        roots = mpmath.polyroots(rates[::-1], maxsteps=200, extraprec=200)
    except mpmath.libmp.NoConvergence:
        return []
    crossings = []
    for root in roots:
        x = mpmath.re(root)
        is_real = abs(mpmath.im(root)) < VANISHING * abs(x)
        if not is_real or abs(x) * straight.unit > BESIDE:
            continue
        values = [value * x**k for k, value in enumerate(series)]
        if abs(mpmath.fsum(values)) < VANISHING * max(map(abs, values)):
            crossings.append(x)
    return crossings


def _directions(
    reduction: _Reduction, halves: tuple[HalfBranch, ...], slope: float
) -> np.ndarray:
    """Unit tangents (h, n) of half-branches about a curve of a ``slope``."""
    slopes = slope + np.array([float(half.slope) for half in halves])
    sides = np.array([half.side for half in halves])
    inner = np.column_stack([sides, sides * slopes])
    vectors = inner @ reduction.null_space.T
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    directions: np.ndarray = vectors / lengths
    return directions.reshape(-1, len(reduction.null_space))


# --- the reduced equation -------------------------------------------------------------


class _Reduction:
    """One equation f(x, y) on the null space, turned by `ANGLE`, of a located point, and
    where its own point is.

    ``null_space`` (n, 2) holds the axes, in units of the problem's scale.
    """

    def __init__(
        self, problem: System, located: LocatedPoint, residual: PreciseResidual
    ):
        self.null_space = located.null_space
        self.turn(ANGLE)
        jacobian = relative_jacobians(problem, located.u[None])[0]
        left, _, right = np.linalg.svd(jacobian)
        rank = problem.n - 2
        self._scale = mpmath.mpf(problem.domain.scale)
        self._magnitude = mpmath.mpf(problem.magnitude * problem.domain.scale)
        self._residual = residual
        self._across = _matrix(right[:rank].T)  # (n, rank)
        self._solved = _matrix(left[:, :rank].T)  # (rank, m)
        self._left_over = list(_matrix(left[:, rank:]))  # m
        self._u = _matrix(located.u[:, None])

    def place(self) -> np.ndarray:
        """Where the point is (n,), as far as it has been moved."""
        return np.array([float(value) for value in self._u])

    def turn(self, angle: float) -> None:
        """Turn the axes by an ``angle`` (rad)."""
        turn = np.array(
            [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        )
        self.null_space = self.null_space @ turn
        self._axes = _matrix(self.null_space)

    def move_to(self, point: np.ndarray) -> None:
        """Go to a point (n,)."""
        self._u = _matrix(point[:, None])

    def move(self, shift: mpmath.matrix, digits: int) -> None:
        """Go to another place, ``shift`` (2, 1) away along the axes, to so many
        ``digits``."""
        with mpmath.workdps((DEGREE + 1) * digits + SPARE):
            self._prepare(mpmath.mpf(10) ** -digits)
            self._u = self._point(shift)

    def taylor(self, digits: int) -> Terms:
        """The coefficients of f about the place, up to a total degree `DEGREE`, from a
        grid of a spacing with so many ``digits``."""
        with mpmath.workdps((DEGREE + 1) * digits + SPARE):
            step = mpmath.mpf(10) ** -digits
            values: dict[tuple[int, int], mpmath.mpf] = {}
            self._prepare(step)
            for i, j in _up_to(DEGREE):
                shift = mpmath.matrix([i * step, j * step])
                values[i, j] = self._value(shift)
            return _polynomial(values, step)

    def lifted(self, straight: _Straightened) -> LiftedEquation:
        """f about the place in the coordinates in which it is ``straight``, at the digits
        that are set."""
        self._prepare(mpmath.mpf(10) ** -LAST)
        center = self._point(mpmath.matrix([0, 0]))

        def shift(x: mpmath.mpf, y: mpmath.mpf) -> mpmath.matrix:
            above = mpmath.polyval(straight.bend[::-1], x) + y
            return straight.unit * mpmath.matrix([x, above])

        def value(x: mpmath.mpf, y: mpmath.mpf) -> mpmath.mpf:
            return self._value(shift(x, y))

        def offset(x: mpmath.mpf, y: mpmath.mpf) -> np.ndarray:
            apart = self._point(shift(x, y)) - center
            return np.array([float(component) for component in apart])

        return LiftedEquation(value, offset, straight.unit)

    def _prepare(self, step: mpmath.mpf) -> None:
        """Invert F' of the equations that are solved across the null space."""
        if not self._across.cols:
            return
        derivatives = Differences(self._residual, step * self._scale)
        jacobian = derivatives.jacobian(np.array(list(self._u))) / self._magnitude
        jacobian = mpmath.matrix(jacobian.tolist())
        inverse = mpmath.inverse(self._solved * jacobian * self._across)
        solver = self._across * inverse * self._solved / self._magnitude
        self._solver = solver.tolist()  # (n, m)
        self._least = self._scale * mpmath.mpf(10) ** (SPARE_OF_POINT - mpmath.mp.dps)

    def _point(self, shift: mpmath.matrix) -> mpmath.matrix:
        """The point (n, 1) above a place (2, 1) on the axes that solves the equations
        across the null space."""
        start = self._u + self._scale * (self._axes * shift)
        if not self._across.cols:
            return start
        point = list(start)
        for _ in range(mpmath.mp.dps):
            values = self._residual(point)
            # lists of numbers: matrices of mpmath take several times as long
            step = [mpmath.fdot(row, values) for row in self._solver]
            point = [u - du for u, du in zip(point, step, strict=True)]
            if max(abs(du) for du in step) < self._least:
                break
        return mpmath.matrix(point)

    def _value(self, shift: mpmath.matrix) -> mpmath.mpf:
        """f at a place (2, 1) on the axes."""
        values = self._residual(list(self._point(shift)))
        return mpmath.fdot(self._left_over, values) / self._magnitude


def _matrix(values: np.ndarray) -> mpmath.matrix:
    """The same numbers in mpmath."""
    out = mpmath.matrix(*values.shape)
    for place, value in np.ndenumerate(values):
        out[place] = mpmath.mpf(float(value))
    return out


def _up_to(degree: int) -> Iterator[tuple[int, int]]:
    """The exponents of all terms up to a total ``degree``."""
    for i in range(degree + 1):
        for j in range(degree + 1 - i):
            yield i, j


def _polynomial(
    values: dict[tuple[int, int], mpmath.mpf], step: mpmath.mpf
) -> dict[tuple[int, int], mpmath.mpf]:
    """The coefficients of the polynomial through ``values`` at the grid points (i, j)
    times a ``step``, i + j <= `DEGREE`, by Newton's forward differences."""
    shares = _along(_along(values, 0, _differences), 1, _differences)
    terms = _along(_along(shares, 0, _powers), 1, _powers)
    return {(i, j): value / step ** (i + j) for (i, j), value in terms.items()}


def _along(
    values: dict[tuple[int, int], mpmath.mpf],
    axis: int,
    change: Callable[[list[mpmath.mpf]], list[mpmath.mpf]],
) -> dict[tuple[int, int], mpmath.mpf]:
    """The values on every line along one axis, changed."""
    changed: dict[tuple[int, int], mpmath.mpf] = {}
    for fixed in range(DEGREE + 1):
        numbers = range(DEGREE + 1 - fixed)
        keys = [(k, fixed) if axis == 0 else (fixed, k) for k in numbers]
        line = change([values[key] for key in keys])
        changed.update(zip(keys, line, strict=True))
    return changed


def _differences(values: list[mpmath.mpf]) -> list[mpmath.mpf]:
    """Forward differences, over the factorials of their orders, of values at 0, 1,
    ..."""
    differences = list(values)
    count = len(values)
    for level in range(1, count):
        for k in range(count - 1, level - 1, -1):
            differences[k] -= differences[k - 1]
    return [value / factorial(k) for k, value in enumerate(differences)]


def _powers(shares: list[mpmath.mpf]) -> list[mpmath.mpf]:
    """Coefficients of the powers of t in the sum of ``shares`` times 1, t, t (t - 1),
    ..., by Horner's scheme."""
    powers = [mpmath.mpf(0)] * len(shares)
    for k in range(len(shares) - 1, -1, -1):
        before = [mpmath.mpf(0), *powers[:-1]]
        powers = [b - k * p for b, p in zip(before, powers, strict=True)]
        powers[0] += shares[k]
    return powers


# --- the exact place ------------------------------------------------------------------


class _Straightened(NamedTuple):
    """The ``terms`` of f(x, y + bend(x)), in which there is none with y to the power of
    the order of f less one; ``bend`` is a power series. x and y count in a ``unit``,
    in scales."""

    terms: dict[tuple[int, int], mpmath.mpf]
    bend: list[mpmath.mpf]
    unit: mpmath.mpf


class _Multiplicity(NamedTuple):
    """At the exact point f is of this ``order``, and the coefficient of y to the power
    ``row`` has a ``power``-fold root in x."""

    order: int
    row: int
    power: int


def _settled_terms(
    problem: System, located: LocatedPoint, reduction: _Reduction
) -> _Straightened | None:
    """The terms that do not vanish at the exact point, to which the ``reduction`` is
    moved; None where there is none."""
    reach = max(FARTHEST * located.error, NEAREST * problem.domain.scale)
    terms = reduction.taylor(ROUNDS[0])
    angle = _turn_off_tangents(terms)
    if angle:
        reduction.turn(angle)
        terms = reduction.taylor(ROUNDS[0])
    with mpmath.workdps(LAST + SPARE):
        multiplicities = _multiplicities(terms)
    for multiplicity in multiplicities:
        reduction.move_to(located.u)
        straight = _settled_as(reduction, multiplicity, terms)
        moved = float(np.linalg.norm(reduction.place() - located.u))
        if straight is not None and moved < reach:
            return straight
    return None


def _turn_off_tangents(terms: Terms) -> float:
    """The angle (rad) by which to turn the axes, so that no branch leaves near that of
    y, about which it would be steep; 0 where none does.

    The terms of least degree are the product of the distances from the tangents.
    """
    orders = _roots_together([terms[0, j] for j in range(DEGREE + 1)])
    order = next((order for order in orders if order >= 2), None)
    if order is None:
        return 0.0
    leading = np.array([float(terms[order - j, j]) for j in range(order + 1)])
    angles = np.linspace(0.0, np.pi, TURNS, endpoint=False)
    along_x, along_y = -np.sin(angles), np.cos(angles)
    powers = np.arange(order + 1)[:, None]
    sizes = np.abs(leading @ (along_x ** (order - powers) * along_y**powers))
    best = int(np.argmax(sizes))
    if sizes[0] >= STEEP**order * sizes[best]:
        return 0.0
    return float(angles[best])


def _settled_as(
    reduction: _Reduction, multiplicity: _Multiplicity, terms: Terms
) -> _Straightened | None:
    """The terms that do not vanish at the point of a ``multiplicity``, ``terms`` being
    those at the place from which it is looked for; None where there is none."""
    for digits in (*ROUNDS[1:], LAST):
        with mpmath.workdps(LAST + SPARE):
            unit = _own_unit(terms, multiplicity.order)
            straight = _straightened(terms, unit, multiplicity.order)
            x = _root(straight.terms, multiplicity)
            if x is None:
                return None
            shift = mpmath.matrix([x, mpmath.polyval(straight.bend[::-1], x)])
            if mpmath.norm(shift) > 1:
                return None
            shift = unit * shift
        reduction.move(shift, digits)
        terms = reduction.taylor(digits)
    with mpmath.workdps(LAST + SPARE):
        unit = _own_unit(terms, multiplicity.order)
        straight = _straightened(terms, unit, multiplicity.order)
        clean = terms_above(straight.terms)
        if min(i + j for i, j in clean) < multiplicity.order:
            return None
        return straight._replace(terms=clean)


def _own_unit(terms: Terms, order: int) -> mpmath.mpf:
    """The length in which no term of f beyond its ``order`` is larger than that of y to
    this power."""
    leading = abs(terms[0, order])
    lengths = [mpmath.mpf(1)]
    for (i, j), value in terms.items():
        beyond = i + j - order
        if beyond > 0 and value:
            lengths.append((leading / abs(value)) ** (mpmath.mpf(1) / beyond))
    return min(lengths)


def _in_unit(terms: Terms, unit: mpmath.mpf) -> Terms:
    """The terms of f with unknowns counted in a ``unit``."""
    return {(i, j): value * unit ** (i + j) for (i, j), value in terms.items()}


def _multiplicities(terms: Terms) -> list[_Multiplicity]:
    """How many roots may come together at a point nearby, the closest first."""
    candidates = []
    for order in _roots_together([terms[0, j] for j in range(DEGREE + 1)]):
        if order < 2:
            continue
        unit = _own_unit(terms, order)
        straight = _straightened(terms, unit, order)
        for row in range(order - 1):
            series = [straight.terms[i, row] for i in range(DEGREE + 1 - row)]
            powers = _counts_of_roots(series)
            candidates += [_Multiplicity(order, row, power) for power in powers]
            if powers:
                break
    return candidates


def _roots_together(series: list[mpmath.mpf]) -> list[int]:
    """The numbers of roots, with multiplicities, of a polynomial in circles about 0 that
    are clear of others (Pellet 1881), the smallest circle first."""
    size = max(abs(value) for value in series)
    if not size:
        return []
    sizes = [float(abs(value) / size) for value in series]
    counts: list[int] = []
    for radius in RADII:
        shares = [value * radius**k for k, value in enumerate(sizes)]
        count = int(np.argmax(shares))
        is_clear = 2 * shares[count] > sum(shares)
        if is_clear and 0 < count < len(series) - 1 and count not in counts:
            counts.append(count)
    return counts


def _counts_of_roots(series: list[mpmath.mpf]) -> list[int]:
    """The numbers of roots, with multiplicities, of a polynomial that lie together next
    to 0: about 0 itself, or else about their own mean.

    Where rounding leaves the place open by a tenth of the distance to the next roots, a
    circle about 0 that holds eight of them is not clear of these.
    """
    counts = _roots_together(series)
    for power in range(2, len(series) - 1):
        if power in counts or not any(series[power + 1 :]):
            continue
        center = _mean_of_roots(series, power)
        if center is None or abs(center) > FARTHEST_MEAN:
            continue
        if power in _roots_together(_moved(series, center)):
            counts.append(power)
    return counts


def _moved(series: list[mpmath.mpf], center: mpmath.mpf) -> list[mpmath.mpf]:
    """The polynomial of the distance from a ``center``, by Horner's scheme."""
    moved = list(series)
    for level in range(len(moved)):
        for k in range(len(moved) - 2, level - 1, -1):
            moved[k] += center * moved[k + 1]
    return moved


def _mean_of_roots(series: list[mpmath.mpf], power: int) -> mpmath.mpf | None:
    """The root next to 0 of the derivative of a polynomial of order ``power`` - 1, which
    is where as many roots are if they are one; None where Newton's method finds none."""
    for _ in range(power - 1):
        series = [k * value for k, value in enumerate(series)][1:]
    rates = [k * value for k, value in enumerate(series)][1:]
    root = mpmath.mpf(0)
    for _ in range(ROOT_STEPS):
        rate = mpmath.polyval(rates[::-1], root)
        if not rate:
            return None
        root -= mpmath.polyval(series[::-1], root) / rate
    return root


def _root(terms: Terms, multiplicity: _Multiplicity) -> mpmath.mpf | None:
    """The root next to 0 of the derivative of a coefficient, at which all roots of it
    come together; None where there is none."""
    row, power = multiplicity.row, multiplicity.power
    series = [terms[i, row] for i in range(DEGREE + 1 - row)]
    return _mean_of_roots(series, power)


def _straightened(terms: Terms, unit: mpmath.mpf, order: int) -> _Straightened:
    """The terms of f, of an ``order``, in a ``unit``, over the curve on which one
    derivative of f by y vanishes, so that all branches lie about it (Tschirnhausen's
    substitution)."""
    terms = _in_unit(terms, unit)
    bend = _bend(terms, order)
    rows = [[terms[i, j] for i in range(DEGREE + 1 - j)] for j in range(DEGREE + 1)]
    rows = [row + [mpmath.mpf(0)] * (DEGREE + 1 - len(row)) for row in rows]
    for level in range(DEGREE + 1):
        for j in range(DEGREE - 1, level - 1, -1):
            product = _product(rows[j + 1], bend)
            rows[j] = [a + b for a, b in zip(rows[j], product, strict=True)]
    straight = {(i, j): rows[j][i] for i, j in _up_to(DEGREE)}
    return _Straightened(straight, bend, unit)


def _bend(terms: Terms, order: int) -> list[mpmath.mpf]:
    """The power series y(x) along which the derivative of f by y of order ``order`` - 1
    vanishes."""
    power = order - 1
    rows = [
        [comb(j, power) * terms[i, j] for i in range(DEGREE + 1 - j)]
        for j in range(power, DEGREE + 1)
    ]
    rows = [row + [mpmath.mpf(0)] * (DEGREE + 1 - len(row)) for row in rows]
    slope = rows[1][0]
    bend = [mpmath.mpf(0)] * (DEGREE + 1)
    for _ in range(DEGREE + SETTLING):
        value = rows[-1]
        for row in rows[-2::-1]:
            product = _product(value, bend)
            value = [a + b for a, b in zip(row, product, strict=True)]
        bend = [y - v / slope for y, v in zip(bend, value, strict=True)]
    return bend


def _product(one: list[mpmath.mpf], other: list[mpmath.mpf]) -> list[mpmath.mpf]:
    """The product of two power series up to x^`DEGREE`."""
    return [mpmath.fdot(one[: k + 1], other[k::-1]) for k in range(len(one))]
