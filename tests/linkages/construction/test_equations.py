"""Equations of conditions: the largest difference between their sides."""

import math

import numpy as np
import pytest

from linkages.construction.equations import equation_gaps, evaluate

TABLE = np.array([[1.0, 2, 3, 4], [0.3, 0, -0.1, 0], [0, 0.7, 0, -0.2]])


@pytest.mark.parametrize(
    ("equations", "gaps"),
    [
        ("a12 = a34", [2.0]),
        ("a12 = a23 = a41", [3.0]),
        ("a12 = a34, a23 = a41", [2.0, 2.0]),
        ("alpha12 = alpha34", [0.4]),
        ("R1 = R3, R2 = R4", [0.0, 0.9]),
        ("R2 = -R4", [0.5]),
        ("alpha12 + alpha34 = pi", [np.pi - 0.2]),
        ("alpha23 = alpha41 = 2 pi", [0.0]),
        ("alpha12 + alpha23 = alpha34 + alpha41 = 0", [0.4]),
        ("a12 = a23 = 0", [1.0]),
        ("a = 0", [4.0]),
        ("R = 0, alpha = 0", [0.7, 0.3]),
        ("a12^2 + a23^2 = 5", [0.0]),
        ("sin(alpha12)/a12 = 0", [np.sin(0.3)]),
        ("a23 = a12 (a34 - 1) cos(2 alpha23)", [0.0]),
    ],
)
def test_a_gap_is_the_largest_difference_of_the_sides(equations, gaps):
    assert equation_gaps(equations, TABLE) == pytest.approx(gaps, abs=1e-15)


def test_an_equation_without_a_value_is_left_out():
    assert equation_gaps("R2/R1 = 0, R3 = 0", TABLE) == [0.0]


def test_a_formula_is_evaluated_in_the_notation_of_the_sources():
    assert evaluate("1.7 sin(66 deg)") == 1.7 * math.sin(math.radians(66))
    assert evaluate("2 x^2", {"x": 3.0}) == 18.0
    with pytest.raises(NameError):
        evaluate("open")
