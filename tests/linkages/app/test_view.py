"""The command `view`: where the page goes, and what is said of it."""

import webbrowser

import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.viewing.page import LARGEST

RIGID = """
angles = "deg"
lengths = [1.5, 0.7, 1.2, 0.9, 1.1, 0.6]
twists = [50, 80, 30, 100, 60, 110]
offsets = [0.2, -0.3, 0.5, 0.1, -0.4, 0.6]
"""


@pytest.fixture
def opened(tmp_path, monkeypatch):
    """The current folder is empty, and addresses are noted instead of opened."""
    monkeypatch.chdir(tmp_path)
    addresses = []
    monkeypatch.setattr(webbrowser, "open", lambda url: addresses.append(url) or True)
    return addresses


def view(*arguments):
    return CliRunner().invoke(main, ["view", *map(str, arguments)])


def test_the_page_is_named_after_the_linkage_and_opened(opened, tmp_path):
    result = view("bennett")
    assert result.exit_code == ExitCode.DONE
    assert "wrote bennett.html" in result.stderr
    page = tmp_path / "bennett.html"
    assert opened == [page.as_uri()]
    assert 500_000 < page.stat().st_size < LARGEST


def test_a_page_can_be_put_anywhere_and_left_closed(opened, tmp_path):
    result = view("kite", "--out", "my kite.html", "--no-open")
    assert result.exit_code == ExitCode.DONE
    assert opened == []
    assert [path.name for path in tmp_path.iterdir()] == ["my kite.html"]


def test_parameters_and_saved_atlases_are_shown(opened, tmp_path):
    assert view("bennett", "--param", "alpha=70", "--no-open").exit_code == 0
    CliRunner().invoke(main, ["map", "bennett", "--param", "alpha=70", "--out", "out"])
    assert view("out/atlas.nc", "--no-open").exit_code == 0
    content = (tmp_path / "atlas.html").read_text()
    assert content == (tmp_path / "bennett.html").read_text()
    assert content == (tmp_path / "out" / "map.html").read_text()


def test_a_linkage_that_does_not_move_is_shown_with_its_exit_code(opened, tmp_path):
    (tmp_path / "rigid.toml").write_text(RIGID)
    result = view("rigid.toml")
    assert result.exit_code == ExitCode.DOES_NOT_MOVE
    assert "The linkage is rigid" in (tmp_path / "rigid.html").read_text()


def test_where_no_browser_is_the_page_is_written_and_named(opened, monkeypatch):
    monkeypatch.setattr(webbrowser, "open", lambda url: False)
    result = view("bennett")
    assert result.exit_code == ExitCode.DONE
    assert "no browser was found; open bennett.html in one" in result.stderr
