"""The study of margins: quantities on both sides of a threshold, and a page that holds
every decision as it stands."""

import numpy as np
import pytest

from bifurc.decisions import Decision, Role, record_margins
from bifurc.search.explore import explore
from studies.margins import DECISIONS, PAGE, heading, histogram, margin_of, random_curve

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


def test_a_search_takes_decisions():
    with record_margins() as margins:
        explore(random_curve(np.random.default_rng(1)))
    assert len(margins["same point"]) > 0
    assert all(len(quantities) for quantities in margins.values())


@pytest.mark.parametrize("decision", DECISIONS, ids=lambda decision: decision.name)
def test_the_page_holds_every_decision_as_it_stands(decision):
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert f"{heading(decision)} {decision.claim}." in page, (
        "run python -m studies.margins --page"
    )
    assert decision.role in Role
