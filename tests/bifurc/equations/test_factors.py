"""The different factors of recorded equations."""

from fractions import Fraction

import numpy as np
import pytest

import bifurc
from bifurc.equations.factors import (
    Factors,
    polynomial_factors,
    written_factors,
)
from bifurc.equations.polynomials import simplest_ratio
from bifurc.equations.recording import record
from bifurc.equations.tape import Tape

POINTS = np.random.default_rng(0).uniform(0.5, 1.5, (20, 2))
REGION = np.array([[-2.0, 2.0]] * 2)


def tape_of(function) -> Tape:
    tape = bifurc.FunctionProblem(function, [[0.2, 2.0]] * 2).recording.tape
    assert tape is not None
    return tape


def radical_of(factors: Factors) -> np.ndarray:
    return factors.radical().compiled.residuals(POINTS)[:, 0]


def is_multiple_of(values: np.ndarray, expected: np.ndarray) -> bool:
    ratios = values / expected
    return bool(np.allclose(ratios, ratios[0], rtol=1e-12))


def test_factors_are_those_of_products_and_powers_as_written():
    tape = tape_of(lambda u: [-3 * (u[0] - u[1] ** 3) ** 2 * (u[0] + 1) / 7, u[0]])
    factors = written_factors(tape)
    assert factors.rows == (0, 0, 1)
    assert sorted(factors.powers[:2]) == [1, 2]
    x, y = POINTS.T
    assert is_multiple_of(radical_of(factors), (x - y**3) * (x + 1))


def test_equations_without_repeated_factors_stay_what_they_are():
    factors = written_factors(tape_of(lambda u: [u[0] * u[1], np.sin(u[0]) - u[1]]))
    assert not factors.are_simpler


def test_functions_count_as_factors():
    factors = written_factors(tape_of(lambda u: [np.sin(u[0] - u[1]) ** 3]))
    assert factors.powers == (3,)
    assert np.allclose(radical_of(factors), np.sin(POINTS[:, 0] - POINTS[:, 1]))


@pytest.mark.parametrize(
    "function",
    [
        lambda u: [np.sqrt(u[0] + u[1]) * u[1] + u[0]],
        lambda u: [u[0] ** 2 / u[1]],
    ],
)
def test_roots_times_unknowns_in_sums_and_quotients_are_left_alone(function):
    tape = tape_of(function)
    assert not written_factors(tape).are_simpler
    assert not polynomial_factors(tape, [0], REGION).are_simpler


def test_an_expanded_polynomial_is_taken_apart_by_powers():
    tape = tape_of(lambda u: [u[0] ** 3 - u[0] ** 2 * u[1], u[0]])
    assert not written_factors(tape).are_simpler
    factors = polynomial_factors(tape, [0], REGION)
    assert factors.rows == (0, 0, 1) and sorted(factors.powers[:2]) == [1, 2]
    x, y = POINTS.T
    assert is_multiple_of(radical_of(factors), x * (x - y))


def test_a_square_is_one_in_any_units_and_in_functions_of_the_unknowns():
    def expanded(u):
        a, b = 0.1 * u[0] + 0.7 * u[1], np.exp(u[0])
        return [a**2 - 2 * a * b + b**2]

    factors = polynomial_factors(tape_of(expanded), [0], REGION)
    assert factors.powers == (2,)
    x, y = POINTS.T
    assert is_multiple_of(radical_of(factors), 0.1 * x + 0.7 * y - np.exp(x))


@pytest.mark.parametrize("last", [0.01, 0.1**2, 0.01 + 5e-18])
def test_decimals_next_to_doubles_make_a_square_that_these_do_not(last):
    tape = tape_of(lambda u: [u[0] ** 2 - 0.2 * u[0] + last])
    assert polynomial_factors(tape, [0], REGION).powers == (2,)


def test_decimals_of_many_digits_make_a_square():
    def expanded(u):  # (x - 0.1234567)^2
        return [u[0] ** 2 - 0.2469134 * u[0] + 0.01524155677489]

    assert polynomial_factors(tape_of(expanded), [0], REGION).powers == (2,)


def test_what_is_a_square_but_for_more_than_rounding_is_none():
    tape = tape_of(lambda u: [u[0] ** 2 - 0.2 * u[0] + 0.01 + 1e-16])
    assert not polynomial_factors(tape, [0], REGION).are_simpler


def test_a_polynomial_of_too_many_terms_stays_what_it_is():
    tape = tape_of(lambda u: [(1 + u[0] + u[1]) ** 40 - 1])
    assert not polynomial_factors(tape, [0], REGION).are_simpler


@pytest.mark.parametrize("far", [1e2, 1e5, 1e7, 123456.7])
def test_factors_keep_their_digits_far_from_the_origin(far):
    def expanded(u):
        a, b = (u[0] - far) ** 2, u[1] ** 2 - 1
        return [a * a + 2 * a * b + b * b]

    region = np.array([[far - 2, far + 2.1], [-2.03, 1.97]])
    factors = polynomial_factors(tape_of(expanded), [0], region)
    assert factors.powers == (2,)
    x = far + POINTS[:, 0]
    points = np.column_stack([x, POINTS[:, 1]])
    values = factors.radical().compiled.residuals(points)[:, 0]
    assert is_multiple_of(values, (x - far) ** 2 + POINTS[:, 1] ** 2 - 1)


def test_a_double_circle_far_from_the_origin_is_one_form():
    far = 1e5

    def expanded(u):
        a, b = (u[0] - far) ** 2, u[1] ** 2 - 1
        return [a * a + 2 * a * b + b * b]

    bounds = [(far - 2, far + 2.1), (-2.03, 1.97)]
    atlas = bifurc.explore(bifurc.FunctionProblem(expanded, bounds))
    (form,) = atlas.forms
    assert form.multiplicity == 2
    x, y = form.branch.sample(200).T
    assert np.abs(np.hypot(x - far, y) - 1).max() < 1e-9


def test_what_cancels_stays_where_it_need_not_be_defined():
    def square(u):
        return np.array([(u[0] - u[1]) ** 2 + np.log(u[0]) - np.log(u[0])])

    tape = record(square, np.ones((1, 2))).tape
    region = np.array([[-2.0, 2.0]] * 2)
    factors = polynomial_factors(tape, [0], region)
    values = factors.tape.compiled.residuals(np.array([[-1.0, -1.0]]))
    assert np.isnan(values).any()


@pytest.mark.parametrize(
    ("number", "ratio"),
    [
        (0.09, Fraction(9, 100)),
        (-2 / 3, Fraction(-2, 3)),
        (1234.5678, Fraction(6172839, 5000)),
        (0.0, Fraction(0)),
        (1e300, Fraction(1e300)),
        (5e-324, Fraction(5e-324)),
    ],
)
def test_a_double_is_read_as_the_simplest_ratio_that_is_rounded_to_it(number, ratio):
    assert simplest_ratio(number) == ratio
