"""The independent check of a certificate of a transition map: what it says is proved in
ball arithmetic, or does not hold.

    python check.py map.certificate.json.gz

This file stands alone. It needs Python and python-flint, and nothing of this package. A
ball (`flint.arb`) holds the real number that it stands for, whatever is rounded, so that
every comparison that comes out true is true. The theorems, with their hypotheses and
sources, stand in docs/proof.md; the names here are those of that page.

Throughout, u (n,) are the joint angles in rad, F (6,) the closure equations of the loop
and F' (6, n) their derivative; norms of vectors and matrices are those of the largest
entry and of the largest sum of a row. What is not trusted (approximate inverses,
directions of sections) may be any numbers: they are made here, from the middles of balls.
"""

from __future__ import annotations

import gzip
import json
import math
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise, product
from typing import Any, TypeAlias

from flint import arb, arb_mat, arb_poly, arb_series, ctx

FORMAT = "bifurc certificate 1"
EQUATIONS = 6
HIGHEST = 64  # order of a series
MALFORMED = (
    ArithmeticError,
    AttributeError,
    LookupError,
    RecursionError,
    TypeError,
    ValueError,
)
PRECISIONS = (64, 1024)  # bits
WIDEST_GEOMETRY = 1e-30  # ball of a number of the table, relative; of zero, absolute
WIDEST_TUBE = 1e-8  # rad: beyond, what is proved says little of a motion
LARGEST_MISS = 1e-8  # of equations that are not solved: beyond, a rigid loop would pass
WIDEST_POINT = (
    1e-25  # rad: a near miss that is smaller is not told from a singular point
)
UNPROVED = "that these are all motions"
SLACK = 64  # the part of its reach within which a tube is known to hold what is near
SHORTEST, LONGEST = 4, 6  # loops of which all motions may be known
CIRCLE = (0.0, 3.1875)  # middle and half of an interval that holds a whole turn, in rad
NARROWEST = 2.0**-32  # rad: in cells of this half nothing is looked for
NARROW = 0.1  # rad: in a cell of this half two configurations are told apart by one joint more
VAGUE = 32  # so much wider than its cell is what two held joints hardly determine
WIDE = 0.5  # rad: no box is that wide
PASSED = 3  # boxes of a tube that a cell passes at most
DEEPEST = 14  # bisections of a direction, after which it counts as not excluded
Vector: TypeAlias = list[Any]  # of balls
Json: TypeAlias = Any


class DoesNotHold(Exception):
    """A condition of a theorem that is not met, with its place."""


def require(condition: object, what: str) -> None:
    """Raise `DoesNotHold` unless a condition is certain."""
    if not condition:
        raise DoesNotHold(what)


# --- numbers --------------------------------------------------------------------------


def number(text: str) -> arb:
    """The number that a text is, exactly or in a ball: a hexadecimal float as `float.hex`
    writes it (others might be rounded), a decimal, or "[middle +/- radius]"."""
    if "0x" in text.lower():
        exact = float.fromhex(text)
        require(exact.hex() == text, f"{text} is not the hexadecimal text of a double")
        return arb(exact)
    value = arb(text)
    require(value.is_finite(), f"{text} is not a finite number")
    return value


def arb_vector(values: Iterable[float]) -> Vector:
    """A vector of exact floats."""
    return [arb(float(value)) for value in values]


def numbers(texts: Sequence[str]) -> Vector:
    """The numbers of a list."""
    return [number(text) for text in texts]


def ball(radius: arb) -> arb:
    """All numbers of at most that size."""
    return arb(0, radius.abs_upper())


def column(values: Vector) -> arb_mat:
    """A vector as a matrix of one column."""
    return arb_mat(len(values), 1, values)


def norm(matrix: arb_mat) -> arb:
    """An upper bound of the norm, the largest sum of a row; raises `DoesNotHold` where
    an entry is not bounded."""
    sums = [sum((x.abs_upper() for x in row), arb(0)) for row in matrix.tolist()]
    return largest([total.abs_upper() for total in sums])


def largest(values: Sequence[arb]) -> arb:
    """The largest of exact numbers; raises `DoesNotHold` where one is not finite, with
    which no comparison would be true."""
    require(all(value.is_finite() for value in values), "a ball is not bounded")
    return max(values, default=arb(0))


def rows_of(matrix: arb_mat, rows: Sequence[int]) -> arb_mat:
    """Some rows of a matrix."""
    table = matrix.tolist()
    return arb_mat([table[row] for row in rows])


def stacked(matrix: arb_mat, row: Vector) -> arb_mat:
    """A matrix with one more row."""
    return arb_mat([*matrix.tolist(), row])


def identity(size: int) -> arb_mat:
    """The identity matrix."""
    return arb_mat([[int(i == j) for j in range(size)] for i in range(size)])


def approximate_inverse(matrix: arb_mat) -> arb_mat:
    """Some exact matrix, which is close to the inverse if all is well."""
    try:
        return matrix.mid().inv().mid()
    except ZeroDivisionError:
        raise DoesNotHold("a matrix has no inverse") from None


# --- the closure equations ------------------------------------------------------------

# d Rz(t) / dt = Rz(t) TURN = TURN Rz(t)
TURN = arb_mat([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]])


