"""The equations of which the conditions of the catalogue are made: terms of
`linkages.entry.Condition`.

A link is named as in the sources, 12 from joint 1 to joint 2, 61 from joint 6 to joint
1 of a 6R, a joint by its number. Every term maps a table (3, n) to the largest
difference between the sides of its equations. In a chain of equations all sides are
compared with the first. Angles are compared modulo a full turn.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from linkages.entry import Term


class TableNumbers:
    """The numbers of a table (3, n) by the names that the sources give them."""

    def __init__(self, table: np.ndarray):
        self.lengths: list[float] = table[0].tolist()
        self.twists: list[float] = table[1].tolist()
        self.offsets: list[float] = table[2].tolist()

    def a(self, link: int) -> float:
        """Length of ``link``."""
        return self.lengths[link // 10 - 1]

    def alpha(self, link: int) -> float:
        """Twist of ``link``, rad."""
        return self.twists[link // 10 - 1]

    def R(self, joint: int) -> float:
        """Offset of ``joint``."""
        return self.offsets[joint - 1]


def equation(gap: Callable[[TableNumbers], float]) -> Term:
    """The term of an equation whose sides differ by ``gap``."""
    return lambda table: abs(gap(TableNumbers(table)))


def equal_lengths(*pairs: tuple[int, int]) -> Term:
    """a_ij = a_kl for every pair of links."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        return max(abs(t.a(one) - t.a(other)) for one, other in pairs)

    return term


def equal_twists(*pairs: tuple[int, int]) -> Term:
    """alpha_ij = alpha_kl for every pair of links."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        return max(_turn(t.alpha(one) - t.alpha(other)) for one, other in pairs)

    return term


def equal_links(*pairs: tuple[int, int]) -> Term:
    """Lengths and twists of every pair of links are equal."""
    lengths = equal_lengths(*pairs)
    twists = equal_twists(*pairs)
    return lambda table: max(lengths(table), twists(table))


def opposite_twists(*pairs: tuple[int, int]) -> Term:
    """alpha_ij + alpha_kl = 0 for every pair of links."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        return max(_turn(t.alpha(one) + t.alpha(other)) for one, other in pairs)

    return term


def supplementary_twists(*pairs: tuple[int, int]) -> Term:
    """alpha_ij + alpha_kl = pi for every pair of links."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        sums = [t.alpha(one) + t.alpha(other) for one, other in pairs]
        return max(_turn(total - math.pi) for total in sums)

    return term


def zero_twist_sums(*pairs: tuple[int, int]) -> Term:
    """The chain alpha_ij + alpha_kl = ... = 0 over the pairs of links."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        sums = [t.alpha(one) + t.alpha(other) for one, other in pairs]
        return max(_turn(side - sums[0]) for side in (*sums, 0.0))

    return term


def twists_of_value(value: float, *links: int) -> Term:
    """The chain alpha_ij = ... = ``value``, rad, over the links."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        twists = [t.alpha(link) for link in links]
        return max(_turn(side - twists[0]) for side in (*twists, value))

    return term


def equal_offsets(*pairs: tuple[int, int]) -> Term:
    """R_i = R_k for every pair of joints."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        return max(abs(t.R(one) - t.R(other)) for one, other in pairs)

    return term


def opposite_offsets(*pairs: tuple[int, int]) -> Term:
    """R_i = -R_k for every pair of joints."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        return max(abs(t.R(one) + t.R(other)) for one, other in pairs)

    return term


def zero_lengths(*links: int) -> Term:
    """The chain a_ij = ... = 0 over these links; all lengths are 0 if none is given."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        if not links:
            return max(abs(length) for length in t.lengths)
        return _zero_chain([t.a(link) for link in links])

    return term


def zero_twists(table: np.ndarray) -> float:
    """All twists are 0."""
    return max(_turn(twist) for twist in TableNumbers(table).twists)


def zero_offsets(*joints: int) -> Term:
    """The chain R_i = ... = 0 over these joints; all offsets are 0 if none is given."""

    def term(table: np.ndarray) -> float:
        t = TableNumbers(table)
        if not joints:
            return max(abs(offset) for offset in t.offsets)
        return _zero_chain([t.R(joint) for joint in joints])

    return term


def _zero_chain(sides: list[float]) -> float:
    """Largest difference of the sides, and of 0, from the first."""
    return max(abs(side - sides[0]) for side in (*sides, 0.0))


def _turn(angle: float) -> float:
    """Size of an angle modulo a full turn, rad."""
    return abs((angle + math.pi) % (2 * math.pi) - math.pi)
