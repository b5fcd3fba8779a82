"""The study of errors between moving and not, on a few of its cases."""

import pytest

from studies.grey_zone import (
    CHANGES,
    Answer,
    Change,
    Verdict,
    answer,
    describe,
    faults,
    hangs_on_seed,
)

BENNETT = CHANGES[0]
BRANCHING = next(
    change
    for change in CHANGES
    if change.linkage == "special-double-subtractive-goldberg"
)


# through a crossing that opened by less a near motion takes a minute to follow
@pytest.mark.parametrize(("change", "small"), [(BENNETT, 1e-11), (BRANCHING, 1e-11)])
def test_the_answers_come_in_one_order(change, small):
    answers = [answer(change, error) for error in (1e-6, small, 3e-13, 1e-15)]
    assert faults(answers) == []
    assert [one.verdict for one in answers] == [
        Verdict.NEARLY_MOVES,
        Verdict.NEARLY_MOVES,
        Verdict.MOVES_WITHIN_TOLERANCE,
        Verdict.MOVES,
    ]
    ratios = [one.misclosure / one.error for one in answers[:3]]
    assert ratios == pytest.approx([ratios[0]] * 3, rel=0.02)


def test_within_the_closing_tolerance_all_forms_and_bifurcations_are_there():
    within = answer(BRANCHING, 8e-13)
    assert (within.forms, within.bifurcations) == (4, 4)


def test_near_motions_do_not_hang_on_the_seed():
    assert not hangs_on_seed(BENNETT, 1e-5, 2)
    assert not hangs_on_seed(BRANCHING, 1e-4, 2)


def test_faults_are_seen():
    def made(error, verdict, stalled=0, assemblies=0):
        numbers = (1e-9, 1, stalled, 0, assemblies)
        return Answer(Change("none", "twists", 1), error, verdict, *numbers)

    answers = [
        made(1e-3, Verdict.MOVES),
        made(1e-4, Verdict.NEARLY_MOVES, stalled=2, assemblies=17),
    ]
    assert faults(answers) == [
        "the verdicts are not in order",
        "2 forms stalled at 1.0e-04",
        "17 assemblies at 1.0e-04",
    ]
    assert "2 forms stalled" in describe([answers])