class Loop:
    """The closure equations F = 0 of a loop of revolute joints, T_1 ... T_n = I with
    T_i = Rz(u_i) Tz(R_i) Tx(a_i) Rx(alpha_i).

    F is half the skew part of the rotation, and the translation over ``scale``: six
    numbers that vanish where the loop is closed, and where the product is a half turn.
    """

    def __init__(self, geometry: Json):
        columns = [geometry[key] for key in ("lengths", "twists", "offsets")]
        table = [list(row) for row in zip(*map(numbers, columns), strict=True)]
        self.scale = number(geometry["scale"])
        self._require_sizes(table)
        self.table = table
        self.links = [self._link(*row) for row in table]
        self.n = len(self.links)

    def _require_sizes(self, table: Sequence[Vector]) -> None:
        """The numbers are narrow balls, and the scale does not make translations small:
        where a loop has any, it is at most twice the largest link."""
        for value in (number for row in table for number in row):
            size = value.mid().abs_upper() if value.mid() != 0 else arb(1)
            is_narrow = value.rad() <= WIDEST_GEOMETRY * size
            require(is_narrow, f"the ball {value} of the table is too wide")
        require(self.scale > 0, "the scale is not positive")
        links = [abs(length) + abs(offset) for length, _, offset in table]
        extent = largest([link.abs_upper() for link in links])
        is_fair = extent == 0 or self.scale <= 2 * extent
        require(is_fair, "the scale is larger than the loop")

    @staticmethod
    def _link(length: arb, twist: arb, offset: arb) -> arb_mat:
        sine, cosine = twist.sin_cos()
        return arb_mat(
            [
                [1, 0, 0, length],
                [0, cosine, -sine, 0],
                [0, sine, cosine, offset],
                [0, 0, 0, 1],
            ]
        )

    def dual_quaternion(self, i: int) -> Vector:
        """The unit dual quaternion (8,) of link i, translations over ``scale``."""
        length, twist, offset = self.table[i]
        s, c = (twist / 2).sin_cos()
        a, r = length / self.scale / 2, offset / self.scale / 2
        return [c, s, arb(0), arb(0), -a * s, a * c, r * s, r * c]

    def _joint(self, i: int, angle: arb) -> arb_mat:
        s, c = angle.sin_cos()
        turn: list[Vector] = [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
        return arb_mat(turn) * self.links[i]

    def equations(self, m: Any) -> Vector:
        """The six linear functions of a matrix m[i, j], (4, 4), that F and its
        derivatives are."""
        return [
            (m[2, 1] - m[1, 2]) / 2,
            (m[0, 2] - m[2, 0]) / 2,
            (m[1, 0] - m[0, 1]) / 2,
            m[0, 3] / self.scale,
            m[1, 3] / self.scale,
            m[2, 3] / self.scale,
        ]

    def at(self, u: Vector) -> Derivatives:
        """F and its derivatives at a point, or over a box."""
        return Derivatives(self, [self._joint(i, angle) for i, angle in enumerate(u)])

    def series(self, curve: Sequence[arb_poly], order: int) -> list[Vector]:
        """The coefficients (6, order + 1) of F(c(x)) as a series in x."""
        cap, ctx.cap = ctx.cap, order + 1
        rows = [[arb_series([int(i == j)]) for j in range(4)] for i in range(3)]
        for link, angle in zip(self.links, curve, strict=True):
            s, c = arb_series(angle.coeffs()).sin_cos()
            table = link.tolist()
            for i, (x, y, z, w) in enumerate(rows):
                turned = (x * c + y * s, y * c - x * s, z, w)
                rows[i] = [_combination(turned, table, j) for j in range(4)]
        ctx.cap = cap
        length = order + 1
        matrix = {
            (i, j): _padded(rows[i][j], length) for i in range(3) for j in range(4)
        }
        by_power = [
            self.equations({at: value[k] for at, value in matrix.items()})
            for k in range(length)
        ]
        return [list(values) for values in zip(*by_power, strict=True)]


def _combination(row: Sequence[arb_series], table: list[Vector], j: int) -> arb_series:
    """Entry j of a row of series times the matrix of a link, most of which is zero."""
    total = arb_series([0])
    for entry, line in zip(row, table, strict=True):
        if line[j] != 0:
            total = total + entry * line[j]
    return total


def _padded(series: arb_series, length: int) -> Vector:
    coefficients = series.coeffs()
    return coefficients + [arb(0)] * (length - len(coefficients))


class Derivatives:
    """F, F' and F'' times directions, from the ``transforms`` T_1 ... T_n."""

    def __init__(self, loop: Loop, transforms: list[arb_mat]):
        self.loop = loop
        self.transforms = transforms
        before, after = identity(4), identity(4)
        self.before = [before]  # T_1 ... T_i
        for transform in transforms:
            before = before * transform
            self.before.append(before)
        self.after = [after]  # T_i ... T_n, the last first, turned round below
        for transform in reversed(transforms):
            after = transform * after
            self.after.append(after)
        self.after.reverse()
        self.turned = [TURN * matrix for matrix in self.after]

    @property
    def value(self) -> arb_mat:
        """F, as a column."""
        return column(self.loop.equations(self.before[-1]))

    @property
    def is_no_half_turn(self) -> bool:
        """Whether the rotation is near enough to I for its skew part to decide."""
        product = self.before[-1]
        return product[0, 0] + product[1, 1] + product[2, 2] > -1

    @property
    def jacobian(self) -> arb_mat:
        """F', (6, n)."""
        pairs = zip(self.before[:-1], self.turned[:-1], strict=True)
        columns = [self.loop.equations(before * after) for before, after in pairs]
        return arb_mat(columns).transpose()

    def second(self, direction: Vector) -> arb_mat:
        """F'' times a direction (n,), which is the derivative of F' in it, (6, n)."""
        n = self.loop.n
        before = [arb_mat(4, 4)]
        for i in range(n):
            turned = self.before[i] * self.turned_joint(i) * direction[i]
            before.append(before[i] * self.transforms[i] + turned)
        after = [arb_mat(4, 4)]
        for i in reversed(range(n)):
            after.append(self.transforms[i] * after[-1] + self.turned[i] * direction[i])
        after.reverse()
        columns = []
        for i in range(n):
            change = before[i] * self.turned[i] + self.before[i] * (TURN * after[i])
            columns.append(self.loop.equations(change))
        return arb_mat(columns).transpose()

    def turned_joint(self, i: int) -> arb_mat:
        """The derivative of T_i."""
        return TURN * self.transforms[i]


# --- statements 1 and 2: tubes about a curve ------------------------------------------


class Frame:
    """A norm |S^-1 u| of vectors u (n,): that of the largest entry, but for the direction
    in which an ``inverse`` is largest, which counts less.

    A matrix that couples this direction with the others is smaller in it. S = I + (s - 1)
    v v^T about; any regular S would do.
    """

    def __init__(self, inverse: arb_mat):
        weak = max(inverse.transpose().tolist(), key=lambda v: _length(v).mid())
        unit = [(x / _length(weak)).mid() for x in weak]
        stretch = (norm(inverse).sqrt() - 1).mid()
        outer = column(unit) * arb_mat([unit])
        self.matrix = (identity(len(unit)) + outer * stretch).mid()
        self.inverse = self.matrix.inv()

    def norm(self, matrix: arb_mat) -> arb:
        """An upper bound of the norm of a matrix (n, n)."""
        return norm(self.inverse * matrix * self.matrix)

    def size(self, u: Vector) -> arb:
        """An upper bound of the norm of a vector."""
        return norm(self.inverse * column(u))

    def balls(self, radius: arb) -> Vector:
        """What holds all vectors up to a norm."""
        return (self.matrix * column([ball(radius)] * self.matrix.nrows())).entries()


def best_frame(inverse: arb_mat, defects: Sequence[arb_mat]) -> tuple[Frame, arb]:
    """The norm, this one or the plain one, in which some matrices together are smaller,
    and an upper bound of the sum of their norms."""
    choices = []
    for frame in (Frame(identity(inverse.nrows())), Frame(inverse)):
        total = sum((frame.norm(defect) for defect in defects), arb(0))
        choices.append((frame, total.abs_upper()))
    return min(choices, key=lambda choice: choice[1])


@dataclass
class Box:
    """A part of a curve with all that is within ``reach`` of it across.

    Q = {u : t.(u - c(x)) = 0 and |u - c(x)| <= reach for some x with |x| <= half}; x is
    counted from ``middle``. By theorem 1 there is at most one closed configuration on
    every section, no farther than ``radius`` from c(x); by theorem 2 there is exactly
    one with F = 0 in the ``rows``, of which the others miss by ``misses`` at most.
    """

    curve: list[arb_poly]
    middle: arb
    half: arb
    reach: arb
    normal: Vector
    velocity: Vector
    frame: Frame = field(init=False)
    contraction: arb = field(default_factory=arb)
    radius: arb = field(default_factory=arb)
    misses: arb = field(default_factory=arb)
    misfit: arb = field(default_factory=arb)  # largest F(c(x))

    def point(self, x: arb) -> Vector:
        """c(x)."""
        return [angle(x) for angle in self.curve]

    def along(self, step: Vector) -> arb:
        """t.step."""
        return _dot(self.normal, step)

    def holds_inside(self, u: Vector) -> bool:
        """Whether all points of a ball u (n,) lie in the interior of Q (the lemma)."""
        speed = self.along(self.velocity)
        ends = [self.along(_minus(u, self.point(x))) for x in (-self.half, self.half)]
        if not (ends[0] > 0 and ends[1] < 0):
            return False
        x = self.section_at(self.normal, self.along(u).mid())
        step = _minus(u, self.point(x))
        shift = self.along(step) / speed  # from x to the section that u lies on
        across = [d - v * shift for d, v in zip(step, self.velocity, strict=True)]
        return norm(column(across)) < self.reach

    @property
    def distance(self) -> arb:
        """An upper bound of how far, in any joint, these are from the curve."""
        return (norm(self.frame.matrix) * self.radius).abs_upper()

    @property
    def slack(self) -> arb:
        """What is so near to the curve is in the tube, as it is beyond the ends."""
        return self.reach / SLACK

    @cached_property
    def skewness(self) -> arb:
        """An upper bound of how many times as far from the curve a point is on its section
        as it is at least."""
        longest = norm(column(self.velocity)) * norm(arb_mat([self.normal]))
        return (1 + longest / self.along(self.velocity)).abs_upper()

    @cached_property
    def _about(self) -> list[tuple[float, float]]:
        """The middle and half of what the curve passes in every joint, in floats."""
        curve = self.point(ball(self.half))
        return [(float(x), float(x.rad()) + float(self.reach)) for x in curve]

    def may_meet(self, held: Sequence[Held]) -> bool:
        """Whether the box is near a cell; nothing is proved here."""
        for interval, (middle, half) in zip(held, self._about, strict=True):
            if interval is not None:
                away = abs(math.remainder(interval[0] - middle, 2 * math.pi))
                if away > 2 * interval[1] + 4 * half:
                    return False
        return True

    def remoteness(self, u: Vector) -> float:
        """How far a point is from what the curve passes, less than 0 inside; nothing is
        proved here."""
        pairs = zip(u, self._about, strict=True)
        return max(
            abs(math.remainder(float(x) - m, 2 * math.pi)) - h for x, (m, h) in pairs
        )

    def end(self, side: int) -> Vector:
        """What holds all closed configurations on the first (-1) or last (1) section, and
        more by the slack."""
        ends = _plus(self.point(side * self.half), self.frame.balls(self.radius))
        return thickened(ends, self.slack)

    def section_at(self, normal: Vector, height: arb) -> arb:
        """Some x of the box, with about normal.c(x) = height."""
        x = arb(0)
        for _ in range(4):
            slope = _dot(normal, [angle.derivative()(x) for angle in self.curve])
            x = x + (height - _dot(normal, self.point(x))) / slope
            x = max(-self.half, min(self.half, x.mid()))
        return x


def _minus(u: Vector, v: Vector) -> Vector:
    return [x - y for x, y in zip(u, v, strict=True)]


def _plus(u: Vector, v: Vector) -> Vector:
    return [x + y for x, y in zip(u, v, strict=True)]


def _turns(u: Vector, place: Vector) -> Vector:
    """The whole turns after which a place is nearest to u, in rad."""
    away = [float(x) / (2 * math.pi) for x in _minus(u, place)]
    return whole_turns([round(turns) for turns in away])


def _near(u: Vector, place: Vector) -> Vector:
    """The point that is whole turns from u and nearest to a place."""
    return _minus(u, _turns(u, place))


def thickened(u: Vector, radius: arb) -> Vector:
    """All points within ``radius`` of those of a ball (n,)."""
    return [x + ball(radius) for x in u]


@dataclass(frozen=True)
class Piece:
    """Where a box is: on a polynomial of a curve, from ``low`` to ``high``, with its
    ``reach``, the n - 1 ``rows`` of F that are solved, and the ``order`` of the series by
    which F is bounded on the curve."""

    polynomial: list[arb_poly]
    low: arb
    high: arb
    reach: arb
    rows: Sequence[int]
    order: int


def make_box(loop: Loop, piece: Piece) -> Box:
    """The box of a piece, of which theorems 1 and 2 are proved; raises `DoesNotHold`."""
    middle = ((piece.low + piece.high) / 2).mid()
    ends = [(piece.high - middle).abs_upper(), (middle - piece.low).abs_upper()]
    half = largest(ends)
    curve = [angle(arb_poly([middle, 1])) for angle in piece.polynomial]
    velocity = [angle.derivative()(ball(half)) for angle in curve]
    box = Box(curve, middle, half, piece.reach, _normal(curve), velocity)
    require(box.along(velocity) > 0, "the curve turns back on its sections")
    everywhere = [x + ball(piece.reach) for x in box.point(ball(half))]
    over = loop.at(everywhere)
    values = _values_along(loop, curve, ball(half), piece.order)
    box.misfit = norm(values)
    _prove_unique(box, loop, piece.rows, over, values)
    _bound_misses(box, piece.rows, over, values)
    return box


def _prove_unique(
    box: Box, loop: Loop, rows: Sequence[int], over: Derivatives, values: arb_mat
) -> None:
    """Theorem 1: u - v = (I - Y A)(u - v) - Y (F(v); 0) with A = G'(c(m)) + x F'' c' + F''
    w, |x| <= half, |w| <= reach."""
    centre = loop.at(box.point(arb(0))).jacobian
    matrix = stacked(rows_of(centre, rows), box.normal)
    inverse = approximate_inverse(matrix)
    of_rows = arb_mat([row[:-1] for row in inverse.tolist()])
    across = [ball(box.reach)] * loop.n
    defects = (
        identity(loop.n) - inverse * matrix,
        of_rows * rows_of(over.second(box.velocity), rows) * box.half,
        of_rows * rows_of(over.second(across), rows),
    )
    box.frame, box.contraction = best_frame(inverse, defects)
    require(box.contraction < 1, "the left inverse does not contract")
    misfit = (of_rows * rows_of(values, rows)).entries()
    box.radius = (box.frame.size(misfit) / (1 - box.contraction)).abs_upper()
    require(box.distance < box.reach, "the tube is narrower than the curve is exact")
    require(
        box.distance <= WIDEST_TUBE, "the curve is farther off than a motion may be"
    )


def _bound_misses(
    box: Box, rows: Sequence[int], over: Derivatives, values: arb_mat
) -> None:
    """Theorem 2: what is solved closes the loop, but for the other rows."""
    require(over.is_no_half_turn, "the loop may be off by half a turn")
    others = [row for row in range(EQUATIONS) if row not in rows]
    if others:
        slopes = rows_of(over.jacobian, others)
        moved = slopes * column(box.frame.balls(box.radius))
        box.misses = (norm(rows_of(values, others)) + norm(moved)).abs_upper()
        require(box.misses <= LARGEST_MISS, "the other equations miss by too much")


def _normal(curve: Sequence[arb_poly]) -> Vector:
    """The direction of a curve in the middle, as an exact vector of about unit length."""
    slopes = [angle.derivative()(arb(0)).mid() for angle in curve]
    length = sum((x * x for x in slopes), arb(0)).sqrt()
    require(length > 0, "the curve stands still")
    return [(x / length).mid() for x in slopes]


def _values_along(loop: Loop, curve: list[arb_poly], span: arb, order: int) -> arb_mat:
    """F(c(x)) for all x of a span about 0, (6, 1): a series with its remainder."""
    at_centre = loop.series(curve, order - 1)
    everywhere = [angle(arb_poly([span, 1])) for angle in curve]
    remainders = loop.series(everywhere, order)
    values = []
    for coefficients, remainder in zip(at_centre, remainders, strict=True):
        polynomial = arb_poly([*coefficients, remainder[order]])
        values.append(polynomial(span))
    return column(values)


@dataclass(frozen=True)
class Tube:
    """Boxes of which each begins inside the one before and ends inside the next one."""

    boxes: list[Box]

    @property
    def ends(self) -> tuple[Vector, Vector]:
        """What holds all closed configurations on the first and on the last section."""
        return self.boxes[0].end(-1), self.boxes[-1].end(1)


def make_tube(boxes: list[Box], winding: Sequence[int] | None) -> Tube:
    """The tube of boxes that overlap (the lemma), closed after so many turns of each joint
    where a ``winding`` is given; raises `DoesNotHold`."""
    for number, (box, following) in enumerate(pairwise(boxes)):
        overlap = do_overlap(box, following, [arb(0)] * len(box.normal))
        require(overlap, f"boxes {number} and {number + 1} do not overlap")
    if winding is not None:
        overlap = do_overlap(boxes[-1], boxes[0], whole_turns(winding))
        require(overlap, "the two ends do not overlap")
    return Tube(boxes)


def whole_turns(turns: Sequence[int]) -> Vector:
    """Whole turns in rad."""
    require(all(type(turn) is int for turn in turns), f"{turns} are no whole turns")
    return [2 * arb.pi() * turn for turn in turns]


def do_overlap(box: Box, following: Box, shift: Vector) -> bool:
    """Whether the end of a box is inside the following one, and the begin of that inside
    this one; the former lies ``shift`` farther on."""
    end = _minus(box.end(1), shift)
    begin = _plus(following.end(-1), shift)
    return following.holds_inside(end) and box.holds_inside(begin)


# --- statement 3: singular points -----------------------------------------------------


@dataclass(frozen=True)
class Point:
    """A singular point in u = centre + V x + W y, with what is known beforehand of its
    ``null`` space V (k vectors) and of a complement, ``range`` W.

    The ``rows`` of F, n - k of them, are those that determine y, and ``extra`` is the
    combination of all whose derivatives along V vanish too.
    """

    centre: Vector
    null: list[Vector]
    range: list[Vector]
    rows: Sequence[int]
    extra: Vector

    @property
    def basis(self) -> arb_mat:
        """[V W], (n, n)."""
        return arb_mat([*self.null, *self.range]).transpose()

    @property
    def nullity(self) -> int:
        """k."""
        return len(self.null)


def point_of(values: Json) -> Point:
    """The singular point that is written in a certificate."""
    return Point(
        numbers(values["centre"]),
        [numbers(vector) for vector in values["null"]],
        [numbers(vector) for vector in values["range"]],
        values["rows"],
        numbers(values["extra"]),
    )


@dataclass(frozen=True)
class Enclosure:
    """Where a singular point is: within ``radius`` of the centre; no other one lies within
    ``alone``; what the other equations and derivatives miss by."""

    radius: arb
    alone: arb
    misses: arb


def enclose(loop: Loop, point: Point, alone: arb) -> Enclosure:
    """Theorem 3: exactly one (u, v_1, ..., v_k) within ``alone`` of the centre and V with
    F = 0 and F' v_j = 0 in the rows, extra F' v_j = 0 and V^T v_j = V^T V_j, by Krawczyk's
    operator; raises `DoesNotHold`."""
    centre = augmented(loop, point, arb(0))
    over = augmented(loop, point, alone)
    inverse = approximate_inverse(centre.matrix)
    correction = inverse * centre.values
    defect = identity(centre.matrix.nrows()) - inverse * over.matrix
    contraction = norm(defect)
    require(contraction < 1, "Krawczyk's operator does not contract")
    radius = (norm(correction) / (1 - contraction)).abs_upper()
    require(radius < alone, "Krawczyk's operator leaves its box")

    near = augmented(loop, point, radius)
    require(near.is_no_half_turn, "the loop may be off by half a turn")
    require(near.may_vanish, "an equation does not vanish there: it is a near miss")
    require(near.range_defect < 1, "the rank is not known from below")
    return Enclosure(radius, alone, near.misses)


@dataclass(frozen=True)
class Augmented:
    """The augmented equations over a box about the centre: ``values``, derivatives
    ``matrix``, |I - C F' W| for some C, and all of F and F' v_j, those that are not among
    them as well."""

    values: arb_mat
    matrix: arb_mat
    range_defect: arb
    others: list[arb_mat]
    is_no_half_turn: bool

    @property
    def misses(self) -> arb:
        """What the equations that are not among them miss by at most."""
        return largest([norm(values) for values in self.others])

    @property
    def may_vanish(self) -> bool:
        """Whether F = 0 and F' v_j = 0 are possible."""
        return all(x.contains(0) for values in self.others for x in values.entries())


def augmented(loop: Loop, point: Point, radius: arb) -> Augmented:
    """The augmented equations over all that is within a radius of a point."""
    rows = list(point.rows)
    over = loop.at(thickened(point.centre, radius))
    selection = arb_mat([[int(i == row) for i in range(EQUATIONS)] for row in rows])
    with_extra = stacked(selection, point.extra)
    slope = (with_extra * over.jacobian).tolist()
    no_vectors = [arb(0)] * (loop.n * point.nullity)
    values = rows_of(over.value, rows).entries()
    matrix = [line + no_vectors for line in slope[:-1]]
    others = [over.value]
    for j, plain in enumerate(point.null):
        vector = thickened(plain, radius)
        image = over.jacobian * column(vector)
        values += (with_extra * image).entries()
        values += (arb_mat(point.null) * column(_minus(vector, plain))).entries()
        others.append(image)
        place = slice(loop.n * j, loop.n * (j + 1))
        for by_u, by_v in zip(
            (with_extra * over.second(vector)).tolist(), slope, strict=True
        ):
            matrix.append(by_u + _placed(by_v, place, no_vectors))
        for line in point.null:
            matrix.append([arb(0)] * loop.n + _placed(line, place, no_vectors))
    regular = selection * over.jacobian * arb_mat(point.range).transpose()
    defect = identity(len(rows)) - approximate_inverse(regular) * regular
    is_no_half_turn = over.is_no_half_turn
    return Augmented(
        column(values), arb_mat(matrix), norm(defect), others, is_no_half_turn
    )


def _placed(part: Vector, place: slice, zeros: Vector) -> Vector:
    """Zeros with a part in its place."""
    row = list(zeros)
    row[place] = part
    return row


@dataclass(frozen=True)
class Sector:
    """Where one half-branch leaves a sphere: the x (k,) of a ball, the n - 1 ``rows`` of
    F that are solved there, and a point near the solution."""

    x: Vector
    rows: Sequence[int]
    place: Vector


class Sphere:
    """The equations on the sphere |u - centre| = r about a singular point, by Taylor's
    formula with F'' over the ball inside: with u - centre = B z and z = (x, y)

        F(u) in F(c) + F'(c) B z + 1/2 sum z_j H_j z,    F'(u) B in F'(c) B + sum z_j H_j.
    """

    def __init__(self, loop: Loop, point: Point, radius: arb):
        self.loop, self.point, self.radius = loop, point, radius
        self.basis = point.basis
        self.inverse_basis = self.basis.inv()
        lengths = [_length(row) for row in self.inverse_basis.tolist()]
        coordinates = [ball(length * radius) for length in lengths]
        shift = (self.basis * column(coordinates)).entries()
        over = loop.at([c + d for c, d in zip(point.centre, shift, strict=True)])
        require(over.is_no_half_turn, "the loop may be off by half a turn")
        centre = loop.at(point.centre)
        self.value = centre.value
        self.slope = centre.jacobian * self.basis
        vectors = [*point.null, *point.range]
        self.bends = [over.second(vector) * self.basis for vector in vectors]
        self.x = coordinates[: point.nullity]
        self._bound_range(coordinates[point.nullity :])
        self._eliminate()

    def _bound_range(self, y: Vector) -> None:
        """For theorem 4: how large y is where the rows vanish, from y = (I - C F' W) y - C (F +
        F' V x + 1/2 F''(z, z))."""
        rows, k = self.point.rows, self.point.nullity
        slope = rows_of(self.slope, rows).tolist()
        of_x = arb_mat([line[:k] for line in slope])
        of_y = arb_mat([line[k:] for line in slope])
        self.from_rows = approximate_inverse(of_y)
        contraction = norm(identity(len(rows)) - self.from_rows * of_y)
        require(contraction < 1, "the range is not complementary to the null space")
        for _ in range(2):
            rest = rows_of(self.value + self._bend([*self.x, *y]), rows)
            rest = rest + of_x * column(self.x)
            bound = norm(self.from_rows * rest) / (1 - contraction)
            y = [ball(bound)] * len(y)
        self.y = y

    def _bend(self, z: Vector) -> arb_mat:
        """1/2 sum z_j H_j z, (6, 1)."""
        total = arb_mat(EQUATIONS, 1)
        for coordinate, bend in zip(z, self.bends, strict=True):
            total = total + bend * column(z) * (coordinate / 2)
        return total

    def _eliminate(self) -> None:
        """Combinations N of the equations in which F' W is about zero."""
        rows, k = list(self.point.rows), self.point.nullity
        others = [row for row in range(EQUATIONS) if row not in rows]
        of_y = arb_mat([line[k:] for line in self.slope.tolist()])
        combinations = []
        for other in others:
            weights = (rows_of(of_y, [other]) * self.from_rows).mid().entries()
            line = [arb(int(i == other)) for i in range(EQUATIONS)]
            for row, weight in zip(rows, weights, strict=True):
                line[row] = -weight
            combinations.append(line)
        combination = arb_mat(combinations)
        self.reduced_value = (combination * self.value).entries()
        self.reduced_slope = (combination * self.slope).tolist()
        bends = [(combination * bend).tolist() for bend in self.bends]
        self.reduced_bends = [
            [bend[line] for bend in bends] for line in range(len(others))
        ]

    def _sizes(self, direction: Vector) -> arb:
        """The numbers s with u = c + B (s direction, y) on the sphere."""
        k = self.point.nullity
        table = self.basis.tolist()
        of_x = [_dot(row[:k], direction) for row in table]
        of_y = [_dot(row[k:], self.y) for row in table]
        return (self.radius + ball(_length(of_y))) / _length(of_x)

    def excludes(self, direction: Vector) -> bool:
        """Whether no solution on the sphere has x in a cone of directions."""
        size = self._sizes(direction)
        z = [*(size * x for x in direction), *self.y]
        k = self.point.nullity
        rows = zip(
            self.reduced_value, self.reduced_slope, self.reduced_bends, strict=True
        )
        for value, slope, bends in rows:
            quadratic = [_dot(bend[:k], direction) for bend in bends[:k]]
            total = size * size * _dot(quadratic, direction) / 2
            mixed = [_dot(bend[k:], self.y) for bend in bends]
            total = (
                total + _dot(mixed[:k], direction) * size + _dot(mixed[k:], self.y) / 2
            )
            total = total + value + _dot(slope, z)
            if not total.contains(0):
                return True
        return False

    def holds(self, sector: Sector, direction: Vector) -> bool:
        """Whether the x of a cone of directions on the sphere lie in a sector."""
        size = self._sizes(direction)
        return _hold(sector.x, [size * part for part in direction])

    def solution_in(self, sector: Sector) -> Vector:
        """Theorem 4: what holds the only solution of the rows in a sector on the sphere,
        which exists; raises `DoesNotHold` where there may be two, or none."""
        z = [*sector.x, *self.y]
        middle = self.derivative([x.mid() for x in z], sector.rows)
        inverse = approximate_inverse(middle)
        defect = identity(self.loop.n) - inverse * self.derivative(z, sector.rows)
        frame, contraction = best_frame(inverse, [defect])
        require(contraction < 1, "a sector may hold two half-branches")
        step = _minus(sector.place, self.point.centre)
        place = self.coordinates_of(sector.place)
        values = rows_of(self.loop.at(sector.place).value, sector.rows)
        height = (_dot(step, step) - self.radius**2) / (2 * self.radius)
        misfit = (inverse * stacked(values, [height])).entries()
        distance = frame.balls(frame.size(misfit) / (1 - contraction))
        # what is mapped into itself
        is_inside = _hold(z, _plus(place, distance))
        require(is_inside, "an arc is not in its sector")
        return _plus(sector.place, (self.basis * column(distance)).entries())

    def coordinates_of(self, u: Vector) -> Vector:
        """z = (x, y) of a point u."""
        step = _minus(u, self.point.centre)
        return (self.inverse_basis * column(step)).entries()

    def derivative(self, z: Vector, rows: Sequence[int]) -> arb_mat:
        """The derivative of F in the rows and of |u - c|^2 / 2 r, by z, over a box z."""
        jacobian = self.slope
        for coordinate, bend in zip(z, self.bends, strict=True):
            jacobian = jacobian + bend * coordinate
        gram = self.basis.transpose() * self.basis
        radial = (gram * column(z)).entries()
        return stacked(rows_of(jacobian, rows), [x / self.radius for x in radial])

    def contains(self, u: Vector) -> bool:
        """Whether all points of a ball u lie inside the sphere."""
        return _length(_minus(u, self.point.centre)) < self.radius

    def require_no_other(self, sectors: Sequence[Sector]) -> int:
        """How many cones of directions it took to show that all closed configurations on
        the sphere lie in the sectors (theorem 4); raises `DoesNotHold`."""
        k = self.point.nullity
        count = 0
        for side, sign in product(range(k), (-1, 1)):
            open_cells = [([arb(0)] * (k - 1), arb(1), 0)]
            while open_cells:
                middle, half, depth = open_cells.pop()
                direction = thickened(middle, half)
                direction.insert(side, arb(sign))
                count += 1
                if self.excludes(direction):
                    continue
                if any(self.holds(sector, direction) for sector in sectors):
                    continue
                require(depth < DEEPEST, "a half-branch may be missing")
                for signs in product((-1, 1), repeat=k - 1):
                    steps = [
                        x + s * half / 2 for x, s in zip(middle, signs, strict=True)
                    ]
                    open_cells.append((steps, half / 2, depth + 1))
        return count


def _dot(u: Vector, v: Vector) -> arb:
    return sum((x * y for x, y in zip(u, v, strict=True)), arb(0))


def _hold(u: Vector, v: Vector) -> bool:
    """Whether the balls of u hold those of v."""
    return all(x.contains(y) for x, y in zip(u, v, strict=True))


def _length(u: Vector) -> arb:
    return sum((x * x for x in u), arb(0)).nonnegative_part().sqrt()


# --- statement 4: nothing missing -----------------------------------------------------


def _quaternion_product(p: Vector, q: Vector) -> Vector:
    """The product of two quaternions, the real part first."""
    a, b, c, d = p
    e, f, g, h = q
    return [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]


def _product(p: Vector, q: Vector) -> Vector:
    """The product of two dual quaternions (8,), the dual part last."""
    real = _quaternion_product(p[:4], q[:4])
    one, other = _quaternion_product(p[:4], q[4:]), _quaternion_product(p[4:], q[:4])
    return [*real, *_plus(one, other)]


def _unit(i: int) -> Vector:
    return [arb(int(j == i)) for j in range(8)]


ONE, AXIS = _unit(0), _unit(3)  # 1, and k of the axis of a joint
Held: TypeAlias = tuple[float, float] | None  # middle and half of an interval, in rad


class Chain:
    """The product Z_i G_i ... Z_j G_j of some joints in unit dual quaternions, or of the
    rest of the loop turned round: linear in a tensor of (cos u/2, sin u/2), one factor a
    joint."""

    def __init__(self, loop: Loop, joints: Sequence[int], is_rest: bool):
        self.joints = joints
        self.terms: dict[tuple[int, ...], Vector] = {}
        self._columns: dict[Any, list[Vector]] = {}
        links = [loop.dual_quaternion(joint) for joint in joints]
        for powers in product((0, 1), repeat=len(joints)):
            total = ONE
            for power, link in zip(powers, links, strict=True):
                turn = AXIS if power else ONE
                total = _product(_product(total, turn), link)
            if is_rest:  # minus its conjugate
                total = [x if i % 4 else -x for i, x in enumerate(total)]
            self.terms[powers] = total

    def columns(self, held: Sequence[Held], changed: int | None = None) -> list[Vector]:
        """What the tensor of the joints that are not held is multiplied with (8, m), or its
        derivative by the joint ``changed``."""
        key = (tuple(held), changed)
        if key not in self._columns:
            self._columns[key] = self._contracted(*key)
        return self._columns[key]

    def _contracted(self, held: Sequence[Held], changed: int | None) -> list[Vector]:
        factors: list[tuple[arb, arb] | None] = []
        for i, interval in enumerate(held):
            if interval is None:
                factors.append(None)
                continue
            s, c = (arb(*interval) / 2).sin_cos()
            factors.append((-s / 2, c / 2) if i == changed else (c, s))
        sums: dict[tuple[int, ...], Vector] = {}
        for powers, term in self.terms.items():
            weight = arb(1)
            free = []
            for power, factor in zip(powers, factors, strict=True):
                if factor is None:
                    free.append(power)
                else:
                    weight = weight * factor[power]
            weighted = [weight * x for x in term]
            former = sums.get(tuple(free))
            sums[tuple(free)] = _plus(former, weighted) if former else weighted
        return [sums[free] for free in sorted(sums)]


def chains_of(loop: Loop, first: int) -> list[Chain]:
    """The halves of a loop, from one joint on."""
    joints = [(first + i) % loop.n for i in range(loop.n)]
    half = (loop.n + 1) // 2
    return [Chain(loop, joints[:half], False), Chain(loop, joints[half:], True)]


def left_inverse(matrix: arb_mat) -> arb_mat:
    """Some exact matrix, which is close to a left inverse if all is well."""
    transposed = matrix.mid().transpose()
    return (approximate_inverse(transposed * matrix) * transposed).mid()


def weighted_norm(matrix: arb_mat) -> tuple[arb, Vector]:
    """An upper bound of the norm of a matrix (n, n) of vectors whose entries are divided by
    weights, and these; raises `DoesNotHold` where an entry is not bounded."""
    sizes = arb_mat([[x.abs_upper() for x in row] for row in matrix.tolist()])
    weights = [arb(1)] * sizes.nrows()
    for _ in range(3):
        sums = (sizes * column(weights)).entries()
        least = largest(sums) / 64 + arb(2) ** -64
        weights = [(x + least).mid() for x in sums]
    sums = (sizes * column(weights)).entries()
    ratios = [(x / y).abs_upper() for x, y in zip(sums, weights, strict=True)]
    return largest(ratios), weights


def null_direction(matrix: arb_mat) -> Vector:
    """About the vector, of length 1, that a matrix of exact numbers makes shortest."""
    square = matrix.transpose() * matrix
    shifted = square + identity(matrix.ncols()) * arb(2) ** -30
    inverse = approximate_inverse(shifted)
    vector = column(arb_vector(math.sin(1 + 3 * i) for i in range(matrix.ncols())))
    for _ in range(2):
        vector = (inverse * vector).mid()
        vector = (vector / _length(vector.entries())).mid()
    entries: Vector = vector.entries()
    return entries


@dataclass(frozen=True)
class Family:
    """All M = M_0 + sum d_i M_i, with the d_i in the balls ``steps``, and M_0 and M_i
    ``middle`` and ``slopes``."""

    middle: arb_mat
    slopes: list[arb_mat]
    steps: Vector

    def multiplied(self, left: arb_mat) -> Family:
        """The products with a matrix of exact numbers."""
        slopes = [left * slope for slope in self.slopes]
        return Family(left * self.middle, slopes, self.steps)

    @property
    def change(self) -> arb_mat:
        """What holds all sum d_i M_i."""
        total = arb_mat(self.middle.nrows(), self.middle.ncols())
        for slope, step in zip(self.slopes, self.steps, strict=True):
            total = total + slope * step
        return total

    def changed(self, z: arb_mat) -> arb_mat:
        """What holds all sum d_i M_i z, closer than the product does."""
        total = arb_mat(self.middle.nrows(), 1)
        for slope, step in zip(self.slopes, self.steps, strict=True):
            total = total + (slope * z) * step
        return total


def kernel_of(family: Family) -> Vector | None:
    """Theorem 6, 1: what holds the vector z that some M makes zero, up to a factor; None
    where no M does. Raises `DoesNotHold` where one M may make two vectors zero."""
    bordered = stacked(family.middle, null_direction(family.middle))
    inverse = left_inverse(bordered)
    of_rows = arb_mat([row[:-1] for row in inverse.tolist()])
    rest = identity(bordered.ncols()) - inverse * bordered
    bent = family.multiplied(of_rows)
    constant = column([row[-1] for row in inverse.tolist()])
    z = _fixed(rest - bent.change, constant)
    for _ in range(3):
        z = constant + rest * z - bent.changed(z)
    across = family.multiplied((identity(8) - family.middle * of_rows).mid())
    values = across.middle * z + across.changed(z)
    entries: Vector = z.entries()
    return entries if all(x.contains(0) for x in values.entries()) else None


def _fixed(defect: arb_mat, constant: arb_mat) -> arb_mat:
    """What holds all z = constant + defect z; raises `DoesNotHold` where there may be
    several."""
    contraction, weights = weighted_norm(defect)
    require(contraction < 1, "two configurations may be in one cell")
    ratios = zip(constant.entries(), weights, strict=True)
    size = largest([(x / w).abs_upper() for x, w in ratios]) / (1 - contraction)
    return column([ball(size * w) for w in weights])


def angles_of(tensor: Vector) -> Vector | None:
    """The angles u of one or two joints whose (cos u/2, sin u/2) a tensor is the product of,
    up to a factor; None where it is no product. Raises `DoesNotHold` where it may be
    zero."""
    if len(tensor) < 2:
        return []
    if len(tensor) == 2:
        return [_angle(*tensor)]
    a, b, c, d = tensor
    if not (a * d - b * c).contains(0):
        return None
    ratios = [[[a, c], [b, d]], [[a, b], [c, d]]]
    return [_angle(*max(equal, key=_middle_size)) for equal in ratios]


def _middle_size(vector: Vector) -> float:
    return math.hypot(*(float(x) for x in vector))


def _angle(c: arb, s: arb) -> arb:
    """The angle u with (cos u/2, sin u/2) : (c, s), or any angle where both may be zero."""
    is_cosine_larger = abs(float(c)) > abs(float(s))
    if (c if is_cosine_larger else s).contains(0):
        return ball(arb(CIRCLE[1]))
    if is_cosine_larger:
        return 2 * (s / c).atan()
    return arb.pi() - 2 * (c / s).atan()


class Leaf:
    """What holds all points of a ball at which F is no larger than ``misfit``: the middle and
    all sums of ``directions`` (n,), one for each joint that is ``held`` and a ball of what is
    left, times what is in the balls ``steps``. F' at the middle is ``slope``."""

    def __init__(self, loop: Loop, hull: Vector, held: Sequence[int], misfit: arb):
        middle = [x.mid() for x in hull]
        centre = loop.at(middle)
        self.slope, self.over = centre.jacobian, loop.at(hull)
        away = _minus(hull, middle)
        self.steps = [*(away[joint] for joint in held), arb(1)]
        free = [joint for joint in range(loop.n) if joint not in held]
        bent = self.over.second(away) * column(away) / 2
        values = column([ball(misfit)] * EQUATIONS) - centre.value - bent
        moved = self._solved(held, free, values, away)
        self.directions = [
            [arb(int(i == joint)) for i in range(loop.n)] for joint in held
        ]
        self.directions.append([arb(0)] * loop.n)
        for direction, part in zip(self.directions, moved, strict=True):
            for joint, value in zip(free, part, strict=True):
                direction[joint] = value

    def _solved(
        self, held: Sequence[int], free: Sequence[int], values: arb_mat, away: Vector
    ) -> list[Vector]:
        """How the free joints follow each that is held, and a ball of what is left: with steps
        a and any matrix C, a_free = C (values - F' a_held) + (I - C F') a_free."""
        if not free:
            return [[]] * len(self.steps)
        columns = self.slope.transpose()
        of_held, of_free = (rows_of(columns, some).transpose() for some in (held, free))
        inverse = left_inverse(of_free)
        follows = (-inverse * of_held).mid()
        rest = inverse * values
        rest += (identity(len(free)) - inverse * of_free) * column(
            [away[i] for i in free]
        )
        rest -= (inverse * of_held + follows) * column([away[i] for i in held])
        return [*follows.transpose().tolist(), rest.entries()]


@dataclass(frozen=True)
class Cell:
    """All configurations in which some joints are ``held`` in intervals, and the boxes of
    tubes that may pass there."""

    held: tuple[Held, ...]
    boxes: list[Box]

    @property
    def joints(self) -> list[int]:
        """The joints that are held."""
        return [joint for joint, one in enumerate(self.held) if one]

    @property
    def widest(self) -> tuple[int, float]:
        """The joint that is held in the widest interval, and half of that."""
        halves = [interval[1] if interval else 0.0 for interval in self.held]
        joint = max(range(len(halves)), key=halves.__getitem__)
        return joint, halves[joint]

    def __str__(self) -> str:
        places = [
            f"joint {i} = {interval[0]:.6f}"
            for i, interval in enumerate(self.held, 1)
            if interval
        ]
        return ", ".join(places)

    def halves(self, joint: int) -> Iterator[Cell]:
        """Two cells that hold all of this one."""
        middle, half = self.held[joint] or CIRCLE
        for side in (-half / 2, half / 2):
            interval = (middle + side, half / 2)
            held = (*self.held[:joint], interval, *self.held[joint + 1 :])
            yield Cell(held, [box for box in self.boxes if box.may_meet(held)])


class Motions:
    """All motions of a loop of four to six joints (theorem 6), beside the boxes of tubes
    and spheres, their centres and radii, that are known."""

    def __init__(
        self,
        loop: Loop,
        first: int,
        boxes: list[Box],
        spheres: list[tuple[Vector, arb]],
    ):
        require(SHORTEST <= loop.n <= LONGEST, f"of {loop.n} joints nothing is known")
        self.loop, self.boxes, self.spheres = loop, boxes, spheres
        self.chains = chains_of(loop, first)

    def cells(self, joints: Sequence[int]) -> Iterator[Cell]:
        """The cells that are looked at until all closed configurations that are not in
        tubes or spheres are isolated; raises `DoesNotHold` where that is not reached. Of
        each chain some joint is among those that are held at first."""
        for chain in self.chains:
            is_held = any(joint in joints for joint in chain.joints)
            require(is_held, "a chain is not held")
        held = [CIRCLE if joint in joints else None for joint in range(self.loop.n)]
        open_cells = [Cell(tuple(held), self.boxes)]
        while open_cells:
            cell = open_cells.pop()
            yield cell
            joint, half = cell.widest
            try:
                u = self.configuration(cell)
                if u is None or self._is_known(u, cell):
                    continue
                is_vague = not largest([x.rad() for x in u]) < VAGUE * half
            except DoesNotHold:
                is_vague = True
            if is_vague and half < NARROW and None in cell.held:
                joint = cell.held.index(None)
            wide = (cell.held[joint] or CIRCLE)[1]
            require(wide > NARROWEST, f"configurations may be left about {cell}")
            open_cells += cell.halves(joint)

    def _is_known(self, u: Vector, cell: Cell) -> bool:
        """Whether a ball holds no closed configuration but one, or known ones."""
        if largest([x.rad() for x in u]) > WIDE:
            return False
        for centre, radius in self.spheres:
            if _length(_minus(_near(u, centre), centre)) < radius:
                return True
        return _holds(self._is_on_map, u, cell) or _holds(self._is_single, u, cell)

    def configuration(self, cell: Cell) -> Vector | None:
        """What holds all closed configurations of a cell; None if there are none. Raises
        `DoesNotHold` where two are not told from each other."""
        z = kernel_of(self._family(cell))
        if z is None:
            return None
        u = [arb(*(interval or CIRCLE)) for interval in cell.held]
        for chain in self.chains:
            free = [joint for joint in chain.joints if cell.held[joint] is None]
            tensor, z = z[: 2 ** len(free)], z[2 ** len(free) :]
            angles = angles_of(tensor)
            if angles is None:
                return None
            for joint, angle in zip(free, angles, strict=True):
                u[joint] = angle
        return u

    def _family(self, cell: Cell) -> Family:
        """The matrices (8, m) that make the tensors of the free joints of both chains zero
        where the loop is closed."""
        held = [[cell.held[joint] for joint in chain.joints] for chain in self.chains]
        middles = [[one and (one[0], 0.0) for one in intervals] for intervals in held]
        pairs = zip(self.chains, middles, strict=True)
        parts = [chain.columns(intervals) for chain, intervals in pairs]
        slopes, steps = [], []
        for side, intervals in enumerate(held):
            for place, interval in enumerate(intervals):
                if interval:
                    columns = [[[arb(0)] * 8] * len(part) for part in parts]
                    columns[side] = self.chains[side].columns(intervals, place)
                    slopes.append(_matrix_of(columns))
                    steps.append(ball(arb(interval[1])))
        return Family(_matrix_of(parts), slopes, steps)

    def _is_on_map(self, u: Vector, cell: Cell) -> bool:
        """Whether a closed configuration in a ball u lies within the slack of a curve."""
        nearest = sorted(cell.boxes, key=lambda box: box.remoteness(u))[:PASSED]
        require(nearest, "no curve is near")
        normal = nearest[0].normal
        height = _dot(normal, u)
        wider = height + ball(height.rad() / 64)
        ends = wider.lower(), wider.upper()
        hull, heights, rates, misfit = u, [], [], arb(0)
        for box in nearest:
            turns = _turns(u, box.point(arb(0)))
            shift = _dot(normal, turns)
            low, high = (box.section_at(normal, (end - shift).mid()) for end in ends)
            if low < high:
                heights.append(
                    [_dot(normal, box.point(x)) + shift for x in (low, high)]
                )
                curve = _plus(box.point(low.union(high)), turns)
                hull = [x.union(y) for x, y in zip(hull, curve, strict=True)]
                rates.append(box.misfit * box.skewness / box.slack)
                misfit = max(misfit, box.misfit)
        if not _are_covered(height, heights):
            return False
        leaf = Leaf(self.loop, hull, cell.joints, misfit)
        return self._gain(leaf, [normal]) * largest(rates) < 1

    def _is_single(self, u: Vector, cell: Cell) -> bool:
        """Whether there is one closed configuration at most in a ball."""
        leaf = Leaf(self.loop, u, cell.joints, arb(0))
        return self._gain(leaf, []).is_finite()

    def _gain(self, leaf: Leaf, rows: list[Vector]) -> arb:
        """How many times as far from each other as their F are two points of a leaf on one
        section, in more ``rows``, at most: |Y| / (1 - q) in some weights, |I - Y A| < q for
        all A whose rows are means of those of F' in the leaf. Raises `DoesNotHold` unless
        q < 1."""
        matrix = arb_mat([*leaf.slope.tolist(), *rows])
        inverse = left_inverse(matrix)
        of_rows = arb_mat([row[:EQUATIONS] for row in inverse.tolist()])
        defect = identity(self.loop.n) - inverse * matrix
        for direction, step in zip(leaf.directions, leaf.steps, strict=True):
            defect = defect - of_rows * leaf.over.second(direction) * step
        contraction, weights = weighted_norm(defect)
        require(contraction < 1, "the left inverse does not contract")
        pairs = zip(of_rows.tolist(), weights, strict=True)
        scaled = arb_mat([[x / weight for x in row] for row, weight in pairs])
        gain: arb = norm(scaled) * largest(weights) / (1 - contraction)
        return gain


def _matrix_of(columns: list[list[Vector]]) -> arb_mat:
    """The columns of both chains beside each other."""
    one, other = columns
    return arb_mat(one + other).transpose()


def _holds(condition: Callable[..., bool], *values: Any) -> bool:
    """Whether a condition is certain; not where it raises `DoesNotHold`."""
    try:
        return condition(*values)
    except DoesNotHold:
        return False


def _are_covered(height: arb, parts: Sequence[Vector]) -> bool:
    """Whether intervals, each from one ball to another, cover a ball."""
    reached = height.lower()
    for low, high in sorted(parts, key=lambda part: float(part[0])):
        if low <= reached:
            reached = max(reached, high.lower())
    return bool(reached >= height.upper())


# --- a certificate --------------------------------------------------------------------


@dataclass
class Statement:
    """A statement of a certificate: its ``name``, the numbers with which it holds, what of
    it does not, and how long it took."""

    name: str
    numbers: str = ""
    failures: list[str] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def holds(self) -> bool:
        """Whether all of it holds."""
        return not self.failures

    def __str__(self) -> str:
        verdict = "holds" if self.holds else f"does not hold: {self.failures[0]}"
        more = len(self.failures) - 1
        if more > 0:
            verdict += f" (and {more} more)"
        numbers = f"; {self.numbers}" if self.numbers else ""
        return f"{self.name}: {verdict}{numbers} ({self.seconds:.1f} s)"


class Check:
    """The statements of a certificate, checked one after the other."""

    def __init__(self, certificate: Json):
        require(certificate["format"] == FORMAT, f"the format is not {FORMAT!r}")
        least, most = PRECISIONS
        require(least <= certificate["precision"] <= most, "the precision is unusual")
        ctx.prec = certificate["precision"]
        self.certificate = certificate
        self.loop = Loop(certificate["geometry"])
        self.curves = [
            [[arb_poly(numbers(angle)) for angle in piece] for piece in curve["pieces"]]
            for curve in certificate["curves"]
        ]
        self.tubes: list[Tube | None] = []
        self.enclosed: list[tuple[Vector, arb]] = []  # singular points
        self.exits: list[tuple[Json, Vector]] = []  # half-branches, and where they are

    def statements(self) -> Iterator[Statement]:
        """What holds, as soon as it is known; the last one rests on the others."""
        self._require_used_pieces()
        statements = []
        for statement in (
            self._no_jump,
            self._motion,
            lambda: self._of_points("singular points", self._check_point),
            lambda: self._of_points("half-branches", self._check_sphere),
        ):
            statements.append(statement())
            yield statements[-1]
        if self.tubes and not self._open_ends:
            statements.append(self._joined(statements))
            yield statements[-1]
        if self.has_all_motions:
            yield self._all_motions(statements)

    @property
    def _motions(self) -> Any:
        """What an older certificate does not have."""
        return self.certificate.get("motions", "the certificate is an older one")

    @property
    def has_all_motions(self) -> bool:
        """Whether theorem 6 is claimed."""
        return isinstance(self._motions, dict)

    def _no_jump(self) -> Statement:
        """Theorem 1, with the lemma on tubes."""
        statement = Statement("no jump")
        began = time.process_time()
        for number, tube in enumerate(self.certificate["tubes"]):
            try:
                self._require_ends(tube)
                boxes = [self._box(tube["curve"], *values) for values in tube["boxes"]]
                made = make_tube(boxes, tube.get("winding"))
                self._require_new(made)
                self.tubes.append(made)
            except DoesNotHold as reason:
                statement.failures.append(f"{self._tube_name(number)}: {reason}")
                self.tubes.append(None)
        boxes = self._boxes
        radius = largest([box.distance for box in boxes])
        self._compare(statement, radius, "radius")
        contraction = float(largest([box.contraction for box in boxes]))
        reach = min((float(box.reach) for box in boxes), default=0.0)
        statement.numbers = (
            f"{len(boxes)} boxes in {len(self.tubes)} tubes; every closed configuration "
            f"within {reach:.1e} across lies within {float(radius):.1e} of the curve; "
            f"contraction {contraction:.2f} at most"
            if boxes
            else "there are no boxes"
        )
        statement.seconds = time.process_time() - began
        return statement

    def _require_used_pieces(self) -> None:
        """Every piece of a curve is that of a box or of a half-branch: of another one
        nothing would be proved."""
        used = {
            (tube["curve"], box[0])
            for tube in self.certificate["tubes"]
            for box in tube["boxes"]
        }
        for point in self.certificate["points"]:
            used |= {(one["curve"], one["piece"]) for one in point["half_branches"]}
        written = {
            (k, number)
            for k, curve in enumerate(self.curves)
            for number, piece in enumerate(curve)
            if piece
        }
        require(used == written, "the pieces of the curves are not those that are used")

    def _require_ends(self, tube: Json) -> None:
        """A tube has boxes, and either closes or has two ends."""
        require(len(tube["boxes"]) > 0, "it has no boxes")
        require(("winding" in tube) != ("ends" in tube), "it has no ends, or too many")
        if "winding" in tube:
            is_whole = isinstance(tube["winding"], list)
            require(is_whole, "how it closes is not said")
            return
        require(len(tube["ends"]) == 2, "it has not two ends")
        points = range(len(self.certificate["points"]))
        for end in tube["ends"]:
            is_known = end is None or end["point"] in points
            require(is_known, "an end is at no point")

    def _require_new(self, tube: Tube) -> None:
        """The middle of a tube lies in no other one: the same motion is not listed
        twice."""
        middle = tube.boxes[len(tube.boxes) // 2].end(0)
        for box in self._boxes:
            is_new = not box.holds_inside(_near(middle, box.point(arb(0))))
            require(is_new, "it runs where another one does")

    def _box(self, curve: int, piece: int, *values: Any) -> Box:
        low, high, reach, rows, order = values
        require(0 < order <= HIGHEST, f"the order {order} is not from 1 to {HIGHEST}")
        is_selection = len(set(rows)) == self.loop.n - 1 and set(rows) <= set(
            range(EQUATIONS)
        )
        require(is_selection, f"the rows {rows} are not {self.loop.n - 1} equations")
        sizes = [number(text) for text in (low, high, reach)]
        place = Piece(
            self.curves[curve][piece], sizes[0], sizes[1], sizes[2], rows, order
        )
        return make_box(self.loop, place)

    @property
    def _boxes(self) -> list[Box]:
        return [box for tube in self.tubes if tube for box in tube.boxes]

    def _tube_name(self, number: int) -> str:
        curve = self.certificate["curves"][self.certificate["tubes"][number]["curve"]]
        return f"tube {number} of {curve['name']}"

    def _motion(self) -> Statement:
        """Theorem 2, which the same boxes prove."""
        statement = Statement("motion")
        misses = largest([box.misses for box in self._boxes])
        self._compare(statement, misses, "misses")
        words = (
            f"on every section {self.loop.n - 1} of the 6 equations are solved exactly"
        )
        others = f", the others miss by {float(misses):.1e} at most"
        statement.numbers = words + (": the loop closes" if misses == 0 else others)
        if not self._boxes:
            statement.numbers = "there are no boxes"
        for number, tube in enumerate(self.tubes):
            if tube is None:
                statement.failures.append(f"{self._tube_name(number)} does not hold")
        return statement

    def _compare(self, statement: Statement, value: arb, claim: str) -> None:
        """Let a statement fail unless a value is as small as the certificate claims."""
        if not value <= number(self.certificate["claims"][claim]):
            failure = f"the {claim} {float(value):.1e} exceeds what is claimed"
            statement.failures.append(failure)

    def _of_points(self, name: str, check: Callable[[Json], str]) -> Statement:
        """What is checked of every singular point."""
        began = time.process_time()
        statement = Statement(name)
        words = []
        for point in self.certificate["points"]:
            try:
                words.append(f"{point['name']} {check(point)}")
            except DoesNotHold as reason:
                statement.failures.append(f"{point['name']}: {reason}")
        statement.numbers = ", ".join(words) or "there are none"
        statement.seconds = time.process_time() - began
        return statement

    def _check_point(self, values: Json) -> str:
        """Theorem 3."""
        point = point_of(values)
        enclosure = enclose(self.loop, point, number(values["alone"]))
        within = number(values["within"])
        require(enclosure.radius <= within, "the enclosure is wider than is claimed")
        require(
            within <= WIDEST_POINT, "the enclosure is too wide: it may be a near miss"
        )
        is_inside = arb(self.loop.n).sqrt() * within < number(values["sphere"])
        require(is_inside, "the point may lie outside of its sphere")
        self._require_new_point(point.centre, within)
        rank = self.loop.n - point.nullity
        return (
            f"rank {rank} within {float(enclosure.radius):.1e}, alone within "
            f"{float(enclosure.alone):.1e}, misses {float(enclosure.misses):.1e}"
        )

    def _require_new_point(self, centre: Vector, within: arb) -> None:
        """No other enclosure overlaps this one: the same point is not listed twice."""
        for other, radius in self.enclosed:
            away = _minus(_near(centre, other), other)
            is_new = any(x.abs_lower() > within + radius for x in away)
            require(is_new, "it is listed twice")
        self.enclosed.append((centre, within))

    def _check_sphere(self, values: Json) -> str:
        """Theorem 4."""
        sphere = Sphere(self.loop, point_of(values), number(values["sphere"]))
        sectors = []
        for half_branch in values["half_branches"]:
            polynomial = self.curves[half_branch["curve"]][half_branch["piece"]]
            x = number(half_branch["x"])
            turns = whole_turns(half_branch["turns"])
            place = _minus([angle(x) for angle in polynomial], turns)
            sector = Sector(numbers(half_branch["sector"]), half_branch["rows"], place)
            solution = sphere.solution_in(sector)
            self.exits.append((half_branch, _plus(solution, turns)))
            sectors.append(sector)
        require(are_disjoint(sectors), "two sectors overlap")
        is_named = values["kind"] == _kind(len(sectors))
        require(is_named, f"{len(sectors)} half-branches make no {values['kind']}")
        sphere.require_no_other(sectors)
        return f"{len(sectors)} on the sphere of {float(sphere.radius):.1e}"

    @property
    def _open_ends(self) -> list[str]:
        """Where motions may leave what the certificate covers."""
        covered = {tube["curve"] for tube in self.certificate["tubes"]}
        names = [curve["name"] for curve in self.certificate["curves"]]
        open_ends = [name for k, name in enumerate(names) if k not in covered]
        for number, tube in enumerate(self.certificate["tubes"]):
            if None in tube.get("ends", []):
                open_ends.append(f"an end of {self._tube_name(number)}")
        for point in self.certificate["points"]:
            if any("tube" not in one for one in point["half_branches"]):
                open_ends.append(f"a half-branch of {point['name']}")
        return open_ends

    def _joined(self, others: Sequence[Statement]) -> Statement:
        """Theorem 5: besides, every tube that does not close ends inside spheres, and
        every half-branch is inside a tube."""
        statement = Statement("joined", "a motion that is on the map never leaves it")
        if not all(other.holds for other in others):
            statement.failures.append("it rests on the others")
            return statement
        for number, values in enumerate(self.certificate["tubes"]):
            if "winding" in values:
                continue
            pairs = zip(self._tube(number).ends, values["ends"], strict=True)
            if not all(self._is_inside(end, place) for end, place in pairs):
                failure = f"{self._tube_name(number)} ends outside of its sphere"
                statement.failures.append(failure)
        for half_branch, u in self.exits:
            box = self._tube(half_branch["tube"]).boxes[half_branch["box"]]
            if not box.holds_inside(u):
                statement.failures.append("a half-branch is not in its tube")
        return statement

    def _all_motions(self, others: Sequence[Statement]) -> Statement:
        """Theorem 6: besides, closed configurations elsewhere are isolated."""
        statement = Statement("all motions")
        if self._open_ends or not all(other.holds for other in others):
            statement.failures.append("it rests on the others")
            return statement
        began = time.process_time()
        spheres = [
            (numbers(point["centre"]), number(point["sphere"]))
            for point in self.certificate["points"]
        ]
        choice = self._motions
        try:
            motions = Motions(self.loop, choice["first"], self._boxes, spheres)
            count = sum(1 for _ in motions.cells(choice["held"]))
            words = self._where_motions_are(spheres)
            statement.numbers = f"{words}; {count} cells"
        except DoesNotHold as reason:
            statement.failures.append(str(reason))
        statement.seconds = time.process_time() - began
        return statement

    def _where_motions_are(self, spheres: Sequence[tuple[Vector, arb]]) -> str:
        if not self.tubes and not spheres:
            return "there is no motion"
        if not spheres:
            return "every motion is on the map"
        radius = float(largest([radius for _, radius in spheres]))
        return f"every motion is on the map, or stays within {radius:.1e} of a singular point"

    def _tube(self, number: int) -> Tube:
        tube = self.tubes[number]
        if tube is None:
            raise DoesNotHold(f"{self._tube_name(number)} does not hold")
        return tube

    def _is_inside(self, end: Vector, place: Json) -> bool:
        """Whether all of an end lies inside the sphere of a point."""
        point = self.certificate["points"][place["point"]]
        inner = _minus(end, whole_turns(place["turns"]))
        distance = _length(_minus(inner, numbers(point["centre"])))
        return distance < number(point["sphere"])

    @property
    def unclaimed(self) -> list[str]:
        """What the certificate says nothing of: what its maker left open, where motions
        may leave what it covers, and what no certificate of this format holds."""
        beyond = [f"where motions go beyond {place}" for place in self._open_ends]
        if not self.has_all_motions:
            beyond.append(f"{UNPROVED} ({self._motions})")
        return [*self.certificate["open"], *beyond]


def _kind(half_branches: int) -> str | None:
    """What a singular point on smooth curves is; where none or one leaves it, nothing
    that is known here."""
    if half_branches < 2:
        return None
    return "bifurcation" if half_branches > 2 else "rank drop"


def are_disjoint(sectors: Sequence[Sector]) -> bool:
    """Whether no two sectors have a point in common."""
    for number, sector in enumerate(sectors):
        for other in sectors[:number]:
            pairs = zip(sector.x, other.x, strict=True)
            if all(x.overlaps(y) for x, y in pairs):
                return False
    return True


def read_certificate(path: str) -> Json:
    """The content of a file."""
    opened = gzip.open if path.endswith(".gz") else open
    with opened(path, "rt", encoding="utf-8") as file:
        try:
            return json.load(file)
        except RecursionError:
            raise ValueError("it is nested too deeply") from None


def check_certificate(certificate: Json, say: Callable[[str], object]) -> bool:
    """Whether all statements of a certificate hold; each is said in a line."""
    holds = True
    try:
        check = Check(certificate)
        for statement in check.statements():
            say(str(statement))
            holds = holds and statement.holds
        for words in check.unclaimed:
            say(f"not claimed: {words}")
        claims = [check.tubes, certificate["points"], check.has_all_motions]
        require(any(claims), "nothing is proved")
    except DoesNotHold as reason:
        say(f"does not hold: {reason}")
        return False
    except MALFORMED as error:
        say(f"does not hold: it is no whole certificate ({error!r})")
        return False
    return holds


if __name__ == "__main__":
    sys.exit(0 if check_certificate(read_certificate(sys.argv[1]), print) else 6)
