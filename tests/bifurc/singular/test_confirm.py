"""Singular points with known coordinates, found again at high precision."""

import mpmath
import numpy as np
import pytest

from bifurc.errors import ProblemError
from bifurc.singular.confirm import Convergence, confirm_singular_point

BOTH = np.eye(2)
ROOT = np.sqrt(2.0)


def crossing(u):
    """Two lines that cross at (sqrt 2, 0)."""
    x, y = u[0] - mpmath.sqrt(2), u[1]
    return [(y - x) * (y + 2 * x)]


def tacnode(u):
    return [u[1] ** 2 - u[0] ** 4]


def test_a_crossing_is_found_to_all_digits():
    found = confirm_singular_point(crossing, np.array([ROOT, 0.0]), BOTH, 50)
    with mpmath.workdps(120):
        assert abs(found.u[0] - mpmath.sqrt(2)) < mpmath.mpf(10) ** -50
    assert found.convergence is Convergence.QUADRATIC and found.nullity == 2


def test_the_distance_is_that_of_the_double_result():
    found = confirm_singular_point(crossing, np.array([ROOT + 3e-12, 0.0]), BOTH, 50)
    assert found.distance == pytest.approx(3e-12, rel=1e-3)
    assert found.agreeing_digits == pytest.approx(11.5, abs=0.1)


@pytest.mark.parametrize("digits", [20, 50, 100])
def test_more_digits_are_more_exact(digits):
    found = confirm_singular_point(crossing, np.array([ROOT, 1e-9]), BOTH, digits)
    with mpmath.workdps(3 * digits):
        assert abs(found.u[0] - mpmath.sqrt(2)) < mpmath.mpf(10) ** -digits


def test_repeated_equations_change_nothing():
    once = confirm_singular_point(crossing, np.array([ROOT, 1e-9]), BOTH)
    often = confirm_singular_point(
        lambda u: [*crossing(u), 3 * crossing(u)[0], 0], np.array([ROOT, 1e-9]), BOTH
    )
    with mpmath.workdps(60):
        assert mpmath.norm(once.u - often.u) < mpmath.mpf(10) ** -49
    assert often.nullity == 2


def test_the_error_at_a_tacnode_is_stated_and_bounds_the_true_one():
    found = confirm_singular_point(tacnode, np.array([4e-6, 1e-11]), BOTH, 50)
    assert found.convergence is Convergence.LINEAR
    assert 0 < float(mpmath.norm(found.u)) <= found.error < 1e-10
    assert found.distance == pytest.approx(4e-6, rel=1e-3)


def test_a_regular_point_is_not_confirmed():
    found = confirm_singular_point(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1], np.array([1.0, 0.0]), BOTH
    )
    assert found.convergence is Convergence.NONE


def test_equations_that_contradict_each_other_show_their_gap():
    found = confirm_singular_point(
        lambda u: [u[0] * u[1], u[0] * u[1] + mpmath.mpf(10) ** -12], np.zeros(2), BOTH
    )
    assert found.convergence is Convergence.INCONSISTENT
    assert found.residual == pytest.approx(1e-12, rel=1e-6)


def test_small_equations_are_measured_by_their_magnitude():
    found = confirm_singular_point(
        lambda u: [1e-7 * (u[0] ** 2 + u[1] ** 2 - 1)],
        np.array([1.0, 0.0]),
        BOTH,
        50,
        1e-7,
    )
    assert found.convergence is Convergence.NONE


def test_too_few_digits_are_refused():
    with pytest.raises(ProblemError, match="digits: 10"):
        confirm_singular_point(crossing, np.zeros(2), BOTH, 10)
