"""Terms of conditions: the largest difference between the sides of their equations."""

import numpy as np
import pytest

from linkages.construction.table_equations import (
    TableNumbers,
    equal_lengths,
    equal_links,
    equal_offsets,
    equal_twists,
    equation,
    opposite_offsets,
    opposite_twists,
    supplementary_twists,
    twists_of_value,
    zero_lengths,
    zero_offsets,
    zero_twist_sums,
    zero_twists,
)

TABLE = np.array([[1.0, 2, 3, 4], [0.3, 0, -0.1, 0], [0, 0.7, 0, -0.2]])


@pytest.mark.parametrize(
    ("term", "size"),
    [
        (equal_lengths((12, 34)), 2.0),
        (equal_lengths((12, 23), (12, 41)), 3.0),
        (equal_twists((12, 34)), 0.4),
        (equal_links((23, 41)), 2.0),
        (equal_offsets((1, 3), (2, 4)), 0.9),
        (opposite_offsets((2, 4)), 0.5),
        (opposite_twists((12, 34)), 0.2),
        (supplementary_twists((12, 34)), np.pi - 0.2),
        (twists_of_value(0.1, 12, 34), 0.4),
        (twists_of_value(2 * np.pi, 23, 41), 0.0),
        (zero_twist_sums((12, 23), (34, 41)), 0.4),
        (zero_lengths(12, 23), 1.0),
        (zero_lengths(), 4.0),
        (zero_offsets(1, 3), 0.0),
        (zero_offsets(2, 4), 0.9),
        (zero_offsets(), 0.7),
        (zero_twists, 0.3),
        (equation(lambda t: t.a(12) ** 2 + t.a(23) ** 2 - 5), 0.0),
        (equation(lambda t: np.sin(t.alpha(12)) / t.a(12)), np.sin(0.3)),
    ],
)
def test_a_term_is_the_largest_difference_of_its_sides(term, size):
    assert term(TABLE) == pytest.approx(size, abs=1e-15)


def test_the_last_link_and_joint_are_those_that_close_the_loop():
    t = TableNumbers(TABLE)
    assert (t.a(41), t.alpha(41), t.R(4)) == (4.0, 0.0, -0.2)
