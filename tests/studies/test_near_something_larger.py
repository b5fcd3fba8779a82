"""Beside something larger a map is right, or says that it is in doubt: a sample."""

import pytest

from linkages.mapping import map_linkage
from studies.near_something_larger import (
    FAMILIES,
    Answer,
    Verdict,
    answers,
    describe,
    draw,
    judge,
)
from tests.samples import one_in

WITH_A_SURFACE = [family for family in FAMILIES if family.forms == 4]
WITH_MORE_MOTIONS = FAMILIES[5:9]
GOOD = {Verdict.RIGHT, Verdict.RIGHT_IN_DOUBT}


@pytest.mark.parametrize("decades", [5.0, 8.5])
def test_curves_beside_a_surface_are_told_from_it(decades):
    found = list(answers(WITH_A_SURFACE, [decades], seeds=1))
    assert {answer.verdict for answer in found} <= GOOD


def test_what_doubles_do_not_tell_from_a_surface_is_in_doubt():
    found = list(answers(WITH_A_SURFACE[:1], [14.0], seeds=1))
    assert [answer.verdict for answer in found] == [Verdict.IN_DOUBT]
    assert [answer.level for answer in found] == ["estimated"]


@pytest.mark.parametrize("seeds", one_in(2, [1, 2]))
@pytest.mark.parametrize("decades", [7.0, 11.0, 14.0])
def test_a_near_miss_is_no_bifurcation_or_in_doubt(decades, seeds):
    found = list(answers(WITH_MORE_MOTIONS, [decades], seeds=seeds))
    assert Verdict.WRONG not in {answer.verdict for answer in found}
    if decades < 12:
        assert {answer.verdict for answer in found} <= GOOD


def test_other_counts_than_those_of_the_family_are_wrong():
    kites, bennetts = FAMILIES[3], FAMILIES[8]
    atlas = map_linkage(kites.member(0.1))
    assert judge(kites, atlas) is Verdict.RIGHT
    assert judge(bennetts, atlas) is Verdict.WRONG


def test_the_table_says_down_to_where_all_maps_are_right():
    verdicts = [Verdict.RIGHT, Verdict.RIGHT_IN_DOUBT, Verdict.IN_DOUBT, Verdict.WRONG]
    found = [
        Answer("kites", decades, 0, verdict, "estimated")
        for decades, verdict in zip((1.0, 1.5, 2.0, 2.5), verdicts, strict=True)
    ]
    row = describe(found).splitlines()[-1].split()
    assert row == ["kites", "4", "1", "1", "1", "1", "3.2e-02"]
    assert len(draw(found).axes) == 1
