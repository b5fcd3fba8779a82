"""The examples of README and docs: Python blocks run, `bifurc` lines do what is shown,
the picture is true.

A console block holds `$ bifurc ...` lines, each with the output that must follow: line
by line, "..." for any lines, the beginning of a line for the whole of it. A comment
"exit code N" behind a command is what it ends with. Blocks that are files are written
to these first (docs/generator/page_files.py).
"""

import re
import shlex
import tomllib
from pathlib import Path

import matplotlib
import pytest
from click.testing import CliRunner

from bifurc.graphs import transition_graph
from docs.generator.page_files import BLOCK, files_of
from linkages.app.cli import main
from linkages.linkage import load
from linkages.mapping import map_linkage
from tests.linkages.app.sweep.same_process import pool_at_once

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page, language):
    return [
        text
        for kind, _, text in BLOCK.findall(page.read_text(encoding="utf-8"))
        if kind == language
    ]


def console_examples(text):
    """(arguments, exit code, expected lines) of every command of a console block."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, *expected = part.rstrip("\n").split("\n")
        code = re.search(r"# exit code (\d+)", command)
        program, *arguments = shlex.split(command, comments=True)
        assert program == "bifurc", command
        yield arguments, int(code[1]) if code else 0, expected


def check_output(output, expected):
    lines, anywhere = iter(output.splitlines()), False
    for wanted in expected:
        if wanted == "...":
            anywhere = True
            continue
        for line in lines:
            if line.startswith(wanted):
                break
            assert anywhere, f"{line!r} where {wanted!r} is promised"
        else:
            raise AssertionError(f"{wanted!r} is promised and does not come")
        anywhere = False


@pytest.mark.parametrize(
    "page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix()
)
def test_the_examples_of_a_page_do_what_it_says(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    matplotlib.use("Agg")
    monkeypatch.setattr("linkages.app.sweep.run.open_pool", pool_at_once)
    for name, text in files_of(page.read_text(encoding="utf-8")).items():
        Path(name).write_text(text, encoding="utf-8")
    for text in blocks(page, "console"):
        for arguments, code, expected in console_examples(text):
            result = CliRunner().invoke(main, arguments)
            assert result.exit_code == code, (arguments, result.output)
            check_output(result.stdout, expected)
    names: dict = {}
    for text in blocks(page, "python"):
        exec(compile(text, str(page), "exec"), names)


def test_the_picture_in_the_readme_is_the_graph_of_forms():

    (text,) = blocks(ROOT / "README.md", "mermaid")
    names = dict(re.findall(r'(\w+)\["(.*?)"\]', text))
    drawn = re.findall(r"(\w+)(?:\[.*?\])? ---\|(\w+)\| (\w+)", text)
    graph = transition_graph(map_linkage(load("special-double-subtractive-goldberg")))
    real = {
        (frozenset((a, b)), data["bifurcation"])
        for a, b, data in graph.edges(data=True)
    }
    assert {(frozenset((names[a], names[b])), point) for a, point, b in drawn} == real


@pytest.mark.parametrize(
    "page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix()
)
def test_links_between_pages_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def test_the_citation_is_of_this_version():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {project['version']}\n" in citation
    assert f"\nlicense: {project['license']}\n" in citation
    assert f'\ntitle: "{project["name"]}: ' in citation


def test_what_contributing_names_is_there():
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    names = re.findall(
        r"`((?:bifurc|linkages|tests|studies|docs|viewer)/[\w./]+)`", page
    )
    assert len(names) > 20
    missing = [name for name in names if not (ROOT / name).exists()]
    assert missing == []
