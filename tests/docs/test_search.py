"""The script of the site in a browser: the search of the gallery, and the button that
sets a linkage in motion."""

import os
import shutil

import pytest

from docs.generator.directives import view_html
from docs.generator.gallery import Card, gallery_html, search_html
from docs.generator.places import DOCS

BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
CARDS = [
    Card("bennett", "Bennett linkage", "Bennett 1903", 4, 1, 0),
    Card("altmann", "Altmann 6R", "Altmann 1954", 6, 1, 0),
    Card("two-forms", "Some 6R", "Song 2013; Bennett 1903", 6, 2, 1),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page with three cards and a linkage; skipped where there is no Chromium."""
    api = pytest.importorskip("playwright.sync_api")
    named = (shutil.which(name) for name in BROWSERS)
    program = os.environ.get("BIFURC_CHROMIUM") or next(filter(None, named), None)
    if program is None:
        pytest.skip("no Chromium was found: install chromium-headless-shell")
    script = (DOCS / "static" / "site.js").read_text(encoding="utf-8")
    style = (DOCS / "static" / "site.css").read_text(encoding="utf-8")
    body = search_html(CARDS) + gallery_html(CARDS, "") + view_html("bennett", "", "")
    path = tmp_path_factory.mktemp("site") / "gallery.html"
    path.write_text(f"<style>{style}</style>{body}<script>{script}</script>")
    with api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        opened = browser.new_page()
        opened.goto(path.as_uri())
        yield opened
        browser.close()


def search(page, words="", joints="", forms=""):
    """The names on the cards that are left."""
    page.fill("input[name=words]", words)
    page.select_option("select[name=joints]", joints)
    page.select_option("select[name=forms]", forms)
    names = page.locator(".gallery-card:visible code").all_inner_texts()
    assert page.inner_text(".gallery-count") == f"{len(names)} of 3 linkages"
    return names


def test_all_cards_are_shown_at_first(page):
    assert search(page) == ["bennett", "altmann", "two-forms"]


def test_words_are_looked_for_in_name_title_and_author(page):
    assert search(page, "Bennett") == ["bennett", "two-forms"]
    assert search(page, "song 2013") == ["two-forms"]
    assert search(page, "1954 altmann") == ["altmann"]
    assert search(page, "nobody") == []


def test_joints_and_forms_can_be_chosen(page):
    assert search(page, joints="6") == ["altmann", "two-forms"]
    assert search(page, joints="6", forms="2") == ["two-forms"]
    assert search(page, "altmann", forms="2") == []


def test_the_button_loads_the_page_of_the_viewer_in_place_of_the_pictures(page):
    assert page.locator("iframe").count() == 0
    page.click(".linkage-buttons button")
    assert page.get_attribute("iframe", "src") == "viewer/bennett.html"
    assert page.locator(".linkage-pictures").count() == 0
