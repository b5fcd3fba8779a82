"""The study of margins: quantities on both sides of a threshold, and a page that holds
every decision as it stands."""

import re
from dataclasses import replace

import numpy as np
import pytest

from bifurc.decisions import Decision, Role, record_margins
from bifurc.search.explore import explore
from studies.margins import (
    DECISIONS,
    GAP,
    PAGE,
    heading,
    histogram,
    is_clear,
    margin_of,
    nearest,
    random_curve,
)

DECISION = Decision("small", "it is small", "size", 1e-3, "a round number")


def test_a_margin_is_the_gap_around_the_threshold():
    margin = margin_of(DECISION, np.array([1e-9, 1e-6, 1e-2, 1.0]))
    assert (margin.below, margin.above) == (1e-6, 1e-2)
    assert (margin.count_below, margin.count_above) == (2, 2)
    assert margin.decades == pytest.approx(4.0)
    assert margin_of(DECISION, np.array([1e-9])).decades == np.inf


def test_a_histogram_has_a_character_a_decade_and_a_bar_at_the_threshold():
    quantities = np.concatenate([np.full(12, 2e-6), [5e-2], [0.0]])
    row = histogram(DECISION, quantities)
    assert len(row) == 24
    assert row.index("|") == 15
    assert row[0] == "1"  # what is 0 is put at the lowest end
    assert row[12] == "2"
    assert row[17] == "1"


def test_a_verdict_is_clear_in_a_gap_or_with_a_third_answer():
    wide, narrow = np.array([1e-5, 1e-1]), np.array([9e-4, 2e-3])
    assert is_clear(DECISION, margin_of(DECISION, wide))
    assert not is_clear(DECISION, margin_of(DECISION, narrow))
    for other in ({"third_answer": "it is in doubt"}, {"role": Role.LOOK}):
        decision = replace(DECISION, **other)
        assert is_clear(decision, margin_of(decision, narrow))


def test_the_cases_nearest_to_a_threshold_are_named():
    lines = nearest(DECISION, {"one": np.array([1e-9]), "two": np.array([1e-4, 2e-3])})
    assert lines.splitlines()[1:] == [
        "  below, 1.00e-04: two",
        "  below, 1.00e-09: one",
        "  above, 2.00e-03: two",
    ]


def test_every_verdict_of_the_page_is_clear():
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert "Verdicts with neither: none." in page
    entries = page.split("## The histogram")[0].split("**")
    for name, text in zip(entries[1::2], entries[2::2], strict=True):
        decades = re.search(r"a gap of ([0-9.]+) decades", text)
        if "(verdict," in text and "Third answer:" not in text and decades:
            assert float(decades.group(1)) >= GAP, name


def test_a_search_takes_decisions():
    with record_margins() as margins:
        explore(random_curve(np.random.default_rng(1)))
    assert len(margins["closing"]) > 0
    assert all(len(quantities) for quantities in margins.values())


@pytest.mark.parametrize("decision", DECISIONS, ids=lambda decision: decision.name)
def test_the_page_holds_every_decision_as_it_stands(decision):
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert f"{heading(decision)} {decision.claim}." in page, (
        "run python -m studies.margins --page"
    )
    assert decision.role in Role
