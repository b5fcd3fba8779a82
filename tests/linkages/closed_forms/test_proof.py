"""Proofs in exact arithmetic: every closed form closes without floating point, and a
wrong one does not."""

import dataclasses
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from linkages.catalogue import catalogue, entry
from linkages.closed_forms.proof import (
    closing_defects,
    exact_parameters,
    prove,
)
from linkages.construction import exact
from linkages.construction.exact import Angle, Quadratic
from tests.samples import one_in

FORMS = [form for linkage in catalogue().values() for form in linkage.closed_forms]


def named(form):
    return f"{form.linkage}: {form.form}"


@pytest.mark.parametrize("form", one_in(4, FORMS, named))
def test_closed_form_closes_exactly(form):
    proof = prove(form, entry(form.linkage), points=6, seed=2)
    assert proof.proved and proof.points == 6
    assert proof.doubt < 1e-12


@pytest.mark.parametrize("form", FORMS[::4], ids=named)
def test_closed_form_with_one_joint_turned_round_is_refuted(form):
    top, bottom = form.half_tangents[2][0]
    wrong = dataclasses.replace(
        form,
        half_tangents=(
            *form.half_tangents[:2],
            ((bottom, top),),
            *form.half_tangents[3:],
        ),
    )
    assert prove(wrong, entry(wrong.linkage), points=2).closed == 0


def test_a_float_is_no_proof():
    loop = entry("bennett").build()
    with pytest.raises(TypeError):
        Angle(0.5)
    with pytest.raises(TypeError):
        closing_defects(loop, [Angle(Fraction(1, 2))] * 4)


def test_exact_parameters_lie_in_their_ranges():
    found = entry("goldberg-5r")
    drawn = exact_parameters(found, np.random.default_rng(0))
    assert all(p.low < float(drawn[p.name]) < p.high for p in found.parameters)
    assert isinstance(exact.sin(drawn["alpha"]), Fraction)


def test_numbers_with_a_square_root_follow_the_rules_of_a_field():
    x, y = (
        Quadratic(Fraction(1), Fraction(2), Fraction(3)),
        Quadratic(Fraction(-2), Fraction(1, 5), Fraction(3)),
    )
    assert x * y / y == x and x - x == 0 and (x + y) - y == x
    assert x * x.inverse() == 1
    assert float(x * y) == pytest.approx(float(x) * float(y))


def test_roots_of_one_field_agree():
    assert exact.sqrt(Fraction(12)) - 2 * exact.sqrt(Fraction(3)) == 0


def test_roots_of_two_fields_follow_the_rules_of_a_field():
    two, three = exact.sqrt(Fraction(2)), exact.sqrt(Fraction(3))
    x = 1 + two - Fraction(2, 5) * three
    y = three * two + 4
    assert x + y == y + x and x * y == y * x and x - x == 0
    assert x * y / y - x == 0 and y / x * x - y == 0
    assert two * three * two * three == 6
    assert float(x * y) == pytest.approx(float(x) * float(y))
    assert float(y / x) == pytest.approx(float(y) / float(x))


KINKED = "generalized-l-shape-goldberg-variant-6r"


@pytest.mark.parametrize("name", ["m_b", "n_1", "k_2"])
def test_a_closed_form_over_two_roots_with_a_wrong_constant_is_refuted(name):
    (form,) = entry(KINKED).closed_forms
    wrong = {**form.constants, name: -sp.sympify(form.constants[name])}
    assert prove(form, entry(KINKED), points=2).closed == 2
    changed = dataclasses.replace(form, constants=wrong)
    assert prove(changed, entry(KINKED), points=2).closed == 0


def test_exact_angles_add_up_like_angles():
    x, y = Angle(Fraction(3, 4)), Angle(Fraction(-5, 2))
    assert float(x + y) == pytest.approx(float(x) + float(y))
    assert x + exact.pi - exact.pi == x and 2 * (x / 2) == x and -1 * x == -x
    assert exact.sin(x) ** 2 + exact.cos(x) ** 2 == 1


def test_exact_inverse_functions_undo_the_functions():
    x = Angle(Fraction(2, 7))
    assert exact.acos(exact.cos(x)) == x and exact.asin(exact.sin(x)) == x
    assert (
        exact.atan2(exact.sin(x), exact.cos(x)) == x
        and 2 * exact.atan(Fraction(2, 7)) == x
    )
