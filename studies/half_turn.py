"""The exact relation of two joints of a line-symmetric Bricard linkage, and what it
forbids a traced curve.

Half the loop is a half-turn, so that both scalar parts of its dual quaternion vanish,
each linear in the tangents x1, x2, x3 of half the angles. Without x3 one equation of
degree 2 in x1 and in x2 is left. Its discriminant D(x1), of degree 4, tells how arcs
lie: a curve changes sheets at real roots of D only, and does not pass from one to the
next where D < 0. The roots are computed with 50 digits.
"""

from __future__ import annotations

from itertools import product

import mpmath
import numpy as np
from scipy.optimize import brentq

from bifurc.branch import Branch
from linkages.loop import Loop

__all__ = ["SHIFT", "HalfTurn", "never_at", "samples"]

SAMPLES = 60  # of every piece
SHIFT = (
    0.7390851,
    1.2020569,
)  # rad, of joints 1 and 2, so that no root of D lies at infinity by symmetry


def samples(branch: Branch) -> np.ndarray:
    """Arclengths, ``SAMPLES`` to a piece."""
    pairs = zip(branch.breaks[:-1], branch.breaks[1:], strict=True)
    return np.concatenate(
        [np.linspace(a, b, SAMPLES, endpoint=False) for a, b in pairs]
    )


def never_at(angle: np.ndarray, value: float) -> bool:
    """Whether a continuous ``angle`` never passes ``value`` modulo 2 pi."""
    side = np.sin((angle - value) / 2)
    return bool(np.all(side[1:] * side[:-1] > 0))


def _times(a: list[mpmath.mpf], b: list[mpmath.mpf]) -> list[mpmath.mpf]:
    """Product of two quaternions."""
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    return [
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    ]


class HalfTurn:
    """The relation of joints 1 and 2 of a line-symmetric Bricard linkage and the roots
    of its discriminant.

    ``biquadratic`` (3, 3) multiplies the powers of the tangents of (theta1 - SHIFT[0])
    / 2 and (theta2 - SHIFT[1]) / 2; ``roots`` (4,) are values of theta1, complex.
    """

    def __init__(self, loop: Loop):
        with mpmath.workdps(50):
            parts = {
                bits: self._scalars(loop, bits) for bits in product((0, 1), repeat=3)
            }
            table = [[mpmath.mpf(0)] * 3 for _ in range(3)]
            for i, j, k, m in product((0, 1), repeat=4):
                table[i + k][j + m] += (
                    parts[i, j, 0][0] * parts[k, m, 1][1]
                    - parts[i, j, 1][0] * parts[k, m, 0][1]
                )
            quartic = [mpmath.mpf(0)] * 5
            for i, j in product(range(3), repeat=2):
                quartic[i + j] += (
                    table[i][1] * table[j][1] - 4 * table[i][2] * table[j][0]
                )
            found = mpmath.polyroots(quartic[::-1], maxsteps=500, extraprec=400)
            real = [abs(mpmath.im(x)) < mpmath.mpf(10) ** -30 for x in found]
            angles = [
                2 * mpmath.atan(mpmath.re(x) if r else x) + SHIFT[0]
                for x, r in zip(found, real, strict=True)
            ]
        self.biquadratic = np.array([[float(x) for x in row] for row in table])
        self.quartic = np.array([float(x) for x in quartic])
        self.roots, self.real = np.array([complex(x) for x in angles]), np.array(real)

    @staticmethod
    def _scalars(loop: Loop, bits: tuple[int, ...]) -> tuple[mpmath.mpf, mpmath.mpf]:
        """Both scalar parts of the half loop where joint i is turned by 0 or, for bit
        1, by pi."""
        zero = mpmath.mpf(0)
        whole, dual = [mpmath.mpf(1), zero, zero, zero], [zero] * 4
        for i, bit in enumerate(bits):
            half = (SHIFT[i] if i < 2 else 0) / mpmath.mpf(2) + bit * mpmath.pi / 2
            turn, twist = (
                [mpmath.cos(half), zero, zero, mpmath.sin(half)],
                mpmath.mpf(float(loop.twists[i])) / 2,
            )
            link = [mpmath.cos(twist), mpmath.sin(twist), zero, zero]
            move = [
                zero,
                mpmath.mpf(float(loop.lengths[i])) / 2,
                zero,
                mpmath.mpf(float(loop.offsets[i])) / 2,
            ]
            step = _times(turn, link)
            slide = _times(_times(turn, move), link)
            dual = [
                a + b
                for a, b in zip(_times(whole, slide), _times(dual, step), strict=True)
            ]
            whole = _times(whole, step)
        return whole[0], dual[0]

    def sheet(self, points: np.ndarray) -> np.ndarray:
        """The derivative by theta2 of the relation, whose square is D there: its sign
        tells the sheets apart."""
        half = (points[..., 0] - SHIFT[0]) / 2
        powers = np.stack(
            [np.cos(half) ** 2, np.cos(half) * np.sin(half), np.sin(half) ** 2], axis=-1
        )
        low, middle, high = np.moveaxis(powers @ self.biquadratic, -1, 0)
        angle = points[..., 1] - SHIFT[1]
        return middle * np.cos(angle) + (high - low) * np.sin(angle)

    def barred(self) -> list[float]:
        """An angle theta1 in the middle of every interval where D < 0."""
        ends = np.sort(self.roots[self.real].real)
        middles = 0.5 * (ends + np.append(ends[1:], ends[:1] + 2 * np.pi))
        powers = np.tan((middles - SHIFT[0]) / 2)[:, None] ** np.arange(5)
        return [
            float(m)
            for m, value in zip(middles, powers @ self.quartic, strict=True)
            if value < 0
        ]

    def stays(self, branch: Branch) -> bool:
        """Whether a traced branch is line-symmetric, changes sheets at real roots and
        enters no barred interval."""
        s = samples(branch)
        points = branch(s)
        sheet = self.sheet(points)
        if np.abs(np.sin((points[:, 3:] - points[:, :3]) / 2)).max() > 1e-6:
            return False
        for i in np.flatnonzero(sheet[1:] * sheet[:-1] < 0):
            at = brentq(
                lambda x: float(self.sheet(branch(x))), s[i], s[i + 1], xtol=1e-15
            )
            away = np.abs(np.sin((branch(at)[0] - self.roots) / 2))
            if not self.real[np.argmin(away)]:
                return False
        return all(never_at(points[:, 0], angle) for angle in self.barred())
