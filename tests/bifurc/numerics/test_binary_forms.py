"""Lines on which homogeneous polynomials of the plane vanish."""

from __future__ import annotations

import numpy as np
import pytest

from bifurc.numerics.binary_forms import lines_of_binary_form, monomials


def form_with_lines(angles):
    """The product of x sin a - y cos a."""
    form = np.array([1.0])
    for angle in angles:
        form = np.convolve(form, [np.sin(angle), -np.cos(angle)])
    return form


@pytest.mark.parametrize(
    "angles", [[0.5], [0.0, np.pi / 2], [0.3, 1.0, 2.9], [0.01, 0.4, 1.6, 2.8]]
)
def test_simple_lines_are_all_found_once(angles) -> None:
    form = form_with_lines(angles)
    lines = lines_of_binary_form(form, float(np.linalg.norm(form)))
    found = np.sort(np.arctan2(lines[:, 1], lines[:, 0]) % np.pi)
    assert found == pytest.approx(np.array(angles), abs=1e-12)
    assert np.abs(monomials(lines, len(angles)) @ form).max() < 1e-14


def test_a_form_without_real_lines_has_none() -> None:
    assert len(lines_of_binary_form(np.array([1.0, 0.0, 2.0]), 1.0)) == 0


@pytest.mark.parametrize("apart", [0.0, 1e-9])
def test_a_double_line_is_open(apart: float) -> None:
    form = form_with_lines([0.7, 0.7 + apart, 2.0])
    assert lines_of_binary_form(form, 1.0) is None


def test_what_vanishes_everywhere_is_open() -> None:
    assert lines_of_binary_form(np.zeros(4), 1.0) is None
    assert lines_of_binary_form(np.array([1.0, 0.0, 2.0]), 1e9) is None
