"""Dead links of a built site are seen."""

import pytest

from docs.generator.links import DeadLink, dead_links, fetched_from_afar


@pytest.fixture
def site(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.html").write_text('<h1 id="top"></h1><a href="sub/b.html#x">b</a>')
    (tmp_path / "sub" / "b.html").write_text('<p id="x"></p><img src="../p.svg">')
    (tmp_path / "p.svg").write_text("<svg/>")
    return tmp_path


def test_a_whole_site_has_no_dead_links(site):
    assert dead_links(site) == []


@pytest.mark.parametrize(
    "target",
    ["c.html", "a.html#bottom", "#nowhere", "sub/", "sub/b.html#top", "%70.png"],
)
def test_a_link_to_what_is_not_there_is_seen(site, target):
    (site / "c").mkdir()
    (site / "c" / "d.html").write_text(f'<a href="{target}">c</a>')
    assert dead_links(site) == [DeadLink("c/d.html", target)]


def test_the_page_of_a_button_is_looked_for(site):
    (site / "e.html").write_text('<button data-page="viewer/x.html"></button>')
    assert dead_links(site) == [DeadLink("e.html", "viewer/x.html")]


def test_other_sites_are_not_asked(site):
    (site / "f.html").write_text('<a href="https://toml.io/x#y">x</a>')
    assert dead_links(site) == []


def test_what_is_fetched_from_other_hosts_is_seen(site):
    address = "https://example.org/x.js"
    (site / "g.html").write_text(f'<a href="{address}">x</a>')
    (site / "h.html").write_text(f'<script src="{address}"></script>')
    assert fetched_from_afar(site) == [DeadLink("h.html", address)]
