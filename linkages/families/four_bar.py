"""Planar four-bars: general, parallelogram, rhombus and kite.

All twists and offsets vanish; theta_i is the exterior angle at joint i, and the four
add up to a multiple of a full turn.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from linkages.construction.conditions import decided, require_positive
from linkages.entry import Entry, FormPattern, Parameter
from linkages.loop import GeometryError, Loop

__all__ = ["ENTRIES", "form_patterns", "four_bar", "kite", "parallelogram", "rhombus"]

SOURCE = "Hunt 1990, Kinematic geometry of mechanisms"
NAMES = ("12", "23", "34", "41")


def four_bar(a: Any, b: Any, c: Any, d: Any) -> Loop:
    """The planar four-bar with links 12, 23, 34, 41 of lengths ``a``, ``b``, ``c``,
    ``d``.

    Raises `GeometryError` for a length that is not positive, or a longest link that the
    others cannot span.
    """
    lengths = (a, b, c, d)
    for name, value in zip(NAMES, lengths, strict=True):
        require_positive(f"length of link {name}", value)
    known = [decided(value) for value in lengths]
    sizes = [size for size in known if size is not None]
    if len(sizes) == 4 and 2 * max(sizes) >= sum(sizes):
        longest = sizes.index(max(sizes))
        rest = sum(sizes) - max(sizes)
        raise GeometryError(
            f"length of link {NAMES[longest]}",
            f"{max(sizes):.6g}",
            f"less than {rest:.6g}, the sum of the others (too long by {max(sizes) - rest:.3g})",
        )
    return Loop(lengths, (0, 0, 0, 0), (0, 0, 0, 0), "four-bar")


def parallelogram(a: Any, b: Any) -> Loop:
    """The planar four-bar with opposite links alike: 12 and 34 of length ``a``, 23 and
    41 of length ``b``."""
    return four_bar(a, b, a, b)


def rhombus(a: Any) -> Loop:
    """The planar four-bar with four links of length ``a``."""
    return four_bar(a, a, a, a)


def kite(a: Any, b: Any) -> Loop:
    """The planar four-bar with links 12 and 41 of length ``a``, 23 and 34 of length
    ``b``."""
    return four_bar(a, b, b, a)


def _pairs(sign: int, *extra: Any) -> Any:
    """Residual of theta3 = sign theta1, theta4 = sign theta2, and ``extra`` functions
    of half angles."""

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.asarray(theta) / 2
        rows = [
            np.sin(h[..., 2] - sign * h[..., 0]),
            np.sin(h[..., 3] - sign * h[..., 1]),
        ]
        return np.stack(rows + [f(h) for f in extra], axis=-1)

    return residual


def _proper(name: str) -> FormPattern:
    return FormPattern(name, _pairs(+1, lambda h: np.cos(h[..., 0] + h[..., 1])))


def _folded(first: int) -> FormPattern:
    """Two pairs of links stay folded onto each other at joints ``first`` and ``first +
    2`` (from 1)."""
    residual = _pairs(
        -1, lambda h: np.cos(h[..., first - 1]), lambda h: np.cos(h[..., first + 1])
    )
    return FormPattern(f"folded form (joints {first},{first + 2} inactive)", residual)


def _kite(axis: int) -> FormPattern:
    """The angles beside the axis of symmetry, which runs through joint ``axis`` (from
    1), are alike."""
    i, j = axis % 4, (axis + 2) % 4
    return FormPattern(
        "kite form",
        lambda theta: np.sin((theta[..., i] - theta[..., j]) / 2)[..., None],
    )


def form_patterns(a: float, b: float, c: float, d: float) -> tuple[FormPattern, ...]:
    """The forms of the planar four-bar with links 12, 23, 34, 41 of lengths that are
    alike in pairs."""
    if a == b == c == d:
        return _proper("rhombus form"), _folded(1), _folded(2)
    if a == c and b == d:
        return _proper("parallelogram form"), FormPattern(
            "antiparallelogram form", _pairs(-1)
        )
    if a == d and b == c:
        return _folded(1), _kite(1)
    if a == b and c == d:
        return _folded(2), _kite(2)
    return ()


def _length(name: str, default: float, meaning: str) -> Parameter:
    return Parameter(name, default, "length", meaning, 0.3, 3.0)


ENTRIES: tuple[Entry, ...] = (
    Entry(
        "four-bar",
        "Planar four-bar",
        SOURCE,
        four_bar,
        (
            _length("a", 1.0, "length of link 12"),
            _length("b", 2.4, "length of link 23"),
            _length("c", 2.0, "length of link 34"),
            _length("d", 2.7, "length of link 41"),
        ),
        conditions=(
            "all twists and offsets 0",
            "no link as long as the other three together",
        ),
        facts={"mobility": 1, "rank": 3, "forms": 2, "bifurcations": 0},
    ),
    Entry(
        "parallelogram",
        "Parallelogram four-bar",
        SOURCE,
        parallelogram,
        (
            _length("a", 1.0, "length of links 12 and 34"),
            _length("b", 2.0, "length of links 23 and 41"),
        ),
        conditions=("a12 = a34, a23 = a41", "all twists and offsets 0"),
        patterns=lambda a, b: form_patterns(a, b, a, b),
        facts={"mobility": 1, "rank": 3, "forms": 2, "bifurcations": 2, "arcs": 4},
    ),
    Entry(
        "rhombus",
        "Rhombus four-bar",
        SOURCE,
        rhombus,
        (_length("a", 1.0, "length of every link"),),
        conditions=("a12 = a23 = a34 = a41", "all twists and offsets 0"),
        patterns=lambda a: form_patterns(a, a, a, a),
        facts={"mobility": 1, "rank": 3, "forms": 3, "bifurcations": 3, "arcs": 6},
    ),
    Entry(
        "kite",
        "Kite four-bar",
        SOURCE,
        kite,
        (
            _length("a", 1.0, "length of links 12 and 41"),
            _length("b", 2.0, "length of links 23 and 34"),
        ),
        conditions=("a12 = a41, a23 = a34", "all twists and offsets 0"),
        patterns=lambda a, b: form_patterns(a, b, b, a),
        facts={"mobility": 1, "rank": 3, "forms": 2, "bifurcations": 2, "arcs": 4},
    ),
)
