"""Singular points with known coordinates, found again at high precision."""

import mpmath
import numpy as np
import pytest

from bifurc.errors import ProblemError
from bifurc.singular.confirm import (
    Confirmation,
    Convergence,
    Residual,
    confirm_singular_point,
)

ROOT = np.sqrt(2.0)


def confirm(
    function: Residual,
    place: tuple[float, float],
    digits: int = 50,
    magnitude: float = 1.0,
) -> Confirmation:
    """The confirmation of a point of the plane at which all derivatives vanish."""
    return confirm_singular_point(
        function, np.array(place), np.eye(2), digits, magnitude
    )


def crossing(u):
    """Two lines that cross at (sqrt 2, 0)."""
    x, y = u[0] - mpmath.sqrt(2), u[1]
    return [(y - x) * (y + 2 * x)]


def tacnode(u):
    return [u[1] ** 2 - u[0] ** 4]


def circle(u):
    return [u[0] ** 2 + u[1] ** 2 - 1]


@pytest.mark.parametrize("digits", [20, 50, 100])
def test_a_crossing_is_found_to_all_digits(digits):
    point = confirm(crossing, (ROOT, 1e-9), digits)
    with mpmath.workdps(3 * digits):
        assert abs(point.u[0] - mpmath.sqrt(2)) < mpmath.mpf(10) ** -digits
    assert point.convergence is Convergence.QUADRATIC
    assert point.nullity == 2


def test_a_point_that_is_right_to_rounding_stays_where_it_is():
    point = confirm(crossing, (ROOT, 0.0))
    with mpmath.workdps(120):
        assert abs(point.u[0] - mpmath.sqrt(2)) < mpmath.mpf(10) ** -50
    assert point.convergence is Convergence.QUADRATIC
    assert point.distance < 1e-15


def test_the_distance_is_that_of_the_double_result():
    point = confirm(crossing, (ROOT + 3e-12, 0.0))
    assert point.distance == pytest.approx(3e-12, rel=1e-3)
    assert point.agreeing_digits == pytest.approx(11.5, abs=0.1)


def test_repeated_equations_change_nothing():
    def repeated(u):
        (value,) = crossing(u)
        return [value, 3 * value, 0]

    once = confirm(crossing, (ROOT, 1e-9))
    often = confirm(repeated, (ROOT, 1e-9))
    with mpmath.workdps(60):
        assert mpmath.norm(once.u - often.u) < mpmath.mpf(10) ** -49
    assert often.nullity == 2


def test_the_error_at_a_tacnode_is_stated_and_bounds_the_true_one():
    point = confirm(tacnode, (4e-6, 1e-11))
    assert point.convergence is Convergence.LINEAR
    assert 0 < float(mpmath.norm(point.u)) <= point.error < 1e-10
    assert point.distance == pytest.approx(4e-6, rel=1e-3)


def test_a_regular_point_is_not_confirmed():
    assert confirm(circle, (1.0, 0.0)).convergence is Convergence.NONE


def test_small_equations_are_measured_by_their_magnitude():
    def small_circle(u):
        return [1e-7 * circle(u)[0]]

    point = confirm(small_circle, (1.0, 0.0), magnitude=1e-7)
    assert point.convergence is Convergence.NONE


def test_equations_that_contradict_each_other_show_their_gap():
    def contradiction(u):
        product = u[0] * u[1]
        return [product, product + mpmath.mpf(10) ** -12]

    point = confirm(contradiction, (0.0, 0.0))
    assert point.convergence is Convergence.INCONSISTENT
    assert point.residual == pytest.approx(1e-12, rel=1e-6)


def test_too_few_digits_are_refused():
    with pytest.raises(ProblemError, match="digits: 10"):
        confirm(crossing, (0.0, 0.0), digits=10)
