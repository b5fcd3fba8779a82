"""The study of the translator: what the paper says holds, and its table."""

from studies.redrawing import HOLDS
from studies.wohlhart_translator import TWISTS, claims, stroke_table


def test_all_that_the_paper_says_holds_with_29_corrected():
    found = claims()
    assert len(found) == 7
    for claim in found:
        assert claim.deviation < HOLDS, claim.sentence


def test_the_table_has_both_strokes_of_every_twist():
    rows = stroke_table().splitlines()[1:]
    assert len(rows) == 2 * len(TWISTS)
    assert "70.528779" in rows[-1]
    assert "0, 120            240, 360" in rows[-1]
