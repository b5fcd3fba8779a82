"""Statements of the sources in words: what the program sees bears the correction out,
and stands on the page of the docs."""

from pathlib import Path

import pytest

from linkages.errata.misprints import word_errata

PAGE = Path(__file__).parents[3] / "docs" / "errata.md"
SEEN = {
    "table 3.5.1, against table 3.5.2": (
        "Type II: it is l-shape-goldberg-variant-6r; "
        "Type IV: it is serial-goldberg-variant-6r"
    ),
    "section 3.4.3": "it is mixed-double-goldberg-type-iii",
    "section 3.4.2": (
        "2 2 1 1 1 1 turns for beta = 50, delta = 45 deg; "
        "2 2 1 1 1 3 turns for beta = 80, delta = 45 deg; "
        "0 0 1 1 1 1 turns for beta = 50, delta = 83 deg"
    ),
    "section 3.5": "closes at 60 of 60 random pairs of angles",
    "text after (5.2.19)": (
        "double-subtractive-goldberg: closes at 60 of 60 random pairs of angles; "
        "wohlhart-double-goldberg: closes at 60 of 60 random pairs of angles"
    ),
    "section 5.3.4, second linkage": (
        "Form I; of 12 random ones: Form I in 2, Form I and Form II in 7, Form II in 3"
    ),
    "section 5.3.5, table 5.3.1": "7 of 12 random ones have bifurcations",
    "sections 5.2, 5.4": (
        "4 forms in 12 of 12 random ones; 4 in the special one, of which Form III and "
        "Form IV do not meet"
    ),
    "section 4.2": "in 5 of 12 random ones both are one closed curve",
    "section 4": ("short: theta = 120, phi = 0 deg; long: theta = 240, phi = 360 deg"),
    "section 2": "none of O2, O4, O6 meet at 75, 90, 105, 115 deg",
    "section 5.2.1": "4 of 12 random ones have more than one component",
    "table 5.4.1, row n/n+3": "8 of 8 pairs leave a 6R of mobility 1",
    "section 5.4.5": "1/2/3, 1/7/8, 3/4/5, 5/6/7 of 56 move",
}


@pytest.mark.parametrize("erratum", word_errata(), ids=lambda erratum: erratum.place)
def test_what_is_seen_stands_on_the_page(erratum):
    seen = erratum.see()
    assert seen == SEEN.get(erratum.place, seen)
    row = f"| {erratum.source} | {erratum.place} | {erratum.printed} |"
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    (line,) = [line for line in lines if line.startswith(row)]
    assert line.endswith(f"| {seen} |")


def test_every_statement_that_can_be_measured_is():
    places = [erratum.place for erratum in word_errata()]
    assert SEEN.keys() <= set(places)
    assert len(set(places)) == len(places)
