"""Every study is a command that tells what it does."""

import time
from importlib import import_module
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from studies.study import Study

STUDIES = Path(__file__).parents[2] / "studies"


def commands() -> list[str]:
    """The names of the studies that are run by themselves."""
    names = []
    for path in sorted(STUDIES.glob("*.py")):
        if '__name__ == "__main__"' in path.read_text(encoding="utf-8"):
            names.append(path.stem)
    return names


@pytest.mark.parametrize("name", commands())
def test_a_study_answers_help(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    module = import_module(f"studies.{name}")
    command = module.main
    assert isinstance(command, click.Command)
    result = CliRunner().invoke(command, ["--help"])
    assert result.exit_code == 0
    assert "Usage:" in result.output
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["relations_figure", "bench", "same_answer_maps"])
def test_a_study_writes_to_no_path_without_a_name(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = import_module(f"studies.{name}").main
    arguments = [""] if name == "same_answer_maps" else ["--out", ""]
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code == 2
    assert "no name of a" in result.output
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("work_precision", ["--case", "UNKNOWN"]),
        ("curve_bank", ["--names", "UNKNOWN"]),
        ("curve_bank", ["--changes", "UNKNOWN"]),
        ("surface_bank", ["--names", "UNKNOWN"]),
        ("textbook_problems", ["--names", "UNKNOWN"]),
        ("textbook_problems", ["--collections", "UNKNOWN"]),
        ("textbook_times", ["--names", "UNKNOWN"]),
        ("grey_zone", ["--only", "UNKNOWN", "--out", "out"]),
        ("map_budget", ["UNKNOWN"]),
        ("reconfiguration_routes", ["UNKNOWN"]),
        ("same_answer", ["UNKNOWN"]),
        ("same_mechanism", ["UNKNOWN"]),
    ],
)
def test_an_unknown_name_ends_a_study_in_one_line(
    name, arguments, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    command = import_module(f"studies.{name}").main
    result = CliRunner().invoke(command, arguments)
    assert isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code != 0
    last = result.stderr.splitlines()[-1]
    assert last.startswith("Error: ") and "UNKNOWN" in last
    assert list(tmp_path.iterdir()) == []


def test_a_package_that_is_not_installed_is_named() -> None:
    @click.command(cls=Study)
    def study() -> None:
        import_module("no_such_package.part")

    result = CliRunner().invoke(study, [])
    assert result.exit_code == 1
    assert result.stderr == (
        "Error: no_such_package is not installed; pip install no_such_package\n"
    )


def test_a_study_gives_signs_of_life(monkeypatch) -> None:
    monkeypatch.setattr("linkages.app.output.EVERY", 0.02)

    @click.command("slow", cls=Study)
    def study() -> None:
        time.sleep(0.3)

    lines = CliRunner().invoke(study, []).stderr.splitlines()
    assert len(lines) >= 2
    assert all(line.startswith("working, ") for line in lines)
