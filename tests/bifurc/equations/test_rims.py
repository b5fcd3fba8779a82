"""Equations that are defined on one side only, and what they are on the rim."""

import mpmath
import numpy as np
import pytest

from bifurc import FunctionProblem, Kind, explore
from bifurc.equations.factors import written_factors
from bifurc.systems.equation_file import read_equations

END = (
    1e-7  # a rim is left where a bound is, within 1e-9 of the scale and more if oblique
)
BOUNDS = [(-2.0, 2.0), (-2.0, 2.1)]


def atlas_of(tmp_path, equation):
    path = tmp_path / "rim.toml"
    path.write_text(
        f'equations = ["{equation}"]\n[unknowns]\nx = [-2, 2]\ny = [-2, 2.1]\n'
    )
    return read_equations(path).explore()


def problem_of(function):
    return FunctionProblem(lambda u: [function(*u)], BOUNDS)


@pytest.mark.parametrize(
    ("equation", "same"),
    [
        ("sqrt(1 - x^2 - y^2)", "1 - x^2 - y^2"),
        ("asin(x*y) - pi/2", "x*y - 1"),
        ("acos(x) - pi", "x + 1"),
        ("atan(2*sqrt(x - y)/3)", "x - y"),
        ("log(1 + sqrt(1 - x^2 - y^2))", "1 - x^2 - y^2"),
    ],
)
def test_what_is_zero_on_a_rim_is_a_curve(tmp_path, equation, same):
    rim, plain = atlas_of(tmp_path, equation), atlas_of(tmp_path, same)
    lengths = [form.branch.length for form in rim.forms]
    assert np.allclose(lengths, [form.branch.length for form in plain.forms])
    assert not rim.points and not len(rim.rigid)
    assert all(form.labels["rims"] for form in rim.forms)


def test_a_curve_ends_on_the_rim_of_another_factor(tmp_path):
    atlas = atlas_of(tmp_path, "sqrt(x)*(x^2 + y^2 - 1)")
    rim, half = atlas.forms
    assert rim.labels == {"rims": ["x = 0, the rim of sqrt"]} and not half.labels
    assert half.branch.length == pytest.approx(np.pi, abs=END)  # a half circle
    assert np.all(half.branch.sample(50)[:, 0] > -END)
    assert [point.kind for point in atlas.points] == [Kind.BIFURCATION] * 2


def test_a_root_as_one_term_ends_where_the_other_is_negative(tmp_path):
    (form,) = atlas_of(tmp_path, "2*sqrt(1 - x^2) = 2*y").forms
    assert form.branch.length == pytest.approx(np.pi, abs=END)
    assert np.all(form.branch.sample(50)[:, 1] > -END)


def test_a_factor_that_vanishes_where_a_logarithm_is_not_defined_is_none(tmp_path):
    lines = atlas_of(tmp_path, "x*log(x)*y").forms
    ends = [line.branch(np.array([0.0, line.branch.length])) for line in lines]
    assert len(lines) == 2  # x = 1 and the right half of y = 0
    assert np.allclose(ends[0][:, 0], 1.0)


def test_nothing_on_a_rim_is_listed_as_isolated():
    problem = problem_of(
        lambda x, y: np.sqrt(x**2 + y**2 - 1) * (2 + y) + x**2 + y**2 - 1
    )
    atlas = explore(problem)
    assert not len(atlas.rigid)
    assert "on rim" in {doubt.kind for doubt in atlas.completeness.doubts}


def test_an_odd_root_has_no_rim_and_a_chain_of_functions_goes_down_to_one():
    tape = problem_of(lambda x, y: np.exp(np.cbrt(x - y)) - 1).recording.tape
    factors = written_factors(tape)
    assert factors.are_simpler and not factors.rims
    assert np.allclose(factors.radical().compiled.residuals(np.array([[3.0, 1.0]])), 2)


def test_a_value_that_a_function_has_inside_is_left_alone():
    tape = problem_of(lambda x, y: np.asin(x * y) - 1.0).recording.tape
    assert not written_factors(tape).are_simpler


@pytest.mark.parametrize(
    "equation",
    [
        "(x-y)^1.5 + x*y",
        "x^2.5 - y^2",
        "x^x*y - y",
        "log(x)^2*y",
        "(x*y)^1.5 - x^3",
        "x*log(x) - y*log(y)",
    ],
)
def test_powers_and_logarithms_of_negative_numbers_do_not_end_a_search(
    tmp_path, equation
):
    assert atlas_of(tmp_path, equation).provenance is not None


def test_many_digits_are_refused_beyond_a_rim(tmp_path):
    path = tmp_path / "power.toml"
    path.write_text('equations=["(x-y)^1.5"]\n[unknowns]\nx = [-2, 2]\ny = [-2, 2]\n')
    residual = read_equations(path).problem.precise_residual()
    assert residual([mpmath.mpf(2), mpmath.mpf(1)]) == [1]
    with pytest.raises(ValueError, match="no real number"):
        residual([mpmath.mpf(1), mpmath.mpf(2)])


def doubts_of(*functions, bounds=BOUNDS):
    atlas = explore(FunctionProblem(lambda u: [f(*u) for f in functions], bounds))
    return atlas, {doubt.kind for doubt in atlas.completeness.doubts}


def test_a_rim_that_only_combinations_of_equations_have_is_in_doubt():
    def rim(x, y, z):
        return np.acosh(x**2 + y**2 + z**2)

    atlas, doubts = doubts_of(
        lambda *u: 0.6 * rim(*u) - 1.7 * (u[2] - u[0] * u[1]),
        lambda *u: 0.8 * rim(*u) + 1.3 * (u[2] - u[0] * u[1]),
        bounds=[*BOUNDS, (-2.2, 2.0)],
    )
    assert not atlas.forms and "along rim" in doubts


def test_a_rim_of_a_factor_of_a_sum_is_in_doubt():
    _, doubts = doubts_of(lambda x, y: np.acos(x) * y - np.acos(x) * x)
    assert "along rim" in doubts


@pytest.mark.parametrize(
    "function",
    [
        lambda x, y: y - np.sqrt(x**2),
        lambda x, y: y - (x + 2.0) ** 1.5,
        lambda x, y: np.sqrt(x) - np.cbrt(y),
    ],
)
def test_curves_that_end_or_turn_on_a_rim_leave_nothing_missing_there(function):
    _, doubts = doubts_of(function)
    assert "along rim" not in doubts


def test_forms_that_meet_where_a_root_has_no_slope_are_in_doubt():
    atlas, doubts = doubts_of(lambda x, y: (np.cbrt(x) - y) * y)
    assert len(atlas.bifurcations) == 1 or "meeting on rim" in doubts
