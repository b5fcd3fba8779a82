"""Formulas become MathML."""

from latex2mathml.converter import convert

from docs.generator.mathml import mathml
from linkages.catalogue import catalogue


def test_a_formula_has_its_fractions_and_indices():
    shown = mathml(r"\tan\frac{\theta_1}{2} = \frac{m}{t_{1}}", "block")
    assert shown.count("<mfrac>") == 2 and shown.count("<msub>") == 2
    assert 'display="block"' in shown


def test_every_closed_form_of_a_linkage_can_be_shown():
    for form in catalogue()["bricard-line-symmetric"].closed_forms:
        for left, right in form.latex().items():
            assert "merror" not in convert(f"{left} = {right}")
