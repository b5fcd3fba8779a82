"""A mechanism of many unknowns: the one form through its state."""

import numpy as np
import pytest

import linkages
from bifurc.branch import Outcome
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from bifurc.search.one_form import has_one_form
from linkages import Closure

SIDE = 13  # vertices: 364 unknowns


@pytest.fixture(scope="module")
def atlas():
    sheet = linkages.load("lang-howell-mesh", rows=SIDE, columns=SIDE)
    return linkages.map_linkage(sheet)


def test_its_form_goes_to_the_limits_of_its_creases(atlas):
    (form,) = atlas.forms
    assert form.name == "Form 1 (as assigned)"
    assert form.branch.outcome is Outcome.LEFT_REGION
    folds = np.ptp(form.branch(np.array([0.0, form.branch.length])), axis=0)
    # from flat to flat again: every crease by 180 degrees
    assert np.degrees(folds) == pytest.approx(180.0, abs=1e-6)


def test_the_answer_says_that_others_were_not_looked_for(atlas):
    kinds = {claim.kind for claim in atlas.completeness.claims}
    assert SearchClaim.ONE_FORM.name in kinds
    doubts = {doubt.kind for doubt in atlas.completeness.doubts}
    assert SearchDoubt.OTHER_FORMS.name in doubts
    assert f"{len(atlas.names)} unknowns" in atlas.completeness.statement


def test_few_unknowns_are_searched():
    assert not has_one_form(Closure(linkages.load("miura-ori")))
    many = linkages.load("miura-ori", rows=SIDE, columns=SIDE)
    assert has_one_form(Closure(many))
