"""What `bifurc map --out` leaves on disk, also when it is interrupted."""

import json
import time

import pytest
from click.testing import CliRunner

import bifurc.search.tracing
from linkages.app.cli import main
from linkages.app.files import write_data
from linkages.app.output import StatusLine, prepare_folder, saying_progress
from linkages.closure.closure import Closure
from linkages.linkage import load
from linkages.mapping import map_linkage


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def interrupted_search(monkeypatch):
    """Ctrl-C when the second branch is about to be traced."""
    trace, calls = bifurc.search.tracing.trace_branch, []

    def trace_one(*arguments, **options):
        calls.append(1)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return trace(*arguments, **options)

    monkeypatch.setattr(bifurc.search.tracing, "trace_branch", trace_one)


def test_out_holds_dataset_graph_summary_and_figures_and_nothing_else(tmp_path):
    folder = tmp_path / "new" / "folder"
    result = run("map", "parallelogram", "--out", folder, "--verbose")
    assert result.exit_code == 0
    found = names(folder)
    assert {"atlas.nc", "graph.graphml", "summary.txt", "map.html"} <= set(found)
    figures = set(found) - {"atlas.nc", "graph.graphml", "summary.txt", "map.html"}
    stems = {name.rsplit(".", 1)[0] for name in figures}
    assert len(stems) >= 4
    assert figures == {
        f"{stem}.{ending}" for stem in stems for ending in ("png", "svg")
    }
    assert (folder / "summary.txt").read_text() == result.stdout


def test_an_interrupted_search_keeps_what_was_found_and_ends_with_130(
    tmp_path, interrupted_search
):
    result = run("map", "rhombus", "--out", tmp_path, "--json")
    assert result.exit_code == 130
    document = json.loads(result.stdout)
    assert len(document["forms"]) == 1
    assert document["completeness"]["level"] == "estimated"
    assert "interrupted" in result.stderr
    assert "atlas.nc" in names(tmp_path)
    assert not [name for name in names(tmp_path) if name.startswith(".")]


def test_a_search_interrupted_before_anything_is_found_ends_with_130(monkeypatch):
    def seeds(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Closure, "seeds", seeds)
    result = run("map", "rhombus")
    assert result.exit_code == 130
    assert "interrupted" in result.stdout


def test_an_interrupt_while_a_file_is_written_leaves_no_half_of_it(
    tmp_path, monkeypatch
):
    import bifurc.figures.plotting

    def half(atlas, folder, *_):
        (folder / "transition_map.png").write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(bifurc.figures.plotting, "save_figures", half)
    result = run("map", "parallelogram", "--out", tmp_path)
    assert result.exit_code == 130
    assert names(tmp_path) == ["atlas.nc", "graph.graphml", "summary.txt"]


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_computed(
    tmp_path, monkeypatch
):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr(
        bifurc.search.tracing, "trace_branch", None
    )  # any computation would fail
    for folder in (tmp_path / "file", tmp_path / "file" / "below", "/proc/nothing"):
        result = run("map", "parallelogram", "--out", folder)
        assert result.exit_code == 2
        assert str(folder) in result.stderr
        assert result.stdout == ""


def test_preparing_a_folder_leaves_nothing_in_it(tmp_path):
    prepare_folder(tmp_path / "a")
    assert names(tmp_path / "a") == []


def test_results_replace_older_ones(tmp_path):

    (tmp_path / "summary.txt").write_text("old")
    written = write_data(map_linkage(load("bennett")), tmp_path, "new")
    assert (tmp_path / "summary.txt").read_text() == "new\n"
    assert sorted(path.name for path in written) == names(tmp_path)


def test_a_search_says_what_it_does_where_no_terminal_is(capsys, monkeypatch):
    monkeypatch.setattr("linkages.app.output.EVERY", 0.01)
    with saying_progress():
        time.sleep(0.1)
        with StatusLine() as status:
            status("forms so far; step: gather seeds", 3)
            time.sleep(0.1)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "working, 0 s"
    assert lines[-1] == "exploring, 0 s: 3 forms so far; step: gather seeds"
    time.sleep(0.05)
    assert capsys.readouterr().err == ""
