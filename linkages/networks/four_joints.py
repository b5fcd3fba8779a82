"""When four Bennett loops around an axis leave a Bennett linkage: joints 2, 4, 6, 8 of
the outer loop all straight or all folded (Song 2013, section 5.4.5)."""

from __future__ import annotations

from linkages.construction.numbers import Number, atan, tan


def bennett_gap(alpha: Number, beta: Number, gamma: Number, delta: Number) -> Number:
    """tan(alpha/2) tan(beta/2) - tan(gamma/2) tan(delta/2), twists in rad: 0 where the
    outer loop moves.

    Equivalent to (5.4.1) of Song (2013), that the pairs a, b and c, d in line have one
    Bennett ratio; it makes pairs that are folded fit as well, of which nothing is said
    there.
    """
    return tan(alpha / 2) * tan(beta / 2) - tan(gamma / 2) * tan(delta / 2)


def bennett_twist(alpha: Number, gamma: Number, delta: Number) -> Number:
    """The twist beta (rad) for which the outer loop moves."""
    return 2 * atan(tan(gamma / 2) * tan(delta / 2) / tan(alpha / 2))
