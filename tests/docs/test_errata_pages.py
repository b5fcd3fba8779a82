"""The page of misprints, cut into one page a source."""

from docs.generator.errata_pages import errata_index, errata_pages
from docs.generator.places import DOCS
from linkages.errata.misprints import misprints, word_errata

PAGE = (DOCS / "errata.md").read_text(encoding="utf-8")


def test_every_row_stands_on_the_page_of_each_of_its_sources():
    rows = sum(
        len(erratum.source.split("; ")) for erratum in [*misprints(), *word_errata()]
    )
    assert sum(page.count for page in errata_pages(PAGE)) == rows


def test_a_row_of_two_sources_names_the_equation_of_each():
    pages = {page.source: page.markdown() for page in errata_pages(PAGE)}
    row = "[mixed-double-goldberg-type-iii](../linkages/mixed-double-goldberg-type-iii.md)"
    assert f"| (3.4.16) | {row}" in pages["Song 2013"]
    assert f"| (4.16) | {row}" in pages["Song and Chen 2012 (mixed)"]


def test_the_index_keeps_the_words_and_lists_the_sources_in_place_of_the_rows():
    pages = errata_pages(PAGE)
    index = errata_index(PAGE, pages)
    assert index.startswith("# Misprints in the sources")
    assert not any(line.startswith("|") for line in index.splitlines())
    for page in pages:
        assert f"(errata/{page.name}.md): {page.count} rows" in index
