import numpy as np
import pytest

from linkages.catalogue import entry
from linkages.families.bricard import (
    bricard_line_symmetric,
    bricard_octahedral_line_symmetric,
    patterns,
)
from linkages.values import GeometryError

TWISTS = (0.6981317007977318, 1.3962634015954636, 2.2689280275926285)


def test_opposite_links_and_offsets_are_alike():
    loop = bricard_line_symmetric(1, 2, 3, *TWISTS, 4, 5, 6)
    assert loop.lengths == (1, 2, 3, 1, 2, 3)
    assert loop.offsets == (4, 5, 6, 4, 5, 6)
    assert loop.twists == TWISTS * 2


def test_the_special_cases_lack_offsets_or_lengths():
    assert bricard_line_symmetric(1, 2, 3, *TWISTS).offsets == (0,) * 6
    assert bricard_octahedral_line_symmetric(*TWISTS, 1, 2, 3).lengths == (0,) * 6


def test_a_negative_length_is_refused():
    with pytest.raises(GeometryError, match="length a23"):
        bricard_line_symmetric(1, -2, 3, *TWISTS, 0, 0, 0)


def _roots(theta1, a, alpha, offsets):
    """tan(theta2/2) and tan(theta3/2) by the corrected eqs (4.2.15)-(4.2.22): (plus,
    minus) and (minus, plus)."""
    (a12, a23, a34), (r1, r2, r3) = a, offsets
    (c12, c23, c34), (s12, s23, s34) = np.cos(alpha), np.sin(alpha)
    s, c = np.sin(theta1), np.cos(theta1)
    found = []
    for which in (2, 3):
        if which == 2:
            free = (a34 * s12 * c23 + a12 * s34) * s - (r3 * c23 + r2) * s12 * s34 * c
            free += (
                r1 * (c12 * c23 + c34)
                + r2 * (c23 + c12 * c34)
                + r3 * (1 + c12 * c23 * c34)
            )
            by_sin = (
                a23 * s12 * c34
                + a12 * s23
                + r3 * s23 * s34 * s
                + (a23 * c12 * s34 + a34 * s23) * c
            )
            by_cos = (
                -(r3 * c34 + r1) * s12 * s23
                + (a34 * c12 * s23 + a23 * s34) * s
                - r3 * c12 * s23 * s34 * c
            )
        else:
            free = (a12 * c23 * s34 + a34 * s12) * s - (r2 * c23 + r3) * s12 * s34 * c
            free += (
                r1 * (c12 + c23 * c34)
                + r2 * (1 + c12 * c23 * c34)
                + r3 * (c23 + c12 * c34)
            )
            by_sin = (
                a23 * c12 * s34
                + a34 * s23
                + r2 * s12 * s23 * s
                + (a23 * s12 * c34 + a12 * s23) * c
            )
            by_cos = (
                -(r2 * c12 + r1) * s23 * s34
                + (a12 * s23 * c34 + a23 * s12) * s
                - r2 * s12 * s23 * c34 * c
            )
        root = np.sqrt(4 * by_sin**2 - 4 * (free - by_cos) * (free + by_cos))
        found.append(
            [(-2 * by_sin + sign * root) / (2 * (free - by_cos)) for sign in (1, -1)]
        )
    return (found[0][0], found[1][1]), (found[0][1], found[1][0])


def test_the_roots_of_the_closed_form_close_and_carry_its_names(closure_gap):
    values = entry("bricard-line-symmetric").defaults
    lengths, offsets = (
        [values[k] for k in keys]
        for keys in (("a12", "a23", "a34"), ("R1", "R2", "R3"))
    )
    loop = bricard_line_symmetric(**values)
    first, second = patterns(**values)[:2]
    for theta1 in np.linspace(-3.0, 3.0, 7):
        for form, other, roots in zip(
            (first, second),
            (second, first),
            _roots(theta1, lengths, TWISTS, offsets),
            strict=True,
        ):
            theta = np.tile([theta1, *(2 * np.arctan(roots))], 2)
            assert closure_gap(loop, theta) < 1e-13
            assert np.abs(form.residual(theta)).max() < 1e-13
            assert np.abs(other.residual(theta)).max() > 1e-3
