"""Every study is a command that tells what it does."""

from importlib import import_module
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

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
