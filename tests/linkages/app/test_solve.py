"""The command `bifurc solve`: outputs, exit codes, and errors in one line."""

from __future__ import annotations

import json

import networkx as nx
import pytest
from click.testing import CliRunner

import bifurc
from linkages.app.cli import main

PITCHFORK = """
parameter = "p"
[unknowns]
x = [-2, 2]
p = [-2, 2]
[parameters]
k = 1
[equations]
rate = "x' = k*p*x - x^3"
[events]
one = "p = 1"
"""


def solve(*arguments):
    return CliRunner().invoke(main, ["solve", *map(str, arguments)])


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "pitchfork.toml"
    file.write_text(PITCHFORK)
    return file


def test_everything_is_written_and_shown(path, tmp_path) -> None:
    out = tmp_path / "out"
    result = solve(path, "--out", out)
    assert result.exit_code == 0
    for text in (
        "pitchfork\nThe solutions are 2 forms in 1 component, 1 bifurcation.",
        "rate  x' = k*p*x - x^3",
        "with k = 1",
        "supercritical pitchfork",
        "stable",
    ):
        assert text in result.stdout
    assert (out / "summary.txt").read_text() == result.stdout
    pictures = ("diagram", "transition_map", "unknowns", "singular_values")
    for name in (*pictures, "form_graph"):
        assert (out / f"{name}.png").stat().st_size > 1000
        assert (out / f"{name}.svg").stat().st_size > 1000
    atlas = bifurc.load_atlas(out / "atlas.nc")
    assert len(atlas.diagram.events("one")) == 3
    assert nx.read_graphml(out / "graph.graphml").nodes["point/B1"]["branching"]


def test_json_is_one_document_with_the_diagram(path) -> None:
    result = solve(path, "--json", "--param", "k=4", "--seed", "2")
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert document["parameters"] == {"k": 4.0}
    assert document["seed"] == 2
    diagram = document["diagram"]
    assert diagram["branchings"] == [{"point": "B1", "kind": "supercritical pitchfork"}]
    assert sorted(event["u"]["x"] for event in diagram["events"]) == pytest.approx(
        [-2, 0, 2], abs=1e-12
    )
    assert len(document["singular_points"][0]["passes"]) == 2
    assert {one["stability"] for one in diagram["stretches"]} == {"stable", "unstable"}


@pytest.mark.parametrize(
    "equations, code, words",
    [
        (["x^2 + p^2 + 1"], 3, "There is no solution within the bounds"),
        (["x^2 + p^2"], 3, "isolated solution"),
        (
            ["x", "p - x^2"],
            3,
            "There is no curve of solutions, but 1 isolated solution",
        ),
        (["0*x + x - x + 1e-3*p"], 0, "1 form"),
    ],
)
def test_the_exit_code_says_whether_there_are_curves(
    tmp_path, equations, code, words
) -> None:
    path = tmp_path / "system.toml"
    unknowns = "[unknowns]\nx = [-1, 1]\np = [-1, 1]\n"
    path.write_text(f"equations = {json.dumps(equations)}\n{unknowns}")
    result = solve(path)
    assert (result.exit_code, words in result.stdout) == (code, True), result.stdout
    assert solve(path, "--json").exit_code == code


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--param", "q=1"], "parameters.q: there is none in the file"),
        (["--param", "k"], "--param k: it must be KEY=NUMBER"),
        (["--param", "k=one"], "--param k=one: it must be KEY=NUMBER"),
        (["--param", "k=nan"], "parameters.k"),
        (["--param", "k=1", "--param", "k=2"], "k is given twice"),
        (["--tolerance", "1"], "--tolerance"),
    ],
)
def test_bad_input_ends_in_one_line_and_writes_nothing(
    path, tmp_path, arguments, message
) -> None:
    out = tmp_path / "out"
    result = solve(path, "--out", out, *arguments)
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not out.exists()


def test_a_file_that_is_none_is_named(tmp_path) -> None:
    result = solve(tmp_path / "nothing.toml")
    assert result.exit_code == 2
    assert "nothing.toml: there is no such file" in result.stderr


def test_a_budget_that_ends_at_once_says_that_nothing_is_known(path) -> None:
    result = solve(path, "--budget", "1e-9")
    assert result.exit_code == 7
    assert "is not known" in result.stdout


def test_boxes_prove_that_nothing_is_missing(tmp_path) -> None:
    file = tmp_path / "lemniscate.toml"
    file.write_text(
        'equations = ["(x^2 + y^2)^2 = x^2 - y^2"]\n[unknowns]\nx = [-2, 2]\ny = [-2, 2.1]\n'
    )
    levels = []
    for boxes in (0, 100_000):
        result = solve(file, "--json", "--boxes", boxes, "--paths", 0)
        levels.append(json.loads(result.stdout)["completeness"]["level"])
    assert levels == ["estimated", "certified"]
    assert solve(file, "--boxes", -1).exit_code == 2


def test_charts_that_ran_out_are_said_first_and_more_of_them_can_be_had(
    tmp_path,
) -> None:
    file = tmp_path / "sphere.toml"
    file.write_text(
        'equations = ["x^2 + y^2 + z^2 = 1"]\n'
        "[unknowns]\nx = [-2, 2]\ny = [-2, 2]\nz = [-2, 2]\n"
    )
    few = solve(file, "--charts", 20)
    assert "1 surface. Charts ran out: " in few.stdout.splitlines()[1]
    assert "more than" in few.stdout
    document = json.loads(solve(file, "--charts", 20, "--json").stdout)
    assert "Charts ran out" in document["verdict"]
    (doubt,) = document["completeness"]["doubts"]
    assert doubt["kind"] == "charts ran out"
    assert 0 < doubt["data"]["starts"] <= 200
    assert "Charts ran out" not in solve(file, "--charts", 1000).stdout
    assert solve(file, "--charts", -1).exit_code == 2


def test_the_diagram_is_drawn_over_the_axes_that_are_chosen(
    path, tmp_path, monkeypatch
) -> None:
    drawn = []

    def save_figures(atlas, stage, others, *_):
        drawn.append(others["diagram"](atlas).axes[0])
        return []

    monkeypatch.setattr("bifurc.figures.plotting.save_figures", save_figures)
    result = solve(path, "--axes", "x,|x|", "--out", tmp_path / "out")
    assert result.exit_code == 0
    assert (drawn[0].get_xlabel(), drawn[0].get_ylabel()) == ("x", "|x|")
    for axes, words in (
        ("x", "does not name two axes"),
        ("x,q", "axis: 'q' is not allowed; it must be |u|, a function, or one of"),
    ):
        result = solve(path, "--axes", axes, "--out", tmp_path / "none")
        assert (result.exit_code, words in result.stderr) == (2, True), result.stderr
    result = solve(path, "--axes", "x,p")
    assert "--axes: figures are only drawn with --out DIR" in result.stderr
