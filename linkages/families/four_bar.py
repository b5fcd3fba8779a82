"""Four-bars: planar ones, general, parallelogram, rhombus and kite, and the spherical
one.

In the plane all twists and offsets vanish; theta_i is the exterior angle at joint i, and
the four add up to a multiple of a full turn. The axes of the spherical one meet in a
point, for comparison with the Bennett linkage.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from linkages.construction.conditions import decided, require_positive
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number
from linkages.entry import FormPattern
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop
from linkages.values import GeometryError, told_apart

POSITION = 10
LINKS = ("12", "23", "34", "41")
Function: TypeAlias = Callable[[np.ndarray], np.ndarray]


def four_bar(a: Number, b: Number, c: Number, d: Number) -> Loop:
    """The planar four-bar with links 12, 23, 34, 41 of lengths ``a``, ``b``, ``c``,
    ``d``.

    Raises `GeometryError` for a length that is not positive, or a longest link that the
    others cannot span.
    """
    lengths = (a, b, c, d)
    sizes = []
    for link, value in zip(LINKS, lengths, strict=True):
        require_positive(f"length of link {link}", value)
        size = decided(value)
        if size is not None:
            sizes.append(size)
    if len(sizes) == 4:
        _refuse_too_long(sizes)
    return Loop(lengths, (0, 0, 0, 0), (0, 0, 0, 0), "four-bar")


def _refuse_too_long(sizes: list[float]) -> None:
    longest = max(sizes)
    rest = sum(sizes) - longest
    if 2 * longest < sum(sizes):
        return
    excess = longest - rest
    shown, most = told_apart(longest, rest)
    allowed = f"less than {most}, the sum of the others (too long by {excess:.3g})"
    name = f"length of link {LINKS[sizes.index(longest)]}"
    raise GeometryError(name, shown, allowed)


def parallelogram(a: Number, b: Number) -> Loop:
    """The planar four-bar with opposite links alike: 12 and 34 of length ``a``, 23 and
    41 of length ``b``."""
    return four_bar(a, b, a, b)


def rhombus(a: Number) -> Loop:
    """The planar four-bar with four links of length ``a``."""
    return four_bar(a, a, a, a)


def kite(a: Number, b: Number) -> Loop:
    """The planar four-bar with links 12 and 41 of length ``a``, 23 and 34 of length
    ``b``."""
    return four_bar(a, b, b, a)


def _pairs(sign: int, *extra: Function) -> Function:
    """Residual of theta3 = sign theta1, theta4 = sign theta2, and ``extra`` functions
    of half angles."""

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.asarray(theta) / 2
        rows = [
            np.sin(h[..., 2] - sign * h[..., 0]),
            np.sin(h[..., 3] - sign * h[..., 1]),
        ]
        rows += [function(h) for function in extra]
        return np.stack(rows, axis=-1)

    return residual


def _proper(name: str) -> FormPattern:
    return FormPattern(name, _pairs(+1, lambda h: np.cos(h[..., 0] + h[..., 1])))


def _folded(first: int) -> FormPattern:
    """Two pairs of links stay folded onto each other at joints ``first`` and ``first +
    2`` (from 1)."""
    second = first + 2

    name = f"folded form (joints {first},{second} inactive)"
    residual = _pairs(
        -1,
        lambda h: np.cos(h[..., first - 1]),
        lambda h: np.cos(h[..., second - 1]),
    )
    return FormPattern(name, residual)


def _kite(axis: int) -> FormPattern:
    """The angles beside the axis of symmetry, which runs through joint ``axis`` (from
    1), are alike."""
    i = axis % 4
    j = (axis + 2) % 4

    def residual(theta: np.ndarray) -> np.ndarray:
        difference = np.asarray(theta[..., i] - theta[..., j])
        return np.stack([np.sin(difference / 2)], axis=-1)

    return FormPattern("kite form", residual)


def form_patterns(a: float, b: float, c: float, d: float) -> tuple[FormPattern, ...]:
    """The forms of the planar four-bar with links 12, 23, 34, 41 of lengths that are
    alike in pairs."""
    if a == b == c == d:
        return _proper("rhombus form"), _folded(1), _folded(2)
    if a == c and b == d:
        crossed = FormPattern("antiparallelogram form", _pairs(-1))
        return _proper("parallelogram form"), crossed
    if a == d and b == c:
        return _folded(1), _kite(1)
    if a == b and c == d:
        return _folded(2), _kite(2)
    return ()


def spherical_four_bar(
    alpha12: Number, alpha23: Number, alpha34: Number, alpha41: Number
) -> Loop:
    """Spherical 4R: lengths and offsets zero, twists (rad) free. Source: Savage (1972),
    among others."""
    twists = (alpha12, alpha23, alpha34, alpha41)
    return closed_chain(*(Link(0, twist) for twist in twists))


ENTRIES = read_entries(
    "four_bar",
    {
        "four-bar": Model(four_bar),
        "parallelogram": Model(parallelogram, lambda a, b: form_patterns(a, b, a, b)),
        "rhombus": Model(rhombus, lambda a: form_patterns(a, a, a, a)),
        "kite": Model(kite, lambda a, b: form_patterns(a, b, b, a)),
        "spherical-four-bar": Model(spherical_four_bar),
    },
)
