"""Lines in the plane on which a homogeneous polynomial vanishes."""

from __future__ import annotations

from functools import partial

import numpy as np

from bifurc.decisions import is_multiple_line
from bifurc.numerics.roots import bracketed_roots

# Angles on a half circle, between two of which there is one root of a form of low degree
# whose roots are apart; none of them is special.
ANGLES = 0.0123 + np.linspace(0.0, np.pi, 721)


def monomials(vectors: np.ndarray, degree: int) -> np.ndarray:
    """x^d, x^(d - 1) y, ..., y^d (k, d + 1) of vectors (k, 2)."""
    x, y = vectors.T
    powers = np.arange(degree + 1)
    terms: np.ndarray = x[:, None] ** (degree - powers) * y[:, None] ** powers
    return terms


def lines_of_binary_form(form: np.ndarray, unit: float) -> np.ndarray | None:
    """Unit vectors (t, 2), one for each real line on which a form with coefficients
    (d + 1,) of the `monomials` vanishes; None where a line is a multiple one, or
    nearly, so that their number is open. ``unit`` is the size that an ordinary form has
    there."""
    heights = np.abs(_values(form, _root_angles(_turned(form))))
    if not len(heights) or np.any(is_multiple_line(heights, unit)):
        return None
    return unit_vectors(_root_angles(form))


def _turned(form: np.ndarray) -> np.ndarray:
    """The derivative (d + 1,) of a form by the angle: x F_y - y F_x."""
    degree = len(form) - 1
    powers = np.arange(degree + 1)
    turned = np.zeros(degree + 1)
    turned[:-1] += powers[1:] * form[1:]
    turned[1:] -= (degree - powers[:-1]) * form[:-1]
    return turned


def _root_angles(form: np.ndarray) -> np.ndarray:
    """Angles (k,) of a half circle at which a form changes its sign."""
    is_positive = _values(form, ANGLES) >= 0.0
    cells = np.flatnonzero(is_positive[:-1] != is_positive[1:])
    if not len(cells):
        return np.empty(0)
    low, high = ANGLES[cells], ANGLES[cells + 1]
    return bracketed_roots(partial(_values, form), low, high)


def _values(form: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Values (k,) of a form (d + 1,) at unit vectors at angles (k,)."""
    values: np.ndarray = monomials(unit_vectors(angles), len(form) - 1) @ form
    return values


def unit_vectors(angles: np.ndarray) -> np.ndarray:
    """Unit vectors (k, 2) of the plane at angles (k,)."""
    vectors = np.empty((len(angles), 2))
    vectors[:, 0] = np.cos(angles)
    vectors[:, 1] = np.sin(angles)
    return vectors
