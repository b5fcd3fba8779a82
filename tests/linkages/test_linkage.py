"""Loading a linkage by name or from a file, and what it looks like at a prompt."""

from pathlib import Path

import pytest

from bifurc.errors import BifurcError
from linkages.catalogue import UnknownLinkageError, entry
from linkages.entry import Linkage
from linkages.file import LinkageFileError
from linkages.linkage import load
from linkages.loop import Loop
from linkages.values import GeometryError

TABLE = """
angles = "deg"
lengths = [1.0, 0.65, 1.0, 0.65]
twists = [100, 40, 100, 40]
offsets = [0, 0, 0, 0]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with a linkage file and a folder in it."""
    (tmp_path / "mine.toml").write_text(TABLE)
    (tmp_path / "more").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_named_linkage_has_the_loop_and_the_forms_of_its_entry():
    linkage = load("bennett", a=2.0)
    assert linkage.loop == entry("bennett").build(a=2.0)
    assert linkage.name == "bennett"
    assert [pattern.name for pattern in linkage.patterns] == ["Bennett form"]


@pytest.mark.parametrize("source", ["mine.toml", Path("mine.toml")])
def test_a_file_is_read_by_its_path_or_by_a_text(folder, source):
    assert load(source).name == "mine"


@pytest.mark.parametrize(
    ("source", "error", "words"),
    [
        ("Bennett", UnknownLinkageError, "'Bennett'; the nearest names are bennett"),
        ("", UnknownLinkageError, "no linkage is called ''"),
        ("mine", UnknownLinkageError, "'mine'; the nearest names are mine.toml"),
        ("more", LinkageFileError, "more: is a folder"),
        ("mine.tmol", LinkageFileError, r"no such file; the nearest here: mine\.toml"),
        ("out/mine", LinkageFileError, "no such file"),
        (Path("more"), LinkageFileError, "more: is a folder"),
        (Path("bennett"), LinkageFileError, "bennett: there is no such file"),
        ("nowhere.toml", LinkageFileError, r"nowhere\.toml: there is no such file"),
        (5, GeometryError, "linkage: 5 .* a name of the catalogue or the path"),
        (None, GeometryError, "linkage: None .* a name of the catalogue"),
    ],
)
def test_what_is_no_linkage_is_named(folder, source, error, words):
    with pytest.raises(error, match=words):
        load(source)


def test_a_file_takes_no_parameters(folder):
    with pytest.raises(GeometryError, match=r"parameters of mine\.toml: a .* left out"):
        load("mine.toml", a=1.0)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("1", 'parameter a of bennett: "1" .* a number'),
        (None, "parameter a of bennett: None .* a number"),
        (1j, "parameter a of bennett: 1j .* a number"),
        (float("nan"), "parameter a of bennett: nan .* a finite number"),
        (float("inf"), "parameter a of bennett: inf .* a finite number"),
    ],
)
def test_a_parameter_that_is_no_number_is_named(value, words):
    with pytest.raises(GeometryError, match=words):
        load("bennett", a=value)


def test_a_parameter_that_the_family_does_not_have_is_named():
    with pytest.raises(BifurcError, match=r"'gamma' .* one of a, alpha, beta"):
        load("bennett", gamma=1.0)


def test_a_linkage_shows_its_table_and_the_forms_of_its_source():
    lines = repr(load("bennett")).splitlines()
    assert lines[0] == "bennett: 4 joints"
    assert lines[2].split() == ["1", "12", "1", "100.0000", "0"]
    assert lines[-1] == "  forms named by the source: Bennett form"
    assert repr(Linkage(load("bennett").loop)).splitlines() == lines[:-1]


def test_a_notebook_shows_a_linkage_as_a_table():
    html = load("bennett")._repr_html_()
    assert html.count("<tr>") == 5
    assert "<th>twist (deg)</th>" in html
    assert "<td>100.0000</td>" in html
    assert "Bennett form" in html


def test_a_name_with_signs_of_html_is_shown_as_it_is():
    loop = Loop((1,) * 4, (0,) * 4, (0,) * 4, "a<b>")
    assert "a&lt;b&gt;: 4 joints" in Linkage(loop)._repr_html_()
