"""Misprints: the print fails by a stated amount, the correction holds, and the page of
the docs is current."""

from pathlib import Path

import pytest

from linkages.catalogue import entry
from linkages.errata.erratum import HOLDS
from linkages.errata.misprints import errata_of, misprints, word_errata
from tests.samples import one_in

PAGE = Path(__file__).parents[3] / "docs" / "errata.md"


@pytest.mark.parametrize(
    "erratum",
    one_in(3, misprints(), lambda erratum: f"{erratum.equation} {erratum.linkage}"),
)
def test_printed_equation_fails_and_the_corrected_one_holds(erratum):
    printed, corrected = erratum.measure()
    assert printed > 1e-3
    assert corrected < HOLDS


@pytest.mark.parametrize(
    "erratum", misprints(), ids=lambda erratum: f"{erratum.equation} {erratum.linkage}"
)
def test_page_of_the_docs_has_the_row_with_its_amount(erratum):
    amount = f"{erratum.measure()[0]:.1g}"
    start = f"| {erratum.source} | {erratum.equation} | {erratum.linkage} | {erratum.printed} |"
    rows = [
        line
        for line in PAGE.read_text(encoding="utf-8").splitlines()
        if line.startswith(start)
    ]
    assert len(rows) == 1 and rows[0].split(" | ")[5] == amount


def test_page_of_the_docs_has_no_other_rows():
    rows = [
        line
        for line in PAGE.read_text(encoding="utf-8").splitlines()
        if line.startswith("| ")
    ]
    assert len(rows) == len(misprints()) + len(word_errata()) + 2


def test_every_misprint_belongs_to_a_linkage_of_the_catalogue():
    assert all(entry(erratum.linkage) for erratum in misprints())
    assert {e.equation for e in errata_of("wohlhart-double-goldberg")} >= {
        "(5.2.4)",
        "(5.2.5)",
        "(5.4), (5.5)",
    }
