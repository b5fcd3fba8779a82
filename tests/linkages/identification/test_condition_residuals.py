"""The conditions that the catalogue states hold for its members, and tell by how much a
table breaks them."""

import numpy as np
import pytest

from linkages.catalogue import catalogue, entry
from linkages.identification.condition_residuals import condition_residual
from linkages.identification.equivalence import as_loop, table
from linkages.identification.identify import identify


@pytest.mark.parametrize("name", list(catalogue()))
def test_conditions_written_in_symbols_hold_for_the_default_member(name):
    found = entry(name)
    residuals = [
        condition_residual(text, table(found.build())) for text in found.conditions
    ]
    assert all(size is None or size < 1e-12 for size in residuals)


def test_a_third_of_the_conditions_and_more_are_equations_in_the_numbers_of_the_table():
    sizes = [
        condition_residual(text, table(found.build()))
        for found in catalogue().values()
        for text in found.conditions
    ]
    assert sum(size is not None for size in sizes) >= len(sizes) // 3


@pytest.mark.parametrize(
    ("condition", "size"),
    [
        ("a12 = a34", 2.0),
        ("a12 = a34, a23 = 2", 2.0),
        ("alpha12 + alpha34 = 0", 0.2),
        ("alpha12 = -2 pi + alpha34", 0.4),
        ("sin(alpha12)/a12 = 0", np.sin(0.3)),
        ("a12 (cos alpha12 + cos alpha34) = 0", np.cos(0.3) + np.cos(0.1)),
        ("a12^2 + a23^2 = 5", 0.0),
        ("all offsets 0", 0.7),
        ("R = 0", 0.7),
        ("R1 = R2 = 0", 0.7),
        ("links a, b, a, b, twists likewise", None),
        ("sin(alpha)/a = sin(beta)/b", None),
    ],
)
def test_a_condition_is_evaluated(condition, size):
    values = np.array([[1.0, 2, 3, 4], [0.3, 0, -0.1, 0], [0, 0.7, 0, 0]])
    assert condition_residual(condition, values) == (
        None if size is None else pytest.approx(size)
    )


def test_a_broken_condition_is_told_with_its_residual():
    values = table(entry("dietmaier").build())
    values[2, 1] *= 1.001  # R2 = R6
    match = identify(
        as_loop(values), entries=[entry("dietmaier")], locking=False
    ).nearest[0]
    sizes = dict(match.conditions)
    assert sizes["R1 = R4 = 0, R2 = R6, R3 = R5"] == pytest.approx(
        3.1e-4 / as_loop(values).characteristic_length
    )
    assert sizes["a23 = a56, alpha23 = alpha56"] < 1e-15
