"""The page: one file that holds everything, small, and built from viewer/."""

import html.parser
import json
import logging
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import linkages.viewing.page
from linkages.viewing.document import make_view_document
from linkages.viewing.page import LARGEST, make_page, viewer_script, write_page

ROOT = Path(__file__).parents[3]
DSG = "special-double-subtractive-goldberg"


class Content(html.parser.HTMLParser):
    """The text of the elements of a page, by their tags and ids, and its addresses."""

    def __init__(self, page):
        super().__init__()
        self.texts, self.addresses, self._open = {}, [], ""
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self._open = values.get("id", tag)
        self.addresses += [values[key] for key in ("src", "href") if key in values]

    def handle_data(self, data):
        self.texts[self._open] = self.texts.get(self._open, "") + data


def test_a_page_fetches_nothing_and_holds_the_document(atlas_of):
    document = make_view_document(atlas_of(DSG))
    content = Content(make_page(document))
    assert content.addresses == []
    assert json.loads(content.texts["bifurc-document"]) == json.loads(
        json.dumps(document)
    )
    assert content.texts["title"].strip() == DSG


def test_names_cannot_leave_their_place_in_the_page(atlas_of):
    name = "</script><b>&amp;"
    document = make_view_document(atlas_of(DSG)) | {"title": name}
    content = Content(make_page(document))
    assert json.loads(content.texts["bifurc-document"])["title"] == name
    assert "b" not in content.texts


@pytest.mark.parametrize(
    "name", [DSG, "generic 7R", "isomerized-back-to-back-double-goldberg-sum"]
)
def test_a_page_has_less_than_a_megabyte_and_a_half(atlas_of, name, tmp_path):
    path = write_page(make_view_document(atlas_of(name)), tmp_path / "page.html")
    assert path.stat().st_size < LARGEST
    assert [one.name for one in tmp_path.iterdir()] == ["page.html"]


def test_a_page_that_is_larger_is_said_to_be(atlas_of, tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(linkages.viewing.page, "LARGEST", 1000)
    with caplog.at_level(logging.WARNING):
        write_page(make_view_document(atlas_of("bennett")), tmp_path / "page.html")
    assert "the page has 0.6 MB" in caplog.text


def test_the_script_carries_the_licence_of_three():
    head = viewer_script()[:1500]
    version = json.loads((ROOT / "viewer/package.json").read_text())
    assert f"three.js {version['devDependencies']['three']}" in head
    assert "Permission is hereby granted" in head


def test_versions_are_pinned_exactly():
    package = json.loads((ROOT / "viewer/package.json").read_text())
    for version in package["devDependencies"].values():
        assert re.fullmatch(r"\d+\.\d+\.\d+", version)


def test_the_script_is_what_the_sources_give(tmp_path):
    node = shutil.which("node")
    if node is None or not (ROOT / "viewer/node_modules").is_dir():
        pytest.skip("node or its packages are not there: run make viewer")
    target = tmp_path / "viewer.js"
    subprocess.run([node, ROOT / "viewer/build.js", target], check=True)
    assert target.read_text(encoding="utf-8") == viewer_script()
