"""The commands `map --rigorous` and `check`."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from linkages.app.cli import main


def bifurc(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_a_certificate_is_written_and_checked(tmp_path):
    file = tmp_path / "map.json"
    result = bifurc("map", "bennett", "--certificate", file)
    assert result.exit_code == 0, result.output
    assert "  joined: holds" in result.stdout
    assert "  all motions: holds; every motion is on the map" in result.stdout
    checked = bifurc("check", file)
    assert checked.exit_code == 0
    assert "no jump: holds" in checked.stdout

    certificate = json.loads(file.read_text())
    certificate["geometry"]["lengths"][0] = "1.01"
    file.write_text(json.dumps(certificate))
    refused = bifurc("check", file)
    assert refused.exit_code == 6
    assert "does not hold" in refused.stdout


@pytest.mark.parametrize("content", [b"no certificate", b"\xff\xfe"])
@pytest.mark.parametrize("name", ["map.json", "map.json.gz"])
def test_a_file_that_is_no_certificate_is_refused_in_one_line(tmp_path, name, content):
    file = tmp_path / name
    file.write_bytes(content)
    result = bifurc("check", file)
    assert result.exit_code == 2
    assert len(result.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize("options", [["--json"], ["--nearest"]])
def test_what_does_not_go_with_a_proof_is_refused(options):
    result = bifurc("map", "bennett", "--rigorous", *options)
    assert result.exit_code == 2 and "--rigorous" in result.stderr


def test_a_mechanism_has_no_proof():
    result = bifurc("map", "four-bennett-network", "--rigorous")
    assert result.exit_code == 2
    assert "single loops that are given as a table" in result.stderr


def test_a_certificate_has_the_ending_of_its_format(tmp_path):
    result = bifurc("map", "bennett", "--certificate", tmp_path / "map.txt")
    assert result.exit_code == 2
    assert not Path(tmp_path / "map.txt").exists()
