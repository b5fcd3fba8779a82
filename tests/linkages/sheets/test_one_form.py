"""A mechanism of many unknowns: the one form through its state."""

import time

import numpy as np
import pytest

import bifurc
import linkages
from bifurc.branch import Outcome
from bifurc.curves import continuation
from bifurc.limits import Deadline, until
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from bifurc.search.one_form import has_one_form
from linkages import Closure
from linkages.subject import subject_at

STAGES = [
    ("closed loops", "linkages.mapping.as_subject"),
    ("equations", "linkages.closure.equations.write_equations"),
]
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


@pytest.mark.parametrize("stage, slow", STAGES)
def test_where_the_time_is_over_before_there_are_equations_the_stage_is_named(
    monkeypatch, stage, slow
):
    monkeypatch.setattr(slow, lambda *arguments, **options: time.sleep(60))
    sheet = linkages.load("miura-ori")
    with pytest.raises(bifurc.OutOfTimeError, match=f"over while the {stage} of 16"):
        linkages.map_linkage(sheet, settings=bifurc.SearchSettings(budget=0.01))


def test_a_march_of_many_unknowns_asks_for_the_time_after_a_few_pieces(
    atlas, monkeypatch
):
    problem = subject_at(atlas).traced
    monkeypatch.setattr(continuation, "UNKNOWNS_AT_ONCE", problem.n)
    with until(Deadline(0.0)):
        branch = bifurc.trace_branch(problem, problem.given_state)
    assert branch.outcome is Outcome.TIME_LIMIT
    assert len(branch.pieces) == 1


def test_the_subject_that_was_mapped_is_not_made_again(atlas):
    assert subject_at(atlas).closure is subject_at(atlas).readout.closure
