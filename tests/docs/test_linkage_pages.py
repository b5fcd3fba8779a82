"""Every linkage has a page that says what its entry says, and a card that a search
finds."""

import json
import re
from dataclasses import replace

import pytest

from docs.generator.gallery import cards_of, gallery_html, search_html
from docs.generator.linkage_page import linkage_page
from docs.generator.linkage_record import LinkageRecord, record_linkage
from docs.generator.sources import families_toctree, family_pages, linkage_pages
from linkages.catalogue import catalogue, families
from linkages.linkage import load
from linkages.mapping import map_linkage

DSG = "special-double-subtractive-goldberg"


def empty_record(entry):
    """A record of a linkage that was not mapped."""
    joints = entry.build().n
    return LinkageRecord(entry.name, joints, 0, 0, "", "", "", (), (), ())


@pytest.fixture(scope="module")
def pages():
    records = {name: empty_record(entry) for name, entry in catalogue().items()}
    return linkage_pages(records)


@pytest.fixture(scope="module")
def dsg():
    entry = catalogue()[DSG]
    return record_linkage(entry, map_linkage(load(DSG)))


def test_every_entry_has_its_page(pages):
    assert list(pages) == [f"linkages/{name}.md" for name in catalogue()]


def test_a_page_holds_what_its_entry_says(pages):
    for name, entry in catalogue().items():
        page = pages[f"linkages/{name}.md"].replace("\\", "")
        said = [entry.title, entry.source, *entry.errata]
        said += [condition.text for condition in entry.conditions]
        said += [parameter.meaning for parameter in entry.parameters]
        missing = [text for text in said if text.replace("\\", "") not in page]
        assert not missing, name


def test_a_page_shows_its_linkage_and_the_table(pages):
    for name, entry in catalogue().items():
        page = pages[f"linkages/{name}.md"]
        assert f"```{{linkage}} {name}\n```" in page
        assert len(re.findall(r"^\| \d+ \| [\d-]+ \| ", page, re.M)) == entry.build().n


def test_links_of_a_page_lead_to_other_linkages(pages):
    for page in pages.values():
        for target in re.findall(r"\]\(([\w-]+)\.md\)", page):
            assert target in catalogue()


def test_every_linkage_stands_on_the_page_of_one_family():
    listed = []
    for page in family_pages().values():
        listed += re.search(r"\{linkage-gallery\} (.*)", page)[1].split()
    assert sorted(listed) == sorted(catalogue())
    assert families_toctree().count("families/") == len(families())


def test_a_record_says_what_the_map_says(dsg):
    assert (dsg.joints, dsg.form_count, dsg.bifurcation_count) == (6, 4, 4)
    assert dsg.counts.startswith("4 forms, 4 bifurcations, 1 component")
    assert dsg.completeness.startswith("counted: ")
    (bennett,) = [form for form in dsg.forms if "Bennett" in form.name]
    assert bennett.joints_at_rest == "3 at 180.0000, 6 at 180.0000"
    assert {point.kind for point in dsg.points} == {"bifurcation"}


def test_a_record_comes_back_from_json(dsg):
    values = json.loads(json.dumps(dsg.to_json()))
    assert LinkageRecord.from_json(values) == dsg


def test_a_page_holds_forms_points_and_closed_forms(dsg):
    page = linkage_page(catalogue()[DSG], dsg)
    assert all(f"| {form.name} |" in page.replace("\\", "") for form in dsg.forms)
    assert all(f"| {point.name} | bifurcation |" in page for point in dsg.points)
    assert page.count("$$") == 2 * sum(len(f.equations) for f in dsg.closed_forms) > 0


def test_forms_stand_by_name_and_counts_are_said_once(dsg):
    names = [form.name for form in dsg.forms]
    assert names == sorted(names)
    entry = catalogue()[DSG]
    assert "In all" not in linkage_page(entry, dsg)
    more = replace(dsg, counts=f"{dsg.counts}, 1 near miss")
    assert f"In all: {more.counts}." in linkage_page(entry, more)
    other = replace(dsg, verdict=dsg.verdict.replace("4 forms", "14 forms"))
    assert f"In all: {dsg.counts}." in linkage_page(entry, other)


def test_a_card_knows_joints_forms_name_and_author(dsg):
    entry = catalogue()[DSG]
    (card,) = cards_of({DSG: entry}, {DSG: dsg})
    assert (card.joints, card.forms, card.bifurcations) == (6, 4, 4)
    assert DSG in card.words and "song" in card.words
    html = gallery_html([card], "../")
    assert 'data-joints="6" data-forms="4"' in html
    assert f'href="../linkages/{DSG}.html"' in html


def test_the_gallery_offers_the_numbers_of_joints_that_there_are():
    records = {name: empty_record(entry) for name, entry in catalogue().items()}
    html = search_html(cards_of(catalogue(), records))
    joints = re.search(r'<select name="joints">(.*?)</select>', html)[1]
    numbers = {entry.build().n for entry in catalogue().values()}
    assert set(map(int, re.findall(r"<option>(\d+)</option>", joints))) == numbers


def test_words_with_quotes_do_not_end_an_attribute():
    name, entry = "bennett", catalogue()["bennett"]
    (card,) = cards_of({name: entry}, {name: empty_record(entry)})
    quoted = type(card)(name, 'a "title" <b>', "source", 4, 1, 0)
    html = gallery_html([quoted], "")
    assert '"title"' not in html and "<b>" not in html
