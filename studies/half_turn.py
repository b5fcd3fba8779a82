"""The exact relation of two joints of a line-symmetric Bricard linkage, and what it
forbids a traced curve.

Half the loop is a half-turn, so that both scalar parts of its dual quaternion vanish,
each linear in the tangents x1, x2, x3 of half the angles. Without x3 one equation of
degree 2 in x1 and in x2 is left. Its discriminant D(x1), of degree 4, tells how arcs
lie: a curve changes sheets at real roots of D only, and does not pass from one to the
next where D < 0. The roots are computed with 50 digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product
from typing import NamedTuple, TypeAlias

import mpmath
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from bifurc import Branch
from linkages import Loop

Floats: TypeAlias = NDArray[np.float64]
Quaternion: TypeAlias = list[mpmath.mpf]
Table: TypeAlias = list[list[mpmath.mpf]]

SAMPLES = 60  # of every piece
DIGITS = 50
REAL = mpmath.mpf(10) ** -30  # imaginary part below which a root is real
# rad, of joints 1 and 2, so that no root of D lies at infinity by symmetry
SHIFT = (0.7390851, 1.2020569)


def samples(branch: Branch) -> Floats:
    """Arclengths, ``SAMPLES`` to a piece."""
    parts = []
    for start, end in pairwise(branch.breaks):
        parts.append(np.linspace(start, end, SAMPLES, endpoint=False))
    return np.concatenate(parts)


def never_at(angle: Floats, value: float) -> bool:
    """Whether a continuous ``angle`` never passes ``value`` modulo 2 pi."""
    side = np.sin((angle - value) / 2)
    return bool(np.all(side[1:] * side[:-1] > 0))


def _times(a: Quaternion, b: Quaternion) -> Quaternion:
    """Product of two quaternions."""
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    return [
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    ]


class _Scalars(NamedTuple):
    """The scalar parts of a dual quaternion."""

    real: mpmath.mpf
    dual: mpmath.mpf


def _half_loop(loop: Loop, bits: Sequence[int]) -> _Scalars:
    """Both scalar parts of the half loop where joint i is turned by 0 or, for bit 1, by
    pi."""
    zero = mpmath.mpf(0)
    whole: Quaternion = [mpmath.mpf(1), zero, zero, zero]
    dual: Quaternion = [zero, zero, zero, zero]
    for i, bit in enumerate(bits):
        shift = SHIFT[i] if i < 2 else 0
        half = shift / mpmath.mpf(2) + bit * mpmath.pi / 2
        twist = mpmath.mpf(float(loop.twists[i])) / 2
        length = mpmath.mpf(float(loop.lengths[i])) / 2
        offset = mpmath.mpf(float(loop.offsets[i])) / 2
        turn = [mpmath.cos(half), zero, zero, mpmath.sin(half)]
        link = [mpmath.cos(twist), mpmath.sin(twist), zero, zero]
        step = _times(turn, link)
        slide = _times(_times(turn, [zero, length, zero, offset]), link)
        pairs = zip(_times(whole, slide), _times(dual, step), strict=True)
        dual = [a + b for a, b in pairs]
        whole = _times(whole, step)
    return _Scalars(whole[0], dual[0])


def _biquadratic(loop: Loop) -> Table:
    """Coefficients (3, 3) of the relation of joints 1 and 2, without joint 3.

    Both scalar parts are linear in the tangent of joint 3: P0 + P1 x3 and Q0 + Q1 x3
    vanish together where P0 Q1 - P1 Q0 does.
    """
    parts = {bits: _half_loop(loop, bits) for bits in product((0, 1), repeat=3)}
    table = [[mpmath.mpf(0)] * 3 for _ in range(3)]
    for i, j, k, m in product((0, 1), repeat=4):
        first = parts[i, j, 0].real * parts[k, m, 1].dual
        second = parts[i, j, 1].real * parts[k, m, 0].dual
        table[i + k][j + m] += first - second
    return table


def _discriminant(table: Table) -> list[mpmath.mpf]:
    """Coefficients (5,) of D, from the constant one on: b^2 - 4 a c, each of them a
    quadratic in the tangent of joint 1."""
    quartic = [mpmath.mpf(0)] * 5
    for i, j in product(range(3), repeat=2):
        quartic[i + j] += table[i][1] * table[j][1] - 4 * table[i][2] * table[j][0]
    return quartic


class HalfTurn:
    """The relation of joints 1 and 2 of a line-symmetric Bricard linkage and the roots
    of its discriminant.

    ``biquadratic`` (3, 3) multiplies the powers of the tangents of (theta1 - SHIFT[0])
    / 2 and (theta2 - SHIFT[1]) / 2; ``quartic`` (5,) those of the first of them in the
    discriminant; ``roots`` (4,) are values of theta1, complex, and ``real`` (4,) tells
    which of them are real.
    """

    def __init__(self, loop: Loop):
        with mpmath.workdps(DIGITS):
            table = _biquadratic(loop)
            quartic = _discriminant(table)
            tangents = mpmath.polyroots(quartic[::-1], maxsteps=500, extraprec=400)
            angles = []
            real = []
            for x in tangents:
                is_real = abs(mpmath.im(x)) < REAL
                angle = 2 * mpmath.atan(mpmath.re(x) if is_real else x) + SHIFT[0]
                angles.append(complex(angle))
                real.append(bool(is_real))
        self.biquadratic = np.array([[float(x) for x in row] for row in table])
        self.quartic = np.array([float(x) for x in quartic])
        self.roots = np.array(angles)
        self.real = np.array(real)

    def sheet(self, points: Floats) -> Floats:
        """The derivative by theta2 of the relation, whose square is D there: its sign
        tells the sheets apart."""
        half = (points[..., 0] - SHIFT[0]) / 2
        c, s = np.cos(half), np.sin(half)
        powers = np.stack([c**2, c * s, s**2], axis=-1)
        low, middle, high = np.moveaxis(powers @ self.biquadratic, -1, 0)
        angle = points[..., 1] - SHIFT[1]
        slope: Floats = middle * np.cos(angle) + (high - low) * np.sin(angle)
        return slope

    def barred(self) -> list[float]:
        """An angle theta1 in the middle of every interval where D < 0."""
        ends = np.sort(self.roots[self.real].real)
        following = np.append(ends[1:], ends[:1] + 2 * np.pi)
        middles = 0.5 * (ends + following)
        tangents = np.tan((middles - SHIFT[0]) / 2)
        values = tangents[:, None] ** np.arange(5) @ self.quartic
        return [float(middle) for middle in middles[values < 0]]

    def stays(self, branch: Branch) -> bool:
        """Whether a traced branch is line-symmetric, changes sheets at real roots and
        enters no barred interval."""
        points = branch(samples(branch))
        if np.abs(np.sin((points[:, 3:] - points[:, :3]) / 2)).max() > 1e-6:
            return False
        if not self._changes_sheets_at_real_roots(branch):
            return False
        return all(never_at(points[:, 0], angle) for angle in self.barred())

    def _changes_sheets_at_real_roots(self, branch: Branch) -> bool:
        """Whether the root of D next to every change of sheets is real."""

        def sheet(s: float) -> float:
            return float(self.sheet(branch(s)))

        s = samples(branch)
        values = self.sheet(branch(s))
        for i in np.flatnonzero(values[1:] * values[:-1] < 0):
            change = brentq(sheet, s[i], s[i + 1], xtol=1e-15)
            theta1 = branch(change)[0]
            distances = np.abs(np.sin((theta1 - self.roots) / 2))
            if not self.real[np.argmin(distances)]:
                return False
        return True
